//! Prepares rays for boxes, a group at a time.
#![allow(clippy::needless_range_loop)] // Iterator adaptors would not be compiled for the level.

use super::super::lane_ray::{ROWS, span};
use super::super::level::{BatchLevel, Boxes};
use super::super::node_format::NodeFormat;
use super::super::view::TreeView;
use super::super::wide::Wide;
use super::rays::{Packet, Row};
use crate::bvh8::layout::WIDTH;
use crate::bvh8::summary::BIAS_PAD;
use crate::ray::Ray;
use crate::slab::{SLACK, STEEPEST, least_of, limit_of};
use crate::triangle::PAD;
use std::arch::x86_64::*;

/// Facts about the rays of a packet; masks have a bit for each ray.
pub(in crate::bvh8::kernel) struct Ready {
    /// Lanes in use, a whole number of groups.
    pub(super) lanes: usize,
    /// Mask of the lanes in use.
    pub(super) used: u64,
    /// Rays that get an answer.
    pub(in crate::bvh8::kernel) asked: u64,
    pub(in crate::bvh8::kernel) regular: u64,
    /// Rays that get an answer and are not regular.
    pub(in crate::bvh8::kernel) irregular: u64,
    /// Rays whose direction is negative along each axis.
    pub(super) down: [u64; 3],
}

/// A ray of a packet.
#[derive(Clone, Copy)]
pub(in crate::bvh8::kernel) struct Lane<'p> {
    packet: &'p Packet,
    lane: usize,
    rows: &'static [[usize; 3]; 2],
}

impl Packet {
    /// Loads rays and prepares them as [`super::super::lane_ray::LaneRay::new`] does.
    ///
    /// # Safety
    /// The machine must have the level; there must be at least one ray, and at most [`super::RAYS`].
    #[inline(always)]
    pub(in crate::bvh8::kernel) unsafe fn prepare<L: BatchLevel>(
        &mut self,
        rays: &[Ray],
        view: &TreeView<'_>,
    ) -> Ready {
        let lanes = rays.len().next_multiple_of(L::Wide::LANES);
        // SAFETY: as the caller promises.
        unsafe { self.fill(rays, lanes) };
        self.set_base(view.units.as_ptr().cast());
        let used = u64::MAX >> (64 - lanes);
        let asked = u64::MAX >> (64 - rays.len());
        let mut ready = Ready { lanes, used, asked, regular: 0, irregular: 0, down: [0; 3] };
        for number in 0..lanes / L::Wide::LANES {
            // SAFETY: as the caller promises.
            unsafe { group::<L::Wide>(self, number * L::Wide::LANES, view, &mut ready) };
        }
        ready.irregular = !ready.regular & asked;
        ready
    }

    /// Tests a group of rays against the children of a node: sets a bit for each ray that hits a box, and writes the
    /// distances at which the rays enter them.
    ///
    /// # Safety
    /// The machine must have the level, the packet must be prepared, and `node` must point to a node.
    #[inline(always)]
    pub(super) unsafe fn intersect_children<W: Wide>(
        &self,
        node: *const u8,
        from: usize,
        children: &mut [u64; WIDTH],
        enters: &mut [Row<f32>; WIDTH],
    ) {
        // SAFETY: as the caller promises.
        unsafe {
            let load = |row: &Row<f32>| W::load(row.at(from));
            let three = |rows: &[Row<f32>; 3]| [load(&rows[0]), load(&rows[1]), load(&rows[2])];
            let (direction, inverse) = (three(&self.direction), three(&self.inverse));
            let (enter_bias, leave_bias) = (three(&self.enter_bias), three(&self.leave_bias));
            let (nearest, limit) = (load(&self.nearest), load(&self.limit));
            for child in 0..WIDTH {
                let plane = |row: usize| W::splat(*node.add(row * 32 + child * 4).cast::<f32>());
                let first =
                    |k: usize| direction[k].by_sign(plane(k), plane(k + 3)).fmadd(inverse[k], enter_bias[k]);
                let last =
                    |k: usize| direction[k].by_sign(plane(k + 3), plane(k)).fmadd(inverse[k], leave_bias[k]);
                // The minimum distance comes last: of two zeros, `max` returns the second, which has no sign.
                let enter = first(0).max(first(1)).max(first(2)).max(nearest);
                let leave = last(0).min(last(1)).min(last(2)).min(limit);
                enter.store(enters[child].at_mut(from));
                children[child] |= u64::from(enter.le(leave)) << from;
            }
        }
    }

    /// One of the rays.
    #[inline(always)]
    pub(in crate::bvh8::kernel) fn lane(&self, lane: usize, ready: &Ready) -> Lane<'_> {
        let [x, y, z] = ready.down;
        let down = (x >> lane & 1) | (y >> lane & 1) << 1 | (z >> lane & 1) << 2;
        Lane { packet: self, lane, rows: &ROWS[down as usize] }
    }
}

impl Boxes for Lane<'_> {
    type Eight = __m256i;

    // SAFETY: the trait states the requirements.
    #[inline(always)]
    unsafe fn span<F: NodeFormat>(&self, node: *const u8, limit: __m256i) -> (__m256i, __m256i) {
        // SAFETY: as the trait demands; the packet is prepared.
        unsafe {
            let all = |row: &Row<f32>| _mm256_set1_ps(*row.at(self.lane));
            let three = |rows: &[Row<f32>; 3]| [all(&rows[0]), all(&rows[1]), all(&rows[2])];
            let packet = self.packet;
            let bias = (three(&packet.enter_bias), three(&packet.leave_bias));
            let nearest = _mm256_castps_si256(all(&packet.nearest));
            let [enter_rows, leave_rows] = self.rows;
            span::<F>(node, (enter_rows, leave_rows), three(&packet.inverse), bias, (nearest, limit))
        }
    }

    #[inline(always)]
    fn limit_bits(&self, t: f32) -> u32 {
        // SAFETY: the packet is prepared.
        let pace = unsafe { *self.packet.pace.at(self.lane) };
        limit_of(t, pace, least_of(pace)).to_bits()
    }
}

/// # Safety
/// As for [`Packet::prepare`], and the packet must be filled.
#[inline(always)]
unsafe fn group<W: Wide>(packet: &mut Packet, from: usize, view: &TreeView<'_>, ready: &mut Ready) {
    // SAFETY: as the caller promises.
    unsafe {
        let load = |rows: &[Row<f32>; 3]| {
            [W::load(rows[0].at(from)), W::load(rows[1].at(from)), W::load(rows[2].at(from))]
        };
        let (origin, direction) = (load(&packet.origin), load(&packet.direction));
        let sizes = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
        let pace = sizes[0].max(sizes[1]).max(sizes[2]);
        let mut far = W::splat(0.0);
        for k in 0..3 {
            let to = |side: usize| W::splat(view.outline.corners[side][k]).sub(origin[k]).abs();
            far = to(0).max(to(1)).max(far);
        }
        let pad = far.mul(W::splat(PAD)).add(W::splat(4.0 * f32::MIN_POSITIVE));
        let (t_min, t_max) = (W::load(packet.t_min.at(from)), W::load(packet.t.at(from)));
        let zero = W::splat(0.0);
        let mut good = zero.le(t_min) & t_min.le(t_max) & zero.lt(pace);
        for k in 0..3 {
            // The pad makes rays enter earlier and leave later.
            let pad = pad.add(origin[k].abs().mul(W::splat(BIAS_PAD))).copy_sign(direction[k]);
            let (enter, leave) = (origin[k].add(pad), origin[k].sub(pad));
            let inverse = pace.div(direction[k]).max(W::splat(-STEEPEST)).min(W::splat(STEEPEST));
            let minus = zero.sub(inverse);
            let bias = [enter.mul(minus), leave.mul(minus)];
            good &= bias[0].abs().add(bias[1].abs()).add(sizes[k]).lt(W::splat(f32::INFINITY));
            enter.store(packet.enter[k].at_mut(from));
            leave.store(packet.leave[k].at_mut(from));
            inverse.store(packet.inverse[k].at_mut(from));
            bias[0].store(packet.enter_bias[k].at_mut(from));
            bias[1].store(packet.leave_bias[k].at_mut(from));
            ready.down[k] |= u64::from(direction[k].signs()) << from;
        }
        ready.regular |= u64::from(good) << from;
        pace.store(packet.pace.at_mut(from));
        W::splat(1.0).div(pace).store(packet.slowness.at_mut(from));
        let s = t_min.mul(pace);
        let least = pace.max(W::splat(1.0)).mul(W::splat(f32::MIN_POSITIVE));
        // Only infinities can produce a NaN here.
        let nearest = s.sub(s.mul(W::splat(SLACK))).sub(least).max(zero);
        nearest.store(packet.nearest.at_mut(from));
        packet.set_limits::<W>(from);
    }
}
