//! Incoherent rays, each on its own path.
//!
//! Where the tree is larger than the near caches, several rays are traversed at once: a step takes a ray through one
//! node or leaf, prefetches what comes next, and hands over to the next ray, which proceeds while the first would
//! wait.

use super::batch::SOMETHING;
use super::body::{self, choose, prefetch, start, start_any};
use super::level::{BatchLevel, Boxes};
use super::node_format::Wide;
use super::packet::{Lane, Packet, Ready};
use super::stack::{Stack, StackStorage};
use super::{TreeView, leaf};
use crate::bvh8::layout::{Ref, WIDTH};
use crate::counters::NoCounters;
use crate::ray::{Hit, Query, Ray};

/// Rays in traversal at once.
const RAYS_IN_FLIGHT: usize = 8;

/// Units of a tree that fit into the near caches: a megabyte and a half.
const NEAR_UNITS: usize = 3 << 14;

/// Answers the rays of a packet that are regular.
///
/// # Safety
/// The machine must have the level, the view must be sound, and the packet must be prepared.
#[inline(always)]
pub(super) unsafe fn each<L: BatchLevel, const ANY: bool, const PLAIN: bool>(
    view: TreeView<'_>,
    (packet, ready): (&Packet, &Ready),
    rays: &[Ray],
    query: &Query,
    answer: &mut impl FnMut(usize, Option<Hit>),
) {
    let base = view.units.as_ptr().cast::<u8>();
    let mut left = ready.regular & ready.asked;
    let mut children = [0; WIDTH];
    // SAFETY: as the caller promises.
    unsafe {
        if view.outline.root.is_node() {
            // The root, with all of them at once.
            children = packet.intersect_all_children::<L::Wide>(base.add(view.outline.root.byte()), ready);
            let [a, b, c, d, e, f, g, h] = children;
            let mut misses = left & !(a | b | c | d | e | f | g | h);
            left &= !misses;
            while misses != 0 {
                answer(misses.trailing_zeros() as usize, None);
                misses &= misses - 1;
            }
        }
        let mut next = || {
            let index = left.trailing_zeros() as usize;
            left &= left.wrapping_sub(1);
            let lane = |index| (packet.lane(index, ready), L::column(&children, index));
            (index < rays.len()).then(|| (index, &rays[index], lane(index)))
        };
        if view.units.len() > NEAR_UNITS {
            return interleaved::<L, ANY, PLAIN>(view, &mut next, query, answer);
        }
        while let Some((index, ray, (lane, root_hits))) = next() {
            answer(
                index,
                if ANY {
                    let found = body::search_any::<L, Wide, NoCounters, PLAIN>(
                        view,
                        (ray, &lane, root_hits),
                        query,
                        &mut NoCounters,
                    );
                    found.then_some(SOMETHING)
                } else {
                    body::search::<L, Wide, NoCounters, PLAIN>(
                        view,
                        (ray, &lane, root_hits),
                        query,
                        &mut NoCounters,
                    )
                },
            );
        }
    }
}

/// # Safety
/// As for [`each`].
#[inline(always)]
unsafe fn interleaved<'r, L: BatchLevel, const ANY: bool, const PLAIN: bool>(
    view: TreeView<'_>,
    next: &mut impl FnMut() -> Option<Next<'r>>,
    query: &Query,
    answer: &mut impl FnMut(usize, Option<Hit>),
) {
    let base = view.units.as_ptr().cast::<u8>();
    let mut storages = [const { StackStorage::uninit() }; RAYS_IN_FLIGHT];
    let mut walks = [const { None::<Walk<'_>> }; RAYS_IN_FLIGHT];
    let mut active = 0;
    for storage in &mut storages {
        let Some(ray) = next() else { break };
        // SAFETY: as the caller promises.
        walks[active] = Some(unsafe { Walk::new::<L, ANY, PLAIN>(&view, ray, Stack::new(storage)) });
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
        match next() {
            // SAFETY: as the caller promises.
            Some(ray) => *walk = unsafe { Walk::new::<L, ANY, PLAIN>(&view, ray, walk.stack.cleared()) },
            None => {
                active -= 1;
                walks.swap(slot, active);
            }
        }
    }
}

/// A ray's index, the ray itself, the ray prepared for boxes, and the children of the root that it hits.
type Next<'r> = (usize, &'r Ray, (Lane<'r>, u32));

/// A ray in traversal.
struct Walk<'r> {
    /// Its index.
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
    unsafe fn new<L: BatchLevel, const ANY: bool, const PLAIN: bool>(
        view: &TreeView<'_>,
        (index, ray, (lane, root_hits)): Next<'r>,
        mut stack: Stack,
    ) -> Walk<'r> {
        let nearest = Hit { t: ray.t_max, u: 0.0, v: 0.0, primitive: u32::MAX, instance: 0 };
        let limit_bits = lane.limit_bits(nearest.t);
        // SAFETY: as the caller promises.
        let current = unsafe {
            let base = view.units.as_ptr().cast::<u8>();
            if ANY {
                start_any::<L, Wide>(base, view.outline.root, root_hits, &mut stack)
            } else {
                start::<Wide>(base, view.outline.root, root_hits)
            }
        };
        Walk { index, ray, lane, nearest, limit_bits, current, stack }
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
            self.next::<ANY>(base)
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
                self.nearest.primitive = if found { 0 } else { u32::MAX };
                return found;
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
    unsafe fn next<const ANY: bool>(&mut self, base: *const u8) -> bool {
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
