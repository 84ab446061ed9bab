//! The options of `bilux denoise`.

use crate::arguments::help;
use crate::arguments::values::{Exposure, parse_count, parse_exposure, parse_quality};
use clap::Args;
use std::path::PathBuf;

/// Remove the noise from a picture
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  bilux denoise noisy.exr -o clean.exr\n  \
    bilux denoise noisy.exr -o clean.png --tonemap agx\n  \
    bilux denoise photo.png -o clean.png --by builtin\n\n\
    The result is much better if the .exr has the layers albedo, normal, depth and variance. To write them:\n  \
    bilux render scene.toml -o noisy.exr --aov guides,variance")]
pub struct Denoise {
    /// The noisy picture
    pub input: PathBuf,
    /// The denoised picture to write; its extension sets the format
    #[arg(short, long, value_name = "OUT", help_heading = help::OUTPUT)]
    pub output: PathBuf,
    /// The layer to denoise, of an EXR that has several [default: its main picture]
    #[arg(long, value_name = "NAME", help_heading = help::PICTURE)]
    pub layer: Option<String>,
    /// The denoiser (`bilux list denoisers`)
    #[arg(long, value_name = "auto|oidn|builtin", default_value = "auto", help_heading = help::PICTURE)]
    pub by: String,
    /// Brighten display formats by this many stops (powers of two), or automatically to the brightness of a photograph
    #[arg(long, value_name = "EV|auto", allow_hyphen_values = true, default_value = "0",
        value_parser = parse_exposure, help_heading = help::PICTURE)]
    pub exposure: Exposure,
    /// The tone-mapping curve for display formats (`bilux list tonemaps`)
    #[arg(long, value_name = "NAME", default_value = "none", help_heading = help::PICTURE)]
    pub tonemap: String,
    /// The quality of a JPEG, from 1 to 100 [default: 92]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_quality, help_heading = help::OUTPUT)]
    pub quality: Option<u8>,
    /// The number of threads; 0 uses all cores
    #[arg(long, value_name = "N", allow_hyphen_values = true, default_value = "0", value_parser = parse_count,
        help_heading = help::SPEED)]
    pub threads: u32,
}
