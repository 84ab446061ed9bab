//! AVX2 and FMA on eight lanes.

use super::View;
use super::body::{self, Level, Stack, reference};
use crate::bvh8::layout::WIDTH;
use crate::bvh8::ray::WideRay;
use crate::counters::Count;
use crate::ray::{Hit, Query};
use std::arch::x86_64::*;

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) unsafe fn closest<C: Count>(
    view: View<'_>,
    ray: &WideRay,
    query: &Query,
    count: &mut C,
) -> Option<Hit> {
    // SAFETY: this function is called only where its features are.
    unsafe { body::closest::<Avx2, C>(view, ray, query, count) }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) unsafe fn any<C: Count>(view: View<'_>, ray: &WideRay, query: &Query, count: &mut C) -> bool {
    // SAFETY: as above.
    unsafe { body::any::<Avx2, C>(view, ray, query, count) }
}

/// A tame ray, a lane for each child of a node.
#[derive(Clone, Copy)]
pub(super) struct BoxRay {
    /// Bytes from the front of a node to the planes where the ray comes in, and goes out.
    enter_rows: [usize; 3],
    leave_rows: [usize; 3],
    inverse: [__m256; 3],
    enter_bias: [__m256; 3],
    leave_bias: [__m256; 3],
    nearest: __m256i,
}

impl BoxRay {
    #[inline(always)]
    pub(super) unsafe fn new(ray: &WideRay) -> BoxRay {
        let enter_rows = std::array::from_fn(|k| (ray.slabs.enters_high[k] * 3 + k) * 32);
        // SAFETY: as the caller promises.
        unsafe {
            BoxRay {
                enter_rows,
                leave_rows: std::array::from_fn(|k| (k * 2 + 3) * 32 - enter_rows[k]),
                inverse: ray.slabs.inverse.map(|x| _mm256_set1_ps(x)),
                enter_bias: ray.enter_bias.map(|x| _mm256_set1_ps(x)),
                leave_bias: ray.leave_bias.map(|x| _mm256_set1_ps(x)),
                nearest: _mm256_set1_epi32(ray.nearest.to_bits() as i32),
            }
        }
    }

    /// Where the ray enters the children of a node, and where it leaves them or reaches the limit.
    ///
    /// Minima and maxima are those of whole numbers, which take a quarter of the time. They are right because what
    /// decides is not negative: a negative entry never beats `nearest`, and a negative exit is below it.
    #[inline(always)]
    pub(super) unsafe fn span(&self, node: *const u8, limit: __m256i) -> (__m256i, __m256i) {
        // SAFETY: a node is aligned to 32 bytes and holds six rows of eight numbers.
        unsafe {
            let enter = |k: usize| {
                let planes = _mm256_load_ps(node.add(self.enter_rows[k]).cast());
                _mm256_castps_si256(_mm256_fmsub_ps(planes, self.inverse[k], self.enter_bias[k]))
            };
            let leave = |k: usize| {
                let planes = _mm256_load_ps(node.add(self.leave_rows[k]).cast());
                _mm256_castps_si256(_mm256_fmsub_ps(planes, self.inverse[k], self.leave_bias[k]))
            };
            let (a, b) = (_mm256_max_epi32(enter(0), enter(1)), _mm256_max_epi32(enter(2), self.nearest));
            let (c, d) = (_mm256_min_epi32(leave(0), leave(1)), _mm256_min_epi32(leave(2), limit));
            (_mm256_max_epi32(a, b), _mm256_min_epi32(c, d))
        }
    }
}

struct Avx2;

impl Level for Avx2 {
    type Ray = BoxRay;
    type Distances = __m256i;

    #[inline(always)]
    unsafe fn ray(ray: &WideRay) -> BoxRay {
        // SAFETY: as the trait demands.
        unsafe { BoxRay::new(ray) }
    }

    #[inline(always)]
    unsafe fn splat(bits: i32) -> __m256i {
        // SAFETY: as the trait demands.
        unsafe { _mm256_set1_epi32(bits) }
    }

    #[inline(always)]
    unsafe fn meet(ray: &BoxRay, node: *const u8, limit: __m256i) -> (u32, __m256i) {
        // SAFETY: as the trait demands.
        unsafe {
            let (enter, leave) = ray.span(node, limit);
            let misses = _mm256_castsi256_ps(_mm256_cmpgt_epi32(enter, leave));
            (_mm256_movemask_ps(misses) as u32 ^ 0xff, enter)
        }
    }

    #[inline(always)]
    unsafe fn array(distances: __m256i) -> [u32; WIDTH] {
        // SAFETY: both are 32 bytes.
        unsafe { std::mem::transmute(distances) }
    }

    /// Sorted in, one after the other.
    #[inline(always)]
    unsafe fn push_sorted(node: *const u8, mask: u32, enter: __m256i, stack: &mut Stack) {
        // SAFETY: as the trait demands.
        unsafe {
            let distances = Self::array(enter);
            let base = stack.height;
            let mut left = mask;
            while left != 0 {
                let child = left.trailing_zeros() as usize & 7;
                left &= left - 1;
                let mut place = stack.height;
                stack.height += 1;
                while place > base && stack.enter[place - 1].assume_init() < distances[child] {
                    stack.enter[place] = stack.enter[place - 1];
                    stack.references[place] = stack.references[place - 1];
                    place -= 1;
                }
                stack.enter[place].write(distances[child]);
                stack.references[place].write(reference(node, child));
            }
        }
    }

    #[inline(always)]
    unsafe fn push(node: *const u8, mask: u32, stack: &mut Stack) {
        let mut left = mask;
        while left != 0 {
            let child = left.trailing_zeros() as usize;
            left &= left - 1;
            // SAFETY: as the trait demands.
            unsafe { stack.put(reference(node, child), 0) };
        }
    }
}
