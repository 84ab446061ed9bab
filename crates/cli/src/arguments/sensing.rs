//! The options of `bilux sensor`. Those of the sensor come from its row of parameters.

use crate::arguments::assignments::value_of;
use crate::arguments::help;
use crate::arguments::tables::{Assigned, OptionTable, TableOptions, sentence};
use crate::arguments::values::{Exposure, parse_exposure, parse_quality};
use bilux::math::registry::{Parameter, ParameterKind};
use bilux::pictures::sensor::SENSOR;
use bilux::tables::values;
use clap::{Arg, Args};
use std::path::PathBuf;

/// Make a picture of photons: what the sensor of a camera reads, with its noise
#[derive(Args)]
#[command(help_template = help::TEMPLATE)]
#[command(after_help = "Examples:\n  bilux sensor light.exr -o shot.png --exposure auto\n  \
    bilux sensor light.exr -o shot.exr --exposure-time 0.002 --f-number 4 --iso 800\n  \
    bilux sensor light.exr -o raw.png --output-kind raw --pattern rggb --bit-depth 12\n\n\
    Samples of the picture are radiance in W/(m2 sr), as Bilux renders it; 1 in every channel is 683 cd/m2. The light of a \
    channel is taken to have one wavelength, and to pass only the filter of its colour. A raw .png has the digital numbers as \
    they are, in 16 bits; in an .exr they are floats.")]
pub struct Sensor {
    /// The picture of the light, such as an .exr
    pub input: PathBuf,
    /// The picture to write; its extension sets the format
    #[arg(short, long, value_name = "OUT", help_heading = help::OUTPUT)]
    pub output: PathBuf,
    /// The layer to take, of an EXR that has several [default: its main picture]
    #[arg(long, value_name = "NAME", help_heading = help::PICTURE)]
    pub layer: Option<String>,
    #[command(flatten)]
    pub sensor: TableOptions<OfSensor>,
    /// Brighten display formats by this many stops (powers of two), or automatically to the brightness of a photograph; raw
    /// numbers stay as they are
    #[arg(long, value_name = "EV|auto", allow_hyphen_values = true, default_value = "0",
        value_parser = parse_exposure, help_heading = help::PICTURE)]
    pub exposure: Exposure,
    /// The tone-mapping curve for display formats (`bilux list tonemaps`)
    #[arg(long, value_name = "NAME", default_value = "none", help_heading = help::PICTURE)]
    pub tonemap: String,
    /// The quality of a JPEG, from 1 to 100 [default: 92]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = parse_quality, help_heading = help::OUTPUT)]
    pub quality: Option<u8>,
}

/// The parameters of the sensor.
pub struct OfSensor;

impl OptionTable for OfSensor {
    fn options() -> Vec<Arg> {
        SENSOR.parameters.iter().map(option).collect()
    }
}

fn option(parameter: &'static Parameter) -> Arg {
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    let is_triple = matches!(parameter.kind, ParameterKind::Colour { .. });
    let (values, default) = (values(parameter.kind), parameter.default.replace(' ', ","));
    let default = if is_triple { default } else { parameter.default.to_owned() };
    let values = values.strip_prefix("colour ").map_or(values.clone(), |range| format!("each {range}"));
    let value = match parameter.kind {
        ParameterKind::Colour { .. } => "R,G,B",
        ParameterKind::Choice(_) => "NAME",
        ParameterKind::Integer { .. } => "N",
        _ => "X",
    };
    let name = match parameter.name {
        // `--output` is the file.
        "output" => "output-kind".to_owned(),
        name => name.replace('_', "-"),
    };
    Arg::new(name.clone())
        .long(name)
        .value_name(value)
        .allow_hyphen_values(true)
        .value_parser(move |text: &str| Ok::<Assigned, String>((parameter.name, value_of(text))))
        .help_heading("Sensor")
        .help(format!("{}; {values}{unit} [default: {default}]", sentence(parameter.summary)))
}
