//! What options have that does not follow from the rows of their settings.

use super::Assigned;
use crate::arguments::help;
use crate::arguments::values::{Exposure, parse_exposure, parse_noise, parse_seconds, parse_spp};
use bilux::scene::Value;
use clap::Arg;

/// The option of a setting, as the command line spells it.
pub(super) fn spelled(option: Arg) -> Arg {
    match SPELLINGS.iter().find(|(setting, _)| option.get_id() == *setting) {
        Some((_, spell)) => spell(option),
        None => option,
    }
}

/// A setting, and what its option has.
type Spelling = (&'static str, fn(Arg) -> Arg);

const SPELLINGS: &[Spelling] = &[
    ("integrator", |option| option.short('i').help_heading(help::COMMON_OPTIONS)),
    ("size", |option| coordinates(option, "WxH").help_heading(help::COMMON_OPTIONS)),
    ("spp", |option| {
        option.value_parser(|text: &str| assigned("spp", parse_spp(text).map(i64::from).map(Value::Integer))).help(
            "Take N samples per pixel; the picture is then the same on every machine [default: stop at 2% noise or \
             after 5 seconds, whichever comes first]",
        )
    }),
    ("noise", |option| {
        option.value_name("REL").value_parser(|text: &str| assigned("noise", parse_noise(text))).help(
            "Stop when the average noise is at most this fraction of the light, such as 2% or 0.02; 2% looks smooth",
        )
    }),
    ("time_limit", |option| {
        option.value_parser(|text: &str| assigned("time_limit", parse_seconds(text))).help(
            "Finish within this time, including reading and denoising; if that is impossible, Bilux says why",
        )
    }),
    ("max_depth", |option| option.help_heading(help::LIGHT)),
    ("camera", |option| option.value_name("NAME|INDEX").help_heading(help::COMMON_OPTIONS)),
    ("eye", |option| coordinates(option, "X,Y,Z")),
    ("look_at", |option| coordinates(option, "X,Y,Z")),
    ("zoom", |option| option.value_name("FACTOR")),
    ("orbit", |option| coordinates(option, "AZ,EL").help_heading(help::COMMON_OPTIONS)),
    ("time", |option| option.help_heading(help::WHAT)),
    ("exposure", |option| {
        option.value_name("EV|auto").value_parser(exposure).help(
            "Brighten by this many stops (powers of two), or automatically to the brightness of a photograph \
             [default: 0, or what a display needs to show the light that a glTF or OBJ file brings]",
        )
    }),
    ("background", |option| {
        option.value_name("transparent|COLOR|FILE").help_heading(help::COMMON_OPTIONS).help(
            "The background: transparent, a colour (white, grey, black, '#rrggbb' or R,G,B from 0 to 1) or a \
             picture; it lights nothing [default: the scene's surroundings]",
        )
    }),
    ("denoise", |option| {
        let option = option.num_args(0..=1).default_missing_value("auto").require_equals(true);
        option.value_name("auto|oidn|builtin|off").help(
            "Denoise with the best available denoiser, or with the one named (`bilux list denoisers`) [default: auto \
             for display formats when noise or time ends the render, else off]",
        )
    }),
];

/// An option whose value may begin with a negative number.
fn coordinates(option: Arg, value: &'static str) -> Arg {
    option.value_name(value).allow_hyphen_values(true)
}

fn assigned(setting: &'static str, value: Result<impl Into<Value>, String>) -> Result<Assigned, String> {
    Ok((setting, value?.into()))
}

/// Reads a number of stops; `auto` is a setting of its own.
fn exposure(text: &str) -> Result<Assigned, String> {
    Ok(match parse_exposure(text)? {
        Exposure::Stops(stops) => ("exposure", stops.into()),
        Exposure::Auto => ("auto_exposure", Value::Bool(true)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::settings::SettingRow;

    #[test]
    fn each_spelling_is_of_a_setting_with_an_option() {
        for (setting, _) in SPELLINGS {
            let row = SettingRow::named(setting).expect(setting);
            assert!(row.option.is_some(), "{setting}");
        }
    }
}
