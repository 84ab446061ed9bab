//! Formulas of the brightness of skies, with z up.

use bilux_math::DVec3;
use bilux_math::transcendental::{acos_f64, exp_f64, sin_cos_f64, sin_f64};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A sky that Bilux has no light for, with its radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum Formula {
    /// The intermediate sky, by the radiance of its zenith.
    Intermediate { zenith: f64 },
    /// Sky of Perez by its five coefficients, and a factor.
    Perez { factor: f64, coefficients: [f64; 5] },
}

impl Formula {
    /// Radiance in a direction, with y up as in the scene.
    pub(in super::super) fn at(self, direction: DVec3, sun: DVec3) -> f64 {
        let file = |v: DVec3| DVec3::new(v.x, -v.z, v.y);
        self.in_file(file(direction), file(sun))
    }

    /// Radiance in a direction, with z up.
    pub(super) fn in_file(self, direction: DVec3, sun: DVec3) -> f64 {
        match self {
            Formula::Intermediate { zenith } => {
                zenith * intermediate(direction, sun) / intermediate(DVec3::Z, sun)
            }
            Formula::Perez { factor, coefficients } => factor * perez(direction, sun, coefficients),
        }
    }
}

/// Formulas that divide by the height of a direction keep to this near the horizon.
const LOWEST: f64 = 0.01;

/// Irradiance of level ground by a sky.
pub(super) fn level(sky: impl Fn(DVec3) -> f64) -> f64 {
    const FINE: u32 = 64;
    // Rings that level ground receives alike from an even sky.
    let ring = |i: u32| {
        let across = ((f64::from(i) + 0.5) / f64::from(FINE)).sqrt();
        let up = (1.0 - across * across).sqrt();
        let at = |j: u32| {
            let (sin, cos) = sin_cos_f64(TAU * (f64::from(j) + 0.5) / f64::from(FINE));
            sky(DVec3::new(across * cos, across * sin, up))
        };
        (0..FINE).map(at).sum::<f64>()
    };
    PI * (0..FINE).map(ring).sum::<f64>() / f64::from(FINE * FINE)
}

fn angle_to(direction: DVec3, sun: DVec3) -> f64 {
    acos_f64(direction.dot(sun).clamp(-1.0, 1.0))
}

/// The clear sky, relative. [Kittler 1967]
pub(super) fn clear(direction: DVec3, sun: DVec3) -> f64 {
    let (angle, cos) = (angle_to(direction, sun), direction.dot(sun));
    (0.91 + 10.0 * exp_f64(-3.0 * angle) + 0.45 * cos * cos)
        * (1.0 - exp_f64(-0.32 / direction.z.max(LOWEST)))
}

/// The intermediate sky, relative. [Nakamura 1985]
pub(super) fn intermediate(direction: DVec3, sun: DVec3) -> f64 {
    let (angle, from_zenith) = (angle_to(direction, sun), acos_f64(direction.z.clamp(-1.0, 1.0)));
    let zenith = acos_f64(sun.z.clamp(-1.0, 1.0)).min(FRAC_PI_2);
    let gradation = (1.35 * sin_f64(5.631 - 3.59 * from_zenith) + 3.12) * sin_f64(4.396 - 2.6 * zenith)
        + 6.37
        - from_zenith;
    gradation / 2.326 * exp_f64(-0.563 * angle * ((2.629 - from_zenith) * (1.562 - zenith) + 0.812))
}

/// Perez's sky, relative. \[Perez 1993, eq. 1]
fn perez(direction: DVec3, sun: DVec3, [a, b, c, d, e]: [f64; 5]) -> f64 {
    let (angle, cos) = (angle_to(direction, sun), direction.dot(sun));
    let gradation = 1.0 + a * exp_f64(b / direction.z.max(LOWEST));
    (gradation * (1.0 + c * exp_f64(d * angle) + e * cos * cos)).max(0.0)
}

/// Kind of sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Weather {
    Clear,
    Overcast,
    Uniform,
    Intermediate,
}

/// Irradiance of level ground by a sky whose zenith has a radiance of 1.
pub(in super::super) fn level_irradiance(weather: Weather, sun: DVec3) -> f64 {
    match weather {
        Weather::Uniform => PI,
        Weather::Overcast => 7.0 / 9.0 * PI,
        Weather::Clear => level(|direction| clear(direction, sun)) / clear(DVec3::Z, sun),
        Weather::Intermediate => {
            level(|direction| intermediate(direction, sun)) / intermediate(DVec3::Z, sun)
        }
    }
}
