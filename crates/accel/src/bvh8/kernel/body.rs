//! The body of the wide kernels, which is the same for all levels.

use super::leaf;
use super::packet::Wide;
use super::tame::{Boxes, TameRay};
use super::{View, plain};
use crate::bvh8::build::binary::MAX_DEPTH;
use crate::bvh8::layout::{LANES, Ref, WIDTH};
use crate::counters::Count;
use crate::ray::{Hit, Query, Ray};
use std::arch::x86_64::{__m256i, _MM_HINT_T0, _mm_prefetch, _mm256_set1_epi32};
use std::mem::MaybeUninit;

/// What a level of instructions does with a node. Distances are the bits of floats that are not negative.
///
/// # Safety
/// Functions must be called only on machines that have the level, with pointers to whole nodes and stacks
/// with room for [`WIDTH`] more.
pub(super) trait Level {
    /// What holds a group of rays.
    type Wide: Wide;
    /// A bit for each lane where the first is not greater.
    unsafe fn at_most(enter: __m256i, leave: __m256i) -> u32;
    /// One bit of each of eight masks.
    unsafe fn column(masks: &[u64; WIDTH], bit: usize) -> u32;
    /// A bit for each child whose box the ray meets up to the limit, and where it enters them.
    #[inline(always)]
    unsafe fn meet<B: Boxes>(ray: &B, node: *const u8, limit: __m256i) -> (u32, __m256i) {
        // SAFETY: as the trait demands.
        unsafe {
            let (enter, leave) = ray.span(node, limit);
            (Self::at_most(enter, leave), enter)
        }
    }
    // SAFETY: as the trait says.
    /// Puts the children of the mask on the stack, the nearest on top.
    unsafe fn push_sorted(node: *const u8, mask: u32, enter: __m256i, stack: &mut Stack);
    /// Puts the node on the stack once for each child of the mask, the nearest on top; the last three bits of the
    /// distance say which child.
    unsafe fn push_children(node: Ref, mask: u32, enter: __m256i, stack: &mut Stack);
    // SAFETY: as the trait says.
    /// Puts the children of the mask on the stack, in any order.
    unsafe fn push(node: *const u8, mask: u32, stack: &mut Stack);
    /// The same distance for all.
    #[inline(always)]
    unsafe fn splat(bits: u32) -> __m256i {
        // SAFETY: as the trait demands.
        unsafe { _mm256_set1_epi32(bits as i32) }
    }
}

/// The distances, one by one.
#[inline(always)]
pub(super) fn lanes(distances: __m256i) -> [u32; WIDTH] {
    // SAFETY: both are 32 bytes.
    unsafe { std::mem::transmute(distances) }
}

/// Every node on the way down leaves at most seven others behind; a whole vector is written at the top.
const ROOM: usize = MAX_DEPTH * (WIDTH - 1) + 2 * WIDTH;

/// Where a stack lies: first the references, then where the ray enters each. Not written before it is used: to clear
/// it would take as long as a short ray.
pub(super) type Room = MaybeUninit<[u32; 2 * ROOM]>;

/// What is still to be visited, and the bits of where the ray enters it, the last three of no meaning.
#[derive(Clone, Copy)]
pub(super) struct Stack {
    base: *mut u32,
    top: *mut u32,
}

impl Stack {
    /// An empty one, that must not be used longer than its room.
    #[inline(always)]
    pub(super) fn new(room: &mut Room) -> Stack {
        let base = room.as_mut_ptr().cast();
        Stack { base, top: base }
    }

    #[inline(always)]
    pub(super) fn is_empty(&self) -> bool {
        self.top == self.base
    }

    /// The same without anything on it.
    #[inline(always)]
    pub(super) fn cleared(&self) -> Stack {
        Stack { base: self.base, top: self.base }
    }

    /// Where the next reference goes, and those behind it.
    #[inline(always)]
    pub(super) fn references(&self) -> *mut u32 {
        self.top
    }

    /// Where the distance of the next reference goes.
    #[inline(always)]
    pub(super) fn distances(&self) -> *mut u32 {
        self.top.wrapping_add(ROOM)
    }

    /// What was written behind the top belongs to the stack.
    ///
    /// # Safety
    /// It must have been written, and there must be room for [`WIDTH`] more.
    #[inline(always)]
    pub(super) unsafe fn grow(&mut self, by: usize) {
        // SAFETY: the tree is not deeper than there is room for.
        self.top = unsafe { self.top.add(by) };
    }

    /// # Safety
    /// As for [`Stack::grow`].
    #[inline(always)]
    pub(super) unsafe fn put(&mut self, reference: Ref, enter: u32) {
        // SAFETY: as above.
        unsafe {
            self.references().write(reference.0);
            self.distances().write(enter);
            self.grow(1);
        }
    }

    /// # Safety
    /// The stack must not be empty.
    #[inline(always)]
    pub(super) unsafe fn take_reference(&mut self) -> Ref {
        // SAFETY: everything below the top has been written.
        unsafe {
            self.top = self.top.sub(1);
            Ref(self.top.read())
        }
    }

    /// # Safety
    /// The stack must not be empty, and hold distances.
    #[inline(always)]
    pub(super) unsafe fn take(&mut self) -> (Ref, u32) {
        // SAFETY: as above.
        unsafe { (self.take_reference(), self.distances().read()) }
    }
}

/// The reference to a child.
#[inline(always)]
pub(super) unsafe fn reference(node: *const u8, child: usize) -> Ref {
    // SAFETY: a node holds its references behind six rows of 32 bytes.
    unsafe { Ref(*node.add(192 + child * 4).cast::<u32>()) }
}

/// Asks for the lines of a node, or of the first block of a leaf, so that they are there when their turn comes.
#[inline(always)]
pub(super) fn prefetch(base: *const u8, reference: Ref) {
    let place = base.wrapping_add(reference.byte()).cast::<i8>();
    for line in 0..4 {
        // SAFETY: a prefetch reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(place.wrapping_add(line * 64)) };
    }
}

/// The nearest of the children of a mask that is not zero; the others go to the stack, the nearer on top.
#[inline(always)]
pub(super) unsafe fn choose<L: Level>(
    base: *const u8,
    node: *const u8,
    mask: u32,
    enter: __m256i,
    stack: &mut Stack,
) -> Ref {
    // SAFETY: as the caller promises.
    unsafe {
        let first = mask.trailing_zeros() as usize;
        let rest = mask & (mask - 1);
        if rest == 0 {
            return reference(node, first);
        }
        let second = rest.trailing_zeros() as usize;
        let others = rest & (rest - 1);
        if others == 0 {
            let distances = lanes(enter);
            let (a, b) = (reference(node, first), reference(node, second));
            let (near, far) = (distances[first & 7], distances[second & 7]);
            let swap = far < near;
            let later = if swap { a } else { b };
            prefetch(base, later);
            stack.put(later, if swap { near } else { far });
            return if swap { b } else { a };
        }
        L::push_sorted(node, mask, enter, stack);
        let nearest = stack.take_reference();
        // Of those that wait, the next only: how many wait nobody can foresee.
        prefetch(base, Ref(*stack.references().sub(1)));
        nearest
    }
}

/// See [`super::closest`].
///
/// # Safety
/// The machine must have the level, and the view must be sound.
#[inline(always)]
pub(super) unsafe fn closest<L: Level, C: Count, const PLAIN: bool>(
    view: View<'_>,
    ray: &Ray,
    query: &Query,
    count: &mut C,
) -> Option<Hit> {
    // SAFETY: as the caller promises; references lead to whole nodes and leaves.
    unsafe {
        match TameRay::new(ray, &view) {
            Some(tame) => search::<L, C, PLAIN>(view, (ray, &tame, 0), query, count),
            None => plain::closest(view, ray, query, count),
        }
    }
}

/// The nearest hit of a ray that is ready for boxes. `met` says which children of the root it meets; 0 that nobody
/// has looked.
///
/// # Safety
/// As for [`closest`]; the ray must be tame.
#[inline(always)]
pub(super) unsafe fn search<L: Level, C: Count, const PLAIN: bool>(
    view: View<'_>,
    (ray, tame, met): (&Ray, &impl Boxes, u32),
    query: &Query,
    count: &mut C,
) -> Option<Hit> {
    // SAFETY: as the caller promises; references lead to whole nodes and leaves.
    unsafe {
        let base = view.units.as_ptr().cast::<u8>();
        let mut nearest = Hit { t: ray.t_max, u: 0.0, v: 0.0, primitive: u32::MAX, instance: 0 };
        let mut room = Room::uninit();
        let mut stack = Stack::new(&mut room);
        let mut current = start(base, view.outline.root, met);
        let mut limit_bits = tame.limit_bits(nearest.t);
        let mut limit = L::splat(limit_bits);
        loop {
            count.node();
            let place = base.add(current.byte());
            if current.is_node() {
                let (mask, enter) = L::meet(tame, place, limit);
                count_early_outs::<L, C>(tame, place, mask, count);
                if mask != 0 {
                    current = choose::<L>(base, place, mask, enter, &mut stack);
                    continue;
                }
            } else {
                count.triangles(current.blocks() * LANES);
                let before = nearest.t;
                leaf::closest::<PLAIN>(ray, (place, current.blocks()), query, &mut nearest);
                if (PLAIN || query.early_out) && nearest.t < before {
                    limit_bits = tame.limit_bits(nearest.t);
                    limit = L::splat(limit_bits);
                }
            }
            loop {
                if stack.is_empty() {
                    return (nearest.primitive != u32::MAX).then_some(nearest);
                }
                let (reference, enter) = stack.take();
                current = reference;
                if enter <= limit_bits | 7 {
                    break;
                }
                count.early_out();
            }
        }
    }
}

/// Where a search begins: at the root, or at the only child that is met.
///
/// # Safety
/// The root must be one.
#[inline(always)]
pub(super) unsafe fn start(base: *const u8, root: Ref, met: u32) -> Ref {
    if met != 0 && met & (met - 1) == 0 {
        // SAFETY: only of nodes is it known what is met.
        return unsafe { reference(base.add(root.byte()), met.trailing_zeros() as usize) };
    }
    root
}

/// The same where any order will do.
///
/// # Safety
/// The machine must have the level, and the root must be one.
#[inline(always)]
pub(super) unsafe fn start_any<L: Level>(base: *const u8, root: Ref, met: u32, stack: &mut Stack) -> Ref {
    if met == 0 {
        return root;
    }
    // SAFETY: as above.
    unsafe {
        L::push(base.add(root.byte()), met, stack);
        stack.take_reference()
    }
}

/// See [`super::any`].
///
/// # Safety
/// As for [`closest`].
#[inline(always)]
pub(super) unsafe fn any<L: Level, C: Count, const PLAIN: bool>(
    view: View<'_>,
    ray: &Ray,
    query: &Query,
    count: &mut C,
) -> bool {
    // SAFETY: as the caller promises; references lead to whole nodes and leaves.
    unsafe {
        match TameRay::new(ray, &view) {
            Some(tame) => search_any::<L, C, PLAIN>(view, (ray, &tame, 0), query, count),
            None => plain::any(view, ray, query, count),
        }
    }
}

/// Whether a ray that is ready for boxes hits anything; `met` as of [`search`].
///
/// # Safety
/// As for [`search`].
#[inline(always)]
pub(super) unsafe fn search_any<L: Level, C: Count, const PLAIN: bool>(
    view: View<'_>,
    (ray, tame, met): (&Ray, &impl Boxes, u32),
    query: &Query,
    count: &mut C,
) -> bool {
    // SAFETY: as the caller promises; references lead to whole nodes and leaves.
    unsafe {
        let base = view.units.as_ptr().cast::<u8>();
        let mut room = Room::uninit();
        let mut stack = Stack::new(&mut room);
        let mut current = start_any::<L>(base, view.outline.root, met, &mut stack);
        let limit = L::splat(tame.limit_bits(ray.t_max));
        loop {
            count.node();
            let place = base.add(current.byte());
            if current.is_node() {
                let (mask, _) = L::meet(tame, place, limit);
                if mask != 0 {
                    L::push(place, mask, &mut stack);
                    current = stack.take_reference();
                    continue;
                }
            } else {
                count.triangles(current.blocks() * LANES);
                if leaf::any::<PLAIN>(ray, (place, current.blocks()), query) {
                    return true;
                }
            }
            if stack.is_empty() {
                return false;
            }
            current = stack.take_reference();
        }
    }
}

/// Subtrees left out because a hit is nearer, where anybody wants to know.
///
/// # Safety
/// As for [`closest`].
#[inline(always)]
unsafe fn count_early_outs<L: Level, C: Count>(
    boxes: &impl Boxes,
    node: *const u8,
    mask: u32,
    count: &mut C,
) {
    if count.counters().is_some() {
        // SAFETY: as the caller promises.
        let (all, _) = unsafe { L::meet(boxes, node, L::splat(f32::INFINITY.to_bits())) };
        for _ in 0..(all & !mask).count_ones() {
            count.early_out();
        }
    }
}
