//! Incoherent rays: together as far as they share their path, then each on its own.
//!
//! Where the tree is larger than the near caches, several rays are traversed at once: a step takes a ray through one
//! node or leaf, prefetches what comes next, and hands over to the next ray, which proceeds while the first would
//! wait.

use super::blocker::{primitive, somewhere};
use super::body::{self, Start, choose, prefetch};
use super::leaf;
use super::level::{BatchLevel, Boxes};
use super::node_format::Wide;
use super::packet::{Lane, Packet, Ready, Tails};
use super::stack::{Stack, StackStorage};
use super::view::TreeView;
use crate::bvh8::layout::Ref;
use crate::counters::NoCounters;
use crate::ray::{Hit, Query, Ray};

/// Rays in traversal at once.
const RAYS_IN_FLIGHT: usize = 8;

/// Units of a tree that fit into the near caches: four megabytes.
const NEAR_UNITS: usize = 8 << 14;

/// Answers the rays of a packet that are regular.
///
/// # Safety
/// The machine must have the level, the view must be sound, and the packet must be prepared.
#[inline(always)]
pub(super) unsafe fn each<L: BatchLevel, const ANY: bool, const PLAIN: bool>(
    view: TreeView<'_>,
    (packet, ready): (&mut Packet, &Ready),
    rays: &[Ray],
    query: &Query,
    answer: &mut impl FnMut(usize, Option<Hit>),
) {
    let mut tails = Tails::new();
    // SAFETY: as the caller promises.
    unsafe { packet.walk_together::<L, ANY>(&view, ready, query, &mut tails) };
    let mut rest = Rest { packet, ready, rays, tails: &tails, left: ready.regular & ready.asked };
    // SAFETY: as the caller promises; the packet has been walked together.
    unsafe {
        if view.units.len() > NEAR_UNITS {
            return interleaved::<L, ANY, PLAIN>(view, &mut rest, query, answer);
        }
        let mut storage = StackStorage::uninit();
        while let Some((index, lane, start)) = rest.next::<ANY>(Stack::new(&mut storage), answer) {
            let ray = (&rays[index], &lane);
            answer(
                index,
                if ANY {
                    let found = body::search_any::<L, Wide, NoCounters, PLAIN>(
                        view,
                        ray,
                        start,
                        query,
                        &mut NoCounters,
                    );
                    found.map(somewhere)
                } else {
                    body::search::<L, Wide, NoCounters, PLAIN>(view, ray, start, query, &mut NoCounters)
                },
            );
        }
    }
}

/// The rays of a packet that have been walked together, and still need an answer.
struct Rest<'p> {
    packet: &'p Packet,
    ready: &'p Ready,
    rays: &'p [Ray],
    tails: &'p Tails,
    /// A bit for each.
    left: u64,
}

impl<'p> Rest<'p> {
    /// Answers rays that need no search of their own; returns the first that does, with its index. The stack must be
    /// empty.
    ///
    /// # Safety
    /// The packet must have been walked together.
    #[inline(always)]
    unsafe fn next<const ANY: bool>(
        &mut self,
        mut stack: Stack,
        answer: &mut impl FnMut(usize, Option<Hit>),
    ) -> Option<(usize, Lane<'p>, Start)> {
        while self.left != 0 {
            let index = self.left.trailing_zeros() as usize;
            self.left &= self.left - 1;
            if ANY && self.tails.found >> index & 1 == 1 {
                // SAFETY: as the caller promises.
                answer(index, Some(unsafe { self.packet.found(index).0 }));
                continue;
            }
            // SAFETY: as the caller promises.
            unsafe {
                let (nearest, limit_bits) = self.packet.found(index);
                self.tails.fill::<ANY>(index, limit_bits, &mut stack);
                if stack.is_empty() {
                    answer(index, (nearest.primitive != u32::MAX).then_some(nearest));
                    continue;
                }
                let current = stack.take_reference();
                let lane = self.packet.lane(index, self.ready);
                return Some((index, lane, Start { current, stack, nearest, limit_bits }));
            }
        }
        None
    }
}

/// # Safety
/// As for [`each`].
#[inline(always)]
unsafe fn interleaved<L: BatchLevel, const ANY: bool, const PLAIN: bool>(
    view: TreeView<'_>,
    rest: &mut Rest<'_>,
    query: &Query,
    answer: &mut impl FnMut(usize, Option<Hit>),
) {
    let base = view.units.as_ptr().cast::<u8>();
    let mut storages = [const { StackStorage::uninit() }; RAYS_IN_FLIGHT];
    let mut walks = [const { None::<Walk<'_>> }; RAYS_IN_FLIGHT];
    let mut active = 0;
    for storage in &mut storages {
        // SAFETY: as the caller promises.
        let Some(walk) = (unsafe { Walk::next::<ANY>(base, rest, Stack::new(storage), answer) }) else {
            break;
        };
        walks[active] = Some(walk);
        active += 1;
    }
    let mut slot = 0;
    while active > 0 {
        slot = if slot < active { slot } else { 0 };
        let Some(walk) = &mut walks[slot] else { return };
        // SAFETY: as the caller promises.
        if unsafe { walk.step::<L, ANY, PLAIN>(base, query) } {
            slot += 1;
            continue;
        }
        answer(walk.index, (walk.nearest.primitive != u32::MAX).then_some(walk.nearest));
        // SAFETY: as the caller promises.
        match unsafe { Walk::next::<ANY>(base, rest, walk.stack.cleared(), answer) } {
            Some(next) => {
                *walk = next;
                slot += 1;
            }
            None => {
                active -= 1;
                walks.swap(slot, active);
            }
        }
    }
}

/// A ray in traversal.
struct Walk<'r> {
    /// Index of the ray.
    index: usize,
    ray: &'r Ray,
    lane: Lane<'r>,
    nearest: Hit,
    limit_bits: u32,
    current: Ref,
    stack: Stack,
}

impl<'r> Walk<'r> {
    /// # Safety
    /// As for [`each`].
    #[inline(always)]
    unsafe fn next<const ANY: bool>(
        base: *const u8,
        rest: &mut Rest<'r>,
        stack: Stack,
        answer: &mut impl FnMut(usize, Option<Hit>),
    ) -> Option<Walk<'r>> {
        // SAFETY: as the caller promises.
        let (index, lane, start) = unsafe { rest.next::<ANY>(stack, answer)? };
        prefetch::<Wide>(base, start.current);
        let Start { current, stack, nearest, limit_bits } = start;
        Some(Walk { index, ray: &rest.rays[index], lane, nearest, limit_bits, current, stack })
    }

    /// One node or leaf; false when none is left.
    ///
    /// # Safety
    /// As for [`each`].
    #[inline(always)]
    unsafe fn step<L: BatchLevel, const ANY: bool, const PLAIN: bool>(
        &mut self,
        base: *const u8,
        query: &Query,
    ) -> bool {
        // SAFETY: as the caller promises; references lead to whole nodes and leaves.
        unsafe {
            let place = base.add(self.current.byte());
            if self.current.is_node() {
                let (mask, enter) =
                    L::intersect_children::<Wide, _>(&self.lane, place, L::splat(self.limit_bits));
                if mask != 0 {
                    self.current = if ANY {
                        L::push::<Wide>(place, mask, &mut self.stack);
                        self.stack.take_reference()
                    } else {
                        choose::<L, Wide>(base, place, mask, enter, &mut self.stack)
                    };
                    prefetch::<Wide>(base, self.current);
                    return true;
                }
            } else if self.leaf::<L, ANY, PLAIN>(place, query) {
                return false;
            }
            self.advance::<ANY>(base)
        }
    }

    /// Tests the triangles of a leaf; true when that ends the search.
    ///
    /// # Safety
    /// As for [`each`].
    #[inline(always)]
    unsafe fn leaf<L: BatchLevel, const ANY: bool, const PLAIN: bool>(
        &mut self,
        place: *const u8,
        query: &Query,
    ) -> bool {
        let before = self.nearest.t;
        let leaf = (place, self.current.blocks());
        // SAFETY: as the caller promises.
        unsafe {
            if ANY {
                let found = leaf::any::<L, Wide, PLAIN>(self.ray, leaf, query);
                self.nearest.primitive = found.map_or(u32::MAX, primitive);
                return found.is_some();
            }
            leaf::closest::<L, Wide, PLAIN>(self.ray, leaf, query, &mut self.nearest);
        }
        if (PLAIN || query.early_out) && self.nearest.t < before {
            self.limit_bits = self.lane.limit_bits(self.nearest.t);
        }
        false
    }

    /// Continues with the next entry of the stack; false when it is empty.
    ///
    /// # Safety
    /// As for [`each`].
    #[inline(always)]
    unsafe fn advance<const ANY: bool>(&mut self, base: *const u8) -> bool {
        while !self.stack.is_empty() {
            // SAFETY: the stack is not empty; the entries of an any-hit search have no distance.
            unsafe {
                let (reference, enter) =
                    if ANY { (self.stack.take_reference(), 0) } else { self.stack.take() };
                self.current = reference;
                if enter <= self.limit_bits | 7 {
                    prefetch::<Wide>(base, self.current);
                    return true;
                }
            }
        }
        false
    }
}
