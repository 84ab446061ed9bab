//! Incoherent rays: up to 64 of them traverse the upper levels of the tree together.
//!
//! Each entry of the stack is a node or a leaf with a mask of the rays that hit its box. A node is tested against
//! those rays, a group at a time, and so is each triangle of a leaf. The deeper the traversal, the fewer rays share an
//! entry. Where they are so few that most lanes would be idle, the entry becomes a *tail* of each of them: a subtree
//! that the ray visits afterwards, on its own, unless it has found something nearer by then.
//!
//! The boxes are tested as in [`super::super::lane_ray`], and the triangles as in [`super::super::block`], operation by
//! operation. So the hits are the same.

use super::super::body::prefetch;
use super::super::level::BatchLevel;
use super::super::node_format::{self, reference};
use super::super::stack::{CAPACITY, MAX_AT_START, Stack};
use super::super::view::TreeView;
use super::super::wide::Wide;
use super::orientation::Mixed;
use super::rays::{Packet, RAYS, Row};
use super::ready::Ready;
use super::triangle::Group;
use crate::bvh8::layout::{Ref, WIDTH};
use crate::ray::{Hit, Query};
use std::mem::MaybeUninit;

/// Fewer rays than this visit a node one by one. A node costs a packet the same whether one or all rays of a group hit
/// it; any number from 8 to 24 is as fast.
const LEAST_AT_NODE: u32 = 16;

/// Fewer rays than this visit a leaf one by one: a ray on its own tests four triangles at once. Any number from 4 to 9
/// is as fast.
const LEAST_AT_LEAF: u32 = 6;

/// Maximum number of tails of a ray; most have one to three. A ray that has as many stays in the shared traversal,
/// however few rays are with it.
const TAILS: usize = MAX_AT_START;

/// Tails of all rays, still to be visited.
pub(in crate::bvh8::kernel) struct Tails {
    counts: [u8; RAYS],
    /// The first tail of each ray, then the second of each, and so on.
    references: [MaybeUninit<[u32; RAYS]>; TAILS],
    /// The bits of the distances at which the ray enters them.
    enters: [MaybeUninit<[u32; RAYS]>; TAILS],
    /// A bit for each ray that has hit something, where any hit is enough.
    pub(in crate::bvh8::kernel) found: u64,
}

/// A node or a leaf, and the rays that hit its box.
#[derive(Clone, Copy)]
struct Entry {
    reference: Ref,
    /// The bits of the distance at which the first of them enters it.
    enter: u32,
    mask: u64,
}

/// Stack of the entries still to be visited.
struct Entries {
    entries: [MaybeUninit<Entry>; CAPACITY],
    size: usize,
}

/// For each child of a node, the distance at which each ray enters its box.
type Enters = [Row<f32>; WIDTH];

/// A packet in traversal.
struct Walk<'p> {
    packet: &'p mut Packet,
    mixed: Mixed,
    query: &'p Query<'p>,
    tails: &'p mut Tails,
    /// Lanes in use, a whole number of groups.
    lanes: usize,
}

impl Packet {
    /// Traces the regular rays of a packet as far as they share nodes and leaves; the rest becomes their tails.
    ///
    /// # Safety
    /// The machine must have the level, the view must be sound, and the packet must be prepared.
    #[inline(always)]
    pub(in crate::bvh8::kernel) unsafe fn walk_together<L: BatchLevel, const ANY: bool>(
        &mut self,
        view: &TreeView<'_>,
        ready: &Ready,
        query: &Query,
        tails: &mut Tails,
    ) {
        // SAFETY: as the caller promises.
        unsafe {
            let mixed = Mixed::new::<L::Wide>(self, ready);
            let mut walk = Walk { packet: self, mixed, query, tails, lanes: ready.lanes };
            walk.run::<L, ANY>(view, ready.regular & ready.asked);
            if !ANY {
                walk.resolve::<L::Wide>();
            }
        }
    }

    /// Hit that a ray has found so far, and the bits of the distance up to which the ray still searches.
    ///
    /// # Safety
    /// The packet must be prepared.
    #[inline(always)]
    pub(in crate::bvh8::kernel) unsafe fn found(&self, lane: usize) -> (Hit, u32) {
        // SAFETY: as the caller promises; the weights are written with the primitive.
        unsafe {
            let primitive = *self.primitive.at(lane);
            let hit = Hit { t: *self.t.at(lane), u: 0.0, v: 0.0, primitive, instance: 0 };
            let limit_bits = (*self.limit.at(lane)).to_bits();
            if primitive == u32::MAX {
                return (hit, limit_bits);
            }
            (Hit { u: *self.u.at(lane), v: *self.v.at(lane), ..hit }, limit_bits)
        }
    }
}

impl Tails {
    #[inline(always)]
    pub(in crate::bvh8::kernel) fn new() -> Tails {
        Tails {
            counts: [0; RAYS],
            references: [const { MaybeUninit::uninit() }; TAILS],
            enters: [const { MaybeUninit::uninit() }; TAILS],
            found: 0,
        }
    }

    /// Puts the tails of a ray onto an empty stack, except those beyond its limit: the nearest on top or, where any hit
    /// is enough, the first.
    ///
    /// # Safety
    /// The lane must be one of a packet.
    #[inline(always)]
    pub(in crate::bvh8::kernel) unsafe fn fill<const ANY: bool>(
        &self,
        lane: usize,
        limit_bits: u32,
        stack: &mut Stack,
    ) {
        // SAFETY: as the caller promises; as many tails have been written as are counted, and a stack has space for
        // all of them when a search begins.
        unsafe {
            let from_references = self.references.as_ptr().cast::<u32>().add(lane);
            let from_enters = self.enters.as_ptr().cast::<u32>().add(lane);
            let (references, enters) = (stack.references(), stack.distances());
            let mut size = 0;
            let count = usize::from(*self.counts.as_ptr().add(lane));
            for tail in 0..count {
                let tail = if ANY { count - 1 - tail } else { tail };
                let (reference, enter) = (*from_references.add(tail * RAYS), *from_enters.add(tail * RAYS));
                if enter > limit_bits {
                    continue;
                }
                let mut place = size;
                while !ANY && place > 0 && *enters.add(place - 1) < enter {
                    *enters.add(place) = *enters.add(place - 1);
                    *references.add(place) = *references.add(place - 1);
                    place -= 1;
                }
                *enters.add(place) = enter;
                *references.add(place) = reference;
                size += 1;
            }
            stack.grow(size);
        }
    }

    /// Gives the rays of a mask another tail; returns those that have no room for it.
    ///
    /// # Safety
    /// The distances of these rays must have been written.
    #[inline(always)]
    unsafe fn put(&mut self, tail: Ref, mask: u64, enters: &Row<f32>) -> u64 {
        let (mut left, mut full) = (mask, 0);
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            let bit = left & left.wrapping_neg();
            left &= left - 1;
            // SAFETY: a mask has a bit for each of the packet's lanes.
            unsafe {
                let count = &mut *self.counts.as_mut_ptr().add(lane);
                let place = usize::from(*count);
                if place == TAILS {
                    full |= bit;
                    continue;
                }
                *count += 1;
                self.references.as_mut_ptr().cast::<u32>().add(place * RAYS + lane).write(tail.0);
                let enter = (*enters.at(lane)).to_bits();
                self.enters.as_mut_ptr().cast::<u32>().add(place * RAYS + lane).write(enter);
            }
        }
        full
    }
}

/// True where too few rays visit a node or leaf together.
#[inline(always)]
fn are_few(reference: Ref, mask: u64) -> bool {
    mask.count_ones() < if reference.is_node() { LEAST_AT_NODE } else { LEAST_AT_LEAF }
}

impl Entries {
    /// Puts a child on top or, if `SORTED`, below nearer children of the same node; `bottom` is the size before its
    /// first child.
    ///
    /// # Safety
    /// Everything below the size must have been written.
    #[inline(always)]
    unsafe fn put<const SORTED: bool>(&mut self, child: Entry, bottom: usize) {
        let mut place = self.size;
        // SAFETY: as the caller promises.
        while SORTED && place > bottom && unsafe { self.entries[place - 1].assume_init().enter } < child.enter
        {
            self.entries[place] = self.entries[place - 1];
            place -= 1;
        }
        self.entries[place] = MaybeUninit::new(child);
        self.size += 1;
    }
}

impl Walk<'_> {
    /// # Safety
    /// As for [`Packet::walk_together`].
    #[inline(always)]
    unsafe fn run<L: BatchLevel, const ANY: bool>(&mut self, view: &TreeView<'_>, all: u64) {
        let base = view.units.as_ptr().cast::<u8>();
        let mut stack = Entries { entries: [const { MaybeUninit::uninit() }; CAPACITY], size: 0 };
        let mut enters: Enters = [const { Row::uninit() }; WIDTH];
        let (mut current, mut mask) = (view.outline.root, all);
        // SAFETY: as the caller promises; references lead to whole nodes and leaves, and everything below the top of the
        // stack has been written. Each node on the way down leaves at most seven others there, so a tree is never too
        // deep for it.
        unsafe {
            if are_few(current, mask) {
                // No box has been tested, so nothing is known of the distance.
                enters[0].clear();
                mask = self.tails.put(current, mask, &enters[0]);
            }
            loop {
                let place = base.add(current.byte());
                if mask != 0 && current.is_node() {
                    let children = self.intersect_children::<L::Wide>(place, mask, &mut enters);
                    let bottom = stack.size;
                    for child in 0..WIDTH {
                        let mut mask = children[child] & mask;
                        if mask == 0 {
                            continue;
                        }
                        let reference = reference::<node_format::Wide>(place, child);
                        if are_few(reference, mask) {
                            mask = self.tails.put(reference, mask, &enters[child]);
                            if mask == 0 {
                                continue;
                            }
                        }
                        prefetch::<node_format::Wide>(base, reference);
                        let enter = (*enters[child].at(mask.trailing_zeros() as usize)).to_bits();
                        if ANY {
                            stack.put::<false>(Entry { reference, enter, mask }, bottom);
                        } else {
                            stack.put::<true>(Entry { reference, enter, mask }, bottom);
                        }
                    }
                } else if mask != 0 {
                    self.leaf::<L::Wide, ANY>(place, current.blocks(), mask);
                }
                if stack.size == 0 {
                    return;
                }
                stack.size -= 1;
                let entry = stack.entries[stack.size].assume_init();
                (current, mask) = (entry.reference, entry.mask);
                if ANY {
                    mask &= !self.tails.found;
                }
            }
        }
    }

    /// For each child of a node, a bit for each ray that hits its box; those outside the mask have no meaning. For
    /// those in it, the distances at which they enter the boxes.
    ///
    /// # Safety
    /// As for [`Packet::walk_together`]; `node` must point to a node.
    #[inline(always)]
    unsafe fn intersect_children<W: Wide>(
        &self,
        node: *const u8,
        mask: u64,
        enters: &mut Enters,
    ) -> [u64; WIDTH] {
        let mut children = [0; WIDTH];
        let mut from = 0;
        while from < self.lanes {
            if mask >> from & ((1 << W::LANES) - 1) != 0 {
                // SAFETY: as the caller promises.
                unsafe { self.packet.intersect_children::<W>(node, from, &mut children, enters) };
            }
            from += W::LANES;
        }
        children
    }

    /// Makes all hits exact.
    ///
    /// # Safety
    /// As for [`Packet::walk_together`].
    #[inline(always)]
    unsafe fn resolve<W: Wide>(&mut self) {
        let mut from = 0;
        while from < self.lanes {
            // SAFETY: as the caller promises.
            unsafe {
                let lanes = self.mixed.lanes::<W>(from);
                Group::new(self.packet, lanes, self.query, from).resolve::<W>();
            }
            from += W::LANES;
        }
    }

    /// Tests a leaf with the rays of a mask.
    ///
    /// # Safety
    /// As for [`Packet::walk_together`]; `leaf` must point to a leaf.
    #[inline(always)]
    unsafe fn leaf<W: Wide, const ANY: bool>(&mut self, leaf: *const u8, blocks: usize, mask: u64) {
        let mut from = 0;
        while from < self.lanes {
            let mask = (mask >> from) as u32 & ((1 << W::LANES) - 1);
            if mask != 0 {
                // SAFETY: as the caller promises.
                unsafe {
                    let lanes = self.mixed.lanes::<W>(from);
                    let mut group = Group::new(self.packet, lanes, self.query, from);
                    let hits = group.test_leaf::<W, ANY>(leaf, blocks, mask);
                    if ANY {
                        self.tails.found |= u64::from(hits) << from;
                    } else if hits != 0 {
                        group.finish::<W>();
                    }
                }
            }
            from += W::LANES;
        }
    }
}
