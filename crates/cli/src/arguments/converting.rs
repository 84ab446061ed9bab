//! The options of `bilux convert`.

use crate::arguments::choices::Posed;
use crate::arguments::help;
use crate::arguments::values::{parse_maintenance, parse_positive, parse_quality};
use clap::Args;
use std::path::PathBuf;

/// Convert a scene or a picture to another format
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(
    after_help = "Examples:\n  bilux convert model.obj -o model.glb\n  bilux convert sky.hdr -o sky.exr\n  \
    bilux convert picture.exr -o picture.jpg --quality 80\n  \
    bilux convert scene.layers.exr -o rays.png --heat-map rays\n  \
    bilux convert plan.exr -o plan.png --heat-map luminance --unit lx --contours 300,500\n  \
    bilux convert plan.exr -o plan.csv --heat-map luminance --unit lx --maintenance-factor 0.8"
)]
pub struct Convert {
    /// The scene or picture to convert; `-` reads it from standard input
    pub input: PathBuf,
    /// The file to write; its extension sets the format, of which .csv is a table of numbers with --heat-map; `-` writes a
    /// picture to standard output
    #[arg(short, long, value_name = "OUT", help_heading = help::OUTPUT)]
    pub output: PathBuf,
    /// The format of a picture on standard output (`bilux list picture-formats`) [default: png]
    #[arg(long, value_name = "NAME", help_heading = help::OUTPUT)]
    pub output_format: Option<String>,
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
    /// Multiply photometric values by this factor, from 0 to 1, for lamps that have aged and rooms that have become dirty
    #[arg(long, value_name = "MF", allow_hyphen_values = true, requires = "unit", value_parser = parse_maintenance, help_heading = help::OUTPUT)]
    pub maintenance_factor: Option<f32>,
    /// Draw lines into the heat map where it has these values
    #[arg(long, value_name = "VALUE,…", allow_hyphen_values = true, requires = "heat_map", value_delimiter = ',', value_parser = parse_positive, help_heading = help::OUTPUT)]
    pub contours: Vec<f32>,
    #[command(flatten)]
    pub posed: Posed,
}
