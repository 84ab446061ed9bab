//! Roughness: the orientation and visibility of the microfacets of a rough surface. The Trowbridge-Reitz distribution,
//! called GGX, with Smith's masking and shadowing. [Walter 2007; Heitz 2014]
//!
//! Directions are local, with the normal as z, and above the surface: callers mirror directions from below.

use bilux_math::transcendental::sin_cos;
use bilux_math::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// Microfacets distributed like the normals of a stretched sphere. The stretch along each of two perpendicular
/// directions is the alpha of that direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// The stretch as a symmetric matrix: xx, xy, yy.
    stretch: [f32; 3],
    /// The smaller alpha; 0 for a smooth surface.
    least: f32,
}

/// A surface with a smaller alpha is smooth, and no direction's alpha is smaller: f32 cannot hold sharper peaks.
pub(super) const MIN_ALPHA: f32 = 1e-3;

impl Ggx {
    /// A smooth surface.
    pub const SMOOTH: Ggx = Ggx { stretch: [0.0; 3], least: 0.0 };

    /// The same roughness in all directions.
    pub fn new(alpha: f32) -> Ggx {
        Ggx::anisotropic(alpha, alpha, 0.0)
    }

    /// One alpha along a direction, which is the local x axis turned by `rotation` in radians, and another across it.
    pub fn anisotropic(alpha_along: f32, alpha_across: f32, rotation: f32) -> Ggx {
        // `max` returns the operand that is not NaN, if there is one.
        if !matches!(alpha_along.max(alpha_across), MIN_ALPHA..) {
            return Ggx::SMOOTH;
        }
        let (along, across) = (alpha_along.max(MIN_ALPHA), alpha_across.max(MIN_ALPHA));
        let (sin, cos) = if along == across { (0.0, 1.0) } else { sin_cos(rotation) };
        let xx = along * cos * cos + across * sin * sin;
        let yy = along * sin * sin + across * cos * cos;
        Ggx { stretch: [xx, (along - across) * sin * cos, yy], least: along.min(across) }
    }

    /// From the parameters of the materials: roughness 0..=1, the square root of alpha; anisotropy 0..=1, how much
    /// smoother the surface is along its brushing than across; and the angle of the brushing from the local x axis, in
    /// radians. [OpenPBR 1.1]
    pub fn from_roughness(roughness: f32, anisotropy: f32, rotation: f32) -> Ggx {
        let narrowed = 1.0 - anisotropy;
        let across = roughness * roughness * (2.0 / (1.0 + narrowed * narrowed)).sqrt();
        Ggx::anisotropic(narrowed * across, across, rotation)
    }

    /// True for a surface that reflects as a delta distribution.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.least == 0.0
    }

    /// The smaller alpha of the two directions.
    #[inline]
    pub(super) fn least(&self) -> f32 {
        self.least
    }

    #[inline]
    fn stretched(&self, x: f32, y: f32) -> Vec2 {
        let [xx, xy, yy] = self.stretch;
        Vec2::new(xx * x + xy * y, xy * x + yy * y)
    }

    /// The density of microfacets over their normals, weighted by cosine. [Walter 2007, eq. 33]
    #[inline]
    pub(super) fn distribution(&self, m: Vec3) -> f32 {
        let [xx, xy, yy] = self.stretch;
        let determinant = xx * yy - xy * xy;
        let back = Vec2::new(yy * m.x - xy * m.y, xx * m.y - xy * m.x) / determinant;
        let q = back.length_squared() + m.z * m.z;
        FRAC_1_PI / (determinant * q * q)
    }

    /// The length of a stretched direction: cosθ·(1 + 2Λ), where Λ is Smith's auxiliary function. [Heitz 2014, eq. 72]
    #[inline]
    pub(super) fn shadow(&self, v: Vec3) -> f32 {
        (self.stretched(v.x, v.y).length_squared() + v.z * v.z).sqrt()
    }

    /// The height-correlated masking and shadowing of two directions, G2 / (4·cosθo): f·|cosθi| of microfacets that
    /// reflect from `wi` to `wo` with density 1. [Heitz 2014, eq. 99]
    #[inline]
    pub(super) fn visible(&self, wo: Vec3, wi: Vec3) -> f32 {
        let sum = self.shadow(wo) * wi.z + self.shadow(wi) * wo.z;
        if sum > 0.0 { 0.5 * wi.z / sum } else { 0.0 }
    }

    /// The density over solid angle of the microfacets visible to `wo`, as sampled by [`Ggx::sample_visible`] with a
    /// bound of [`Ggx::FULL`], divided by the microfacet distribution and by the microfacet's cosine with `wo`.
    #[inline]
    pub(super) fn seen(&self, wo: Vec3) -> f32 {
        2.0 / (wo.z + self.shadow(wo))
    }

    /// The density over solid angle of directions reflected at microfacets sampled within [`Ggx::bound`], divided by
    /// the microfacet distribution. [Eto 2023, eq. 8]
    #[inline]
    pub(super) fn reflected_within_bound(&self, wo: Vec3) -> f32 {
        0.5 / (self.bound(wo) * wo.z + self.shadow(wo))
    }

    /// The full cap of visible microfacets.
    pub(super) const FULL: f32 = 1.0;

    /// The part of the cap of visible microfacets that can reflect `wo` upwards. [Eto 2023, eq. 5]
    #[inline]
    pub(super) fn bound(&self, wo: Vec3) -> f32 {
        let across = 1.0 + (1.0 - wo.z * wo.z).max(0.0).sqrt();
        let (a2, s2) = (self.least.min(1.0) * self.least.min(1.0), across * across);
        (1.0 - a2) * s2 / (s2 + a2 * wo.z * wo.z)
    }

    /// Samples a microfacet visible to `wo`, which is above the surface, as a point of a spherical cap: a reflection
    /// uniform on the unit sphere is above the horizon of the stretched `wo`. [Dupuy 2023]
    #[inline]
    pub(super) fn sample_visible(&self, wo: Vec3, u: Vec2, bound: f32) -> Vec3 {
        let flat = self.stretched(wo.x, wo.y);
        let above = Vec3::new(flat.x, flat.y, wo.z).normalize();
        let lowest = bound * above.z;
        let z = (1.0 - u.y) * (1.0 + lowest) - lowest;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = sin_cos(TAU * u.x);
        let half = Vec3::new(r * cos, r * sin, z) + above;
        let flat = self.stretched(half.x, half.y);
        let m = Vec3::new(flat.x, flat.y, half.z.max(0.0));
        m.try_normalize().unwrap_or(Vec3::Z)
    }
}
