//! Coherent rays, as from a camera or towards a light: up to 64 of them on one path through the tree.
//!
//! At a node, all boxes are tested against the *frustum*, the minimum and maximum of the rays' quantities on each
//! axis: eight boxes at once, whatever the number of rays. A child is tested against the rays themselves only when
//! its turn comes, by which time it is often behind what they have hit; for a node, one group of rays that hits it is
//! enough. Triangles are tested one by one, by a group of rays at a time [Wald 2001], [Overbeck 2008].
//!
//! Rays that are not coherent share the upper levels only: see [`masked`].
//!
//! All of this skips only what [`super::body`] would skip too, or less; the triangle test is the same, operation by
//! operation. So the hits are the same.

mod estimate;
mod exact;
mod frustum;
mod masked;
mod orientation;
mod rays;
mod ready;
mod triangle;

pub(super) use masked::Tails;
pub(super) use rays::{Packet, RAYS};
pub(super) use ready::{Lane, Ready};

use super::blocker::on;
use super::body::prefetch;
use super::level::BatchLevel;
use super::node_format::{self, reference};
use super::stack::{Stack, StackStorage};
use super::view::TreeView;
use super::wide::Wide;
use crate::bvh8::layout::Ref;
use crate::ray::{Hit, Query, Ray};
use frustum::Frustum;
use triangle::Group;

/// A packet in traversal.
struct Walk<'p> {
    packet: &'p mut Packet,
    frustum: Frustum,
    query: &'p Query<'p>,
    /// Lanes in use, a whole number of groups.
    lanes: usize,
    /// A bit for each ray whose search is finished.
    done: u64,
}

/// Answers up to [`RAYS`] rays if they are coherent; otherwise does nothing and returns false.
///
/// # Safety
/// The machine must have the level, the view must be sound, and the packet must be prepared.
#[inline(always)]
pub(super) unsafe fn each<L: BatchLevel, const ANY: bool>(
    view: TreeView<'_>,
    (packet, ready): (&mut Packet, &Ready),
    rays: &[Ray],
    query: &Query,
    answer: &mut impl FnMut(usize, Option<Hit>),
) -> bool {
    if !view.outline.root.is_node() || !frustum::look_coherent(rays) {
        return false;
    }
    // SAFETY: as the caller promises.
    unsafe {
        let Some(frustum) = Frustum::new::<L::Wide>(packet, ready, &rays[0], &view) else { return false };
        let done = if rays.len() == 64 { 0 } else { u64::MAX << rays.len() };
        let mut walk = Walk { packet, frustum, query, lanes: ready.lanes, done };
        walk.run::<L, ANY>(&view);
        let (packet, done) = (&walk.packet, walk.done);
        for lane in 0..rays.len() {
            let primitive = *packet.primitive.at(lane);
            if ANY {
                answer(lane, (done >> lane & 1 == 1).then_some(on(primitive)));
            } else if primitive == u32::MAX {
                answer(lane, None);
            } else {
                let (t, u, v) = (*packet.t.at(lane), *packet.u.at(lane), *packet.v.at(lane));
                answer(lane, Some(Hit { t, u, v, primitive, instance: 0 }));
            }
        }
    }
    true
}

impl Walk<'_> {
    /// # Safety
    /// As for [`each`].
    #[inline(always)]
    unsafe fn run<L: BatchLevel, const ANY: bool>(&mut self, view: &TreeView<'_>) {
        let base = view.units.as_ptr().cast::<u8>();
        let mut storage = StackStorage::uninit();
        let mut stack = Stack::new(&mut storage);
        let mut current = view.outline.root;
        let mut limit_bits = self.frustum.limit.to_bits();
        // SAFETY: as the caller promises; references lead to whole nodes and leaves.
        unsafe {
            loop {
                let node = base.add(current.byte());
                let (mut mask, enter) = self.frustum.intersect_children::<L>(node, L::splat(limit_bits));
                if mask != 0 {
                    L::push_children(current, mask, enter, &mut stack);
                }
                while mask != 0 {
                    prefetch::<node_format::Wide>(
                        base,
                        reference::<node_format::Wide>(node, mask.trailing_zeros() as usize),
                    );
                    mask &= mask - 1;
                }
                loop {
                    if stack.is_empty() || (ANY && self.done == u64::MAX) {
                        return;
                    }
                    let (parent, key) = stack.take();
                    if key > limit_bits | 7 {
                        continue;
                    }
                    let (node, child) = (base.add(parent.byte()), key as usize & 7);
                    let reference = reference::<node_format::Wide>(node, child);
                    if !reference.is_node() {
                        if self.leaf::<L::Wide, ANY>(base, node, child, reference) {
                            limit_bits = self.limit::<L::Wide>().to_bits();
                        }
                    } else if self.group_hits_any::<L::Wide>(node, child) {
                        current = reference;
                        break;
                    }
                }
            }
        }
    }

    /// The maximum distance to which any ray still searches.
    ///
    /// # Safety
    /// As for [`each`].
    #[inline(always)]
    unsafe fn limit<W: Wide>(&self) -> f32 {
        // SAFETY: as the caller promises.
        unsafe {
            let mut limit = W::load(self.packet.limit.at(0));
            for group in 1..self.lanes / W::LANES {
                limit = limit.max(W::load(self.packet.limit.at(group * W::LANES)));
            }
            limit.greatest_lane()
        }
    }

    /// The rays of a group that are still searching.
    #[inline(always)]
    fn active<W: Wide>(&self, from: usize) -> u32 {
        (!self.done >> from) as u32 & ((1 << W::LANES) - 1)
    }

    /// # Safety
    /// As for [`each`].
    #[inline(always)]
    unsafe fn group_hits_any<W: Wide>(&self, node: *const u8, child: usize) -> bool {
        let mut from = 0;
        while from < self.lanes {
            // SAFETY: as the caller promises.
            let mask = unsafe { self.packet.intersect_child::<W>(from, &self.frustum, node, child) };
            if mask & self.active::<W>(from) != 0 {
                return true;
            }
            from += W::LANES;
        }
        false
    }

    /// Tests a leaf with the groups that hit it; true when a limit has changed.
    ///
    /// # Safety
    /// As for [`each`].
    #[inline(always)]
    unsafe fn leaf<W: Wide, const ANY: bool>(
        &mut self,
        base: *const u8,
        node: *const u8,
        child: usize,
        leaf: Ref,
    ) -> bool {
        let mut changed = false;
        for group in 0..self.lanes / W::LANES {
            let from = group * W::LANES;
            // SAFETY: as the caller promises.
            unsafe {
                let mask = self.packet.intersect_child::<W>(from, &self.frustum, node, child)
                    & self.active::<W>(from);
                if mask == 0 {
                    continue;
                }
                let mut group = Group::new(self.packet, &self.frustum, self.query, from);
                let hits = group.test_leaf::<W, ANY>(base.add(leaf.byte()), leaf.blocks(), mask);
                if ANY {
                    self.done |= u64::from(hits) << from;
                } else if hits != 0 {
                    group.finish::<W>();
                    changed = true;
                }
            }
        }
        changed
    }
}
