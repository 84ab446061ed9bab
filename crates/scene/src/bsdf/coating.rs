//! What a coat and fuzz let through to what is below them, and back.
//!
//! A coat reflects E(µ) of the light along a direction, and g = 1 - E passes. Below it, single directions and lobes about
//! them are scaled by the lesser g of the two directions: reciprocal, never more than what passed, and all of it where
//! both are alike, as for a mirror. Diffuse light is scaled by the product of the two over the mean of g, which loses
//! none of it. [Kulla 2017]

use super::{Albedo, FuzzAlbedo};
use bilux_math::Vec3;

/// What lies over a lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coating {
    /// How much of the surface has the coat, 0..=1.
    coat_weight: f32,
    coat: Albedo,
    /// How much of it has fuzz on top, and how that stands.
    fuzz: Option<(f32, FuzzAlbedo)>,
    /// The normal of all this, where what it covers has the z axis.
    up: Vec3,
}

impl Coating {
    /// Nothing.
    pub const NONE: Coating = Coating { coat_weight: 0.0, coat: Albedo::NONE, fuzz: None, up: Vec3::Z };

    /// A coat on this much of the surface, 0..=1.
    pub fn coat(weight: f32, coat: Albedo) -> Coating {
        Coating { coat_weight: weight, coat, ..Coating::NONE }
    }

    /// The same with a coat too, below the rest.
    pub fn coated(self, weight: f32, coat: Albedo) -> Coating {
        Coating { coat_weight: weight, coat, ..self }
    }

    /// The same below fuzz on this much of the surface, 0..=1.
    pub fn below(self, weight: f32, fuzz: FuzzAlbedo) -> Coating {
        Coating { fuzz: (weight > 0.0).then_some((weight, fuzz)), ..self }
    }

    /// The same about another normal than that of what it covers.
    pub fn about(self, up: Vec3) -> Coating {
        Coating { up, ..self }
    }

    /// True where there is nothing.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.coat_weight == 0.0 && self.fuzz.is_none()
    }

    /// The fraction that passes along a direction of this cosine with the normal.
    #[inline]
    pub fn passed(&self, cos: f32) -> f32 {
        if self.is_none() {
            return 1.0;
        }
        let below_fuzz = self.fuzz.map_or(1.0, |(weight, fuzz)| 1.0 - weight * fuzz.at(cos));
        below_fuzz * (1.0 - self.coat_weight * self.coat.at(cos))
    }

    /// The fraction that passes along a direction, as what is covered sees it.
    #[inline]
    pub(super) fn passed_along(&self, direction: Vec3) -> f32 {
        if self.is_none() { 1.0 } else { self.passed(direction.dot(self.up).abs()) }
    }

    /// The fraction of what is scattered between two directions that passes on its way in and out.
    #[inline]
    pub(super) fn both(&self, wo: Vec3, wi: Vec3) -> f32 {
        if self.is_none() { 1.0 } else { self.passed_along(wo).min(self.passed_along(wi)) }
    }
}
