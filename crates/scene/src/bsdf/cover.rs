//! What a coat lets through to what is below it, and back.
//!
//! A coat reflects E(µ) of the light along a direction, and g = 1 - E passes. Below it, single directions and lobes about
//! them are scaled by the lesser g of the two directions: reciprocal, never more than what passed, and all of it where
//! both are alike, as for a mirror. Diffuse light is scaled by the product of the two over the mean of g, which loses
//! none of it. [Kulla 2017]

use super::Albedo;

/// What lies over a lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cover {
    /// How much of the surface has the coat, 0..=1.
    coat_weight: f32,
    coat: Albedo,
}

impl Cover {
    /// Nothing.
    pub const NONE: Cover = Cover { coat_weight: 0.0, coat: Albedo::NONE };

    /// A coat on this much of the surface, 0..=1.
    pub fn coat(weight: f32, coat: Albedo) -> Cover {
        Cover { coat_weight: weight, coat }
    }

    /// True where there is nothing.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.coat_weight == 0.0
    }

    /// The fraction that passes along a direction of this cosine with the normal.
    #[inline]
    pub fn passed(&self, cos: f32) -> f32 {
        if self.is_none() { 1.0 } else { 1.0 - self.coat_weight * self.coat.at(cos) }
    }

    /// The fraction of what is scattered between two directions that passes on its way in and out.
    #[inline]
    pub(super) fn both(&self, cos_o: f32, cos_i: f32) -> f32 {
        if self.is_none() { 1.0 } else { self.passed(cos_o).min(self.passed(cos_i)) }
    }
}
