//! `sky`: a clear or hazy daylight sky with its sun, by an analytic model. [Preetham 1999]

use super::environment_map::EnvironmentMap;
use super::sun::Sun;
use super::{BuiltLight, Light, LightEntry};
use crate::texture::Texture;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::{acos, exp, powf, sin_cos, tan};
use bilux_math::{Rgb, Vec3};
use std::f32::consts::{FRAC_1_PI, PI, TAU};
use std::sync::Arc;

pub(super) const ENTRY: LightEntry = LightEntry {
    entry: Entry {
        name: "sky",
        summary: "analytic daylight sky with the sun, clear or hazy",
        source: "Preetham 1999",
        parameters: &[
            number("elevation", "elevation of the sun", "degrees", [0.0, 90.0], "40"),
            number("azimuth", "azimuth of the sun, to the right of -z", "degrees", [-360.0, 360.0], "50"),
            number("turbidity", "turbidity: 2 is clear, 10 is hazy", "", [1.7, 10.0], "3"),
            super::colour("ground", "albedo of the ground", "", "0.2"),
            super::colour(
                "scale",
                "factor on the whole light: at 1 it is about as bright as white paper in the midday sun",
                "",
                "1",
            ),
            number("sun_scale", "factor on the sun only", "", [0.0, 1e6], "1"),
            number("sun_diameter", "angular diameter of the sun", "degrees", [0.01, 90.0], "0.533"),
            super::GROUP,
        ],
    },
    surrounds: true,
    flux_per_intensity: super::NO_INTENSITY,
    build: |reader, _| {
        let degrees = |key: &str| reader.number(key).to_radians();
        let (sin_e, cos_e) = sin_cos(degrees("elevation"));
        let (sin_a, cos_a) = sin_cos(degrees("azimuth"));
        let sky = Sky::new(Vec3::new(cos_e * sin_a, sin_e, -cos_e * cos_a), reader.number("turbidity"));
        let scale = reader.colour("scale");
        let sun = sky.sun() * (scale * reader.number("sun_scale"));
        let picture = Arc::new(sky.picture(reader.colour("ground"), sky.sun() * reader.number("sun_scale")));
        let map = EnvironmentMap::new(picture, scale, 0.0, false);
        let mut lights: Vec<Arc<dyn Light>> = vec![Arc::new(map)];
        if !sun.is_black() {
            lights.push(Arc::new(Sun::new(sky.towards, degrees("sun_diameter"), sun, None)));
        }
        Ok(BuiltLight::Several(lights))
    },
};

const fn number(
    name: &'static str,
    summary: &'static str,
    unit: &'static str,
    [min, max]: [f64; 2],
    default: &'static str,
) -> Parameter {
    Parameter { name, summary, unit, kind: ParameterKind::Number { min, max }, default }
}

/// The size of the map: the sky is smooth.
const SIZE: [usize; 2] = [256, 128];
/// The luminance in kcd/m² of a radiance of 1, and the illuminance in klx of an irradiance of 1.
const UNIT: f32 = 20.0;
/// The sun's illuminance above the atmosphere, in klx, then its colour there: a black body of 5800 K with luminance 1.
const ABOVE_THE_AIR: f32 = 128.0;
const SUN_COLOUR: Rgb = Rgb::new(1.075, 0.985, 0.927);
/// Wavelengths for red, green and blue, in µm.
const WAVELENGTHS: [f32; 3] = [0.612, 0.549, 0.465];

/// The distribution over the sky, by the angles to the zenith and to the sun: Perez's A to E. [Preetham 1999, eq. 3]
#[derive(Clone, Copy)]
struct Perez([f32; 5]);

impl Perez {
    /// Each coefficient from its slope over turbidity, and its value at zero turbidity. [Preetham 1999, A.2]
    fn of(table: [[f32; 2]; 5], turbidity: f32) -> Perez {
        Perez(table.map(|[slope, start]| slope * turbidity + start))
    }

    fn at(&self, cos_zenith: f32, gamma: f32, cos_gamma: f32) -> f32 {
        let Perez([a, b, c, d, e]) = *self;
        (1.0 + a * exp(b / cos_zenith)) * (1.0 + c * exp(d * gamma) + e * cos_gamma * cos_gamma)
    }
}

/// A sky. Chromaticity and luminance are in x, y and Y.
struct Sky {
    towards: Vec3,
    turbidity: f32,
    /// x, y and Y in kcd/m² at the zenith, divided by Perez's function there.
    zenith: [f32; 3],
    over: [Perez; 3],
}

impl Sky {
    fn new(towards: Vec3, turbidity: f32) -> Sky {
        let t = turbidity;
        let angle = acos(towards.y.clamp(0.0, 1.0));
        let over = [
            Perez::of(
                [
                    [-0.0193, -0.2592],
                    [-0.0665, 0.0008],
                    [-0.0004, 0.2125],
                    [-0.0641, -0.8989],
                    [-0.0033, 0.0452],
                ],
                t,
            ),
            Perez::of(
                [
                    [-0.0167, -0.2608],
                    [-0.0950, 0.0092],
                    [-0.0079, 0.2102],
                    [-0.0441, -1.6537],
                    [-0.0109, 0.0529],
                ],
                t,
            ),
            Perez::of(
                [
                    [0.1787, -1.4630],
                    [-0.3554, 0.4275],
                    [-0.0227, 5.3251],
                    [0.1206, -2.5771],
                    [-0.0670, 0.3703],
                ],
                t,
            ),
        ];
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * angle);
        let luminance = (4.0453 * t - 4.9710) * tan(chi) - 0.2155 * t + 2.4192;
        let x = [
            [0.00166, -0.00375, 0.00209, 0.0],
            [-0.02903, 0.06377, -0.03202, 0.00394],
            [0.11693, -0.21196, 0.06052, 0.25886],
        ];
        let y = [
            [0.00275, -0.00610, 0.00317, 0.0],
            [-0.04214, 0.08970, -0.04153, 0.00516],
            [0.15346, -0.26756, 0.06670, 0.26688],
        ];
        let cubic = |m: [[f32; 4]; 3]| {
            let of_angle = |row: [f32; 4]| row.into_iter().fold(0.0, |sum, k| sum * angle + k);
            m.into_iter().fold(0.0, |sum, row| sum * t + of_angle(row))
        };
        let zenith = [cubic(x), cubic(y), luminance.max(0.0)];
        let there = over.map(|perez| perez.at(1.0, angle, towards.y));
        Sky { towards, turbidity, zenith: [0, 1, 2].map(|i| zenith[i] / there[i]), over }
    }

    /// Radiance from a direction above the horizon.
    fn radiance(&self, direction: Vec3) -> Rgb {
        let cos_zenith = direction.y.max(1e-3);
        let cos_gamma = direction.dot(self.towards).clamp(-1.0, 1.0);
        let gamma = acos(cos_gamma);
        let [x, y, luminance] =
            [0, 1, 2].map(|i| self.zenith[i] * self.over[i].at(cos_zenith, gamma, cos_gamma));
        from_xyy(x, y, luminance.max(0.0)) * (1.0 / UNIT)
    }

    /// The sun's irradiance on a surface that faces it, after extinction by molecules and haze in the atmosphere.
    /// [Preetham 1999, A.1] The air mass is from [Kasten 1966].
    fn sun(&self) -> Rgb {
        let angle = acos(self.towards.y.clamp(0.0, 1.0));
        let mass = 1.0 / (self.towards.y + 0.15 * powf(93.885 - angle.to_degrees(), -1.253));
        let haze = 0.04608 * self.turbidity - 0.04586;
        let left = WAVELENGTHS.map(|wavelength| {
            let molecules = 0.008735 * powf(wavelength, -4.08);
            exp(-mass * (molecules + haze * powf(wavelength, -1.3)))
        });
        Rgb::from_array(left) * SUN_COLOUR * (ABOVE_THE_AIR / UNIT)
    }

    /// The sky as an environment map; below the horizon is the ground, lit by the sky and a sun.
    fn picture(&self, ground: Rgb, sun: Rgb) -> Texture {
        let [width, height] = SIZE;
        let direction = |i: usize| {
            let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            let (sin_theta, cos_theta) = sin_cos(PI * y / height as f32);
            let (sin_phi, cos_phi) = sin_cos((x / width as f32 - 0.5) * TAU);
            Vec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
        };
        let above = width * (height / 2);
        let mut texels: Vec<Rgb> = (0..above).map(|i| self.radiance(direction(i))).collect();
        let cell = TAU / width as f32 * PI / height as f32;
        let falls = |(i, radiance): (usize, &Rgb)| {
            let up = direction(i).y;
            *radiance * (up * (1.0 - up * up).sqrt() * cell)
        };
        let all = texels.iter().enumerate().map(falls).sum::<Rgb>() + sun * self.towards.y;
        texels.resize(width * height, ground * all * FRAC_1_PI);
        Texture::new("sky", width, height, texels, false)
    }
}

/// Linear Rec. 709 from a chromaticity and a luminance; values out of range are clamped. [IEC 61966-2-1]
fn from_xyy(x: f32, y: f32, luminance: f32) -> Rgb {
    let (x, z) = (x / y * luminance, (1.0 - x - y) / y * luminance);
    let y = luminance;
    Rgb::new(
        3.240_454 * x - 1.537_139 * y - 0.498_531 * z,
        -0.969_266 * x + 1.876_011 * y + 0.041_556 * z,
        0.055_643 * x - 0.204_026 * y + 1.057_225 * z,
    )
    .map(|c| c.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(elevation: f32, turbidity: f32) -> Sky {
        let (sin, cos) = sin_cos(elevation.to_radians());
        Sky::new(Vec3::new(cos, sin, 0.0), turbidity)
    }

    /// Measured luminances: a clear zenith has some kcd/m² (more near the sun), the sun at noon gives 70 to 110 klx,
    /// the sky 10 to 30. For haze above 3 and a high sun the model is known to give too much. [Zotti 2007]
    #[test]
    fn a_day_is_as_bright_as_days_are() {
        for (elevation, turbidity) in [(30.0, 2.5), (45.0, 3.0), (60.0, 3.0)] {
            let sky = sky(elevation, turbidity);
            let zenith = sky.radiance(Vec3::Y).luminance() * UNIT;
            assert!((1.5..16.0).contains(&zenith), "{elevation}: {zenith} kcd/m² at the zenith");
            let sun = sky.sun().luminance() * UNIT;
            assert!((60.0..115.0).contains(&sun), "{elevation}: {sun} klx by the sun");
            let ground = sky.picture(Rgb::WHITE, Rgb::BLACK).texel(0, SIZE[1] - 1).luminance() * PI * UNIT;
            assert!((6.0..35.0).contains(&ground), "{elevation}: {ground} klx by the sky");
        }
    }

    #[test]
    fn skies_are_blue_and_evenings_red() {
        let noon = sky(60.0, 3.0);
        let zenith = noon.radiance(Vec3::Y);
        assert!(zenith.b > 1.5 * zenith.r, "{zenith:?}");
        let colour = |elevation: f32| {
            let sun = sky(elevation, 3.0).sun();
            sun.r / sun.b
        };
        assert!(colour(60.0) < 1.6 && colour(5.0) > 3.0 * colour(60.0), "{} {}", colour(60.0), colour(5.0));
        // The sky is brightest around the sun.
        let morning = sky(30.0, 3.0);
        let [beside, above, opposite] =
            [morning.towards, Vec3::Y, morning.towards * Vec3::new(-1.0, 1.0, 1.0)]
                .map(|direction| morning.radiance(direction).luminance());
        assert!(beside > 2.0 * above && beside > 2.0 * opposite, "{beside} {above} {opposite}");
    }

    /// However low the sun and thick the haze, no value is negative or NaN.
    #[test]
    fn every_sky_is_light() {
        for (elevation, turbidity) in [(0.0, 1.7), (0.0, 10.0), (90.0, 1.7), (90.0, 10.0), (1.0, 5.0)] {
            let sky = sky(elevation, turbidity);
            let picture = sky.picture(Rgb::WHITE, sky.sun());
            let texels = (0..SIZE[0] * SIZE[1]).map(|i| picture.texel(i % SIZE[0], i / SIZE[0]));
            assert!(texels.chain([sky.sun()]).all(|c| c.is_finite() && c.r >= 0.0 && c.b >= 0.0));
        }
    }
}
