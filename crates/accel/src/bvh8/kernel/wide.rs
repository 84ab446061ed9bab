//! Vectors with a lane for each of several rays, at any level.

use std::arch::x86_64::*;

/// Declares unsafe functions without a body.
macro_rules! declare {
    ($($name:ident($($argument:tt)*) -> $result:ty;)*) => {
        // SAFETY: as the trait that declares them demands.
        $(unsafe fn $name($($argument)*) -> $result;)*
    };
}
/// Defines functions of one expression, all of which require only their level and valid pointers.
macro_rules! define {
    ($($name:ident($($argument:tt)*) -> $result:ty = $body:expr;)*) => {
        // SAFETY: as the trait that they belong to demands.
        $(#[inline(always)] unsafe fn $name($($argument)*) -> $result { unsafe { $body } })*
    };
}
pub(super) use {declare, define};

/// Floats, one for each ray of a group. Masks have a bit for each lane.
///
/// # Safety
/// All functions require a machine that has the level; pointers must lead to as many numbers as there are lanes.
pub(super) trait Wide: Copy {
    /// Lanes of a vector.
    const LANES: usize;
    /// A vector of half the lanes, in double precision.
    type Half: Half;
    /// A choice for each lane.
    type Mask: Copy;

    declare! {
        splat(x: f32) -> Self;
        load(from: *const f32) -> Self;
        store(self, to: *mut f32) -> ();
        add(self, other: Self) -> Self;
        sub(self, other: Self) -> Self;
        mul(self, other: Self) -> Self;
        div(self, other: Self) -> Self;
        min(self, other: Self) -> Self;
        max(self, other: Self) -> Self;
        // The product plus the third, rounded once.
        fmadd(self, by: Self, more: Self) -> Self;
        abs(self) -> Self;
        // With the sign of the other, if its own is positive.
        copy_sign(self, of: Self) -> Self;
        // The second where this is negative, else the first.
        by_sign(self, plus: Self, minus: Self) -> Self;
        mask(bits: u32) -> Self::Mask;
        // The other where the mask is set.
        select(self, mask: Self::Mask, other: Self) -> Self;
        // A bit for each lane with a set sign bit.
        signs(self) -> u32;
        lt(self, other: Self) -> u32;
        le(self, other: Self) -> u32;
        least_lane(self) -> f32;
        greatest_lane(self) -> f32;
        lower_half(self) -> Self::Half;
        upper_half(self) -> Self::Half;
    }
}

/// Half a vector's lanes, in single precision.
pub(super) type Float<W> = <<W as Wide>::Half as Half>::Narrow;

/// Doubles.
///
/// # Safety
/// As for [`Wide`].
pub(super) trait Half: Copy {
    /// As many floats.
    type Narrow: Narrow;

    declare! {
        splat(x: f64) -> Self;
        widen(x: Self::Narrow) -> Self;
        // Zeros become positive.
        narrow(self) -> Self::Narrow;
        add(self, other: Self) -> Self;
        sub(self, other: Self) -> Self;
        mul(self, other: Self) -> Self;
        div(self, other: Self) -> Self;
        lt(self, other: Self) -> u32;
    }
}

/// Floats, with integers next to them.
///
/// # Safety
/// As for [`Wide`].
pub(super) trait Narrow: Copy {
    declare! {
        load(from: *const f32) -> Self;
        store(self, to: *mut f32) -> ();
        // Writes the lanes of the mask.
        store_some(self, mask: u32, to: *mut f32) -> ();
        le(self, other: Self) -> u32;
        eq(self, other: Self) -> u32;
        // A bit for each lane in which the integer occurs.
        places(x: u32, of: *const u32) -> u32;
        // Writes an integer into the lanes of the mask.
        put(x: u32, mask: u32, to: *mut u32) -> ();
    }
}

impl Wide for __m512 {
    const LANES: usize = 16;
    type Half = __m512d;
    type Mask = __mmask16;

    define! {
        splat(x: f32) -> Self = _mm512_set1_ps(x);
        load(from: *const f32) -> Self = _mm512_loadu_ps(from);
        store(self, to: *mut f32) -> () = _mm512_storeu_ps(to, self);
        add(self, other: Self) -> Self = _mm512_add_ps(self, other);
        sub(self, other: Self) -> Self = _mm512_sub_ps(self, other);
        mul(self, other: Self) -> Self = _mm512_mul_ps(self, other);
        div(self, other: Self) -> Self = _mm512_div_ps(self, other);
        min(self, other: Self) -> Self = _mm512_min_ps(self, other);
        max(self, other: Self) -> Self = _mm512_max_ps(self, other);
        fmadd(self, by: Self, more: Self) -> Self = _mm512_fmadd_ps(self, by, more);
        abs(self) -> Self = _mm512_abs_ps(self);
        copy_sign(self, of: Self) -> Self = _mm512_or_ps(self, _mm512_and_ps(of, _mm512_set1_ps(-0.0)));
        by_sign(self, plus: Self, minus: Self) -> Self =
            _mm512_mask_blend_ps(_mm512_movepi32_mask(_mm512_castps_si512(self)), plus, minus);
        mask(bits: u32) -> __mmask16 = _cvtu32_mask16(bits);
        select(self, mask: __mmask16, other: Self) -> Self = _mm512_mask_blend_ps(mask, self, other);
        signs(self) -> u32 = u32::from(_mm512_movepi32_mask(_mm512_castps_si512(self)));
        lt(self, other: Self) -> u32 = u32::from(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(self, other));
        le(self, other: Self) -> u32 = u32::from(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(self, other));
        least_lane(self) -> f32 = _mm512_reduce_min_ps(self);
        greatest_lane(self) -> f32 = _mm512_reduce_max_ps(self);
        lower_half(self) -> __m512d = _mm512_cvtps_pd(_mm512_castps512_ps256(self));
        upper_half(self) -> __m512d = _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(self));
    }
}

impl Half for __m512d {
    type Narrow = __m256;

    define! {
        splat(x: f64) -> Self = _mm512_set1_pd(x);
        widen(x: __m256) -> Self = _mm512_cvtps_pd(x);
        narrow(self) -> __m256 = _mm256_add_ps(_mm512_cvtpd_ps(self), _mm256_setzero_ps());
        add(self, other: Self) -> Self = _mm512_add_pd(self, other);
        sub(self, other: Self) -> Self = _mm512_sub_pd(self, other);
        mul(self, other: Self) -> Self = _mm512_mul_pd(self, other);
        div(self, other: Self) -> Self = _mm512_div_pd(self, other);
        lt(self, other: Self) -> u32 = u32::from(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(self, other));
    }
}

impl Narrow for __m256 {
    define! {
        load(from: *const f32) -> Self = _mm256_loadu_ps(from);
        store(self, to: *mut f32) -> () = _mm256_storeu_ps(to, self);
        store_some(self, mask: u32, to: *mut f32) -> () = _mm256_mask_storeu_ps(to, mask as u8, self);
        le(self, other: Self) -> u32 = u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(self, other));
        eq(self, other: Self) -> u32 = u32::from(_mm256_cmp_ps_mask::<_CMP_EQ_OQ>(self, other));
        places(x: u32, of: *const u32) -> u32 =
            u32::from(_mm256_cmpeq_epi32_mask(_mm256_set1_epi32(x as i32), _mm256_loadu_si256(of.cast())));
        put(x: u32, mask: u32, to: *mut u32) -> () =
            _mm256_mask_storeu_epi32(to.cast(), mask as u8, _mm256_set1_epi32(x as i32));
    }
}

impl Wide for __m256 {
    const LANES: usize = 8;
    type Half = __m256d;
    type Mask = __m256;

    define! {
        splat(x: f32) -> Self = _mm256_set1_ps(x);
        load(from: *const f32) -> Self = _mm256_loadu_ps(from);
        store(self, to: *mut f32) -> () = _mm256_storeu_ps(to, self);
        add(self, other: Self) -> Self = _mm256_add_ps(self, other);
        sub(self, other: Self) -> Self = _mm256_sub_ps(self, other);
        mul(self, other: Self) -> Self = _mm256_mul_ps(self, other);
        div(self, other: Self) -> Self = _mm256_div_ps(self, other);
        min(self, other: Self) -> Self = _mm256_min_ps(self, other);
        max(self, other: Self) -> Self = _mm256_max_ps(self, other);
        fmadd(self, by: Self, more: Self) -> Self = _mm256_fmadd_ps(self, by, more);
        abs(self) -> Self = _mm256_andnot_ps(_mm256_set1_ps(-0.0), self);
        copy_sign(self, of: Self) -> Self = _mm256_or_ps(self, _mm256_and_ps(of, _mm256_set1_ps(-0.0)));
        by_sign(self, plus: Self, minus: Self) -> Self = _mm256_blendv_ps(plus, minus, self);
        mask(bits: u32) -> __m256 = {
            let lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let chosen = _mm256_and_si256(_mm256_set1_epi32(bits as i32), lanes);
            _mm256_castsi256_ps(_mm256_cmpeq_epi32(chosen, lanes))
        };
        select(self, mask: __m256, other: Self) -> Self = _mm256_blendv_ps(self, other, mask);
        signs(self) -> u32 = _mm256_movemask_ps(self) as u32;
        lt(self, other: Self) -> u32 = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(self, other)) as u32;
        le(self, other: Self) -> u32 = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self, other)) as u32;
        least_lane(self) -> f32 = -_mm256_xor_ps(self, _mm256_set1_ps(-0.0)).greatest_lane();
        greatest_lane(self) -> f32 = {
            let four = _mm_max_ps(_mm256_castps256_ps128(self), _mm256_extractf128_ps::<1>(self));
            let two = _mm_max_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_max_ss(two, _mm_shuffle_ps::<1>(two, two)))
        };
        lower_half(self) -> __m256d = _mm256_cvtps_pd(_mm256_castps256_ps128(self));
        upper_half(self) -> __m256d = _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self));
    }
}

impl Half for __m256d {
    type Narrow = __m128;

    define! {
        splat(x: f64) -> Self = _mm256_set1_pd(x);
        widen(x: __m128) -> Self = _mm256_cvtps_pd(x);
        narrow(self) -> __m128 = _mm_add_ps(_mm256_cvtpd_ps(self), _mm_setzero_ps());
        add(self, other: Self) -> Self = _mm256_add_pd(self, other);
        sub(self, other: Self) -> Self = _mm256_sub_pd(self, other);
        mul(self, other: Self) -> Self = _mm256_mul_pd(self, other);
        div(self, other: Self) -> Self = _mm256_div_pd(self, other);
        lt(self, other: Self) -> u32 = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(self, other)) as u32;
    }
}

impl Narrow for __m128 {
    define! {
        load(from: *const f32) -> Self = _mm_loadu_ps(from);
        store(self, to: *mut f32) -> () = _mm_storeu_ps(to, self);
        store_some(self, mask: u32, to: *mut f32) -> () = _mm_maskstore_ps(to, spread(mask), self);
        le(self, other: Self) -> u32 = _mm_movemask_ps(_mm_cmple_ps(self, other)) as u32;
        eq(self, other: Self) -> u32 = _mm_movemask_ps(_mm_cmpeq_ps(self, other)) as u32;
        places(x: u32, of: *const u32) -> u32 = {
            let equal = _mm_cmpeq_epi32(_mm_set1_epi32(x as i32), _mm_loadu_si128(of.cast()));
            _mm_movemask_ps(_mm_castsi128_ps(equal)) as u32
        };
        put(x: u32, mask: u32, to: *mut u32) -> () =
            _mm_maskstore_epi32(to.cast(), spread(mask), _mm_set1_epi32(x as i32));
    }
}

/// Spreads a mask of four bits into a vector.
///
/// # Safety
/// As for [`Wide`].
#[inline(always)]
unsafe fn spread(mask: u32) -> __m128i {
    // SAFETY: as the caller promises.
    unsafe {
        let bits = _mm_setr_epi32(1, 2, 4, 8);
        _mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(mask as i32), bits), bits)
    }
}
