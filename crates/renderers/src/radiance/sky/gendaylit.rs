//! `gendaylit`: the sky of any weather, from what was measured. [Perez 1993]

use super::moment::{Moment, Site};
use super::perez::{Air, water};
use super::{Options, Sun, statements};
use crate::radiance::sky_model::{Form, Sky};
use crate::radiance::statement::Statement;
use crate::radiance::units::EFFICACY;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::transcendental::cos_f64;
use bilux_scene::Span;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::rc::Rc;

/// The angular diameter of its suns in degrees.
const DIAMETER: f64 = 0.533;

/// The dew point in °C that is taken unless one is given.
const DEW_POINT: f64 = 10.973_531_15;

/// The numbers from which the light follows.
#[derive(Clone, Copy, Debug)]
enum Measured {
    /// Clearness and brightness.
    Parameters(f64, f64),
    /// Irradiances by the sun, of a surface that faces it, and by the sky.
    Irradiances(f64, f64),
    /// Illuminances by the sun, of a surface that faces it, and by the sky, in lux.
    Illuminances(f64, f64),
    /// Irradiances of level ground.
    Level(f64, f64),
}

/// The unit of the radiances that it writes.
#[derive(Clone, Copy, Debug)]
enum Unit {
    Visible,
    Solar,
    Lumens,
}

/// Statements that `gendaylit` writes; none for a sky that its formulas do not describe.
pub(in super::super) fn generate(
    words: &[Rc<str>],
    at: &Span,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<Statement>, FormatError> {
    let mut options = Options::new(words, "gendaylit", at);
    let moment = Moment::read(&mut options)?;
    let (mut site, mut year, mut albedo, mut dew_point) = (Site::default(), None, 0.2, DEW_POINT);
    let (mut measured, mut unit, mut has_sun) = (None, Unit::Visible, true);
    while let Some(option) = options.next() {
        let mut pair = |of: fn(f64, f64) -> Measured| -> Result<_, FormatError> {
            Ok(Some(of(options.number(option)?, options.number(option)?)))
        };
        match option {
            "-P" => measured = pair(Measured::Parameters)?,
            "-W" => measured = pair(Measured::Irradiances)?,
            "-L" => measured = pair(Measured::Illuminances)?,
            "-G" => measured = pair(Measured::Level)?,
            "-s" | "+s" => has_sun = option == "+s",
            "-w" => {}
            "-C" => diagnostics
                .note("the colours of a sky of gendaylit (-C) are left out: it is grey", || at.clone()),
            "-y" => year = Some(options.number(option)?.clamp(1.0, 9999.0) as i32),
            "-g" => albedo = options.number(option)?,
            "-d" => dew_point = options.number(option)?,
            "-a" => site.latitude = options.number(option)?.to_radians(),
            "-o" => site.longitude = options.number(option)?.to_radians(),
            "-m" => site.meridian = options.number(option)?.to_radians(),
            "-O" => {
                unit = match options.number(option)? {
                    0.0 => Unit::Visible,
                    1.0 => Unit::Solar,
                    _ => Unit::Lumens,
                }
            }
            _ => {
                let message =
                    format!("'{option}' is not read here: -P, -W, -L or -G say how bright the sky is");
                return options.error(&message);
            }
        }
    }
    let Some(measured) = measured else { return options.error("needs -P, -W, -L or -G with two numbers") };
    let angles = moment.sun(&site, year).below_zenith();
    let towards = angles.direction();
    if angles.altitude <= 0.0 {
        diagnostics
            .note("the sun is below the horizon: gendaylit has no sky for that, and so it is black", || {
                at.clone()
            });
        let form = Form::Perez { clearness: 1.0, brightness: 0.01 };
        return Ok(statements(Sky { form, sun: towards, level: 0.0, ground: 0.0 }, None, at));
    }
    let (zenith, day) = (FRAC_PI_2 - angles.altitude, moment.day_of_year());
    let (air, [direct, diffuse]) = light(measured, unit, zenith, day, water(dew_point));
    let form = Form::Perez { clearness: air.clearness, brightness: air.brightness };
    let ground = albedo * (diffuse + direct * towards.z) / PI;
    let solid_angle = TAU * (1.0 - cos_f64((0.5 * DIAMETER).to_radians()));
    let is_seen = has_sun && air.clearness > 1.0 && direct > 0.0;
    let sun = is_seen.then_some(Sun { radiance: direct / solid_angle, degrees: DIAMETER });
    Ok(statements(Sky { form, sun: towards, level: diffuse, ground }, sun, at))
}

/// The parameters of the sky, and the irradiances by the sun and the sky in the unit that is asked for.
fn light(measured: Measured, unit: Unit, zenith: f64, day: f64, water: f64) -> (Air, [f64; 2]) {
    let positive = |a: f64, b: f64| [a.max(0.0), b.max(0.0)];
    let air = match measured {
        Measured::Parameters(clearness, brightness) => Air { clearness, brightness, zenith, day }.held(),
        Measured::Irradiances(direct, diffuse) => Air::of(positive(direct, diffuse), zenith, day),
        Measured::Level(direct, diffuse) => Air::of(positive(direct / cos_f64(zenith), diffuse), zenith, day),
        Measured::Illuminances(direct, diffuse) => {
            of_illuminances(positive(direct, diffuse), zenith, day, water)
        }
    };
    let [of_sun, of_sky] = air.efficacies(water);
    let watts = match measured {
        Measured::Parameters(..) => air.irradiances(),
        Measured::Irradiances(direct, diffuse) => positive(direct, diffuse),
        Measured::Level(direct, diffuse) => positive(direct / cos_f64(zenith), diffuse),
        Measured::Illuminances(direct, diffuse) => {
            let per =
                |lumens: f64, efficacy: f64| if efficacy > 0.1 { lumens.max(0.0) / efficacy } else { 0.0 };
            [per(direct, of_sun), per(diffuse, of_sky)]
        }
    };
    let lumens = match measured {
        Measured::Illuminances(direct, diffuse) => positive(direct, diffuse),
        _ => [watts[0] * of_sun, watts[1] * of_sky],
    };
    (
        air,
        match unit {
            Unit::Visible => lumens.map(|lumens| lumens / EFFICACY),
            Unit::Solar => watts,
            Unit::Lumens => lumens,
        },
    )
}

/// The sky by illuminances: the efficacies depend on the sky, which depends on them.
fn of_illuminances(lumens: [f64; 2], zenith: f64, day: f64, water: f64) -> Air {
    const STEPS: u32 = 9;
    // Begins with that of all sunlight.
    let mut watts = lumens.map(|lumens| lumens * super::perez::SOLAR_CONSTANT / 127_500.0);
    for _ in 0..STEPS {
        let efficacies = Air::of(watts, zenith, day).efficacies(water);
        for ((watts, lumens), efficacy) in watts.iter_mut().zip(lumens).zip(efficacies) {
            *watts = if efficacy > 0.1 { lumens / efficacy } else { 0.0 };
        }
    }
    Air::of(watts, zenith, day)
}
