//! The frustum that bounds all rays of a packet, and whether the rays are coherent enough for it to be useful.
#![allow(clippy::needless_range_loop)] // Iterator adaptors would not be compiled for the level.

use super::super::level::BatchLevel;
use super::super::view::TreeView;
use super::super::wide::Wide;
use super::rays::{Packet, Row};
use super::ready::Ready;
use crate::ray::Ray;
use std::arch::x86_64::*;

/// The minimum and maximum of each quantity over rays with the same direction signs, a lane for each child of a node.
pub(super) struct Frustum {
    /// Bytes from the start of a node to the planes where rays enter, and where they leave.
    pub(super) enter_rows: [usize; 3],
    pub(super) leave_rows: [usize; 3],
    /// Which axes of space are x, y and z of sheared space.
    pub(super) axes: [usize; 3],
    /// Axes along which the rays run downwards.
    pub(super) down: [bool; 3],
    /// The maximum distance to which any ray still searches.
    pub(super) limit: f32,
    enter: [__m256; 3],
    leave: [__m256; 3],
    inverse: [[__m256; 2]; 3],
    nearest: __m256,
}

/// Maximum width of a frustum, as a fraction of the scene.
const WIDEST: f32 = 0.1;

/// The signs of a ray's direction, and its steepest axis, the last one of a tie.
#[inline(always)]
fn direction_class(ray: &Ray) -> ([bool; 3], usize) {
    let [x, y, z] = ray.direction.map(f32::abs);
    let steep = if z >= x && z >= y { 2 } else { usize::from(y >= x) };
    (ray.direction.map(f32::is_sign_negative), steep)
}

/// A quick check of three of the rays.
#[inline(always)]
pub(super) fn look_coherent(rays: &[Ray]) -> bool {
    let first = direction_class(&rays[0]);
    direction_class(&rays[rays.len() - 1]) == first && direction_class(&rays[rays.len() / 2]) == first
}

/// The quantities gathered over the groups of a packet.
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
    /// `None` where some ray is not regular, differs from the first in direction signs, or is too far from the others.
    ///
    /// # Safety
    /// The machine must have the level, and the packet must be prepared.
    #[inline(always)]
    pub(super) unsafe fn new<W: Wide>(
        packet: &mut Packet,
        ready: &Ready,
        first: &Ray,
        view: &TreeView<'_>,
    ) -> Option<Frustum> {
        let (down, steep) = direction_class(first);
        let same = |k: usize| ready.down[k] == if down[k] { ready.used } else { 0 };
        if ready.irregular != 0 || !same(0) || !same(1) || !same(2) {
            return None;
        }
        let axes = [(steep + 1) % 3, (steep + 2) % 3, steep];
        // SAFETY: as the caller promises.
        unsafe {
            let mut all = group::<W>(packet, 0, axes)?;
            for number in 1..ready.lanes / W::LANES {
                all.join(&group::<W>(packet, number * W::LANES, axes)?, down);
            }
            if !all.are_near(down, axes, view) {
                return None;
            }
            let row = |k: usize, upper: bool| (usize::from(upper) * 3 + k) * 32;
            Some(Frustum {
                enter_rows: [row(0, down[0]), row(1, down[1]), row(2, down[2])],
                leave_rows: [row(0, !down[0]), row(1, !down[1]), row(2, !down[2])],
                axes,
                down,
                limit: all.limit.greatest_lane(),
                enter: [
                    bound(all.enter[0], !down[0]),
                    bound(all.enter[1], !down[1]),
                    bound(all.enter[2], !down[2]),
                ],
                leave: [
                    bound(all.leave[0], down[0]),
                    bound(all.leave[1], down[1]),
                    bound(all.leave[2], down[2]),
                ],
                inverse: [ends(all.inverse[0]), ends(all.inverse[1]), ends(all.inverse[2])],
                nearest: bound(all.nearest, false),
            })
        }
    }

    /// A bit for each child that some ray may hit, and the smallest distance at which a ray may enter it.
    ///
    /// Distances are `(plane − origin) · inverse` as in [`crate::slab`]; with the extreme origin, and the minimum
    /// over both extreme inverses, they bound those of every ray, since rounding is monotone.
    ///
    /// # Safety
    /// The machine must have the level, and `node` must point to a node.
    #[inline(always)]
    pub(super) unsafe fn intersect_children<L: BatchLevel>(
        &self,
        node: *const u8,
        limit: __m256i,
    ) -> (u32, __m256i) {
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

impl Packet {
    /// A bit for each ray of a group that hits the box of a child up to its limit.
    ///
    /// # Safety
    /// The machine must have the level; the group must have been prepared, and `node` must point to a node.
    #[inline(always)]
    pub(super) unsafe fn intersect_child<W: Wide>(
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
                plane(frustum.enter_rows[k]).fmadd(W::load(self.inverse[k].at(from)), bias)
            };
            let leave = |k: usize| {
                let bias = W::load(self.leave_bias[k].at(from));
                plane(frustum.leave_rows[k]).fmadd(W::load(self.inverse[k].at(from)), bias)
            };
            let (a, b) = (enter(0).max(enter(1)), enter(2).max(W::load(self.nearest.at(from))));
            let (c, d) = (leave(0).min(leave(1)), leave(2).min(W::load(self.limit.at(from))));
            a.max(b).le(c.min(d))
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

    /// Whether the rays stay close to each other throughout the scene.
    ///
    /// # Safety
    /// The machine must have the level.
    #[inline(always)]
    unsafe fn are_near(&self, down: [bool; 3], axes: [usize; 3], view: &TreeView<'_>) -> bool {
        let extent = |k: usize| view.outline.corners[1][k] - view.outline.corners[0][k];
        let size = extent(0).max(extent(1)).max(extent(2));
        let mut near = true;
        // SAFETY: as the caller promises.
        unsafe {
            let reach = size.min(self.limit.greatest_lane());
            for i in 0..2 {
                let k = axes[i];
                let slopes = self.shear[i][1].greatest_lane() - self.shear[i][0].least_lane();
                // Origins, including their pads: the maximum where rays enter, the minimum where they leave.
                let origins = if down[k] {
                    self.leave[k].greatest_lane() - self.enter[k].least_lane()
                } else {
                    self.enter[k].greatest_lane() - self.leave[k].least_lane()
                };
                // A NaN does not count as near.
                near &= origins + slopes * reach <= WIDEST * size;
            }
        }
        near
    }
}

/// The maximum lane or the minimum, in all lanes.
///
/// # Safety
/// The machine must have the level.
#[inline(always)]
unsafe fn bound<W: Wide>(x: W, greatest: bool) -> __m256 {
    // SAFETY: as the caller promises.
    unsafe { _mm256_set1_ps(if greatest { x.greatest_lane() } else { x.least_lane() }) }
}

/// The minimum lane of the first and the maximum lane of the second.
///
/// # Safety
/// The machine must have the level.
#[inline(always)]
unsafe fn ends<W: Wide>([low, high]: [W; 2]) -> [__m256; 2] {
    // SAFETY: as the caller promises.
    unsafe { [bound(low, false), bound(high, true)] }
}

/// The extremes of a group. `None` where some ray has another steepest axis.
///
/// # Safety
/// As for [`Frustum::new`].
#[inline(always)]
unsafe fn group<W: Wide>(packet: &mut Packet, from: usize, axes: [usize; 3]) -> Option<Extremes<W>> {
    // SAFETY: as the caller promises.
    unsafe {
        let load = |rows: &[Row<f32>; 3]| {
            [W::load(rows[0].at(from)), W::load(rows[1].at(from)), W::load(rows[2].at(from))]
        };
        let direction = load(&packet.direction);
        let (steep, size) = (axes[2], direction[axes[2]].abs());
        let mut good = u32::MAX;
        for k in 0..3 {
            let other = direction[k].abs();
            good &= if k <= steep { other.le(size) } else { other.lt(size) };
        }
        if good != (1u32 << W::LANES) - 1 {
            return None;
        }
        let shear = [direction[axes[0]].div(direction[steep]), direction[axes[1]].div(direction[steep])];
        shear[0].store(packet.shear[0].at_mut(from));
        shear[1].store(packet.shear[1].at_mut(from));
        let inverse = load(&packet.inverse);
        Some(Extremes {
            enter: load(&packet.enter),
            leave: load(&packet.leave),
            inverse: [[inverse[0]; 2], [inverse[1]; 2], [inverse[2]; 2]],
            shear: [[shear[0]; 2], [shear[1]; 2]],
            nearest: W::load(packet.nearest.at(from)),
            limit: W::load(packet.limit.at(from)),
        })
    }
}
