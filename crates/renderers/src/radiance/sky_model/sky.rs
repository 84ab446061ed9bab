//! Brightness of a sky.

use super::formula::{Formula, Weather, clear};
use bilux_math::DVec3;
use std::f64::consts::PI;

/// Brightness of a sky, in Radiance's units.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Sky {
    pub(in super::super) form: Form,
    /// Towards the sun, with z up.
    pub(in super::super) sun: DVec3,
    /// The irradiance of level ground by the sky alone.
    pub(in super::super) level: f64,
    /// The radiance of the ground below it.
    pub(in super::super) ground: f64,
}

impl Sky {
    /// Radiance just below the horizon, where Radiance blends the sky into the ground, in a direction with z up: what a
    /// source of more than 180 degrees shows there.
    pub(in super::super) fn below_horizon(&self, direction: DVec3, sun: DVec3) -> f64 {
        let horizon = match self.form {
            Form::Cie { standard: CLEAR, zenith } => zenith * clear(direction, sun) / clear(DVec3::Z, sun),
            Form::Cie { standard: OVERCAST, zenith } => zenith / 3.0,
            Form::Cie { zenith, .. } => zenith,
            Form::Perez { .. } => self.level / PI,
            Form::Formula(formula) => formula.in_file(direction, sun),
        };
        let base = direction.z + 1.01;
        let fifth = base * base * base * base * base;
        let weight = fifth * fifth;
        (weight * horizon + self.ground / weight) / (weight + weight.recip())
    }
}

/// Numbers of standard skies of the CIE.
const CLEAR: i32 = 12;
const OVERCAST: i32 = 16;
const UNIFORM: i32 = 5;

/// Distribution of the brightness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum Form {
    /// A standard sky of the CIE, by its number in Bilux and the radiance of its zenith.
    Cie { standard: i32, zenith: f64 },
    /// A sky of Perez, by its clearness and brightness.
    Perez { clearness: f64, brightness: f64 },
    /// One that Bilux has no light for.
    Formula(Formula),
}

/// Distribution of the brightness, with this radiance of the zenith.
pub(in super::super) fn form(weather: Weather, zenith: f64) -> Form {
    match weather {
        Weather::Clear => Form::Cie { standard: CLEAR, zenith },
        Weather::Overcast => Form::Cie { standard: OVERCAST, zenith },
        Weather::Uniform => Form::Cie { standard: UNIFORM, zenith },
        Weather::Intermediate => Form::Formula(Formula::Intermediate { zenith }),
    }
}
