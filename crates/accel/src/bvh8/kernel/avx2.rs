//! The AVX2 and FMA kernels on eight lanes.

use super::axes::Reorder;
use super::level::{BatchLevel, Level, lanes};
use super::stack::Stack;
use crate::bvh8::layout::Ref;
use std::arch::x86_64::*;

super::entries::entries!(Avx2, "avx2,fma,bmi1,bmi2,lzcnt,popcnt");
super::entries::batch_entries!(Avx2, "avx2,fma,bmi1,bmi2,lzcnt,popcnt");

struct Avx2;

impl Reorder for Avx2 {
    super::axes::reorder_by_lanes!();
}

impl Level for Avx2 {
    super::lane_ray::of_eight!();

    // SAFETY: as the trait demands.
    #[inline(always)]
    unsafe fn at_most(enter: __m256i, leave: __m256i) -> u32 {
        // SAFETY: as the trait demands.
        unsafe {
            let misses = _mm256_castsi256_ps(_mm256_cmpgt_epi32(enter, leave));
            _mm256_movemask_ps(misses) as u32 ^ 0xff
        }
    }
}

impl BatchLevel for Avx2 {
    type Wide = __m256;

    // SAFETY: as the trait demands.
    #[inline(always)]
    unsafe fn push_children(node: Ref, mask: u32, enter: __m256i, stack: &mut Stack) {
        // SAFETY: as the trait demands.
        unsafe {
            let distances = lanes::<Avx2>(enter);
            let (references, keys) = (stack.references(), stack.distances());
            let (mut left, mut size) = (mask, 0);
            while left != 0 {
                let child = left.trailing_zeros() & 7;
                left &= left - 1;
                let key = distances[child as usize] & !7 | child;
                let mut place = size;
                while place > 0 && *keys.add(place - 1) < key {
                    *keys.add(place) = *keys.add(place - 1);
                    place -= 1;
                }
                *keys.add(place) = key;
                *references.add(size) = node.0;
                size += 1;
            }
            stack.grow(size);
        }
    }
}
