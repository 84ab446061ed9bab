//! Quantities of light as text, in photometric or radiometric units: `800 lm`, `2000 nit`, `6500 K`, `800 lm 2700 K`.

use crate::bsdf::wavelength::black_body;
use crate::messages::error::nearest_name;
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use bilux_math::photometry::LUMENS_PER_WATT;
use bilux_math::registry::Parameter;

/// Quantity that a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Measure {
    /// Light in all directions together.
    Flux,
    /// Flux per solid angle.
    Intensity,
    /// Flux per solid angle and area.
    Radiance,
    /// Flux per area.
    Irradiance,
}

/// A unit, under all its names.
struct Unit {
    names: &'static [&'static str],
    measure: Measure,
    /// In the radiometric unit of what it measures.
    value: f64,
}

const PER_LUMEN: f64 = 1.0 / LUMENS_PER_WATT as f64;

const fn unit(names: &'static [&'static str], measure: Measure, value: f64) -> Unit {
    Unit { names, measure, value }
}

/// All units of light; the first names are those that messages list.
const UNITS: &[Unit] = &[
    unit(&["lm", "lumen", "lumens"], Measure::Flux, PER_LUMEN),
    unit(&["klm"], Measure::Flux, 1e3 * PER_LUMEN),
    unit(&["W", "watt", "watts"], Measure::Flux, 1.0),
    unit(&["cd", "candela", "candelas", "lm/sr"], Measure::Intensity, PER_LUMEN),
    unit(&["kcd"], Measure::Intensity, 1e3 * PER_LUMEN),
    unit(&["W/sr"], Measure::Intensity, 1.0),
    unit(&["nit", "nits", "nt", "cd/m2", "cd/m²", "cd/m^2"], Measure::Radiance, PER_LUMEN),
    unit(&["kcd/m2", "kcd/m²", "kcd/m^2"], Measure::Radiance, 1e3 * PER_LUMEN),
    unit(&["W/m2/sr", "W/m²/sr", "W/m^2/sr", "W/sr/m2", "W/sr/m²", "W/sr/m^2"], Measure::Radiance, 1.0),
    unit(&["lx", "lux", "lm/m2", "lm/m²", "lm/m^2"], Measure::Irradiance, PER_LUMEN),
    unit(&["klx"], Measure::Irradiance, 1e3 * PER_LUMEN),
    unit(&["W/m2", "W/m²", "W/m^2"], Measure::Irradiance, 1.0),
];

/// Names of the unit of colour temperatures.
const KELVIN: [&str; 2] = ["K", "kelvin"];
/// Temperatures whose colour is a colour of light, in kelvin.
const TEMPERATURES: [f64; 2] = [500.0, 100_000.0];

impl Measure {
    /// Quantities that a parameter with this unit of the tables takes; empty where it is no light.
    pub(crate) fn of_unit(unit: &str) -> &'static [Measure] {
        match unit {
            "W" => &[Measure::Flux],
            "W/sr" => &[Measure::Intensity, Measure::Flux],
            "W/(m² sr)" => &[Measure::Radiance],
            "W/m²" => &[Measure::Irradiance],
            _ => &[],
        }
    }

    fn name(self) -> &'static str {
        match self {
            Measure::Flux => "a flux",
            Measure::Intensity => "an intensity",
            Measure::Radiance => "a radiance",
            Measure::Irradiance => "an irradiance",
        }
    }

    /// Clause for messages: the parameters that take this quantity.
    fn advice(self) -> &'static str {
        match self {
            Measure::Flux => ", which the intensity of a lamp takes",
            Measure::Intensity => ", which the intensity of a lamp takes",
            Measure::Radiance => ", which surfaces, panels and skies take",
            Measure::Irradiance => ", which directional lights take",
        }
    }
}

/// The names of the units of what a parameter takes, for messages and reference pages.
pub fn units_of(unit: &str) -> Vec<&'static str> {
    let taken = Measure::of_unit(unit);
    let of_light = UNITS.iter().filter(|unit| taken.contains(&unit.measure)).map(|unit| unit.names[0]);
    of_light.filter(|name| !name.starts_with('k')).collect()
}

/// A quantity of light, and its colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quantity {
    /// Measured quantity; `None` for a colour alone.
    pub(crate) measure: Option<Measure>,
    /// In radiometric units, its luminance the amount; a colour alone has luminance 1.
    pub(crate) colour: Rgb,
}

impl Quantity {
    /// Reads a quantity. 683 lm are 1 W whose red, green and blue are equal.
    ///
    /// # Errors
    /// What is wrong with it.
    pub(crate) fn read(text: &str) -> Result<Quantity, String> {
        let (mut light, mut kelvin) = (None, None);
        let mut words = text.split_whitespace();
        while let Some(word) = words.next() {
            let (number, rest) = number_and_rest(word)
                .ok_or_else(|| format!("'{word}' is no number with a unit, such as 800 lm"))?;
            let name = if rest.is_empty() { words.next().unwrap_or_default() } else { rest };
            if name.is_empty() {
                return Err(format!("{number} has no unit"));
            }
            if !(0.0..=1e30).contains(&number) {
                return Err(format!("{number} {name} is negative or too much"));
            }
            if is_named(&KELVIN, name) {
                if kelvin.replace(number).is_some() {
                    return Err("there are two temperatures".to_owned());
                }
            } else if light.replace((number, named(name)?)).is_some() {
                return Err("there are two amounts".to_owned());
            }
        }
        let shade = match kelvin {
            Some(kelvin) => shade(kelvin)?,
            None => Rgb::WHITE,
        };
        match (light, kelvin) {
            (Some((amount, unit)), _) => {
                Ok(Quantity { measure: Some(unit.measure), colour: shade * (amount * unit.value) as f32 })
            }
            (None, Some(_)) => Ok(Quantity { measure: None, colour: shade }),
            (None, None) => Err("it is empty".to_owned()),
        }
    }

    /// [`Quantity::read`] for a parameter with this unit.
    ///
    /// # Errors
    /// Also when it measures something else.
    pub(crate) fn of_parameter(text: &str, unit: &str) -> Result<Quantity, String> {
        let quantity = Quantity::read(text)?;
        let taken = Measure::of_unit(unit);
        match quantity.measure {
            Some(measure) if !taken.contains(&measure) => {
                let is = taken.first().map_or("a factor or a colour", |taken| taken.name());
                Err(format!("this is {is}, and '{text}' is {}{}", measure.name(), measure.advice()))
            }
            _ => Ok(quantity),
        }
    }
}

/// The colour that a text stands for as the value of a parameter. A flux is in W, also where the parameter is an intensity.
///
/// # Errors
/// The expected value, and what is wrong with this one.
pub(super) fn colour_of(parameter: &Parameter, text: &str, [min, max]: [f64; 2]) -> Result<Rgb, String> {
    let wanted = format!("a colour [r, g, b] with each from {min} to {max}");
    let units = units_of(parameter.unit);
    // A reflectance is no light.
    if units.is_empty() && max <= 1.0 {
        return shown(text).ok_or_else(|| wanted + ", or \"#rrggbb\" as a screen shows it");
    }
    if text.starts_with('#') {
        return Err(format!("{wanted}: '{text}' says what a screen shows, not how much light that is"));
    }
    let units = if units.is_empty() { "K".to_owned() } else { units.join(", ") + ", K" };
    let wanted = |why: &str| {
        format!("{wanted}, or a text such as \"{}\" (in {units}): {why}", example(parameter.unit))
    };
    let colour = Quantity::of_parameter(text, parameter.unit).map_err(|why| wanted(&why))?.colour;
    match colour.to_array().iter().all(|channel| f64::from(*channel) <= max) {
        true => Ok(colour),
        false => Err(wanted("this is too much")),
    }
}

/// The light of a colour as screens show it, `#rrggbb`.
pub(super) fn shown(text: &str) -> Option<Rgb> {
    let digits = text.strip_prefix('#')?;
    let is_hex = digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
    let all = u32::from_str_radix(digits, 16).ok().filter(|_| is_hex)?;
    Some(Rgb::from_array([16, 8, 0].map(|shift| srgb_decode(f32::from((all >> shift) as u8) / 255.0))))
}

fn example(unit: &str) -> &'static str {
    match Measure::of_unit(unit).first() {
        Some(Measure::Flux) => "800 lm",
        Some(Measure::Intensity) => "800 lm 2700 K",
        Some(Measure::Radiance) => "2000 nit",
        Some(Measure::Irradiance) => "500 lux",
        None => "2700 K",
    }
}

/// The colour of a black body, with luminance 1. [Planck 1901]
fn shade(kelvin: f64) -> Result<Rgb, String> {
    let [least, most] = TEMPERATURES;
    let colour = black_body(kelvin as f32);
    if !(least..=most).contains(&kelvin) || colour.luminance() <= 0.0 {
        return Err(format!("a temperature of {kelvin} K: the colours of light go from {least} to {most} K"));
    }
    Ok(colour / colour.luminance())
}

/// The number that a word begins with, and what follows.
fn number_and_rest(word: &str) -> Option<(f64, &str)> {
    if !word.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
        return None;
    }
    let ends = (1..=word.len()).rev().filter(|end| word.is_char_boundary(*end));
    ends.filter_map(|end| Some((word[..end].parse().ok()?, &word[end..]))).next()
}

/// True if the name is one of these. Case counts only where a name is short, such as that of W and K.
fn is_named(names: &[&str], name: &str) -> bool {
    names.iter().any(|known| *known == name || known.len() >= 3 && known.eq_ignore_ascii_case(name))
}

fn named(name: &str) -> Result<&'static Unit, String> {
    if let Some(unit) = UNITS.iter().find(|unit| is_named(unit.names, name)) {
        return Ok(unit);
    }
    let all = UNITS.iter().flat_map(|unit| unit.names).chain(&KELVIN);
    let all: Vec<String> = all.map(|name| (*name).to_owned()).collect();
    let meant = nearest_name(name, &all).map_or_else(String::new, |near| format!("; did you mean '{near}'?"));
    Err(format!("there is no unit '{name}'{meant}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn is(text: &str, measure: Measure, wanted: f64) {
        let Quantity { measure: found, colour } = Quantity::read(text).unwrap();
        assert_eq!(found, Some(measure), "{text}");
        assert!((f64::from(colour.luminance()) / wanted - 1.0).abs() < 1e-5, "{text}: {colour:?}");
    }

    #[test]
    fn every_unit_has_its_measure_and_its_value() {
        is("683 lm", Measure::Flux, 1.0);
        is("1.366klm", Measure::Flux, 2.0);
        is("40 W", Measure::Flux, 40.0);
        is("683 cd", Measure::Intensity, 1.0);
        is("3 W/sr", Measure::Intensity, 3.0);
        is("2000 nit", Measure::Radiance, 2000.0 / 683.0);
        is("2e3cd/m²", Measure::Radiance, 2000.0 / 683.0);
        is("2 kcd/m2", Measure::Radiance, 2000.0 / 683.0);
        is("500 lux", Measure::Irradiance, 500.0 / 683.0);
        is("0.5klx", Measure::Irradiance, 500.0 / 683.0);
        is("1 W/m2", Measure::Irradiance, 1.0);
        is("800 lm 2700 K", Measure::Flux, 800.0 / 683.0);
        is("2700K 800 Lumens", Measure::Flux, 800.0 / 683.0);
    }

    #[test]
    fn a_temperature_alone_is_a_colour_of_luminance_1() {
        let warm = Quantity::read("2700 K").unwrap();
        let cold = Quantity::read("9000 kelvin").unwrap();
        assert_eq!((warm.measure, cold.measure), (None, None));
        assert!((warm.colour.luminance() - 1.0).abs() < 1e-5 && warm.colour.r > 2.0 * warm.colour.b);
        assert!((cold.colour.luminance() - 1.0).abs() < 1e-5 && cold.colour.r < cold.colour.b);
        // The white of Rec. 709 is daylight of 6504 K, close to a black body of that temperature.
        let white = Quantity::read("6500 K").unwrap().colour;
        assert!((white - Rgb::WHITE).to_array().iter().all(|off| off.abs() < 0.06), "{white:?}");
    }

    /// By the curve of IEC 61966-2-1: of 128 and 64, ((x / 255 + .055) / 1.055)^2.4.
    #[test]
    fn colours_as_screens_show_them() {
        let [red, green, blue] = shown("#ff8040").unwrap().to_array();
        assert!(red == 1.0 && (green - 0.215_861).abs() < 1e-5 && (blue - 0.051_269).abs() < 1e-5);
        for wrong in ["", "#fff", "#gggggg", "ff0000", "#ff00000", "#+12345"] {
            assert_eq!(shown(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn errors_say_what_is_wrong() {
        for (text, unit, why) in [
            ("800 lumn", "W/sr", "there is no unit 'lumn'; did you mean 'lumen'?"),
            ("800 luxx", "W/sr", "did you mean 'lux'?"),
            ("800", "W/sr", "800 has no unit"),
            ("-800 lm", "W/sr", "-800 lm is negative"),
            ("bright", "W/sr", "'bright' is no number with a unit"),
            ("nan lm", "W/sr", "'nan' is no number"),
            ("", "W/sr", "it is empty"),
            ("8 lm 9 cd", "W/sr", "two amounts"),
            ("2700 K 3000 K", "W/sr", "two temperatures"),
            ("0 K", "W/sr", "a temperature of 0 K"),
            (
                "800 lm",
                "W/(m² sr)",
                "this is a radiance, and '800 lm' is a flux, which the intensity of a lamp takes",
            ),
            (
                "500 lux",
                "W/sr",
                "this is an intensity, and '500 lux' is an irradiance, which directional lights take",
            ),
            ("800 lm", "", "this is a factor or a colour, and '800 lm' is a flux"),
        ] {
            let error = Quantity::of_parameter(text, unit).unwrap_err();
            assert!(error.contains(why), "{text}: {error}");
        }
    }
}
