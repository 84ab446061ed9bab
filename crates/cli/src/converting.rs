//! The options of `bilux convert`.

use crate::choices::Posed;
use crate::help;
use crate::values::{parse_positive, parse_quality};
use clap::Args;
use std::path::PathBuf;

/// Convert a scene or a picture to another format
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(
    after_help = "Examples:\n  bilux convert model.obj -o model.glb\n  bilux convert sky.hdr -o sky.exr\n  \
    bilux convert picture.exr -o picture.jpg --quality 80\n  \
    bilux convert scene.layers.exr -o rays.png --heat-map rays"
)]
pub struct Convert {
    /// The scene or picture to convert
    pub input: PathBuf,
    /// The file to write; its extension sets the format
    #[arg(short, long, value_name = "OUT", help_heading = help::OUTPUT)]
    pub output: PathBuf,
    /// Write PLY and STL files as text instead of binary
    #[arg(long, help_heading = help::OUTPUT)]
    pub ascii: bool,
    /// The quality of a JPEG, from 1 to 100 [default: 92]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_quality, help_heading = help::OUTPUT)]
    pub quality: Option<u8>,
    /// The layer of an EXR to convert, such as albedo or ViewLayer.Combined [default: its main picture; all layers for an
    /// EXR]
    #[arg(long, value_name = "NAME", conflicts_with = "heat_map", help_heading = help::OUTPUT)]
    pub layer: Option<String>,
    /// Show one channel of a picture, such as rays.mean or depth.Z, in false colours: black for 0, through violet, red and
    /// orange to pale yellow for its maximum. The name of a layer stands for its first channel
    #[arg(long, value_name = "CHANNEL", help_heading = help::OUTPUT)]
    pub heat_map: Option<String>,
    /// The value that is pale yellow, so that several heat maps can be compared [default: the maximum of the picture]
    #[arg(long, value_name = "VALUE", allow_hyphen_values = true, requires = "heat_map", value_parser = parse_positive, help_heading = help::OUTPUT)]
    pub heat_max: Option<f32>,
    /// Photometric units for --heat-map luminance: cd/m2, or lx for the illuminance of matt surfaces, which needs the layer
    /// albedo. A scale with numbers is added below the picture, which must hold light, such as an EXR
    #[arg(long, value_name = "UNIT", requires = "heat_map", value_parser = ["cd/m2", "lx"], help_heading = help::OUTPUT)]
    pub unit: Option<String>,
    #[command(flatten)]
    pub posed: Posed,
}
