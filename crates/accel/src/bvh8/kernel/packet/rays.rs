//! Up to 64 rays, number by number.

use super::frustum::Frustum;
use super::wide::Wide;
use crate::ray::Ray;
use crate::slab::SLACK;
use std::mem::MaybeUninit;

/// The most rays of a packet.
pub(in crate::bvh8::kernel) const RAYS: usize = 64;

/// A number for each ray; written before it is read.
#[repr(C, align(64))]
pub(super) struct Row<T>(MaybeUninit<[T; RAYS]>);

impl<T> Row<T> {
    #[inline(always)]
    pub(super) fn at(&self, lane: usize) -> *const T {
        self.0.as_ptr().cast::<T>().wrapping_add(lane)
    }

    #[inline(always)]
    pub(super) fn at_mut(&mut self, lane: usize) -> *mut T {
        self.0.as_mut_ptr().cast::<T>().wrapping_add(lane)
    }
}

/// Rays, a lane for each.
pub(in crate::bvh8::kernel) struct Packet {
    pub(super) origin: [Row<f32>; 3],
    pub(super) direction: [Row<f32>; 3],
    pub(super) t_min: Row<f32>,
    /// The end of the ray, then its nearest hit.
    pub(super) t: Row<f32>,
    pub(super) exclude: Row<u32>,
    /// As of [`super::super::tame::TameRay`].
    pub(super) pace: Row<f32>,
    pub(super) inverse: [Row<f32>; 3],
    /// Origins as planes see them where the ray comes in, and goes out.
    pub(super) enter: [Row<f32>; 3],
    pub(super) leave: [Row<f32>; 3],
    pub(super) enter_bias: [Row<f32>; 3],
    pub(super) leave_bias: [Row<f32>; 3],
    pub(super) nearest: Row<f32>,
    pub(super) limit: Row<f32>,
    pub(super) shear: [Row<f32>; 2],
    pub(super) u: Row<f32>,
    pub(super) v: Row<f32>,
    pub(super) primitive: Row<u32>,
}

impl Packet {
    /// Without rays.
    #[inline(always)]
    pub(in crate::bvh8::kernel) fn new() -> Packet {
        // SAFETY: every part may be without a value. Built part by part it would be copied part by part.
        unsafe { MaybeUninit::uninit().assume_init() }
    }

    /// Takes rays over; the last fills the lanes that are left.
    #[inline(always)]
    pub(super) fn fill(&mut self, rays: &[Ray], lanes: usize) {
        for lane in 0..lanes {
            let ray = &rays[lane.min(rays.len() - 1)];
            // SAFETY: there is a place for each of the lanes, whose number is at most `RAYS`.
            unsafe {
                for axis in 0..3 {
                    *self.origin[axis].at_mut(lane) = ray.origin[axis];
                    *self.direction[axis].at_mut(lane) = ray.direction[axis];
                }
                *self.t_min.at_mut(lane) = ray.t_min;
                *self.t.at_mut(lane) = ray.t_max;
                *self.exclude.at_mut(lane) = ray.exclude.index;
                *self.primitive.at_mut(lane) = u32::MAX;
            }
        }
    }

    /// Where the rays of a group meet the box of a child up to their limits: a bit for each.
    ///
    /// # Safety
    /// The machine must have the level; the group must have been prepared, and `node` must point to a node.
    #[inline(always)]
    pub(super) unsafe fn meet<W: Wide>(
        &self,
        from: usize,
        frustum: &Frustum,
        node: *const u8,
        child: usize,
    ) -> u32 {
        // SAFETY: as the caller promises; a node holds six rows of eight numbers.
        unsafe {
            let plane = |row: usize| W::splat(*node.add(row + child * 4).cast::<f32>());
            let enter = |k: usize| {
                let bias = W::load(self.enter_bias[k].at(from));
                plane(frustum.enter_rows[k]).fmsub(W::load(self.inverse[k].at(from)), bias)
            };
            let leave = |k: usize| {
                let bias = W::load(self.leave_bias[k].at(from));
                plane(frustum.leave_rows[k]).fmsub(W::load(self.inverse[k].at(from)), bias)
            };
            let (a, b) = (enter(0).max(enter(1)), enter(2).max(W::load(self.nearest.at(from))));
            let (c, d) = (leave(0).min(leave(1)), leave(2).min(W::load(self.limit.at(from))));
            a.max(b).le(c.min(d))
        }
    }

    /// After hits: how far the rays of a group still look.
    ///
    /// # Safety
    /// As for [`Packet::meet`].
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
