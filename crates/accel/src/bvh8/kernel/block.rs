//! The triangle test on the four triangles of a block, operation by operation that of [`crate::triangle`].
//!
//! Nothing is fused: each product and difference is rounded as in `PreparedRay::cross`, first in f32 and, where the
//! signs leave a triangle, in f64.

use super::axes::{AXES, Axes, Reorder};
use super::doubles::Doubles;
use super::lane_ray::{SIZES, halves};
use super::node_format::NodeFormat;
use crate::bvh8::layout::LANES;
use crate::ray::{Culling, Ray};
use std::arch::x86_64::*;

/// A ray with a lane for each triangle. Axes are those of sheared space.
#[derive(Clone, Copy)]
pub(super) struct BlockRay {
    axes: &'static Axes,
    /// The negated origin.
    back: [__m128; 3],
    shear: [__m128; 2],
    /// The direction along the third axis.
    depth: __m128,
}

/// Corners in sheared space: `[axis][corner]`.
pub(super) type Sheared = [[__m128; 3]; 3];

/// Triangles that may be hit.
pub(super) struct Candidates {
    /// The sign bit of each lane.
    there: __m128,
    corners: Sheared,
}

/// Triangles that are hit within the part of the ray that counts.
pub(super) struct Crossings {
    /// The sign bit of each lane.
    within: __m128,
    t: __m128,
    v: __m128,
    w: __m128,
}

impl BlockRay {
    /// # Safety
    /// The machine must have the level.
    #[inline(always)]
    pub(super) unsafe fn new<L: Reorder>(ray: &Ray) -> BlockRay {
        // SAFETY: as the caller promises.
        unsafe {
            let (origin, direction) = halves(ray);
            let sizes = _mm_and_ps(direction, _mm_loadu_ps(SIZES.as_ptr().cast()));
            let pairs = _mm_max_ps(sizes, _mm_shuffle_ps::<0b10_11_00_01>(sizes, sizes));
            let greatest = _mm_max_ps(pairs, _mm_shuffle_ps::<0b01_00_11_10>(pairs, pairs));
            let steepest = _mm_movemask_ps(_mm_cmpeq_ps(sizes, greatest));
            // Without branches, as they would be unpredictable.
            let axes = &AXES[steepest as usize & 7];
            let direction = L::reorder(direction, axes);
            let back = _mm_xor_ps(L::reorder(origin, axes), _mm_set1_ps(-0.0));
            let depth = _mm_shuffle_ps::<0b10_10_10_10>(direction, direction);
            let shear = _mm_div_ps(direction, depth);
            BlockRay {
                axes,
                back: [
                    _mm_shuffle_ps::<0>(back, back),
                    _mm_shuffle_ps::<0b01_01_01_01>(back, back),
                    _mm_shuffle_ps::<0b10_10_10_10>(back, back),
                ],
                shear: [_mm_shuffle_ps::<0>(shear, shear), _mm_shuffle_ps::<0b01_01_01_01>(shear, shear)],
                depth,
            }
        }
    }

    /// The triangles that the signs of their edges do not reject, without the one that the ray leaves.
    ///
    /// # Safety
    /// The machine must have the level, and `block` must point to a block.
    #[inline(always)]
    pub(super) unsafe fn signs<L: Reorder, F: NodeFormat>(
        &self,
        block: *const u8,
        exclude: u32,
    ) -> Candidates {
        // SAFETY: as the caller promises; the primitives of a block are aligned to 16 bytes.
        unsafe {
            let corners = F::corners::<L>(block, self.axes);
            let rows = |axis: usize| {
                let [a, b, c] = corners[axis];
                let back = self.back[axis];
                [_mm_add_ps(back, a), _mm_add_ps(back, b), _mm_add_ps(back, c)]
            };
            let z = rows(2);
            let lean = |axis: usize| {
                let [a, b, c] = rows(axis);
                let by = |z: __m128| _mm_mul_ps(self.shear[axis], z);
                [_mm_sub_ps(a, by(z[0])), _mm_sub_ps(b, by(z[1])), _mm_sub_ps(c, by(z[2]))]
            };
            let (x, y) = (lean(0), lean(1));
            let edge = |p: usize, q: usize| _mm_sub_ps(_mm_mul_ps(x[p], y[q]), _mm_mul_ps(y[p], x[q]));
            let (u, v, w) = (edge(2, 1), edge(0, 2), edge(1, 0));
            // A NaN may drop out here; then fewer triangles are rejected.
            let (least, greatest) = (_mm_min_ps(_mm_min_ps(u, v), w), _mm_max_ps(_mm_max_ps(u, v), w));
            let zero = _mm_setzero_ps();
            let one_side = _mm_or_ps(_mm_cmpnlt_ps(least, zero), _mm_cmpngt_ps(greatest, zero));
            let primitives = _mm_load_si128(block.add(F::PRIMITIVES).cast());
            let excluded = _mm_cmpeq_epi32(primitives, _mm_set1_epi32(exclude as i32));
            // No mesh has indices so large that their sign bit is set; empty lanes have.
            let never = _mm_castsi128_ps(_mm_or_si128(excluded, primitives));
            Candidates { there: _mm_andnot_ps(never, one_side), corners: [x, y, z] }
        }
    }

    /// The exact stage, and everything else that decides whether a hit counts.
    ///
    /// # Safety
    /// The machine must have the level of the doubles.
    #[inline(always)]
    pub(super) unsafe fn cross<D: Doubles>(
        &self,
        candidates: &Candidates,
        (t_min, t_max): (f32, f32),
        culling: Culling,
    ) -> Crossings {
        // SAFETY: as the caller promises.
        unsafe {
            // Not `map`, which would be compiled without the instructions of the level, and called.
            let wide = |[a, b, c]: [__m128; 3]| [D::widen(a), D::widen(b), D::widen(c)];
            let [x, y, z] = candidates.corners;
            let (x, y, z) = (wide(x), wide(y), wide(z));
            let edge = |p: usize, q: usize| x[p].mul(y[q]).sub(y[p].mul(x[q]));
            let (u, v, w) = (edge(2, 1), edge(0, 2), edge(1, 0));
            let zero = D::splat(0.0);
            let (least, greatest) = (u.min(v).min(w), u.max(v).max(w));
            // A NaN makes the determinant NaN, which is rejected there.
            let one_side = least.ge(zero).or(greatest.le(zero));
            let det = u.add(v).add(w);
            let size = det.and_not(D::splat(-0.0));
            let sound = size.gt(zero).and(size.lt(D::splat(f64::INFINITY)));
            let along = u.mul(z[0]).add(v.mul(z[1]));
            let along = along.add(w.mul(z[2]));
            let depth = D::widen(self.depth);
            let t = along.div(det.mul(depth)).narrow();
            let within = _mm_and_ps(_mm_cmpge_ps(t, _mm_set1_ps(t_min)), _mm_cmple_ps(t, _mm_set1_ps(t_max)));
            let within = _mm_and_ps(within, candidates.there);
            let mut good = one_side.and(sound);
            if culling == Culling::Back {
                good = good.and(det.mul(depth).gt(zero));
            }
            let within = _mm_and_ps(within, good.narrow_mask());
            Crossings { within, t, v: v.div(det).narrow(), w: w.div(det).narrow() }
        }
    }
}

impl Candidates {
    /// True where there are none.
    ///
    /// # Safety
    /// Requires SSE, which every machine of this kind has.
    #[inline(always)]
    pub(super) unsafe fn is_empty(&self) -> bool {
        // SAFETY: as the caller promises.
        unsafe { _mm_movemask_ps(self.there) == 0 }
    }
}

impl Crossings {
    /// A mask with a bit for each hit.
    ///
    /// # Safety
    /// Requires SSE, which every machine of this kind has.
    #[inline(always)]
    pub(super) unsafe fn mask(&self) -> u32 {
        // SAFETY: as the caller promises.
        unsafe { _mm_movemask_ps(self.within) as u32 }
    }

    /// Distances of all four.
    #[inline(always)]
    pub(super) fn t(&self) -> [f32; LANES] {
        // SAFETY: both are 16 bytes.
        unsafe { std::mem::transmute(self.t) }
    }

    /// Barycentric weights of all four.
    #[inline(always)]
    pub(super) fn weights(&self) -> [[f32; LANES]; 2] {
        // SAFETY: both are 16 bytes.
        unsafe { std::mem::transmute([self.v, self.w]) }
    }
}
