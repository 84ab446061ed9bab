//! Shading in the classic modes (`cast`, `whitted`, `cook`). Equations 1 and 2 of the paper are not BSDFs, so materials
//! and lights describe themselves in terms of that older model too.
use bilux_math::{Rgb, Vec3};

/// A surface under Equations 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassicMaterial {
    /// Ambient reflection (ka).
    pub ka: Rgb,
    /// Diffuse reflection (kd).
    pub kd: Rgb,
    /// Specular reflection (ks), the weight of S.
    pub ks: Rgb,
    /// Refraction (kt), the weight of T.
    pub kt: Rgb,
    /// Exponent of the highlight.
    pub exponent: f32,
    /// Share of S that is light from the reflected direction, 0..=1; 1 in the paper.
    pub reflectivity: f32,
    /// Refractive index of the inside over that of the outside.
    pub eta: f32,
    /// Absorption per metre inside, by Beer's law.
    pub sigma_a: Rgb,
    /// True for a thin wall, through which light goes straight on.
    pub thin: bool,
    /// Spread of reflected rays in `cook`: the maximum angle, in radians.
    pub gloss: f32,
    /// Spread of refracted rays in `cook`: the maximum angle, in radians.
    pub translucency: f32,
    /// True where Fresnel's equations divide the light between S and T, or strengthen S towards grazing.
    pub fresnel: bool,
}

impl Default for ClassicMaterial {
    fn default() -> ClassicMaterial {
        ClassicMaterial {
            ka: Rgb::BLACK,
            kd: Rgb::BLACK,
            ks: Rgb::BLACK,
            kt: Rgb::BLACK,
            exponent: 32.0,
            reflectivity: 0.0,
            eta: 1.0,
            sigma_a: Rgb::BLACK,
            thin: false,
            gloss: 0.0,
            translucency: 0.0,
            fresnel: false,
        }
    }
}

/// A light under Equations 1 and 2, as seen from one shading point: without falloff.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassicLight {
    /// Unit direction towards it.
    pub wi: Vec3,
    /// Position of the light; `None` when infinitely far.
    pub position: Option<Vec3>,
    /// Factor on the light's colour, 0..=1: a spot's cone.
    pub strength: f32,
    /// As [`crate::LightSample::clearance`].
    pub clearance: f32,
}
