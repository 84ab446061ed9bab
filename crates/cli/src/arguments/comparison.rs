//! The options of `bilux compare`.

use crate::arguments::help;
use crate::arguments::values::parse_bound;
use clap::Args;
use std::path::PathBuf;

/// Compare pictures with references, by FLIP and other metrics: one pair, or two folders
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  bilux compare a.png reference.png\n  \
    bilux compare a.png reference.png --max-flip 0.02 --heat-map difference.png\n  \
    bilux compare new/ reference/ --max-flip 0.02 --html report.html\n  \
    bilux list metrics    What is measured\n\n\
    Exit status:\n  \
    0  Every bound holds\n  \
    1  A bound does not hold\n  \
    2  Pictures cannot be compared, or one has no counterpart")]
pub struct Compare {
    /// The picture to measure, or a folder of pictures
    pub picture: PathBuf,
    /// The reference picture, or a folder of references with the same names as the pictures
    pub reference: PathBuf,
    /// The layer to compare, of an EXR that has several [default: its main picture]
    #[arg(long, value_name = "NAME", help_heading = help::PICTURE)]
    pub layer: Option<String>,
    /// The maximum mean FLIP error, from 0 to 1
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = parse_bound, help_heading = BOUNDS)]
    pub max_flip: Option<f64>,
    /// The maximum root mean square error
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = parse_bound, help_heading = BOUNDS)]
    pub max_rmse: Option<f64>,
    /// The maximum relative mean square error
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = parse_bound, help_heading = BOUNDS)]
    pub max_relmse: Option<f64>,
    /// The maximum absolute difference in any pixel
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = parse_bound, help_heading = BOUNDS)]
    pub max_error: Option<f64>,
    /// The minimum structural similarity, at most 1
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = parse_bound, help_heading = BOUNDS)]
    pub min_ssim: Option<f64>,
    /// The minimum peak signal-to-noise ratio, in dB
    #[arg(long, value_name = "X", allow_hyphen_values = true, value_parser = parse_bound, help_heading = BOUNDS)]
    pub min_psnr: Option<f64>,
    /// Print JSON instead of text
    #[arg(long, help_heading = help::OUTPUT)]
    pub json: bool,
    /// Write a heat map of the FLIP error to this file
    #[arg(long, value_name = "FILE", help_heading = help::OUTPUT)]
    pub heat_map: Option<PathBuf>,
    /// Write an HTML page with the pictures side by side and flickering, and with their errors
    #[arg(long, value_name = "FILE", help_heading = help::OUTPUT)]
    pub html: Option<PathBuf>,
}

/// The heading of the options that decide the exit status.
const BOUNDS: &str = "Bounds";
