//! What options have that does not follow from the rows of their settings.

use super::Read;
use crate::arguments::help;
use crate::arguments::values::{Exposure, parse_exposure, parse_noise, parse_seconds, parse_spp};
use bilux::math::registry::Parameter;
use bilux::scene::Value;

/// How the command line spells a setting, where its row does not say it.
pub(super) struct Spelling {
    /// The setting.
    pub(super) setting: &'static str,
    /// The name of one letter.
    pub(super) short: Option<char>,
    /// The name of the value.
    pub(super) value: Option<&'static str>,
    /// The value if none is written.
    pub(super) missing: Option<&'static str>,
    /// The heading.
    pub(super) heading: Option<&'static str>,
    /// The help, with the default.
    pub(super) help: Option<&'static str>,
    /// How the value is read.
    pub(super) read: Option<Read>,
}

/// The spelling of the setting of this name.
pub(super) fn spelling(setting: &str) -> &'static Spelling {
    SPELLINGS.iter().find(|spelling| spelling.setting == setting).unwrap_or(&PLAIN)
}

/// Nothing but the row.
const PLAIN: Spelling = of("");

const SPELLINGS: &[Spelling] = &[
    of("integrator").letter('i').under(help::COMMON_OPTIONS),
    of("size").value("WxH").under(help::COMMON_OPTIONS),
    of("spp").read(|row, text| Ok((row.name, Value::Integer(i64::from(parse_spp(text)?))))).help(
        "Take N samples per pixel; the picture is then the same on every machine [default: stop at 2% noise or after \
         5 seconds, whichever comes first]",
    ),
    of("noise").value("REL").read(|row, text| Ok((row.name, parse_noise(text)?.into()))).help(
        "Stop when the average noise is at most this fraction of the light, such as 2% or 0.02; 2% looks smooth",
    ),
    of("time_limit").read(|row, text| Ok((row.name, parse_seconds(text)?.into()))).help(
        "Finish within this time, including reading and denoising; if that is impossible, Bilux says why",
    ),
    of("max_depth").under(help::LIGHT),
    of("camera").value("NAME|INDEX").under(help::COMMON_OPTIONS),
    of("eye").value("X,Y,Z"),
    of("look_at").value("X,Y,Z"),
    of("zoom").value("FACTOR"),
    of("orbit").value("AZ,EL").under(help::COMMON_OPTIONS),
    of("time").under(help::WHAT),
    of("exposure").value("EV|auto").read(exposure).help(
        "Brighten by this many stops (powers of two), or automatically to the brightness of a photograph [default: \
         0, or what a display needs to show the light that a glTF or OBJ file brings]",
    ),
    of("background").value("transparent|COLOR|FILE").under(help::COMMON_OPTIONS).help(
        "The background: transparent, a colour (white, grey, black, '#rrggbb' or R,G,B from 0 to 1) or a picture; it \
         lights nothing [default: the scene's surroundings]",
    ),
    of("denoise").value("auto|oidn|builtin|off").or_without("auto").help(
        "Denoise with the best available denoiser, or with the one named (`bilux list denoisers`) [default: auto for \
         display formats when noise or time ends the render, else off]",
    ),
];

/// Reads a number of stops; `auto` is a setting of its own.
fn exposure(row: &'static Parameter, text: &str) -> Result<(&'static str, Value), String> {
    Ok(match parse_exposure(text)? {
        Exposure::Stops(stops) => (row.name, stops.into()),
        Exposure::Auto => ("auto_exposure", Value::Bool(true)),
    })
}

const fn of(setting: &'static str) -> Spelling {
    Spelling { setting, short: None, value: None, missing: None, heading: None, help: None, read: None }
}

impl Spelling {
    const fn letter(self, short: char) -> Spelling {
        Spelling { short: Some(short), ..self }
    }

    const fn value(self, value: &'static str) -> Spelling {
        Spelling { value: Some(value), ..self }
    }

    const fn or_without(self, missing: &'static str) -> Spelling {
        Spelling { missing: Some(missing), ..self }
    }

    const fn under(self, heading: &'static str) -> Spelling {
        Spelling { heading: Some(heading), ..self }
    }

    const fn help(self, help: &'static str) -> Spelling {
        Spelling { help: Some(help), ..self }
    }

    const fn read(self, read: Read) -> Spelling {
        Spelling { read: Some(read), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::settings::SettingRow;

    #[test]
    fn each_spelling_is_of_a_setting_with_an_option() {
        for spelling in SPELLINGS {
            let row = SettingRow::named(spelling.setting).expect(spelling.setting);
            assert!(row.option.is_some(), "{}", spelling.setting);
        }
    }
}
