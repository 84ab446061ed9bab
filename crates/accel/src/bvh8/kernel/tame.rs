//! A ray as the wide kernels want it, made in a few dozen instructions.
//!
//! # Boxes
//! Where [`crate::slab`] takes a plane's distance as `(plane − origin) · inverse`, this takes it as the fused
//! `plane · inverse − bias` with `bias = origin · inverse`, rounded once a ray. That rounding displaces
//! all planes of an axis by at most `2⁻²⁴ · |origin|`, and that of `origin ± pad` by as much again: the pad of
//! the lemma is therefore grown by four times that, twice what it takes; see `docs/adr/0008-bvh8.md`.
//!
//! # Tame rays
//! Of a tame ray all of this is finite and no distance that counts is negative. So no NaN can come up, and
//! distances compare like the whole numbers of the same bits, which takes a quarter of the time.

use super::View;
use crate::ray::Ray;
use crate::slab::{SLACK, STEEPEST, least_of, limit_of};
use crate::triangle::PAD;
use std::arch::x86_64::*;

/// A ray with a lane for each child of a node.
#[derive(Clone, Copy)]
struct BoxRay {
    /// Bytes from the front of a node to the planes where the ray comes in, and goes out.
    enter_rows: [usize; 3],
    leave_rows: [usize; 3],
    inverse: [__m256; 3],
    enter_bias: [__m256; 3],
    leave_bias: [__m256; 3],
    nearest: __m256i,
}

/// A ray for boxes, and for how far it looks.
#[derive(Clone, Copy)]
pub(super) struct TameRay {
    boxes: BoxRay,
    /// The greatest component of the direction, without its sign.
    pace: f32,
}

/// 4 units of f32 rounding: what is added to the pad of the lemma here.
pub(super) const BIAS_PAD: f32 = 4.0 / 16_777_216.0;

impl TameRay {
    /// `None` for rays that are not tame, or can hit nothing.
    ///
    /// # Safety
    /// The machine must have AVX2.
    #[inline(always)]
    pub(super) unsafe fn new(ray: &Ray, view: &View<'_>) -> Option<TameRay> {
        // SAFETY: as the caller promises; corners are four floats each.
        unsafe {
            let wide = |v: [f32; 3]| _mm_setr_ps(v[0], v[1], v[2], 0.0);
            let (origin, direction) = (wide(ray.origin), wide(ray.direction));
            let [low, high] = [0, 1].map(|side| _mm_loadu_ps(view.corners[side].as_ptr()));
            let minus = _mm_set1_ps(-0.0);
            let size = |v| _mm_andnot_ps(minus, v);
            let (sizes, pace) = (size(direction), greatest(size(direction)));
            let far = greatest(_mm_max_ps(size(_mm_sub_ps(low, origin)), size(_mm_sub_ps(high, origin))));
            let pad = _mm_add_ps(
                _mm_add_ps(_mm_mul_ps(far, _mm_set1_ps(PAD)), _mm_set1_ps(4.0 * f32::MIN_POSITIVE)),
                _mm_mul_ps(size(origin), _mm_set1_ps(BIAS_PAD)),
            );
            let steepest = _mm_set1_ps(STEEPEST);
            let inverse = _mm_div_ps(pace, direction);
            let inverse = _mm_min_ps(_mm_max_ps(inverse, _mm_or_ps(minus, steepest)), steepest);
            // Rays come in where planes are farther, and go out where they are nearer.
            let pad = _mm_or_ps(pad, _mm_and_ps(direction, minus));
            let enter = _mm_mul_ps(_mm_add_ps(origin, pad), inverse);
            let leave = _mm_mul_ps(_mm_sub_ps(origin, pad), inverse);
            // Sums of sizes are finite when all of them are; no comparison holds for what is not a number.
            let sum = _mm_add_ps(_mm_add_ps(size(enter), size(leave)), sizes);
            let finite = _mm_movemask_ps(_mm_cmplt_ps(sum, _mm_set1_ps(f32::INFINITY))) & 7 == 7;
            let length = _mm_cvtss_f32(pace);
            let ends = ray.t_min >= 0.0 && ray.t_min <= ray.t_max;
            if !(finite && ends && length > 0.0) {
                return None;
            }
            let s = ray.t_min * length;
            let least = s - s * SLACK - least_of(length);
            // What is not a number comes from infinities only.
            let least = if least > 0.0 { least } else { 0.0 };
            let boxes = BoxRay::new(direction, inverse, enter, leave, least);
            Some(TameRay { boxes, pace: length })
        }
    }
}

/// The greatest of the first three, in all four.
///
/// # Safety
/// Asks for SSE, which every machine of this kind has.
#[inline(always)]
unsafe fn greatest(v: __m128) -> __m128 {
    // SAFETY: every x86-64 machine has SSE.
    unsafe {
        let rotated = _mm_max_ps(v, _mm_shuffle_ps::<0b11_00_10_01>(v, v));
        let pair = _mm_max_ps(rotated, _mm_shuffle_ps::<0b11_01_00_10>(v, v));
        _mm_shuffle_ps::<0>(pair, pair)
    }
}

/// Bytes from the front of a node to the planes where a ray comes in, and goes out, by the signs of its direction.
pub(super) const ROWS: [[[usize; 3]; 2]; 8] = {
    let mut rows = [[[0; 3]; 2]; 8];
    let mut place = 0;
    while place < 8 * 2 * 3 {
        let (down, side, axis) = (place / 6, place / 3 % 2, place % 3);
        rows[down][side][axis] = ((down >> axis & 1 ^ side) * 3 + axis) * 32;
        place += 1;
    }
    rows
};

impl BoxRay {
    /// # Safety
    /// The machine must have AVX2.
    #[inline(always)]
    unsafe fn new(direction: __m128, inverse: __m128, enter: __m128, leave: __m128, least: f32) -> BoxRay {
        // SAFETY: as the caller promises.
        unsafe {
            let [enter_rows, leave_rows] = ROWS[_mm_movemask_ps(direction) as usize & 7];
            let lane = |v: __m128, lane: i32| {
                _mm256_permutevar8x32_ps(_mm256_castps128_ps256(v), _mm256_set1_epi32(lane))
            };
            let spread = |v: __m128| [_mm256_broadcastss_ps(v), lane(v, 1), lane(v, 2)];
            BoxRay {
                enter_rows,
                leave_rows,
                inverse: spread(inverse),
                enter_bias: spread(enter),
                leave_bias: spread(leave),
                nearest: _mm256_set1_epi32(least.to_bits() as i32),
            }
        }
    }
}

impl Boxes for TameRay {
    // SAFETY: the trait says what is asked for.
    #[inline(always)]
    unsafe fn span(&self, node: *const u8, limit: __m256i) -> (__m256i, __m256i) {
        // SAFETY: as the trait demands.
        unsafe {
            let BoxRay { inverse, enter_bias, leave_bias, nearest, .. } = self.boxes;
            let rows = (&self.boxes.enter_rows, &self.boxes.leave_rows);
            span(node, rows, inverse, (enter_bias, leave_bias), (nearest, limit))
        }
    }

    #[inline(always)]
    fn limit_bits(&self, t: f32) -> u32 {
        limit_of(t, self.pace, least_of(self.pace)).to_bits()
    }
}

/// A ray that can be held against boxes.
pub(super) trait Boxes {
    /// Where the ray enters the children of a node, and where it leaves them or reaches the limit.
    ///
    /// # Safety
    /// The machine must have AVX2 and FMA, and `node` must point to a node.
    unsafe fn span(&self, node: *const u8, limit: __m256i) -> (__m256i, __m256i);

    /// The bits of the least `s` that no hit at `t` or before can exceed; `t` is not negative.
    fn limit_bits(&self, t: f32) -> u32;
}

/// See [`Boxes::span`].
///
/// Minima and maxima of whole numbers are right because what decides is not negative: a negative entry never
/// beats `nearest`, and a negative exit is below it.
///
/// # Safety
/// As for [`Boxes::span`].
#[inline(always)]
pub(super) unsafe fn span(
    node: *const u8,
    (enter_rows, leave_rows): (&[usize; 3], &[usize; 3]),
    inverse: [__m256; 3],
    (enter_bias, leave_bias): ([__m256; 3], [__m256; 3]),
    (nearest, limit): (__m256i, __m256i),
) -> (__m256i, __m256i) {
    // SAFETY: a node is aligned to 32 bytes and holds six rows of eight numbers.
    unsafe {
        let distance = |row: usize, k: usize, bias: __m256| {
            let planes = _mm256_load_ps(node.add(row).cast());
            _mm256_castps_si256(_mm256_fmsub_ps(planes, inverse[k], bias))
        };
        let enter = |k: usize| distance(enter_rows[k], k, enter_bias[k]);
        let leave = |k: usize| distance(leave_rows[k], k, leave_bias[k]);
        let (a, b) = (_mm256_max_epi32(enter(0), enter(1)), _mm256_max_epi32(enter(2), nearest));
        let (c, d) = (_mm256_min_epi32(leave(0), leave(1)), _mm256_min_epi32(leave(2), limit));
        (_mm256_max_epi32(a, b), _mm256_min_epi32(c, d))
    }
}
