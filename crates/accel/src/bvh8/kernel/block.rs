//! The triangle test on the four triangles of a block, operation by operation that of [`crate::triangle`].
//!
//! Nothing is fused: each product and difference is rounded as in `PreparedRay::cross`, first in f32 and, where the
//! signs leave a triangle, in f64.

use super::tame::halves;
use crate::bvh8::layout::LANES;
use crate::ray::{Culling, Ray};
use std::arch::x86_64::*;

/// A ray with a lane for each triangle. Axes are those of sheared space.
#[derive(Clone, Copy)]
pub(super) struct BlockRay {
    /// Bytes from the front of a block to the rows of each axis.
    rows: [usize; 3],
    /// Less the origin.
    back: [__m128; 3],
    shear: [__m128; 2],
    /// The direction along the third axis.
    depth: __m128,
}

/// Corners in sheared space: `[axis][corner]`.
pub(super) type Sheared = [[__m128; 3]; 3];

/// Triangles that are hit between the ends that count.
pub(super) struct Crossings {
    /// The sign bit of each.
    within: __m128,
    t: __m128,
    v: __m128,
    w: __m128,
}

impl BlockRay {
    /// # Safety
    /// The machine must have AVX.
    #[inline(always)]
    pub(super) unsafe fn new(ray: &Ray) -> BlockRay {
        // SAFETY: as the caller promises.
        unsafe {
            let (origin, direction) = halves(ray);
            let keep = _mm_loadu_ps([0x7fff_ffff_u32, 0x7fff_ffff, 0x7fff_ffff, 0].as_ptr().cast());
            let sizes = _mm_and_ps(direction, keep);
            let pairs = _mm_max_ps(sizes, _mm_permute_ps::<0b10_11_00_01>(sizes));
            let greatest = _mm_max_ps(pairs, _mm_permute_ps::<0b01_00_11_10>(pairs));
            let steepest = _mm_movemask_ps(_mm_cmpeq_ps(sizes, greatest));
            // Without branches, as nobody could foresee them.
            let Axes { order, rows } = &AXES[steepest as usize & 7];
            let order = _mm_load_si128(order.as_ptr().cast());
            let direction = _mm_permutevar_ps(direction, order);
            let back = _mm_xor_ps(_mm_permutevar_ps(origin, order), _mm_set1_ps(-0.0));
            let depth = _mm_permute_ps::<0b10_10_10_10>(direction);
            let shear = _mm_div_ps(direction, depth);
            BlockRay {
                rows: *rows,
                back: [
                    _mm_permute_ps::<0>(back),
                    _mm_permute_ps::<0b01_01_01_01>(back),
                    _mm_permute_ps::<0b10_10_10_10>(back),
                ],
                shear: [_mm_permute_ps::<0>(shear), _mm_permute_ps::<0b01_01_01_01>(shear)],
                depth,
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
                let corner =
                    |corner: usize| _mm_add_ps(self.back[axis], _mm_load_ps(row.add(corner * LANES)));
                [corner(0), corner(1), corner(2)]
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
            // What is not a number may drop out here, and reject less.
            let (least, greatest) = (_mm_min_ps(_mm_min_ps(u, v), w), _mm_max_ps(_mm_max_ps(u, v), w));
            let zero = _mm_setzero_ps();
            let one_side = _mm_or_ps(_mm_cmpnlt_ps(least, zero), _mm_cmpngt_ps(greatest, zero));
            (_mm_movemask_ps(one_side) as u32, [x, y, z])
        }
    }

    /// The exact stage, and all that decides whether a hit counts. What the signs rejected is rejected here too.
    ///
    /// # Safety
    /// The machine must have AVX, and `block` must point to a block.
    #[inline(always)]
    pub(super) unsafe fn cross(
        &self,
        block: *const u8,
        corners: Sheared,
        (ray, t_max): (&Ray, f32),
        culling: Culling,
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
            let (least, greatest) =
                (_mm256_min_pd(_mm256_min_pd(u, v), w), _mm256_max_pd(_mm256_max_pd(u, v), w));
            // What is not a number makes the determinant none, and is refused there.
            let one_side = _mm256_or_pd(
                _mm256_cmp_pd::<_CMP_GE_OQ>(least, zero),
                _mm256_cmp_pd::<_CMP_LE_OQ>(greatest, zero),
            );
            let det = _mm256_add_pd(_mm256_add_pd(u, v), w);
            let size = _mm256_andnot_pd(_mm256_set1_pd(-0.0), det);
            let sound = _mm256_and_pd(
                _mm256_cmp_pd::<_CMP_GT_OQ>(size, zero),
                _mm256_cmp_pd::<_CMP_LT_OQ>(size, _mm256_set1_pd(f64::INFINITY)),
            );
            let along = _mm256_add_pd(_mm256_mul_pd(u, z[0]), _mm256_mul_pd(v, z[1]));
            let along = _mm256_add_pd(along, _mm256_mul_pd(w, z[2]));
            let depth = _mm256_cvtps_pd(self.depth);
            let t = _mm256_cvtpd_ps(_mm256_div_pd(along, _mm256_mul_pd(det, depth)));
            let within =
                _mm_and_ps(_mm_cmpge_ps(t, _mm_set1_ps(ray.t_min)), _mm_cmple_ps(t, _mm_set1_ps(t_max)));
            let primitives = _mm_load_si128(block.add(9 * LANES * 4).cast());
            let excluded = _mm_cmpeq_epi32(primitives, _mm_set1_epi32(ray.exclude.index as i32));
            let within = _mm_andnot_ps(_mm_castsi128_ps(excluded), within);
            // No mesh has so many; places without a triangle do.
            let within = _mm_andnot_ps(_mm_castsi128_ps(primitives), within);
            let mut good = _mm256_and_pd(one_side, sound);
            if culling == Culling::Back {
                good = _mm256_and_pd(good, _mm256_cmp_pd::<_CMP_GT_OQ>(_mm256_mul_pd(det, depth), zero));
            }
            let good = _mm256_castpd_si256(good);
            let (low, high) = (_mm256_castsi256_si128(good), _mm256_extracti128_si256::<1>(good));
            let within = _mm_and_ps(within, _mm_castsi128_ps(_mm_packs_epi32(low, high)));
            let over = |x| _mm256_cvtpd_ps(_mm256_div_pd(x, det));
            Crossings { within, t, v: over(v), w: over(w) }
        }
    }
}

impl Crossings {
    /// A bit for each.
    ///
    /// # Safety
    /// The machine must have AVX.
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

/// Of three corners along one axis.
const ROW_BYTES: usize = 3 * LANES * 4;

/// Which axes of space are x, y and z of sheared space, and bytes from the front of a block to the rows of each.
#[repr(C, align(16))]
struct Axes {
    order: [u32; 4],
    rows: [usize; 3],
}

/// By which components are the greatest, a bit for each: the last of them becomes z.
const AXES: [Axes; 8] = [axes(2), axes(0), axes(1), axes(1), axes(2), axes(2), axes(2), axes(2)];

const fn axes(z: usize) -> Axes {
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    Axes {
        order: [x as u32, y as u32, z as u32, z as u32],
        rows: [x * ROW_BYTES, y * ROW_BYTES, z * ROW_BYTES],
    }
}
