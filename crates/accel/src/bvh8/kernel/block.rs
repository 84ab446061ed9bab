//! The triangle test on the four triangles of a block, operation by operation that of [`crate::triangle`].
//!
//! Nothing is fused: each product and difference is rounded as in `PreparedRay::cross`, first in f32 and, where the
//! signs leave a triangle, in f64.

use crate::bvh8::layout::LANES;
use crate::ray::{Culling, Query, Ray};
use crate::slab::{least_of, limit_of};
use std::arch::x86_64::*;

/// A ray with a lane for each triangle. Axes are those of sheared space.
#[derive(Clone, Copy)]
pub(super) struct BlockRay {
    /// Bytes from the front of a block to the rows of each axis.
    rows: [usize; 3],
    origin: [__m128; 3],
    shear: [__m128; 2],
    /// The direction along the third axis.
    depth: f32,
    t_min: f32,
    exclude: u32,
}

/// Corners in sheared space: `[axis][corner]`.
pub(super) type Sheared = [[__m128; 3]; 3];

/// Triangles that are hit between the ends that count.
pub(super) struct Crossings {
    /// A bit for each.
    pub(super) mask: u32,
    t: __m128,
    v: __m256d,
    w: __m256d,
    det: __m256d,
}

impl BlockRay {
    /// # Safety
    /// The machine must have AVX.
    #[inline(always)]
    pub(super) unsafe fn new(ray: &Ray) -> BlockRay {
        let [x, y, z] = [ray.direction[0].abs(), ray.direction[1].abs(), ray.direction[2].abs()];
        // Without branches, as nobody could foresee them.
        let axes = AXES[usize::from(y >= x) | (usize::from(z >= x) & usize::from(z >= y)) << 1];
        // SAFETY: as the caller promises; axes are less than three.
        unsafe {
            let origin = |k: usize| _mm_set1_ps(*ray.origin.get_unchecked(axes[k]));
            let direction = |k: usize| *ray.direction.get_unchecked(axes[k]);
            let depth = direction(2);
            BlockRay {
                rows: [axes[0] * ROW_BYTES, axes[1] * ROW_BYTES, axes[2] * ROW_BYTES],
                origin: [origin(0), origin(1), origin(2)],
                shear: [_mm_set1_ps(direction(0) / depth), _mm_set1_ps(direction(1) / depth)],
                depth,
                t_min: ray.t_min,
                exclude: ray.exclude.index,
            }
        }
    }

    /// A bit for each triangle that the signs of its edges do not reject, and all corners.
    ///
    /// # Safety
    /// The machine must have AVX, and `block` must point to a block.
    #[inline(always)]
    pub(super) unsafe fn signs(&self, block: *const u8) -> (u32, Sheared) {
        // SAFETY: a block is aligned to 32 bytes and holds nine rows of four numbers.
        unsafe {
            let rows = |axis: usize| {
                let row = block.add(self.rows[axis]).cast::<f32>();
                [0, 1, 2].map(|corner| _mm_sub_ps(_mm_load_ps(row.add(corner * LANES)), self.origin[axis]))
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
            let zero = _mm_setzero_ps();
            let either = |a, b, c| _mm_or_ps(_mm_or_ps(a, b), c);
            let below = |a| _mm_cmplt_ps(a, zero);
            let above = |a| _mm_cmpgt_ps(a, zero);
            let mixed =
                _mm_and_ps(either(below(u), below(v), below(w)), either(above(u), above(v), above(w)));
            (_mm_movemask_ps(mixed) as u32 ^ 15, [x, y, z])
        }
    }

    /// A bit for each triangle that does not lie wholly behind `t`: the exact distance is a mean of those of the corners.
    ///
    /// # Safety
    /// The machine must have AVX.
    #[inline(always)]
    pub(super) unsafe fn not_behind(&self, [_, _, [a, b, c]]: &Sheared, t: f32) -> u32 {
        // SAFETY: as the caller promises.
        unsafe {
            let pace = self.depth.abs();
            let limit = _mm_set1_ps(limit_of(t, pace, least_of(pace)));
            let near = if self.depth < 0.0 {
                _mm_sub_ps(_mm_setzero_ps(), _mm_max_ps(_mm_max_ps(*a, *b), *c))
            } else {
                _mm_min_ps(_mm_min_ps(*a, *b), *c)
            };
            // What is not a number is left to the exact stage.
            _mm_movemask_ps(_mm_cmpngt_ps(near, limit)) as u32
        }
    }

    /// The exact stage, for the triangles of a mask that is not zero, and all that decides whether a hit counts.
    ///
    /// # Safety
    /// The machine must have AVX, and `block` must point to a block.
    #[inline(always)]
    pub(super) unsafe fn cross(
        &self,
        block: *const u8,
        (mask, corners): (u32, Sheared),
        t_max: f32,
        query: &Query,
    ) -> Crossings {
        // SAFETY: as the caller promises; a block holds its primitives behind nine rows of four numbers.
        unsafe {
            // Not `map`, which would be compiled without the instructions of the level, and called.
            let wide = |[a, b, c]: [__m128; 3]| [_mm256_cvtps_pd(a), _mm256_cvtps_pd(b), _mm256_cvtps_pd(c)];
            let [x, y, z] = corners;
            let (x, y, z) = (wide(x), wide(y), wide(z));
            let edge =
                |p: usize, q: usize| _mm256_sub_pd(_mm256_mul_pd(x[p], y[q]), _mm256_mul_pd(y[p], x[q]));
            let (u, v, w) = (edge(2, 1), edge(0, 2), edge(1, 0));
            let zero = _mm256_setzero_pd();
            let either = |a, b, c| _mm256_or_pd(_mm256_or_pd(a, b), c);
            let below = |a| _mm256_cmp_pd::<_CMP_LT_OQ>(a, zero);
            let above = |a| _mm256_cmp_pd::<_CMP_GT_OQ>(a, zero);
            let mixed =
                _mm256_and_pd(either(below(u), below(v), below(w)), either(above(u), above(v), above(w)));
            let det = _mm256_add_pd(_mm256_add_pd(u, v), w);
            let size = _mm256_andnot_pd(_mm256_set1_pd(-0.0), det);
            let sound = _mm256_and_pd(
                _mm256_cmp_pd::<_CMP_GT_OQ>(size, zero),
                _mm256_cmp_pd::<_CMP_LT_OQ>(size, _mm256_set1_pd(f64::INFINITY)),
            );
            let along = _mm256_add_pd(_mm256_mul_pd(u, z[0]), _mm256_mul_pd(v, z[1]));
            let along = _mm256_add_pd(along, _mm256_mul_pd(w, z[2]));
            let depth = f64::from(self.depth);
            let t = _mm256_cvtpd_ps(_mm256_div_pd(along, _mm256_mul_pd(det, _mm256_set1_pd(depth))));
            let within =
                _mm_and_ps(_mm_cmpge_ps(t, _mm_set1_ps(self.t_min)), _mm_cmple_ps(t, _mm_set1_ps(t_max)));
            let primitives = _mm_load_si128(block.add(9 * LANES * 4).cast());
            let excluded = _mm_cmpeq_epi32(primitives, _mm_set1_epi32(self.exclude as i32));
            let within = _mm_andnot_ps(_mm_castsi128_ps(excluded), within);
            let mut mask = mask & _mm_movemask_ps(within) as u32;
            mask &= _mm256_movemask_pd(_mm256_andnot_pd(mixed, sound)) as u32;
            if query.culling == Culling::Back {
                let negative = _mm256_movemask_pd(det) as u32;
                mask &= if depth < 0.0 { negative } else { !negative };
            }
            Crossings { mask, t, v, w, det }
        }
    }
}

impl Crossings {
    /// Distances of all four.
    #[inline(always)]
    pub(super) fn t(&self) -> [f32; LANES] {
        // SAFETY: both are 16 bytes.
        unsafe { std::mem::transmute(self.t) }
    }

    /// Barycentric weights of all four.
    ///
    /// # Safety
    /// The machine must have AVX.
    #[inline(always)]
    pub(super) unsafe fn weights(&self) -> [[f32; LANES]; 2] {
        // SAFETY: as the caller promises; both are 16 bytes.
        unsafe {
            let over = |x| std::mem::transmute(_mm256_cvtpd_ps(_mm256_div_pd(x, self.det)));
            [over(self.v), over(self.w)]
        }
    }
}

/// Of three corners along one axis.
const ROW_BYTES: usize = 3 * LANES * 4;

/// Which axes of space are x, y and z of sheared space: the last is the steepest, and the last of equals.
const AXES: [[usize; 3]; 4] = [[1, 2, 0], [2, 0, 1], [0, 1, 2], [0, 1, 2]];
