//! The sign stage of the triangle test on the four triangles of a block.
//!
//! No operation is fused: each product and difference is rounded as in [`PreparedRay::cross`].

use crate::bvh8::layout::LANES;
use crate::triangle::PreparedRay;
use std::arch::x86_64::*;
use std::mem::MaybeUninit;

/// A ray, a lane for each triangle. Axes are those of sheared space.
#[derive(Clone, Copy)]
pub(super) struct BlockRay {
    /// Bytes from the front of a block to the rows of each axis.
    rows: [usize; 3],
    origin: [__m128; 3],
    shear: [__m128; 2],
}

/// Sheared corners, written only where the mask says so: `[axis][corner][lane]`.
#[repr(C, align(16))]
pub(super) struct Sheared(pub(super) [[[MaybeUninit<f32>; LANES]; 3]; 3]);

impl BlockRay {
    #[inline(always)]
    pub(super) unsafe fn new(ray: &PreparedRay) -> BlockRay {
        // SAFETY: every x86-64 machine has SSE2.
        unsafe {
            BlockRay {
                rows: ray.axes.map(|axis| axis * 3 * LANES * 4),
                origin: ray.axes.map(|axis| _mm_set1_ps(ray.ray.origin[axis])),
                shear: ray.shear.map(|s| _mm_set1_ps(s)),
            }
        }
    }

    /// A bit for each triangle that the signs of its edges do not reject, and the corners for those.
    #[inline(always)]
    pub(super) unsafe fn signs(&self, block: *const u8) -> (u32, Sheared) {
        // SAFETY: a block is aligned to 32 bytes and holds nine rows of four numbers.
        unsafe {
            let rows = |axis: usize| {
                let row = block.add(self.rows[axis]).cast::<f32>();
                let at = |corner: usize| _mm_sub_ps(_mm_load_ps(row.add(corner * LANES)), self.origin[axis]);
                [at(0), at(1), at(2)]
            };
            let z = rows(2);
            let lean = |axis: usize| {
                let [a, b, c] = rows(axis);
                let s = self.shear[axis];
                [
                    _mm_sub_ps(a, _mm_mul_ps(s, z[0])),
                    _mm_sub_ps(b, _mm_mul_ps(s, z[1])),
                    _mm_sub_ps(c, _mm_mul_ps(s, z[2])),
                ]
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
            let mask = _mm_movemask_ps(mixed) as u32 ^ 15;
            let mut sheared = Sheared([[[MaybeUninit::uninit(); LANES]; 3]; 3]);
            if mask != 0 {
                for (axis, rows) in [x, y, z].iter().enumerate() {
                    for corner in 0..3 {
                        _mm_store_ps(sheared.0[axis][corner].as_mut_ptr().cast(), rows[corner]);
                    }
                }
            }
            (mask, sheared)
        }
    }
}
