//! Several rays at once, each on a way of its own: while one waits for memory, the others go on.
//!
//! A step takes a ray through one node or leaf, asks for what comes next, and hands over to the next ray.

use super::body::{Level, Room, Stack, choose};
use super::leaf;
use super::packet::{self, Packet};
use super::tame::TameRay;
use super::{View, plain};
use crate::bvh8::layout::Ref;
use crate::counters::Nothing;
use crate::ray::{Hit, Query, Ray};
use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};

/// Rays on the way at once.
const WAYS: usize = 4;

/// A ray on its way.
struct Walk<'r> {
    /// Its number.
    index: usize,
    ray: &'r Ray,
    tame: TameRay,
    nearest: Hit,
    limit_bits: u32,
    current: Ref,
    stack: Stack,
}

/// Answers each ray by its number: with its nearest hit or, where `ANY`, with whichever is found first.
///
/// # Safety
/// The machine must have the level, and the view must be sound.
#[inline(always)]
pub(super) unsafe fn each<L: Level, const ANY: bool>(
    view: View<'_>,
    rays: &[Ray],
    query: &Query,
    mut answer: impl FnMut(usize, Option<Hit>),
) {
    let mut packet = Packet::new();
    // SAFETY: as the caller promises.
    unsafe {
        for (number, chunk) in rays.chunks(packet::RAYS).enumerate() {
            let first = number * packet::RAYS;
            expect(rays.as_ptr().wrapping_add(first + packet::RAYS));
            let rays = chunk;
            let mut answer = |index: usize, hit: Option<Hit>| answer(first + index, hit);
            if !packet::each::<L, ANY>(view, &mut packet, rays, query, &mut answer) {
                apart::<L, ANY>(view, rays, query, &mut answer);
            }
        }
    }
}

/// Answers rays that have nothing to do with each other.
///
/// # Safety
/// As for [`each`].
#[inline(always)]
unsafe fn apart<L: Level, const ANY: bool>(
    view: View<'_>,
    rays: &[Ray],
    query: &Query,
    answer: &mut impl FnMut(usize, Option<Hit>),
) {
    let base = view.units.as_ptr().cast::<u8>();
    let mut waiting = rays.iter().enumerate();
    let mut rooms = [const { Room::uninit() }; WAYS];
    let mut walks: Vec<Walk<'_>> = Vec::with_capacity(WAYS);
    let mut way = 0;
    // SAFETY: as the caller promises.
    unsafe {
        for room in &mut rooms {
            let Some(ray) = next::<ANY>(&view, &mut waiting, query, answer) else { break };
            walks.push(Walk::new(&view, ray, Stack::new(room)));
        }
        while !walks.is_empty() {
            way = if way < walks.len() { way } else { 0 };
            let walk = &mut walks[way];
            if walk.step::<L, ANY>(base, query) {
                way += 1;
                continue;
            }
            answer(walk.index, (walk.nearest.primitive != u32::MAX).then_some(walk.nearest));
            match next::<ANY>(&view, &mut waiting, query, answer) {
                Some(ray) => walk.restart(&view, ray),
                None => drop(walks.swap_remove(way)),
            }
        }
    }
}

/// The next ray that is tame; those before it are answered.
///
/// # Safety
/// As for [`each`].
#[inline(always)]
unsafe fn next<'r, const ANY: bool>(
    view: &View<'_>,
    waiting: &mut impl Iterator<Item = (usize, &'r Ray)>,
    query: &Query,
    answer: &mut impl FnMut(usize, Option<Hit>),
) -> Option<(usize, &'r Ray, TameRay)> {
    const SOMETHING: Hit = Hit { t: 0.0, u: 0.0, v: 0.0, primitive: 0, instance: 0 };
    for (index, ray) in waiting {
        // SAFETY: as the caller promises.
        match unsafe { TameRay::new(ray, view) } {
            Some(tame) => return Some((index, ray, tame)),
            None if ANY => answer(index, plain::any(*view, ray, query, &mut Nothing).then_some(SOMETHING)),
            None => answer(index, plain::closest(*view, ray, query, &mut Nothing)),
        }
    }
    None
}

impl<'r> Walk<'r> {
    #[inline(always)]
    fn new(view: &View<'_>, (index, ray, tame): (usize, &'r Ray, TameRay), stack: Stack) -> Walk<'r> {
        let nearest = Hit { t: ray.t_max, u: 0.0, v: 0.0, primitive: u32::MAX, instance: 0 };
        let limit_bits = tame.limit_bits(nearest.t);
        Walk { index, ray, tame, nearest, limit_bits, current: view.root, stack }
    }

    #[inline(always)]
    fn restart(&mut self, view: &View<'_>, (index, ray, tame): (usize, &'r Ray, TameRay)) {
        self.nearest = Hit { t: ray.t_max, primitive: u32::MAX, ..self.nearest };
        self.limit_bits = tame.limit_bits(ray.t_max);
        (self.index, self.ray, self.tame, self.current) = (index, ray, tame, view.root);
        self.stack.clear();
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
                let (mask, enter) = L::meet(&self.tame.boxes, place, L::splat(self.limit_bits));
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
            } else if self.leaf::<L, ANY>(place, query) {
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
    unsafe fn leaf<L: Level, const ANY: bool>(&mut self, place: *const u8, query: &Query) -> bool {
        let before = self.nearest.t;
        let leaf = (place, self.current.blocks());
        // SAFETY: as the caller promises.
        unsafe {
            if ANY {
                let found = leaf::any(self.ray, self.tame.steepest, leaf, query);
                self.nearest.primitive = if found { 0 } else { u32::MAX };
                return found;
            }
            leaf::closest(self.ray, self.tame.steepest, leaf, query, &mut self.nearest);
        }
        if query.early_out && self.nearest.t < before {
            self.limit_bits = self.tame.limit_bits(self.nearest.t);
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

/// Asks for the lines of the next rays.
///
/// # Safety
/// None is needed: a prefetch reads nothing.
#[inline(always)]
unsafe fn expect(rays: *const Ray) {
    for line in 0..size_of::<Ray>() * packet::RAYS / 64 {
        // SAFETY: a prefetch reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(rays.cast::<i8>().wrapping_add(line * 64)) };
    }
}

/// Asks for the lines of a node, or of the first block of a leaf.
///
/// # Safety
/// None is needed: a prefetch reads nothing.
#[inline(always)]
unsafe fn prefetch(base: *const u8, reference: Ref) {
    // SAFETY: a prefetch reads nothing.
    unsafe {
        let place = base.wrapping_add(reference.byte()).cast::<i8>();
        for line in 0..4 {
            _mm_prefetch::<_MM_HINT_T0>(place.wrapping_add(line * 64));
        }
    }
}
