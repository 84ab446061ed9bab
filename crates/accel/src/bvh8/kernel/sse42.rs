//! SSE4.2: eight lanes as two halves of four.
//!
//! Nothing is fused here, so the distance to a plane is computed as in [`crate::slab`]: `(plane − origin) · inverse`,
//! with the origin moved by the pad. Each step is rounded in proportion to the distance, and the moved origin once:
//! less than the increase of the pad for the fused levels. See `docs/adr/0008-bvh8.md`.

use super::axes::{Axes, Reorder};
use super::doubles::Halves;
use super::lane_ray::{LEVEL, MIN, ROWS, SHORTEST, SIZES, halves};
use super::level::{Boxes, Level};
use super::node_format::NodeFormat;
use super::view::TreeView;
use crate::bvh8::summary::FAR_PAD;
use crate::ray::Ray;
use crate::slab::SLACK;
use std::arch::x86_64::*;

super::entries::entries!(Sse42, "sse4.2,popcnt");

struct Sse42;

/// A ray with a lane for each child of half a node; otherwise as [`super::lane_ray::LaneRay`].
#[derive(Clone, Copy)]
struct LaneRay {
    enter_rows: [usize; 3],
    leave_rows: [usize; 3],
    inverse: [__m128; 3],
    /// The padded origin for the planes where the ray enters, and for those where it leaves.
    enter: [__m128; 3],
    leave: [__m128; 3],
    nearest: __m128i,
}

impl Reorder for Sse42 {
    // SAFETY: as the trait demands.
    #[inline(always)]
    unsafe fn reorder(numbers: __m128, axes: &Axes) -> __m128 {
        // SAFETY: as the trait demands.
        unsafe {
            let bytes = _mm_load_si128(axes.bytes.as_ptr().cast());
            _mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(numbers), bytes))
        }
    }
}

impl Level for Sse42 {
    type Eight = [__m128i; 2];
    type LaneRay = LaneRay;
    type Doubles = Halves;

    // SAFETY: as the trait demands.
    #[inline(always)]
    unsafe fn prepare(ray: &Ray, view: &TreeView<'_>) -> Option<LaneRay> {
        // SAFETY: as the trait demands.
        unsafe { LaneRay::new(ray, view) }
    }

    #[inline(always)]
    unsafe fn splat(bits: u32) -> [__m128i; 2] {
        // SAFETY: as the trait demands.
        unsafe { [_mm_set1_epi32(bits as i32); 2] }
    }

    #[inline(always)]
    unsafe fn at_most(enter: [__m128i; 2], leave: [__m128i; 2]) -> u32 {
        // SAFETY: as the trait demands.
        unsafe {
            let misses =
                _mm_packs_epi32(_mm_cmpgt_epi32(enter[0], leave[0]), _mm_cmpgt_epi32(enter[1], leave[1]));
            _mm_movemask_epi8(_mm_packs_epi16(misses, _mm_setzero_si128())) as u32 ^ 0xff
        }
    }
}

impl LaneRay {
    /// See [`super::lane_ray::LaneRay::new`].
    ///
    /// # Safety
    /// The machine must have SSE4.2.
    #[inline(always)]
    unsafe fn new(ray: &Ray, view: &TreeView<'_>) -> Option<LaneRay> {
        // SAFETY: as the caller promises; an outline has four numbers for the centre and eight for the reach.
        unsafe {
            let outline = view.outline;
            let (origin, direction) = halves(ray);
            let greatest = |numbers: __m128| {
                let sizes = _mm_and_ps(numbers, _mm_loadu_ps(SIZES.as_ptr().cast()));
                let pairs = _mm_max_ps(sizes, _mm_shuffle_ps::<0b10_11_00_01>(sizes, sizes));
                _mm_max_ps(pairs, _mm_shuffle_ps::<0b01_00_11_10>(pairs, pairs))
            };
            let far = greatest(_mm_sub_ps(origin, _mm_loadu_ps(outline.centre.as_ptr())));
            let pace = greatest(direction);
            // A NaN is dropped in at most half of the lanes, so at least one lane fails.
            let within = |numbers: __m128, from: usize| {
                _mm_cmple_ps(numbers, _mm_loadu_ps(outline.reach.as_ptr().add(from)))
            };
            let within = _mm_movemask_ps(_mm_and_ps(within(far, 0), within(pace, 4)));
            if !(within == 0xf && _mm_cvtss_f32(pace) >= SHORTEST && ray.t_min >= 0.0) {
                return None;
            }
            let minus = _mm_set1_ps(-0.0);
            let down = _mm_and_ps(direction, minus);
            let tilted = _mm_max_ps(_mm_andnot_ps(minus, direction), _mm_set1_ps(LEVEL));
            let inverse = _mm_div_ps(_mm_set1_ps(1.0), _mm_or_ps(tilted, down));
            let pad = _mm_add_ps(_mm_mul_ps(far, _mm_set1_ps(FAR_PAD)), _mm_set1_ps(outline.pad));
            // The pad makes rays enter earlier and leave later.
            let pad = _mm_or_ps(pad, down);
            let (enter, leave) = (_mm_add_ps(origin, pad), _mm_sub_ps(origin, pad));
            let nearest = (ray.t_min * (1.0 - SLACK) - MIN).max(0.0);
            let [enter_rows, leave_rows] = ROWS[_mm_movemask_ps(direction) as usize & 7];
            let spread = |v: __m128| {
                [
                    _mm_shuffle_ps::<0>(v, v),
                    _mm_shuffle_ps::<0b01_01_01_01>(v, v),
                    _mm_shuffle_ps::<0b10_10_10_10>(v, v),
                ]
            };
            Some(LaneRay {
                enter_rows,
                leave_rows,
                inverse: spread(inverse),
                enter: spread(enter),
                leave: spread(leave),
                nearest: _mm_castps_si128(_mm_set1_ps(nearest)),
            })
        }
    }
}

impl LaneRay {
    /// See [`Boxes::span`]; for four children. These are functions, as closures would be compiled without the
    /// instructions.
    ///
    /// # Safety
    /// As for [`Boxes::span`].
    #[inline(always)]
    unsafe fn half<F: NodeFormat, const FROM: usize>(
        &self,
        node: *const u8,
        frame: &F::Frame4,
        limit: __m128i,
    ) -> (__m128i, __m128i) {
        // SAFETY: as the caller promises.
        unsafe {
            let (a, b) = (self.enter::<F, FROM>(node, 0, frame), self.enter::<F, FROM>(node, 1, frame));
            let enter = _mm_max_epi32(_mm_max_epi32(a, b), self.enter::<F, FROM>(node, 2, frame));
            let (a, b) = (self.leave::<F, FROM>(node, 0, frame), self.leave::<F, FROM>(node, 1, frame));
            let leave = _mm_min_epi32(_mm_min_epi32(a, b), self.leave::<F, FROM>(node, 2, frame));
            (_mm_max_epi32(enter, self.nearest), _mm_min_epi32(leave, limit))
        }
    }

    // SAFETY: as above.
    #[inline(always)]
    unsafe fn enter<F: NodeFormat, const FROM: usize>(
        &self,
        node: *const u8,
        k: usize,
        frame: &F::Frame4,
    ) -> __m128i {
        // SAFETY: as the caller promises.
        unsafe {
            let planes = F::planes4(node, self.enter_rows[k], FROM, k, frame);
            _mm_castps_si128(_mm_mul_ps(_mm_sub_ps(planes, self.enter[k]), self.inverse[k]))
        }
    }

    // SAFETY: as above.
    #[inline(always)]
    unsafe fn leave<F: NodeFormat, const FROM: usize>(
        &self,
        node: *const u8,
        k: usize,
        frame: &F::Frame4,
    ) -> __m128i {
        // SAFETY: as the caller promises.
        unsafe {
            let planes = F::planes4(node, self.leave_rows[k], FROM, k, frame);
            _mm_castps_si128(_mm_mul_ps(_mm_sub_ps(planes, self.leave[k]), self.inverse[k]))
        }
    }
}

impl Boxes for LaneRay {
    type Eight = [__m128i; 2];

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn span<F: NodeFormat>(
        &self,
        node: *const u8,
        limit: [__m128i; 2],
    ) -> ([__m128i; 2], [__m128i; 2]) {
        // SAFETY: as the trait demands.
        unsafe {
            let frame = F::frame4(node);
            let low = self.half::<F, 0>(node, &frame, limit[0]);
            let high = self.half::<F, 4>(node, &frame, limit[1]);
            ([low.0, high.0], [low.1, high.1])
        }
    }

    #[inline(always)]
    fn limit_bits(&self, t: f32) -> u32 {
        (t * (1.0 + 2.0 * SLACK) + MIN).to_bits()
    }
}
