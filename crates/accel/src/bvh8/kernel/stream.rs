//! Rays that have nothing to do with each other, each on a way of its own.
//!
//! Where the tree is larger than the near caches, several are on their way at once: a step takes a ray through one
//! node or leaf, asks for what comes next, and hands over to the next ray, which goes on while the first would wait.

use super::batch::SOMETHING;
use super::body::{self, Level, Room, Stack, choose};
use super::packet::{Lane, Packet, Ready};
use super::tame::Boxes;
use super::{View, leaf};
use crate::bvh8::layout::Ref;
use crate::counters::Nothing;
use crate::ray::{Hit, Query, Ray};
use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};

/// Rays on the way at once.
const WAYS: usize = 4;

/// Units of a tree that the near caches hold: a megabyte and a half.
const NEAR_UNITS: usize = 3 << 14;

/// Answers the rays of a packet that are tame.
///
/// # Safety
/// The machine must have the level, the view must be sound, and the packet must be ready.
#[inline(always)]
pub(super) unsafe fn each<L: Level, const ANY: bool>(
    view: View<'_>,
    (packet, ready): (&Packet, &Ready),
    rays: &[Ray],
    query: &Query,
    answer: &mut impl FnMut(usize, Option<Hit>),
) {
    let mut left = ready.tame;
    let mut next = || {
        let index = left.trailing_zeros() as usize;
        left &= left.wrapping_sub(1);
        (index < rays.len()).then(|| (index, &rays[index], packet.lane(index, ready)))
    };
    // SAFETY: as the caller promises.
    unsafe {
        if view.units.len() > NEAR_UNITS {
            return interleaved::<L, ANY>(view, &mut next, query, answer);
        }
        while let Some((index, ray, lane)) = next() {
            answer(
                index,
                if ANY {
                    let found = body::search_any::<L, Nothing>(view, (ray, &lane), query, &mut Nothing);
                    found.then_some(SOMETHING)
                } else {
                    body::search::<L, Nothing>(view, (ray, &lane), query, &mut Nothing)
                },
            );
        }
    }
}

/// # Safety
/// As for [`each`].
#[inline(always)]
unsafe fn interleaved<'r, L: Level, const ANY: bool>(
    view: View<'_>,
    next: &mut impl FnMut() -> Option<(usize, &'r Ray, Lane<'r>)>,
    query: &Query,
    answer: &mut impl FnMut(usize, Option<Hit>),
) {
    let base = view.units.as_ptr().cast::<u8>();
    let mut rooms = [const { Room::uninit() }; WAYS];
    let mut walks = [const { None::<Walk<'_>> }; WAYS];
    let mut active = 0;
    for room in &mut rooms {
        let Some(ray) = next() else { break };
        walks[active] = Some(Walk::new(&view, ray, Stack::new(room)));
        active += 1;
    }
    let mut way = 0;
    while active > 0 {
        way = if way < active { way } else { 0 };
        let Some(walk) = &mut walks[way] else { return };
        // SAFETY: as the caller promises.
        if unsafe { walk.step::<L, ANY>(base, query) } {
            way += 1;
            continue;
        }
        answer(walk.index, (walk.nearest.primitive != u32::MAX).then_some(walk.nearest));
        match next() {
            Some(ray) => *walk = Walk::new(&view, ray, walk.stack.cleared()),
            None => {
                active -= 1;
                walks.swap(way, active);
            }
        }
    }
}

/// A ray on its way.
struct Walk<'r> {
    /// Its number.
    index: usize,
    ray: &'r Ray,
    lane: Lane<'r>,
    nearest: Hit,
    limit_bits: u32,
    current: Ref,
    stack: Stack,
}

impl<'r> Walk<'r> {
    #[inline(always)]
    fn new(view: &View<'_>, (index, ray, lane): (usize, &'r Ray, Lane<'r>), stack: Stack) -> Walk<'r> {
        let nearest = Hit { t: ray.t_max, u: 0.0, v: 0.0, primitive: u32::MAX, instance: 0 };
        let limit_bits = lane.limit_bits(nearest.t);
        Walk { index, ray, lane, nearest, limit_bits, current: view.root, stack }
    }

    /// One node or leaf; false when there is none left.
    ///
    /// # Safety
    /// As for [`each`].
    #[inline(always)]
    unsafe fn step<L: Level, const ANY: bool>(&mut self, base: *const u8, query: &Query) -> bool {
        // SAFETY: as the caller promises; references lead to whole nodes and leaves.
        unsafe {
            let place = base.add(self.current.byte());
            if self.current.is_node() {
                let (mask, enter) = L::meet(&self.lane, place, L::splat(self.limit_bits));
                if mask != 0 {
                    self.current = if ANY {
                        L::push(place, mask, &mut self.stack);
                        self.stack.take_reference()
                    } else {
                        choose::<L>(place, mask, enter, &mut self.stack)
                    };
                    prefetch(base, self.current);
                    return true;
                }
            } else if self.leaf::<ANY>(place, query) {
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
    unsafe fn leaf<const ANY: bool>(&mut self, place: *const u8, query: &Query) -> bool {
        let before = self.nearest.t;
        let leaf = (place, self.current.blocks());
        // SAFETY: as the caller promises.
        unsafe {
            if ANY {
                let found = leaf::any(self.ray, leaf, query);
                self.nearest.primitive = if found { 0 } else { u32::MAX };
                return found;
            }
            leaf::closest(self.ray, leaf, query, &mut self.nearest);
        }
        if query.early_out && self.nearest.t < before {
            self.limit_bits = self.lane.limit_bits(self.nearest.t);
        }
        false
    }

    /// Goes on with what waits on the stack; false when nothing does.
    ///
    /// # Safety
    /// As for [`each`].
    #[inline(always)]
    unsafe fn next<const ANY: bool>(&mut self, base: *const u8) -> bool {
        while !self.stack.is_empty() {
            // SAFETY: something is there; what any hit puts there has no distance.
            unsafe {
                let (reference, enter) =
                    if ANY { (self.stack.take_reference(), 0) } else { self.stack.take() };
                self.current = reference;
                if enter <= self.limit_bits | 7 {
                    prefetch(base, self.current);
                    return true;
                }
            }
        }
        false
    }
}

/// Asks for the lines of a node, or of the first block of a leaf.
#[inline(always)]
fn prefetch(base: *const u8, reference: Ref) {
    let place = base.wrapping_add(reference.byte()).cast::<i8>();
    for line in 0..4 {
        // SAFETY: a prefetch reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(place.wrapping_add(line * 64)) };
    }
}
