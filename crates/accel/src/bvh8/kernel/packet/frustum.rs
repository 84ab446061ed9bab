//! What bounds all rays of a packet, and whether they are near enough to each other for that to be of use.
#![allow(clippy::needless_range_loop)] // What iterators are made of is not compiled for the level.

use super::super::View;
use super::super::body::Level;
use super::super::tame::{BIAS_PAD, PAD, STEEPEST};
use super::rays::{Packet, Row};
use super::wide::Wide;
use crate::ray::Ray;
use crate::slab::SLACK;
use std::arch::x86_64::*;

/// The least and the greatest of what rays have that go the same way on every axis, a lane for each child of a node.
pub(super) struct Frustum {
    /// Bytes from the front of a node to the planes where rays come in, and go out.
    pub(super) enter_rows: [usize; 3],
    pub(super) leave_rows: [usize; 3],
    /// Which axes of space are x, y and z of sheared space.
    pub(super) axes: [usize; 3],
    /// Axes along which the rays run downwards.
    pub(super) down: [bool; 3],
    /// How far the ray looks that looks farthest.
    pub(super) limit: f32,
    enter: [__m256; 3],
    leave: [__m256; 3],
    inverse: [[__m256; 2]; 3],
    nearest: __m256,
}

/// A frustum may become as wide as this part of the scene.
const WIDEST: f32 = 0.1;

/// Which way a ray runs along each axis, and its steepest axis, the last of equals.
#[inline(always)]
fn way(ray: &Ray) -> ([bool; 3], usize) {
    let [x, y, z] = ray.direction.map(f32::abs);
    let steep = if z >= x && z >= y { 2 } else { usize::from(y >= x) };
    (ray.direction.map(f32::is_sign_negative), steep)
}

/// A first look, at three of the rays.
#[inline(always)]
pub(super) fn alike(rays: &[Ray]) -> bool {
    let first = way(&rays[0]);
    way(&rays[rays.len() - 1]) == first && way(&rays[rays.len() / 2]) == first
}

/// What is gathered over the groups of a packet.
#[derive(Clone, Copy)]
struct Extremes<W> {
    enter: [W; 3],
    leave: [W; 3],
    inverse: [[W; 2]; 3],
    shear: [[W; 2]; 2],
    nearest: W,
    limit: W,
}

impl Frustum {
    /// Prepares the rays of a packet as [`super::super::tame::TameRay`] does. `None` where one of them is not tame, does
    /// not go the way of the first, or is too far from the others.
    ///
    /// # Safety
    /// The machine must have the level, and the packet must be filled up to `lanes`.
    #[inline(always)]
    pub(super) unsafe fn new<W: Wide>(
        packet: &mut Packet,
        lanes: usize,
        first: &Ray,
        view: &View<'_>,
    ) -> Option<Frustum> {
        let (down, steep) = way(first);
        let axes = [(steep + 1) % 3, (steep + 2) % 3, steep];
        // SAFETY: as the caller promises.
        unsafe {
            let mut all = group::<W>(packet, 0, down, axes, view)?;
            for number in 1..lanes / W::LANES {
                all.join(&group::<W>(packet, number * W::LANES, down, axes, view)?, down);
            }
            if !all.are_near(down, axes, view) {
                return None;
            }
            let wide = |x: f32| _mm256_set1_ps(x);
            let bound = |x: &[W; 3], greatest: bool, k: usize| {
                wide(if greatest { x[k].greatest_lane() } else { x[k].least_lane() })
            };
            let inverse =
                |k: usize| [wide(all.inverse[k][0].least_lane()), wide(all.inverse[k][1].greatest_lane())];
            let row = |k: usize, upper: bool| (usize::from(upper) * 3 + k) * 32;
            Some(Frustum {
                enter_rows: [row(0, down[0]), row(1, down[1]), row(2, down[2])],
                leave_rows: [row(0, !down[0]), row(1, !down[1]), row(2, !down[2])],
                axes,
                down,
                limit: all.limit.greatest_lane(),
                enter: [
                    bound(&all.enter, !down[0], 0),
                    bound(&all.enter, !down[1], 1),
                    bound(&all.enter, !down[2], 2),
                ],
                leave: [
                    bound(&all.leave, down[0], 0),
                    bound(&all.leave, down[1], 1),
                    bound(&all.leave, down[2], 2),
                ],
                inverse: [inverse(0), inverse(1), inverse(2)],
                nearest: wide(all.nearest.least_lane()),
            })
        }
    }

    /// A bit for each child that some ray may meet, and where the first may enter it.
    ///
    /// Distances are `(plane − origin) · inverse` as in [`crate::slab`]; with the extreme origin, and the least over both
    /// extreme inverses, they are bounds to those of every ray, since rounding is monotone.
    ///
    /// # Safety
    /// The machine must have the level, and `node` must point to a node.
    #[inline(always)]
    pub(super) unsafe fn meet<L: Level>(&self, node: *const u8, limit: __m256i) -> (u32, __m256i) {
        // SAFETY: a node is aligned to 32 bytes and holds six rows of eight numbers.
        unsafe {
            let enter = |k: usize| {
                let d = _mm256_sub_ps(_mm256_load_ps(node.add(self.enter_rows[k]).cast()), self.enter[k]);
                let [low, high] = self.inverse[k];
                _mm256_min_ps(_mm256_mul_ps(d, low), _mm256_mul_ps(d, high))
            };
            let leave = |k: usize| {
                let d = _mm256_sub_ps(_mm256_load_ps(node.add(self.leave_rows[k]).cast()), self.leave[k]);
                let [low, high] = self.inverse[k];
                _mm256_max_ps(_mm256_mul_ps(d, low), _mm256_mul_ps(d, high))
            };
            let (a, b) = (_mm256_max_ps(enter(0), enter(1)), _mm256_max_ps(enter(2), self.nearest));
            let (c, d) = (_mm256_min_ps(leave(0), leave(1)), leave(2));
            let enter = _mm256_castps_si256(_mm256_max_ps(a, b));
            let leave = _mm256_min_epi32(_mm256_castps_si256(_mm256_min_ps(c, d)), limit);
            (L::at_most(enter, leave), enter)
        }
    }
}

impl<W: Wide> Extremes<W> {
    /// # Safety
    /// The machine must have the level.
    #[inline(always)]
    unsafe fn join(&mut self, other: &Extremes<W>, down: [bool; 3]) {
        // SAFETY: as the caller promises.
        unsafe {
            for k in 0..3 {
                let (enter, leave) = (&mut self.enter[k], &mut self.leave[k]);
                *enter = if down[k] { enter.min(other.enter[k]) } else { enter.max(other.enter[k]) };
                *leave = if down[k] { leave.max(other.leave[k]) } else { leave.min(other.leave[k]) };
                self.inverse[k][0] = self.inverse[k][0].min(other.inverse[k][0]);
                self.inverse[k][1] = self.inverse[k][1].max(other.inverse[k][1]);
            }
            for k in 0..2 {
                self.shear[k][0] = self.shear[k][0].min(other.shear[k][0]);
                self.shear[k][1] = self.shear[k][1].max(other.shear[k][1]);
            }
            self.nearest = self.nearest.min(other.nearest);
            self.limit = self.limit.max(other.limit);
        }
    }

    /// Whether the rays stay close to each other all through the scene.
    ///
    /// # Safety
    /// The machine must have the level.
    #[inline(always)]
    unsafe fn are_near(&self, down: [bool; 3], axes: [usize; 3], view: &View<'_>) -> bool {
        let extent = |k: usize| view.corners[1][k] - view.corners[0][k];
        let size = extent(0).max(extent(1)).max(extent(2));
        let mut near = true;
        // SAFETY: as the caller promises.
        unsafe {
            let reach = size.min(self.limit.greatest_lane());
            for i in 0..2 {
                let k = axes[i];
                let slopes = self.shear[i][1].greatest_lane() - self.shear[i][0].least_lane();
                // Origins, give or take their pads: the greatest where rays come in, the least where they go out.
                let origins = if down[k] {
                    self.leave[k].greatest_lane() - self.enter[k].least_lane()
                } else {
                    self.enter[k].greatest_lane() - self.leave[k].least_lane()
                };
                // Not a number is not near.
                near &= origins + slopes * reach <= WIDEST * size;
            }
        }
        near
    }
}

/// Prepares a group. The numbers are those of [`super::super::tame::TameRay::new`]; `None` where one ray is not tame or goes
/// another way.
///
/// # Safety
/// As for [`Frustum::new`].
#[inline(always)]
unsafe fn group<W: Wide>(
    packet: &mut Packet,
    from: usize,
    down: [bool; 3],
    axes: [usize; 3],
    view: &View<'_>,
) -> Option<Extremes<W>> {
    let full = (1u32 << W::LANES) - 1;
    // SAFETY: as the caller promises.
    unsafe {
        let load3 = |rows: &[Row<f32>; 3]| {
            [W::load(rows[0].at(from)), W::load(rows[1].at(from)), W::load(rows[2].at(from))]
        };
        let (origin, direction) = (load3(&packet.origin), load3(&packet.direction));
        let sizes = [direction[0].abs(), direction[1].abs(), direction[2].abs()];
        let pace = sizes[0].max(sizes[1]).max(sizes[2]);
        let steep = axes[2];
        let mut good = full;
        for k in 0..3 {
            good &= if down[k] { direction[k].signs() } else { !direction[k].signs() };
            good &= if k <= steep { sizes[k].le(sizes[steep]) } else { sizes[k].lt(sizes[steep]) };
        }
        let mut far = W::splat(0.0);
        for k in 0..3 {
            let to = |side: usize| W::splat(view.corners[side][k]).sub(origin[k]).abs();
            far = to(0).max(to(1)).max(far);
        }
        let pad = far.mul(W::splat(PAD)).add(W::splat(4.0 * f32::MIN_POSITIVE));
        let (mut enter, mut leave, mut inverse) = (origin, origin, direction);
        for k in 0..3 {
            let pad = pad.add(origin[k].abs().mul(W::splat(BIAS_PAD)));
            let (upper, lower) = (origin[k].add(pad), origin[k].sub(pad));
            (enter[k], leave[k]) = if down[k] { (lower, upper) } else { (upper, lower) };
            inverse[k] = pace.div(direction[k]).max(W::splat(-STEEPEST)).min(W::splat(STEEPEST));
            let bias = [enter[k].mul(inverse[k]), leave[k].mul(inverse[k])];
            good &= bias[0].abs().add(bias[1].abs()).add(sizes[k]).lt(W::splat(f32::INFINITY));
            inverse[k].store(packet.inverse[k].at_mut(from));
            bias[0].store(packet.enter_bias[k].at_mut(from));
            bias[1].store(packet.leave_bias[k].at_mut(from));
        }
        let (t_min, t_max) = (W::load(packet.t_min.at(from)), W::load(packet.t.at(from)));
        good &= W::splat(0.0).le(t_min) & t_min.le(t_max) & W::splat(0.0).lt(pace);
        if good & full != full {
            return None;
        }
        let shear = [direction[axes[0]].div(direction[steep]), direction[axes[1]].div(direction[steep])];
        pace.store(packet.pace.at_mut(from));
        shear[0].store(packet.shear[0].at_mut(from));
        shear[1].store(packet.shear[1].at_mut(from));
        let s = t_min.mul(pace);
        let least = pace.max(W::splat(1.0)).mul(W::splat(f32::MIN_POSITIVE));
        let nearest = s.sub(s.mul(W::splat(SLACK))).sub(least).max(W::splat(0.0));
        nearest.store(packet.nearest.at_mut(from));
        packet.set_limits::<W>(from);
        Some(Extremes {
            enter,
            leave,
            inverse: [[inverse[0]; 2], [inverse[1]; 2], [inverse[2]; 2]],
            shear: [[shear[0]; 2], [shear[1]; 2]],
            nearest,
            limit: W::load(packet.limit.at(from)),
        })
    }
}
