//! Up to 64 rays, as a structure of arrays.

use super::super::wide::Wide;
use crate::ray::Ray;
use crate::slab::SLACK;
use std::arch::x86_64::*;
use std::mem::{MaybeUninit, offset_of};

/// Maximum number of rays in a packet.
pub(in crate::bvh8::kernel) const RAYS: usize = 64;

/// A number for each ray; it is written before it is read.
#[repr(C, align(64))]
pub(super) struct Row<T>(MaybeUninit<[T; RAYS]>);

impl<T> Row<T> {
    #[inline(always)]
    pub(super) const fn uninit() -> Row<T> {
        Row(MaybeUninit::uninit())
    }

    #[inline(always)]
    pub(super) fn at(&self, lane: usize) -> *const T {
        self.0.as_ptr().cast::<T>().wrapping_add(lane)
    }

    #[inline(always)]
    pub(super) fn at_mut(&mut self, lane: usize) -> *mut T {
        self.0.as_mut_ptr().cast::<T>().wrapping_add(lane)
    }
}

impl Row<f32> {
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.0.write([0.0; RAYS]);
    }
}

/// Rays, a lane for each.
pub(in crate::bvh8::kernel) struct Packet {
    pub(super) origin: [Row<f32>; 3],
    pub(super) direction: [Row<f32>; 3],
    pub(super) t_min: Row<f32>,
    /// The end of the ray, then an upper bound on the distance of its nearest hit,
    pub(super) t: Row<f32>,
    /// and a lower bound; they are equal where the distance is exact.
    pub(super) t_low: Row<f32>,
    pub(super) exclude: Row<u32>,
    /// As in [`super::super::lane_ray::LaneRay`].
    pub(super) pace: Row<f32>,
    /// Reciprocal of `pace`.
    pub(super) slowness: Row<f32>,
    pub(super) inverse: [Row<f32>; 3],
    /// Padded origins for the planes where the ray enters, and for those where it leaves.
    pub(super) enter: [Row<f32>; 3],
    pub(super) leave: [Row<f32>; 3],
    /// Padded origins, negated, in units of distance.
    pub(super) enter_bias: [Row<f32>; 3],
    pub(super) leave_bias: [Row<f32>; 3],
    pub(super) nearest: Row<f32>,
    pub(super) limit: Row<f32>,
    pub(super) shear: [Row<f32>; 2],
    /// The direction along the steepest axis, where rays do not share it.
    pub(super) depth: Row<f32>,
    pub(super) u: Row<f32>,
    pub(super) v: Row<f32>,
    pub(super) primitive: Row<u32>,
    /// The triangle of the nearest hit: its first number, counted from the start of the tree.
    pub(super) place: Row<u32>,
    /// The start of the tree.
    base: MaybeUninit<*const f32>,
}

impl Packet {
    /// A packet without rays.
    #[inline(always)]
    pub(in crate::bvh8::kernel) fn new() -> Packet {
        // SAFETY: every part may be uninitialised. Building it part by part would copy it part by part.
        unsafe { MaybeUninit::uninit().assume_init() }
    }

    /// Sets the tree whose triangles the rays will hit.
    #[inline(always)]
    pub(super) fn set_base(&mut self, base: *const f32) {
        self.base = MaybeUninit::new(base);
    }

    /// The start of that tree.
    ///
    /// # Safety
    /// It must have been set.
    #[inline(always)]
    pub(super) unsafe fn base(&self) -> *const f32 {
        // SAFETY: as the caller promises.
        unsafe { self.base.assume_init() }
    }

    /// Loads rays into `lanes` lanes, a multiple of eight; the last ray fills the remaining lanes.
    ///
    /// # Safety
    /// The machine must have AVX2.
    #[inline(always)]
    pub(super) unsafe fn fill(&mut self, rays: &[Ray], lanes: usize) {
        for number in 0..lanes / 8 {
            let from = number * 8;
            let ray = |k: usize| &rays[(from + k).min(rays.len() - 1)];
            // SAFETY: there is a slot for each of the lanes, whose number is at most `RAYS`.
            unsafe {
                let [x, y, z, dx, dy, dz, t_min, t_max] = transposed([
                    numbers(ray(0)),
                    numbers(ray(1)),
                    numbers(ray(2)),
                    numbers(ray(3)),
                    numbers(ray(4)),
                    numbers(ray(5)),
                    numbers(ray(6)),
                    numbers(ray(7)),
                ]);
                for (axis, (origin, direction)) in [(x, dx), (y, dy), (z, dz)].into_iter().enumerate() {
                    _mm256_store_ps(self.origin[axis].at_mut(from), origin);
                    _mm256_store_ps(self.direction[axis].at_mut(from), direction);
                }
                _mm256_store_ps(self.t_min.at_mut(from), t_min);
                _mm256_store_ps(self.t.at_mut(from), t_max);
                _mm256_store_ps(self.t_low.at_mut(from), t_max);
                _mm256_store_si256(self.primitive.at_mut(from).cast(), _mm256_set1_epi32(-1));
                for k in 0..8 {
                    *self.exclude.at_mut(from + k) = ray(k).exclude.index;
                }
            }
        }
    }

    /// After hits: how far the rays of a group still search.
    ///
    /// # Safety
    /// The machine must have the level, and the group must have been prepared.
    #[inline(always)]
    pub(super) unsafe fn set_limits<W: Wide>(&mut self, from: usize) {
        // SAFETY: as the caller promises.
        unsafe {
            let pace = W::load(self.pace.at(from));
            let s = W::load(self.t.at(from)).mul(pace);
            let least = pace.max(W::splat(1.0)).mul(W::splat(f32::MIN_POSITIVE));
            let limit = s.add(s.abs().mul(W::splat(SLACK))).add(least);
            limit.min(W::splat(f32::INFINITY)).store(self.limit.at_mut(from));
        }
    }
}

/// The origin, direction, `t_min` and `t_max` of a ray.
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn numbers(ray: &Ray) -> __m256 {
    const FIRST: usize = offset_of!(Ray, origin);
    const IN_ORDER: bool = offset_of!(Ray, direction) == FIRST + 12
        && offset_of!(Ray, t_min) == FIRST + 24
        && offset_of!(Ray, t_max) == FIRST + 28;
    // SAFETY: if the fields are in order, all eight numbers belong to the ray.
    unsafe {
        if IN_ORDER {
            return _mm256_loadu_ps(std::ptr::from_ref(ray).cast::<u8>().add(FIRST).cast());
        }
        let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
        _mm256_setr_ps(x, y, z, dx, dy, dz, ray.t_min, ray.t_max)
    }
}

/// Transposes eight rows of eight numbers.
///
/// # Safety
/// The machine must have AVX2.
#[inline(always)]
unsafe fn transposed([a, b, c, d, e, f, g, h]: [__m256; 8]) -> [__m256; 8] {
    // SAFETY: as the caller promises.
    unsafe {
        let pairs = |a, b| (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        let (ab, cd, ef, gh) = (pairs(a, b), pairs(c, d), pairs(e, f), pairs(g, h));
        let low = |a, b| _mm256_shuffle_ps::<0b01_00_01_00>(a, b);
        let high = |a, b| _mm256_shuffle_ps::<0b11_10_11_10>(a, b);
        let (p, q) = (low(ab.0, cd.0), low(ef.0, gh.0));
        let (r, s) = (high(ab.0, cd.0), high(ef.0, gh.0));
        let (t, u) = (low(ab.1, cd.1), low(ef.1, gh.1));
        let (v, w) = (high(ab.1, cd.1), high(ef.1, gh.1));
        let first = |a, b| _mm256_permute2f128_ps::<0x20>(a, b);
        let second = |a, b| _mm256_permute2f128_ps::<0x31>(a, b);
        [
            first(p, q),
            first(r, s),
            first(t, u),
            first(v, w),
            second(p, q),
            second(r, s),
            second(t, u),
            second(v, w),
        ]
    }
}
