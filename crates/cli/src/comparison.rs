//! What `bilux compare` is told.

use clap::Args;
use std::path::PathBuf;

/// Say how far picture A is from the reference B.
#[derive(Args)]
#[command(after_help = "Exit status: 0 within the bounds, 1 beyond them, 2 trouble.\n\n\
    Example:\n  bilux compare a.png reference.png --max-flip 0.02 --heat-map difference.png")]
pub struct Compare {
    /// The picture
    pub picture: PathBuf,
    /// The reference
    pub reference: PathBuf,
    /// As JSON
    #[arg(long)]
    pub json: bool,
    /// Most mean FLIP error
    #[arg(long, value_name = "X")]
    pub max_flip: Option<f64>,
    /// Most root mean square error
    #[arg(long, value_name = "X")]
    pub max_rmse: Option<f64>,
    /// Most relative mean square error
    #[arg(long, value_name = "X")]
    pub max_relmse: Option<f64>,
    /// Most error of any sample
    #[arg(long, value_name = "X")]
    pub max_error: Option<f64>,
    /// Least structural similarity
    #[arg(long, value_name = "X")]
    pub min_ssim: Option<f64>,
    /// Least peak signal-to-noise ratio, in dB
    #[arg(long, value_name = "X")]
    pub min_psnr: Option<f64>,
    /// Write a picture of where they differ
    #[arg(long, value_name = "FILE")]
    pub heat_map: Option<PathBuf>,
}
