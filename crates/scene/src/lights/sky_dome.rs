//! A sky by a formula, with the ground below it and the sun: what skies whose amounts of light are given have in common.
//!
//! The formula says how bright the sky is in each direction, but not how bright it is: that follows from the light that falls on
//! level ground, or from the zenith.

use super::environment_map::EnvironmentMap;
use super::sun::Sun;
use super::{BuiltLight, Light};
use crate::parameters::Reader;
use crate::texture::Texture;
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::transcendental::{acos, exp, sin_cos, sin_f64};
use bilux_math::{Rgb, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

/// The size of the map: a texel is 0.7° wide. The sky is smooth but for the horizon, where the ground begins.
const SIZE: [usize; 2] = [512, 256];
/// Formulas that divide by the cosine of the zenith angle keep to this near the horizon.
const LOWEST: f32 = 0.01;

/// Relative radiance of a sky by the angles Z from the zenith and χ from the sun: its gradation times
/// 1 + c (exp(d χ) - f) + e cos² χ. \[CIE 2003; Perez 1993, eq. 1]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SkyFormula {
    pub(super) gradation: Gradation,
    /// c, d and e.
    pub(super) indicatrix: [f32; 3],
    /// f: what the indicatrix is less than by exp(d π/2), or 0.
    pub(super) across: f32,
}

/// Relative radiance of a sky by the angle from the zenith.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Gradation {
    /// 1 + a exp(b / cos Z), of a and b.
    Exponential([f32; 2]),
    /// 1 + 2 cos Z: three times as bright at the zenith as at the horizon. \[Moon 1942]
    Overcast,
}

impl Gradation {
    fn at(self, up: f32) -> f32 {
        match self {
            Gradation::Exponential([a, b]) => 1.0 + a * exp(b / up.max(LOWEST)),
            Gradation::Overcast => 1.0 + 2.0 * up.max(0.0),
        }
    }
}

impl SkyFormula {
    /// In any unit; never negative.
    pub(super) fn at(&self, direction: Vec3, sun: Vec3) -> f32 {
        let [c, d, e] = self.indicatrix;
        let cos = direction.dot(sun).clamp(-1.0, 1.0);
        let indicatrix = 1.0 + c * (exp(d * acos(cos)) - self.across) + e * cos * cos;
        (self.gradation.at(direction.y) * indicatrix).max(0.0)
    }
}

/// The light of a whole sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Amount {
    /// The irradiance of level ground by the sky without the sun.
    Level(Rgb),
    /// The radiance of the zenith.
    Zenith(Rgb),
}

/// The sun's place and size, and the ground.
pub(super) struct Surroundings {
    pub(super) towards: Vec3,
    /// Angular diameter in radians.
    pub(super) diameter: f32,
    pub(super) albedo: Rgb,
}

impl Surroundings {
    pub(super) fn read(reader: &Reader) -> Surroundings {
        let degrees = |key: &str| reader.number(key).to_radians();
        let ((sin_e, cos_e), (sin_a, cos_a)) = (sin_cos(degrees("elevation")), sin_cos(degrees("azimuth")));
        let towards = Vec3::new(cos_e * sin_a, sin_e, -cos_e * cos_a);
        Surroundings { towards, diameter: degrees("sun_diameter"), albedo: reader.colour("ground") }
    }

    /// The lights of a sky, and of a sun with this irradiance on a surface that faces it.
    pub(super) fn lights(&self, formula: &SkyFormula, amount: Amount, sun: Rgb) -> BuiltLight {
        let map = EnvironmentMap::new(Arc::new(self.picture(formula, amount, sun)), Rgb::WHITE, 0.0, false);
        let mut lights: Vec<Arc<dyn Light>> = vec![Arc::new(map)];
        if !sun.is_black() {
            lights.push(Arc::new(Sun::new(self.towards, self.diameter, sun, None)));
        }
        BuiltLight::Several(lights)
    }

    /// The sky as an environment map; below the horizon is the ground, lit by the sky and the sun.
    fn picture(&self, formula: &SkyFormula, amount: Amount, sun: Rgb) -> Texture {
        let [width, height] = SIZE;
        let direction = |i: usize| {
            let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            let (sin_theta, cos_theta) = sin_cos(PI * y / height as f32);
            let (sin_phi, cos_phi) = sin_cos((x / width as f32 - 0.5) * TAU);
            Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
        };
        let above: Vec<f32> =
            (0..width * (height / 2)).map(|i| formula.at(direction(i), self.towards)).collect();
        let level = level_irradiance(&above);
        let scale = match amount {
            Amount::Level(irradiance) => irradiance * per(level),
            Amount::Zenith(radiance) => radiance * per(formula.at(Vec3::Y, self.towards)),
        };
        let mut texels: Vec<Rgb> = above.iter().map(|&relative| scale * relative).collect();
        let ground = self.albedo * (scale * level + sun * self.towards.y.max(0.0)) * FRAC_1_PI;
        texels.resize(width * height, ground);
        Texture::new("sky", width, height, texels, false)
    }
}

/// One over an amount; 0 where there is none.
fn per(amount: f32) -> f32 {
    if amount > 0.0 && amount.is_finite() { 1.0 / amount } else { 0.0 }
}

/// Irradiance of level ground by the rows of texels above the horizon: the integral of each over its row is exact.
fn level_irradiance(above: &[f32]) -> f32 {
    let [width, height] = SIZE;
    let square = |row: usize| {
        let sin = sin_f64(std::f64::consts::PI * row as f64 / height as f64);
        sin * sin
    };
    let row = |(y, row): (usize, &[f32])| {
        let sum: f64 = row.iter().copied().map(f64::from).sum();
        sum * (square(y + 1) - square(y)) * std::f64::consts::PI / width as f64
    };
    above.chunks_exact(width).enumerate().map(row).sum::<f64>() as f32
}

pub(super) const ELEVATION: Parameter =
    number("elevation", "elevation of the sun", "degrees", [-90.0, 90.0], "40");
pub(super) const AZIMUTH: Parameter = number(
    "azimuth",
    "azimuth of the sun, from the north (-z) to the east (+x)",
    "degrees",
    [-360.0, 360.0],
    "135",
);
pub(super) const GROUND: Parameter = super::colour("ground", "albedo of the ground", "", "0.2");
pub(super) const SUN_DIAMETER: Parameter =
    number("sun_diameter", "angular diameter of the sun", "degrees", [0.01, 90.0], "0.533");

pub(super) const fn number(
    name: &'static str,
    summary: &'static str,
    unit: &'static str,
    [min, max]: [f64; 2],
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit, kind: ParameterKind::Number { min, max }, default }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Aabb;

    const OVERCAST: SkyFormula = SkyFormula {
        gradation: Gradation::Exponential([4.0, -0.7]),
        indicatrix: [0.0, -1.0, 0.0],
        across: 0.0,
    };

    fn sky(formula: &SkyFormula, amount: Amount) -> Texture {
        let towards = Vec3::new(0.5, 0.7, -0.4).normalize();
        let around = Surroundings { towards, diameter: 0.01, albedo: Rgb::grey(0.25) };
        around.picture(formula, amount, Rgb::grey(2.0))
    }

    /// The irradiance of level ground by a map, as its look-ups filter it.
    fn received(map: &EnvironmentMap) -> f64 {
        const FINE: u32 = 1000;
        let ring = |i: u32| {
            let up = ((f64::from(i) + 0.5) / f64::from(FINE)).sqrt();
            let across = (1.0 - up * up).sqrt();
            let at = |j: u32| {
                let (sin, cos) = sin_cos(TAU * (j as f32 + 0.5) / 64.0);
                let direction = Vec3::new(across as f32 * sin, up as f32, across as f32 * cos);
                f64::from(map.le(direction).luminance())
            };
            (0..64).map(at).sum::<f64>() / 64.0
        };
        (0..FINE).map(ring).sum::<f64>() / f64::from(FINE) * std::f64::consts::PI
    }

    #[test]
    fn level_ground_receives_what_is_asked_for() {
        let clear = SkyFormula {
            gradation: Gradation::Exponential([-1.0, -0.32]),
            indicatrix: [10.0, -3.0, 0.45],
            across: 0.009,
        };
        for formula in [OVERCAST, clear] {
            let map = EnvironmentMap::new(
                Arc::new(sky(&formula, Amount::Level(Rgb::grey(3.0)))),
                Rgb::WHITE,
                0.0,
                false,
            );
            let found = received(&map);
            assert!((found / 3.0 - 1.0).abs() < 2e-3, "{found}");
        }
    }

    /// The zenith of an overcast sky is three times as bright as its horizon, and lights the ground with 7π/9 of it, in
    /// Moon and Spencer's form; by that of the standard it is 0.78 π of it.
    #[test]
    fn an_overcast_sky_is_brightest_at_the_zenith() {
        let picture = sky(&OVERCAST, Amount::Zenith(Rgb::grey(9.0)));
        let texel = |y: usize| picture.texel(7, y).g;
        assert!((texel(0) - 9.0).abs() < 1e-3, "{}", texel(0));
        assert!((texel(0) / texel(SIZE[1] / 2 - 1) - 1.0 - 4.0 * exp(-0.7)).abs() < 0.01);
        let map = EnvironmentMap::new(Arc::new(picture.clone()), Rgb::WHITE, 0.0, false);
        let level = received(&map) / (9.0 * std::f64::consts::PI);
        assert!((level / (7.0 / 9.0) - 1.0).abs() < 0.02, "{level}");
        // The ground reflects a quarter of it, and of the sun.
        let ground = f64::from(texel(SIZE[1] - 1)) * std::f64::consts::PI;
        let sun = 2.0 * f64::from(Vec3::new(0.5, 0.7, -0.4).normalize().y);
        assert!(
            (ground / (0.25 * (level * 9.0 * std::f64::consts::PI + sun)) - 1.0).abs() < 2e-3,
            "{ground}"
        );
        assert!(map.power(&Aabb { min: -Vec3::ONE, max: Vec3::ONE }) > 0.0);
    }
}
