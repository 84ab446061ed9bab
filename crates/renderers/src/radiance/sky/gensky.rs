//! `gensky`: skies of the CIE before its standard of 2003, with or without their suns. [Ward 1994]

use super::moment::{Moment, Site};
use super::{Options, Sun, statements};
use crate::radiance::sky_model::{Sky, Weather, form, level_irradiance};
use crate::radiance::statement::Statement;
use bilux_import::FormatError;
use bilux_math::transcendental::{cos_f64, sin_f64, tan_f64};
use bilux_scene::Span;
use std::f64::consts::{PI, TAU};
use std::rc::Rc;

/// The luminous efficacies of the light of the sky and of the sun by which the program turns luminances into radiances, in lm/W.
const OF_SKY: f64 = 203.0;
const OF_SUN: f64 = 208.0;

/// The angular diameter of its suns in degrees.
const DIAMETER: f64 = 0.5;

/// An amount of light that is found by the program, a radiance, or an irradiance of level ground.
#[derive(Clone, Copy, Debug)]
enum Amount {
    Found,
    Radiance(f64),
    Irradiance(f64),
}

/// Statements that `gensky` writes.
pub(in super::super) fn generate(words: &[Rc<str>], at: &Span) -> Result<Vec<Statement>, FormatError> {
    let mut options = Options::new(words, "gensky", at);
    let moment = Moment::read(&mut options)?;
    let (mut weather, mut has_sun, mut year, mut site) = (Weather::Clear, true, None, Site::default());
    let (mut zenith, mut solar, mut turbidity, mut albedo) = (Amount::Found, Amount::Found, 2.45, 0.2);
    while let Some(option) = options.next() {
        match option {
            "-s" | "+s" => (weather, has_sun) = (Weather::Clear, option == "+s"),
            "-i" | "+i" => (weather, has_sun) = (Weather::Intermediate, option == "+i"),
            "-c" | "+c" => weather = Weather::Overcast,
            "-u" | "+u" => weather = Weather::Uniform,
            "-y" => year = Some(options.number(option)?.clamp(1.0, 9999.0) as i32),
            "-r" => solar = Amount::Radiance(options.number(option)?),
            "-R" => solar = Amount::Irradiance(options.number(option)?),
            "-b" => zenith = Amount::Radiance(options.number(option)?),
            "-B" => zenith = Amount::Irradiance(options.number(option)?),
            "-t" => turbidity = options.number(option)?,
            "-g" => albedo = options.number(option)?,
            "-a" => site.latitude = options.number(option)?.to_radians(),
            "-o" => site.longitude = options.number(option)?.to_radians(),
            "-m" => site.meridian = options.number(option)?.to_radians(),
            _ => return options.error(&format!("has no option '{option}'")),
        }
    }
    let is_even = matches!(weather, Weather::Overcast | Weather::Uniform);
    let angles = moment.sun(&site, year);
    let angles = if is_even { angles } else { angles.below_zenith() };
    let (towards, altitude) = (angles.direction(), angles.altitude);
    // What level ground receives of a zenith of radiance 1.
    let whole = level_irradiance(weather, towards);
    let zenith = match zenith {
        Amount::Radiance(radiance) => radiance,
        Amount::Irradiance(irradiance) => irradiance / whole,
        Amount::Found => zenith_luminance(weather, altitude, turbidity).max(0.0) / OF_SKY,
    };
    let sun = match solar {
        _ if is_even || towards.z <= 0.0 => 0.0,
        Amount::Radiance(radiance) => radiance,
        Amount::Irradiance(irradiance) => irradiance / (solid_angle() * towards.z),
        Amount::Found => {
            let share = if weather == Weather::Intermediate { 0.15 } else { 1.0 };
            share * 1.5e9 / OF_SUN * (1.147 - 0.147 / towards.z.max(0.16))
        }
    };
    let level = zenith * whole;
    let form = form(weather, zenith);
    // The program lights the ground by the sun even if it is not to be seen.
    let ground = albedo * (level + sun * solid_angle() * towards.z.max(0.0)) / PI;
    let seen = (has_sun && sun > 0.0).then_some(Sun { radiance: sun, degrees: DIAMETER });
    Ok(statements(Sky { form, sun: towards, level, ground }, seen, at))
}

/// The solid angle of its suns.
fn solid_angle() -> f64 {
    TAU * (1.0 - cos_f64((0.5 * DIAMETER).to_radians()))
}

/// The luminance of the zenith in cd/m², by the sun's altitude.
fn zenith_luminance(weather: Weather, altitude: f64, turbidity: f64) -> f64 {
    let overcast = 8.6 * sin_f64(altitude) + 0.123;
    let clear = (1.376 * turbidity - 1.81) * tan_f64(altitude) + 0.38;
    1000.0
        * match weather {
            Weather::Overcast | Weather::Uniform => overcast,
            Weather::Clear => clear,
            Weather::Intermediate => 0.5 * (overcast + clear),
        }
}
