//! Brightness of a sky.

use super::formula::{Formula, Weather};
use bilux_math::DVec3;

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
        Weather::Clear => Form::Cie { standard: 12, zenith },
        Weather::Overcast => Form::Cie { standard: 16, zenith },
        Weather::Uniform => Form::Cie { standard: 5, zenith },
        Weather::Intermediate => Form::Formula(Formula::Intermediate { zenith }),
    }
}
