//! Four doubles, for the exact stage of the triangle test on the four triangles of a block.

use super::wide::{declare, define};
use std::arch::x86_64::*;

/// Four doubles. A comparison sets all bits of a lane, or none; with a NaN, none.
///
/// # Safety
/// All functions require a machine that has the level.
pub(in crate::bvh8) trait Doubles: Copy {
    declare! {
        splat(x: f64) -> Self;
        widen(x: __m128) -> Self;
        // Zeros become positive.
        narrow(self) -> __m128;
        add(self, other: Self) -> Self;
        sub(self, other: Self) -> Self;
        mul(self, other: Self) -> Self;
        div(self, other: Self) -> Self;
        // Returns the second if either is NaN.
        min(self, other: Self) -> Self;
        max(self, other: Self) -> Self;
        and(self, other: Self) -> Self;
        or(self, other: Self) -> Self;
        // Clears the bits that are set in the other.
        and_not(self, other: Self) -> Self;
        lt(self, other: Self) -> Self;
        le(self, other: Self) -> Self;
        gt(self, other: Self) -> Self;
        ge(self, other: Self) -> Self;
        // Takes the result of a comparison.
        narrow_mask(self) -> __m128;
    }
}

impl Doubles for __m256d {
    define! {
        splat(x: f64) -> Self = _mm256_set1_pd(x);
        widen(x: __m128) -> Self = _mm256_cvtps_pd(x);
        narrow(self) -> __m128 = _mm_add_ps(_mm256_cvtpd_ps(self), _mm_setzero_ps());
        add(self, other: Self) -> Self = _mm256_add_pd(self, other);
        sub(self, other: Self) -> Self = _mm256_sub_pd(self, other);
        mul(self, other: Self) -> Self = _mm256_mul_pd(self, other);
        div(self, other: Self) -> Self = _mm256_div_pd(self, other);
        min(self, other: Self) -> Self = _mm256_min_pd(self, other);
        max(self, other: Self) -> Self = _mm256_max_pd(self, other);
        and(self, other: Self) -> Self = _mm256_and_pd(self, other);
        or(self, other: Self) -> Self = _mm256_or_pd(self, other);
        and_not(self, other: Self) -> Self = _mm256_andnot_pd(other, self);
        lt(self, other: Self) -> Self = _mm256_cmp_pd::<_CMP_LT_OQ>(self, other);
        le(self, other: Self) -> Self = _mm256_cmp_pd::<_CMP_LE_OQ>(self, other);
        gt(self, other: Self) -> Self = _mm256_cmp_pd::<_CMP_GT_OQ>(self, other);
        ge(self, other: Self) -> Self = _mm256_cmp_pd::<_CMP_GE_OQ>(self, other);
        narrow_mask(self) -> __m128 = {
            let mask = _mm256_castpd_si256(self);
            let (low, high) = (_mm256_castsi256_si128(mask), _mm256_extracti128_si256::<1>(mask));
            _mm_castsi128_ps(_mm_packs_epi32(low, high))
        };
    }
}

/// Two vectors of two.
#[derive(Clone, Copy)]
pub(super) struct Halves(__m128d, __m128d);

impl Doubles for Halves {
    define! {
        splat(x: f64) -> Self = Halves(_mm_set1_pd(x), _mm_set1_pd(x));
        widen(x: __m128) -> Self = Halves(_mm_cvtps_pd(x), _mm_cvtps_pd(_mm_movehl_ps(x, x)));
        narrow(self) -> __m128 =
            _mm_add_ps(_mm_movelh_ps(_mm_cvtpd_ps(self.0), _mm_cvtpd_ps(self.1)), _mm_setzero_ps());
        add(self, other: Self) -> Self = Halves(_mm_add_pd(self.0, other.0), _mm_add_pd(self.1, other.1));
        sub(self, other: Self) -> Self = Halves(_mm_sub_pd(self.0, other.0), _mm_sub_pd(self.1, other.1));
        mul(self, other: Self) -> Self = Halves(_mm_mul_pd(self.0, other.0), _mm_mul_pd(self.1, other.1));
        div(self, other: Self) -> Self = Halves(_mm_div_pd(self.0, other.0), _mm_div_pd(self.1, other.1));
        min(self, other: Self) -> Self = Halves(_mm_min_pd(self.0, other.0), _mm_min_pd(self.1, other.1));
        max(self, other: Self) -> Self = Halves(_mm_max_pd(self.0, other.0), _mm_max_pd(self.1, other.1));
        and(self, other: Self) -> Self = Halves(_mm_and_pd(self.0, other.0), _mm_and_pd(self.1, other.1));
        or(self, other: Self) -> Self = Halves(_mm_or_pd(self.0, other.0), _mm_or_pd(self.1, other.1));
        and_not(self, other: Self) -> Self =
            Halves(_mm_andnot_pd(other.0, self.0), _mm_andnot_pd(other.1, self.1));
        lt(self, other: Self) -> Self = Halves(_mm_cmplt_pd(self.0, other.0), _mm_cmplt_pd(self.1, other.1));
        le(self, other: Self) -> Self = Halves(_mm_cmple_pd(self.0, other.0), _mm_cmple_pd(self.1, other.1));
        gt(self, other: Self) -> Self = Halves(_mm_cmpgt_pd(self.0, other.0), _mm_cmpgt_pd(self.1, other.1));
        ge(self, other: Self) -> Self = Halves(_mm_cmpge_pd(self.0, other.0), _mm_cmpge_pd(self.1, other.1));
        narrow_mask(self) -> __m128 =
            _mm_shuffle_ps::<0b10_00_10_00>(_mm_castpd_ps(self.0), _mm_castpd_ps(self.1));
    }
}
