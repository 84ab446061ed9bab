//! Data about the whole tree that a ray needs before traversal.

use super::layout::Ref;
use crate::triangle::PAD;
use bilux_math::{Aabb, Vec3};

/// The root of the tree, and its extent.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreeSummary {
    pub(super) root: Ref,
    /// Corners of the bounding box of everything; the fourth components are zero.
    pub(super) corners: [[f32; 4]; 2],
    /// Centre of that box; the fourth component is zero.
    pub(super) centre: [f32; 4],
    /// Limits for rays in the wide kernels: four times the maximum distance of the origin from the centre, on any
    /// axis, and four times the maximum component of the direction.
    pub(super) reach: [f32; 8],
    /// The pad of boxes for a ray that starts at the centre.
    pub(super) pad: f32,
}

/// Sizes beyond this, or below its inverse, are left to the plain kernel.
const LARGEST: f32 = (1u64 << 40) as f32;

/// 4 units of f32 rounding: what the fused box test adds to the pad of the lemma; see `docs/adr/0008-bvh8.md`.
pub(super) const BIAS_PAD: f32 = 4.0 / 16_777_216.0;

/// The pad of boxes per unit of distance between the ray's origin and the centre; two units more, for the rounding of
/// that distance and of the sum.
pub(super) const FAR_PAD: f32 = PAD + BIAS_PAD + 2.0 / 16_777_216.0;

/// Compensates for underflow: 2⁻⁸⁴ over directions as short as 2⁻⁴⁰ is still a normal number.
const MIN_PAD: f32 = 1.0 / (1u128 << 84) as f32;

impl TreeSummary {
    pub(super) fn new(root: Ref, corners: [[f32; 3]; 2]) -> TreeSummary {
        let middle = |k: usize| corners[0][k] * 0.5 + corners[1][k] * 0.5;
        let centre = [middle(0), middle(1), middle(2)];
        let away = |k: usize| (corners[0][k] - centre[k]).abs().max((corners[1][k] - centre[k]).abs());
        let half = away(0).max(away(1)).max(away(2));
        let off = centre[0].abs().max(centre[1].abs()).max(centre[2].abs());
        // Twice the rounding error of this sum.
        let pad = (half * PAD + off * BIAS_PAD + MIN_PAD) * (1.0 + 16.0 / 16_777_216.0);
        // An empty box, or one with a NaN, fits no ray.
        let fits = half <= LARGEST && off <= LARGEST;
        let (reach, pace) = if fits { (LARGEST, LARGEST) } else { (-1.0, -1.0) };
        TreeSummary {
            root,
            corners: corners.map(|[x, y, z]| [x, y, z, 0.0]),
            centre: [centre[0], centre[1], centre[2], 0.0],
            reach: [reach, reach, reach, reach, pace, pace, pace, pace],
            pad,
        }
    }

    /// The bounding box of everything.
    pub(super) fn bounds(&self) -> Aabb {
        let [min, max] = self.corners.map(|[x, y, z, _]| Vec3::new(x, y, z));
        Aabb { min, max }
    }
}
