//! The options of `bilux sensor`. Those of the sensor come from its row of parameters.

use crate::arguments::assignments::{from_flag, value_of};
use crate::arguments::help;
use crate::arguments::values::{Exposure, parse_exposure, parse_quality};
use bilux::math::registry::ParameterKind;
use bilux::pictures::sensor::SENSOR;
use bilux::scene::Parameters;
use bilux::tables::values;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
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
    pub sensor: SensorParameters,
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

/// The parameters of the sensor that are given.
pub struct SensorParameters(pub Parameters);

/// The heading of the sensor's options.
const HEADING: &str = "Sensor";

/// The name of a parameter's option.
fn flag(parameter: &str) -> String {
    match parameter {
        // `--output` is the file.
        "output" => "output-kind".to_owned(),
        name => name.replace('_', "-"),
    }
}

impl Args for SensorParameters {
    fn augment_args(command: Command) -> Command {
        SENSOR.parameters.iter().fold(command, |command, parameter| {
            let unit = if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
            let is_triple = matches!(parameter.kind, ParameterKind::Colour { .. });
            let (values, default) = (values(parameter.kind), parameter.default.replace(' ', ","));
            let default = if is_triple { default } else { parameter.default.to_owned() };
            let values =
                values.strip_prefix("colour ").map_or(values.clone(), |range| format!("each {range}"));
            let mut summary = parameter.summary.to_owned();
            summary[..1].make_ascii_uppercase();
            let help = format!("{summary}; {values}{unit} [default: {default}]");
            let name = match parameter.kind {
                ParameterKind::Colour { .. } => "R,G,B",
                ParameterKind::Choice(_) => "NAME",
                ParameterKind::Integer { .. } => "N",
                _ => "X",
            };
            let option =
                Arg::new(flag(parameter.name)).long(flag(parameter.name)).value_name(name).help(help);
            command.arg(option.allow_hyphen_values(true).help_heading(HEADING))
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        SensorParameters::augment_args(command)
    }
}

impl FromArgMatches for SensorParameters {
    fn from_arg_matches(matches: &ArgMatches) -> Result<SensorParameters, clap::Error> {
        let mut given = Parameters::default();
        for parameter in SENSOR.parameters {
            let flag = flag(parameter.name);
            if let Some(text) = matches.get_one::<String>(&flag) {
                given.set_at(parameter.name, value_of(text), from_flag(&format!("--{flag}")));
            }
        }
        Ok(SensorParameters(given))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = SensorParameters::from_arg_matches(matches)?;
        Ok(())
    }
}
