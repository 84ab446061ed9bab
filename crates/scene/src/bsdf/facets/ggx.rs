//! The Trowbridge-Reitz distribution of microfacets, called GGX. [Walter 2007; Heitz 2014]
//!
//! Directions are local, with the normal as z, and above the surface: callers mirror directions from below.

use super::smith::Smith;
use super::stretch::Stretch;
use bilux_math::transcendental::sin_cos;
use bilux_math::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// Microfacets distributed like the normals of a stretched sphere. The stretch along each of two perpendicular
/// directions is the alpha of that direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx(pub(in crate::bsdf) Stretch);

impl Ggx {
    /// A smooth surface.
    pub const SMOOTH: Ggx = Ggx(Stretch::SMOOTH);

    /// Microfacets of equal roughness in all directions.
    pub fn new(alpha: f32) -> Ggx {
        Ggx::anisotropic(alpha, alpha, 0.0)
    }

    /// One alpha along a direction, which is the local x axis turned by `rotation` in radians, and another across it.
    pub fn anisotropic(alpha_along: f32, alpha_across: f32, rotation: f32) -> Ggx {
        Ggx(Stretch::new(alpha_along, alpha_across, rotation))
    }

    /// From the parameters of the materials: roughness 0..=1, the square root of alpha; anisotropy 0..=1, how much
    /// smoother the surface is along its brushing than across; and the angle of the brushing from the local x axis, in
    /// radians. [OpenPBR 1.1]
    pub fn from_roughness(roughness: f32, anisotropy: f32, rotation: f32) -> Ggx {
        Ggx(Stretch::from_roughness(roughness, anisotropy, rotation))
    }

    /// True for a surface that reflects as a delta distribution.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.0.least == 0.0
    }

    /// The smaller alpha of the two directions.
    #[inline]
    pub(in crate::bsdf) fn least(&self) -> f32 {
        self.0.least
    }

    /// The full cap of visible microfacets.
    pub(in crate::bsdf) const FULL: f32 = 1.0;

    /// The part of the cap of visible microfacets that can reflect `wo` upwards. [Eto 2023, eq. 5]
    #[inline]
    pub(in crate::bsdf) fn bound(&self, wo: Vec3) -> f32 {
        let across = 1.0 + (1.0 - wo.z * wo.z).max(0.0).sqrt();
        let (a2, s2) = (self.0.least.min(1.0) * self.0.least.min(1.0), across * across);
        (1.0 - a2) * s2 / (s2 + a2 * wo.z * wo.z)
    }

    /// The density over solid angle of directions reflected at microfacets sampled within [`Ggx::bound`], divided by
    /// the microfacet distribution. [Eto 2023, eq. 8]
    #[inline]
    pub(in crate::bsdf) fn reflected_within_bound(&self, wo: Vec3) -> f32 {
        0.5 / (self.bound(wo) * wo.z + self.shadow(wo))
    }

    /// Samples a microfacet visible to `wo`, which is above the surface, as a point of a spherical cap: a reflection
    /// uniform on the unit sphere is above the horizon of the stretched `wo`. [Dupuy 2023]
    #[inline]
    pub(in crate::bsdf) fn sample_visible(&self, wo: Vec3, u: Vec2, bound: f32) -> Vec3 {
        let flat = self.0.of(wo.x, wo.y);
        let above = Vec3::new(flat.x, flat.y, wo.z).normalize();
        let lowest = bound * above.z;
        let z = (1.0 - u.y) * (1.0 + lowest) - lowest;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = sin_cos(TAU * u.x);
        let half = Vec3::new(r * cos, r * sin, z) + above;
        let flat = self.0.of(half.x, half.y);
        let m = Vec3::new(flat.x, flat.y, half.z.max(0.0));
        m.try_normalize().unwrap_or(Vec3::Z)
    }
}

impl Smith for Ggx {
    /// [Walter 2007, eq. 33]
    #[inline]
    fn distribution(&self, m: Vec3) -> f32 {
        let (determinant, back) = self.0.back(m);
        let q = back.length_squared() + m.z * m.z;
        FRAC_1_PI / (determinant * q * q)
    }

    /// The length of a stretched direction. [Heitz 2014, eq. 72]
    #[inline]
    fn shadow(&self, v: Vec3) -> f32 {
        (self.0.of(v.x, v.y).length_squared() + v.z * v.z).sqrt()
    }
}
