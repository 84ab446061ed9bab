//! The AVX-512 kernels on eight lanes: masks, and compression for more than two children.

use super::axes::Reorder;
use super::level::{BatchLevel, Level};
use super::node_format::NodeFormat;
use super::stack::Stack;
use crate::bvh8::layout::Ref;
use std::arch::x86_64::*;

super::entries::entries!(Avx512, "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt");
super::entries::batch_entries!(Avx512, "avx512f,avx512vl,avx512dq,avx512bw,avx2,fma,bmi1,bmi2,lzcnt,popcnt");

struct Avx512;

impl Reorder for Avx512 {
    super::axes::reorder_by_lanes!();
}

impl Level for Avx512 {
    super::lane_ray::of_eight!();

    // SAFETY: as the trait demands.
    #[inline(always)]
    unsafe fn at_most(enter: __m256i, leave: __m256i) -> u32 {
        // SAFETY: as the trait demands.
        unsafe { u32::from(_mm256_cmple_epi32_mask(enter, leave)) }
    }

    #[inline(always)]
    unsafe fn push_sorted<F: NodeFormat>(node: *const u8, mask: u32, enter: __m256i, stack: &mut Stack) {
        // SAFETY: as the trait demands.
        unsafe {
            let keys = sorted(mask, enter);
            let references = _mm256_load_si256(node.add(F::REFERENCES).cast());
            let sorted = _mm256_permutevar8x32_epi32(references, keys);
            _mm256_storeu_si256(stack.references().cast(), sorted);
            _mm256_storeu_si256(stack.distances().cast(), keys);
            stack.grow(mask.count_ones() as usize);
        }
    }

    #[inline(always)]
    unsafe fn push<F: NodeFormat>(node: *const u8, mask: u32, stack: &mut Stack) {
        // SAFETY: as the trait demands.
        unsafe {
            let references = _mm256_load_si256(node.add(F::REFERENCES).cast());
            let kept = _mm256_maskz_compress_epi32(mask as u8, references);
            _mm256_storeu_si256(stack.references().cast(), kept);
            stack.grow(mask.count_ones() as usize);
        }
    }
}

impl BatchLevel for Avx512 {
    type Wide = __m512;

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn push_children(node: Ref, mask: u32, enter: __m256i, stack: &mut Stack) {
        // SAFETY: as the trait demands.
        unsafe {
            let keys = if mask & (mask - 1) == 0 { compressed(mask, enter) } else { sorted(mask, enter) };
            _mm256_storeu_si256(stack.references().cast(), _mm256_set1_epi32(node.0 as i32));
            _mm256_storeu_si256(stack.distances().cast(), keys);
            stack.grow(mask.count_ones() as usize);
        }
    }
}

/// The distances of a mask with their lane in the last three bits; those outside the mask come last.
#[inline(always)]
unsafe fn compressed(mask: u32, enter: __m256i) -> __m256i {
    // SAFETY: as the caller promises.
    unsafe {
        let lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
        let keys = _mm256_ternarylogic_epi32::<0xf8>(lanes, enter, _mm256_set1_epi32(!7));
        // Less than all others.
        _mm256_mask_compress_epi32(_mm256_set1_epi32(-1), mask as u8, keys)
    }
}

/// Distances and lanes of [`compressed`] in descending order, by a sorting network of three stages or six.
#[inline(always)]
unsafe fn sorted(mask: u32, enter: __m256i) -> __m256i {
    // SAFETY: as the caller promises.
    unsafe {
        let keys = compressed(mask, enter);
        if mask.count_ones() > 4 { sort8(keys) } else { sort4(keys) }
    }
}

/// One stage of a sorting network: each lane is compared with its partner, and those of the mask keep the smaller.
macro_rules! stage {
    ($keys:expr, $lesser:expr, $partner:expr) => {{
        let partner = $partner;
        let greater = _mm256_max_epi32($keys, partner);
        _mm256_mask_min_epi32(greater, $lesser, $keys, partner)
    }};
}

/// The first four, in descending order.
///
/// # Safety
/// The machine must have AVX-512, as for everything below.
#[inline(always)]
unsafe fn sort4(keys: __m256i) -> __m256i {
    // SAFETY: as the caller promises.
    unsafe {
        let keys = stage!(keys, 0b1010, _mm256_shuffle_epi32::<0b10_11_00_01>(keys));
        let keys = stage!(keys, 0b1100, _mm256_shuffle_epi32::<0b00_01_10_11>(keys));
        stage!(keys, 0b1010, _mm256_shuffle_epi32::<0b10_11_00_01>(keys))
    }
}

/// All eight, in descending order.
#[inline(always)]
unsafe fn sort8(keys: __m256i) -> __m256i {
    // SAFETY: as the caller promises.
    unsafe {
        let keys = stage!(keys, 0b1010_1010, _mm256_shuffle_epi32::<0b10_11_00_01>(keys));
        let keys = stage!(keys, 0b1100_1100, _mm256_shuffle_epi32::<0b00_01_10_11>(keys));
        let keys = stage!(keys, 0b1010_1010, _mm256_shuffle_epi32::<0b10_11_00_01>(keys));
        let reverse = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
        let keys = stage!(keys, 0b1111_0000, _mm256_permutevar8x32_epi32(keys, reverse));
        let keys = stage!(keys, 0b1100_1100, _mm256_shuffle_epi32::<0b01_00_11_10>(keys));
        stage!(keys, 0b1010_1010, _mm256_shuffle_epi32::<0b10_11_00_01>(keys))
    }
}
