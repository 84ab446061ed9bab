//! The light that a coat and fuzz transmit to the layers below, and back.
//!
//! A coat reflects E(µ) of the light along a direction, and transmits g = 1 - E. The delta and glossy lobes below it
//! are scaled by the smaller g of the two directions. That is reciprocal, never exceeds the transmitted light, and
//! keeps all of it where both directions have the same g, as for a mirror. Diffuse light is scaled by the product of
//! the two over the mean of g, which loses none of it. [Kulla 2017]

use super::nodes::NODES;
use super::{Albedo, FuzzAlbedo};
use bilux_math::Vec3;

/// The layers above a lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coating {
    /// The fraction of the surface that has the coat, 0..=1.
    coat_weight: f32,
    coat: Albedo,
    /// The fraction of it that has fuzz on top, and the fuzz's albedo.
    fuzz: Option<(f32, FuzzAlbedo)>,
    /// The coating's normal, in the local frame of the lobe below, whose normal is the z axis.
    up: Vec3,
}

impl Coating {
    /// No coating.
    pub const NONE: Coating = Coating { coat_weight: 0.0, coat: Albedo::NONE, fuzz: None, up: Vec3::Z };

    /// A coat on this fraction of the surface, 0..=1.
    pub fn coat(weight: f32, coat: Albedo) -> Coating {
        Coating { coat_weight: weight, coat, ..Coating::NONE }
    }

    /// Adds a coat below the layers.
    pub fn coated(self, weight: f32, coat: Albedo) -> Coating {
        Coating { coat_weight: weight, coat, ..self }
    }

    /// Adds fuzz above the layers, on this fraction of the surface, 0..=1.
    pub fn below(self, weight: f32, fuzz: FuzzAlbedo) -> Coating {
        Coating { fuzz: (weight > 0.0).then_some((weight, fuzz)), ..self }
    }

    /// Turns the layers to another normal than the lobe's.
    pub fn about(self, up: Vec3) -> Coating {
        Coating { up, ..self }
    }

    /// True when there is no coating.
    #[inline]
    pub fn is_none(&self) -> bool {
        self.coat_weight == 0.0 && self.fuzz.is_none()
    }

    /// The transmitted fraction along a direction whose cosine with the normal is `cos`.
    #[inline]
    pub fn passed(&self, cos: f32) -> f32 {
        let [passed] = self.passed_at([cos]);
        passed
    }

    /// [`Coating::passed`] along several directions.
    #[inline(always)]
    fn passed_at<const N: usize>(&self, cosines: [f32; N]) -> [f32; N] {
        let mut passed = [1.0; N];
        if self.is_none() {
            return passed;
        }
        let roots = cosines.map(|cos| cos.clamp(0.0, 1.0).sqrt());
        if let Some((weight, fuzz)) = &self.fuzz {
            passed = fuzz.at_roots(roots).map(|albedo| 1.0 - weight * albedo);
        }
        if self.coat_weight > 0.0 {
            let albedo = self.coat.at_roots(roots);
            passed = std::array::from_fn(|i| passed[i] * (1.0 - self.coat_weight * albedo[i]));
        }
        passed
    }

    /// [`Coating::passed`], but for rounding, at all nodes of [quadratures](super::nodes).
    pub(super) fn passed_at_nodes(&self) -> [f32; NODES] {
        let mut passed = [1.0; NODES];
        if let Some((weight, fuzz)) = self.fuzz {
            let albedo = fuzz.at_nodes();
            passed = std::array::from_fn(|i| 1.0 - weight * albedo[i]);
        }
        if self.coat_weight > 0.0 {
            let albedo = self.coat.at_nodes();
            passed = std::array::from_fn(|i| passed[i] * (1.0 - self.coat_weight * albedo[i]));
        }
        passed
    }

    /// The transmitted fractions along two directions in the lobe's local frame.
    pub(super) fn passed_along_both(&self, wo: Vec3, wi: Vec3) -> [f32; 2] {
        self.passed_at([wo, wi].map(|direction| direction.dot(self.up).abs()))
    }
}
