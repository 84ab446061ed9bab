//! A ray in the form that the wide kernels use, prepared in a few dozen instructions.
//!
//! # Boxes
//! Where [`crate::slab`] computes the distance to a plane as `(plane − origin) · inverse`, this computes the fused
//! `plane · inverse + bias` with `bias = −origin · inverse ∓ pad · |inverse|`, which is rounded twice per ray. That
//! displaces all planes of an axis by at most `2 · 2⁻²⁴ · |origin|`, so the pad of the lemma is increased by twice
//! that amount. The pad is computed from the distance of the origin from the centre of the tree; see
//! `docs/adr/0008-bvh8.md`.
//!
//! Distances are measured in `t`, so that no step waits for the length of the direction: the chain of dependent steps
//! before a ray's first node should be as short as possible.
//!
//! # Regular rays
//! For a regular ray, all of this is finite and no distance that counts is negative. So no NaN can occur, and distances
//! compare like integers of the same bits, which takes a quarter of the time.

use super::level::Boxes;
use super::node_format::NodeFormat;
use super::view::TreeView;
use crate::bvh8::summary::FAR_PAD;
use crate::ray::Ray;
use crate::slab::{SLACK, STEEPEST};
use std::arch::x86_64::*;
use std::mem::offset_of;

/// A ray with a lane for each child of a node. Distances are `t`.
#[derive(Clone, Copy)]
pub(super) struct LaneRay {
    /// Bytes from the start of a node to the planes where the ray enters, and where it leaves.
    enter_rows: [usize; 3],
    leave_rows: [usize; 3],
    inverse: [__m256; 3],
    /// The negated origin, in units of distance, and the pad.
    enter_bias: [__m256; 3],
    leave_bias: [__m256; 3],
    nearest: __m256i,
}

/// Directions shorter than this are left to the plain kernel.
pub(super) const SHORTEST: f32 = 1.0 / STEEPEST;

/// Smaller components are clamped to this: in a direction that is long enough, that is a tilt as in [`STEEPEST`].
pub(super) const LEVEL: f32 = SHORTEST * SHORTEST;

/// Compensates for underflow in distances: a normal number, because denormals are slow.
pub(super) const MIN: f32 = 4.0 * f32::MIN_POSITIVE;

/// Keeps the magnitudes of three numbers, and zeroes the fourth; twice.
pub(super) const SIZES: [u32; 8] =
    [0x7fff_ffff, 0x7fff_ffff, 0x7fff_ffff, 0, 0x7fff_ffff, 0x7fff_ffff, 0x7fff_ffff, 0];

/// Lower bounds of the values that [`LaneRay::new`] compares: none, the length of the direction, and the minimum `t`.
const LEAST: [f32; 8] = [0.0, 0.0, 0.0, 0.0, SHORTEST, SHORTEST, SHORTEST, 0.0];

impl LaneRay {
    /// `None` for rays that are not regular, or can hit nothing.
    ///
    /// # Safety
    /// The machine must have AVX2 and FMA.
    #[inline(always)]
    pub(super) unsafe fn new(ray: &Ray, view: &TreeView<'_>) -> Option<LaneRay> {
        // SAFETY: as the caller promises; an outline has four numbers for the centre and eight for the reach.
        unsafe {
            let outline = view.outline;
            // Everything is in both halves, so that spreading a component takes one step, within halves.
            let twice = |v: __m128| _mm256_set_m128(v, v);
            let (origin, direction) = halves(ray);
            let (origin, direction) = (twice(origin), twice(direction));
            let away = _mm256_sub_ps(origin, twice(_mm_loadu_ps(outline.centre.as_ptr())));
            let both = _mm256_blend_ps::<0xf0>(away, direction);
            let sizes = _mm256_and_ps(both, _mm256_loadu_ps(SIZES.as_ptr().cast()));
            let pairs = _mm256_max_ps(sizes, _mm256_permute_ps::<0b10_11_00_01>(sizes));
            let greatest = _mm256_max_ps(pairs, _mm256_permute_ps::<0b01_00_11_10>(pairs));
            // A NaN is dropped in at most half of the lanes, so at least one lane fails.
            let within = _mm256_cmp_ps::<_CMP_LE_OQ>(greatest, _mm256_loadu_ps(outline.reach.as_ptr()));
            let lower = _mm256_blend_ps::<0x80>(greatest, direction);
            let enough = _mm256_cmp_ps::<_CMP_GE_OQ>(lower, _mm256_loadu_ps(LEAST.as_ptr()));
            if _mm256_movemask_ps(_mm256_and_ps(within, enough)) != 0xff {
                return None;
            }
            let minus = _mm256_set1_ps(-0.0);
            let tilted = _mm256_max_ps(_mm256_andnot_ps(minus, direction), _mm256_set1_ps(LEVEL));
            let tilted = _mm256_or_ps(tilted, _mm256_and_ps(direction, minus));
            let inverse = _mm256_div_ps(_mm256_set1_ps(1.0), tilted);
            let far = _mm256_permute2f128_ps::<0>(greatest, greatest);
            let pad = _mm256_fmadd_ps(far, _mm256_set1_ps(FAR_PAD), _mm256_set1_ps(outline.pad));
            // The pad makes rays enter earlier and leave later.
            let (bias, steep) =
                (_mm256_mul_ps(_mm256_xor_ps(origin, minus), inverse), _mm256_andnot_ps(minus, inverse));
            let (enter, leave) = (_mm256_fnmadd_ps(pad, steep, bias), _mm256_fmadd_ps(pad, steep, bias));
            let nearest = _mm_fmsub_ss(_mm_set_ss(ray.t_min), _mm_set_ss(1.0 - SLACK), _mm_set_ss(MIN));
            let nearest = _mm_max_ss(nearest, _mm_setzero_ps());
            let [enter_rows, leave_rows] = ROWS[_mm256_movemask_ps(direction) as usize & 7];
            let spread = |v: __m256| {
                [
                    _mm256_permute_ps::<0>(v),
                    _mm256_permute_ps::<0b01_01_01_01>(v),
                    _mm256_permute_ps::<0b10_10_10_10>(v),
                ]
            };
            Some(LaneRay {
                enter_rows,
                leave_rows,
                inverse: spread(inverse),
                enter_bias: spread(enter),
                leave_bias: spread(leave),
                nearest: _mm256_castps_si256(_mm256_broadcastss_ps(nearest)),
            })
        }
    }
}

/// The parts common to the levels with eight lanes, four doubles, and FMA.
macro_rules! of_eight {
    () => {
        type Eight = __m256i;
        type LaneRay = super::lane_ray::LaneRay;
        type Doubles = __m256d;

        // SAFETY: as the trait demands.
        #[inline(always)]
        unsafe fn prepare(ray: &$crate::Ray, view: &super::view::TreeView<'_>) -> Option<Self::LaneRay> {
            // SAFETY: as the trait demands.
            unsafe { super::lane_ray::LaneRay::new(ray, view) }
        }

        #[inline(always)]
        unsafe fn splat(bits: u32) -> __m256i {
            // SAFETY: as the trait demands.
            unsafe { _mm256_set1_epi32(bits as i32) }
        }
    };
}
pub(super) use of_eight;

/// The origin and the direction of a ray, each with the number that follows it in memory.
///
/// # Safety
/// Requires SSE, which every machine of this kind has.
#[inline(always)]
pub(super) unsafe fn halves(ray: &Ray) -> (__m128, __m128) {
    const { assert!(offset_of!(Ray, direction) == 12 && offset_of!(Ray, t_min) == 24) }
    let numbers = std::ptr::from_ref(ray).cast::<f32>();
    // SAFETY: a ray begins with its origin, its direction and its minimum `t`.
    unsafe { (_mm_loadu_ps(numbers), _mm_loadu_ps(numbers.add(3))) }
}

/// Bytes from the start of a node to the planes where a ray enters, and leaves, by the signs of its direction.
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

impl Boxes for LaneRay {
    type Eight = __m256i;

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn span<F: NodeFormat>(&self, node: *const u8, limit: __m256i) -> (__m256i, __m256i) {
        // SAFETY: as the trait demands.
        unsafe {
            let rows = (&self.enter_rows, &self.leave_rows);
            span::<F>(node, rows, self.inverse, (self.enter_bias, self.leave_bias), (self.nearest, limit))
        }
    }

    #[inline(always)]
    fn limit_bits(&self, t: f32) -> u32 {
        // SAFETY: a regular ray exists only where there is FMA.
        unsafe {
            let t = _mm_fmadd_ss(_mm_set_ss(t), _mm_set_ss(1.0 + 2.0 * SLACK), _mm_set_ss(MIN));
            _mm_extract_ps::<0>(t) as u32
        }
    }
}

/// See [`Boxes::span`].
///
/// Integer minima and maxima are correct because the value that decides is not negative: a negative entry never beats
/// `nearest`, and a negative exit is below it.
///
/// # Safety
/// As for [`Boxes::span`].
#[inline(always)]
pub(super) unsafe fn span<F: NodeFormat>(
    node: *const u8,
    (enter_rows, leave_rows): (&[usize; 3], &[usize; 3]),
    inverse: [__m256; 3],
    (enter_bias, leave_bias): ([__m256; 3], [__m256; 3]),
    (nearest, limit): (__m256i, __m256i),
) -> (__m256i, __m256i) {
    // SAFETY: as the caller promises.
    unsafe {
        let frame = F::frame8(node);
        let distance = |row: usize, k: usize, bias: __m256| {
            let planes = F::planes8(node, row, k, &frame);
            _mm256_castps_si256(_mm256_fmadd_ps(planes, inverse[k], bias))
        };
        let enter = |k: usize| distance(enter_rows[k], k, enter_bias[k]);
        let leave = |k: usize| distance(leave_rows[k], k, leave_bias[k]);
        let (a, b) = (_mm256_max_epi32(enter(0), enter(1)), _mm256_max_epi32(enter(2), nearest));
        let (c, d) = (_mm256_min_epi32(leave(0), leave(1)), _mm256_min_epi32(leave(2), limit));
        (_mm256_max_epi32(a, b), _mm256_min_epi32(c, d))
    }
}
