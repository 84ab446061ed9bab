//! The normal of a lobe that has its own.

use bilux_math::Vec3;

/// The cosine between the shading normal and the triangle's above which nothing bends: what faces away then is seen
/// within a tenth of a degree of the surface.
pub(super) const NEARLY_FLAT: f32 = 1.0 - 1e-6;

/// The lobe's index, and its normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct LobeFrame {
    pub(super) index: u8,
    pub(super) n: Vec3,
    pub(super) bends: bool,
}

impl LobeFrame {
    /// [`super::Bsdf::bending`] of the lobe.
    pub(super) fn bend(&mut self, n_geom: Vec3) {
        self.bends = self.n.dot(n_geom) < NEARLY_FLAT;
    }
}
