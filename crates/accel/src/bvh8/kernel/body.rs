//! The body of the wide kernels, which is the same for all levels.

use super::blocker::Blocker;
use super::level::{Boxes, Level, lanes};
use super::node_format::{NodeFormat, reference};
use super::stack::{Stack, StackStorage};
use super::view::TreeView;
use super::{leaf, plain};
use crate::bvh8::layout::{LANES, Ref};
use crate::counters::Count;
use crate::ray::{Hit, Query, Ray};
use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
use std::hint::cold_path;

/// Prefetches the cache lines of a node, or of the first block of a leaf, so that they are there when needed.
#[inline(always)]
pub(super) fn prefetch<F: NodeFormat>(base: *const u8, reference: Ref) {
    let place = base.wrapping_add(reference.byte()).cast::<i8>();
    for line in 0..F::LINES {
        // SAFETY: a prefetch reads nothing.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(place.wrapping_add(line * 64)) };
    }
}

/// The nearest of the children of a non-zero mask; the others go onto the stack, nearer ones on top.
#[inline(always)]
pub(super) unsafe fn choose<L: Level, F: NodeFormat>(
    base: *const u8,
    node: *const u8,
    mask: u32,
    enter: L::Eight,
    stack: &mut Stack,
) -> Ref {
    // SAFETY: as the caller promises.
    unsafe {
        let first = mask.trailing_zeros() as usize;
        let rest = mask & (mask - 1);
        if rest == 0 {
            return reference::<F>(node, first);
        }
        let second = rest.trailing_zeros() as usize;
        let others = rest & (rest - 1);
        if others == 0 {
            let distances = lanes::<L>(enter);
            let (a, b) = (reference::<F>(node, first), reference::<F>(node, second));
            let (near, far) = (distances[first & 7], distances[second & 7]);
            let swap = far < near;
            let later = if swap { a } else { b };
            prefetch::<F>(base, later);
            stack.put(later, if swap { near } else { far });
            return if swap { b } else { a };
        }
        L::push_sorted::<F>(node, mask, enter, stack);
        let nearest = stack.take_reference();
        // Of those that wait, only the next: how many wait is unpredictable.
        prefetch::<F>(base, Ref(*stack.references().sub(1)));
        nearest
    }
}

/// See [`super::closest`].
///
/// # Safety
/// The machine must have the level, and the view must be sound.
#[inline(always)]
pub(super) unsafe fn closest<L: Level, F: NodeFormat, C: Count, const PLAIN: bool>(
    view: TreeView<'_>,
    ray: &Ray,
    query: &Query,
    count: &mut C,
) -> Option<Hit> {
    // SAFETY: as the caller promises; references lead to whole nodes and leaves.
    unsafe {
        match L::prepare(ray, &view) {
            Some(lane_ray) => {
                let mut storage = StackStorage::uninit();
                let start = Start::at_root(&view, ray, &lane_ray, &mut storage);
                search::<L, F, C, PLAIN>(view, (ray, &lane_ray), start, query, count)
            }
            None => plain::closest::<F, C>(view, ray, query, count),
        }
    }
}

/// Start of a search.
pub(super) struct Start {
    pub(super) current: Ref,
    /// References to visit later: at most [`super::stack::MAX_AT_START`].
    pub(super) stack: Stack,
    /// The nearest hit so far.
    pub(super) nearest: Hit,
    /// The bits of the distance up to which nodes count.
    pub(super) limit_bits: u32,
}

impl Start {
    /// At the root, with an empty stack.
    #[inline(always)]
    fn at_root(view: &TreeView<'_>, ray: &Ray, boxes: &impl Boxes, storage: &mut StackStorage) -> Start {
        let nearest = Hit { t: ray.t_max, u: 0.0, v: 0.0, primitive: u32::MAX, instance: 0 };
        let limit_bits = boxes.limit_bits(nearest.t);
        Start { current: view.outline.root, stack: Stack::new(storage), nearest, limit_bits }
    }
}

/// The nearest hit of a ray that is prepared for boxes.
///
/// # Safety
/// As for [`closest`]; the ray must be regular, and the start must hold references of the tree.
#[inline(always)]
pub(super) unsafe fn search<L: Level, F: NodeFormat, C: Count, const PLAIN: bool>(
    view: TreeView<'_>,
    (ray, lane_ray): (&Ray, &impl Boxes<Eight = L::Eight>),
    start: Start,
    query: &Query,
    count: &mut C,
) -> Option<Hit> {
    // SAFETY: as the caller promises; references lead to whole nodes and leaves.
    unsafe {
        let base = view.units.as_ptr().cast::<u8>();
        let Start { mut current, mut stack, mut nearest, mut limit_bits } = start;
        let mut limit = L::splat(limit_bits);
        loop {
            count.node();
            let place = base.add(current.byte());
            if current.is_node() {
                let (mask, enter) = L::intersect_children::<F, _>(lane_ray, place, limit);
                count_early_outs::<L, F, C>(lane_ray, place, mask, count);
                if mask != 0 {
                    current = choose::<L, F>(base, place, mask, enter, &mut stack);
                    continue;
                }
            } else {
                // Many rays reach no leaf: registers are kept for nodes, and saved only here.
                cold_path();
                count.triangles(current.blocks() * LANES);
                let before = nearest.t;
                leaf::closest::<L, F, PLAIN>(ray, (place, current.blocks()), query, &mut nearest);
                if (PLAIN || query.early_out) && nearest.t < before {
                    limit_bits = lane_ray.limit_bits(nearest.t);
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

/// See [`super::any`].
///
/// # Safety
/// As for [`closest`].
#[inline(always)]
pub(super) unsafe fn any<L: Level, F: NodeFormat, C: Count, const PLAIN: bool>(
    view: TreeView<'_>,
    ray: &Ray,
    query: &Query,
    count: &mut C,
) -> Blocker {
    // SAFETY: as the caller promises; references lead to whole nodes and leaves.
    unsafe {
        match L::prepare(ray, &view) {
            Some(lane_ray) => {
                let mut storage = StackStorage::uninit();
                let start = Start::at_root(&view, ray, &lane_ray, &mut storage);
                search_any::<L, F, C, PLAIN>(view, (ray, &lane_ray), start, query, count)
            }
            None => plain::any::<F, C>(view, ray, query, count),
        }
    }
}

/// A primitive that a ray hits which is prepared for boxes, if there is one.
///
/// # Safety
/// As for [`search`].
#[inline(always)]
pub(super) unsafe fn search_any<L: Level, F: NodeFormat, C: Count, const PLAIN: bool>(
    view: TreeView<'_>,
    (ray, lane_ray): (&Ray, &impl Boxes<Eight = L::Eight>),
    start: Start,
    query: &Query,
    count: &mut C,
) -> Blocker {
    // SAFETY: as the caller promises; references lead to whole nodes and leaves.
    unsafe {
        let base = view.units.as_ptr().cast::<u8>();
        let Start { mut current, mut stack, limit_bits, .. } = start;
        let limit = L::splat(limit_bits);
        loop {
            count.node();
            let place = base.add(current.byte());
            if current.is_node() {
                let (mask, _) = L::intersect_children::<F, _>(lane_ray, place, limit);
                if mask != 0 {
                    L::push::<F>(place, mask, &mut stack);
                    current = stack.take_reference();
                    continue;
                }
            } else {
                // As above.
                cold_path();
                count.triangles(current.blocks() * LANES);
                let found = leaf::any::<L, F, PLAIN>(ray, (place, current.blocks()), query);
                if found.is_some() {
                    return found;
                }
            }
            if stack.is_empty() {
                return None;
            }
            current = stack.take_reference();
        }
    }
}

/// Counts the subtrees that are skipped because a hit is nearer, if the caller counts at all.
///
/// # Safety
/// As for [`closest`].
#[inline(always)]
unsafe fn count_early_outs<L: Level, F: NodeFormat, C: Count>(
    boxes: &impl Boxes<Eight = L::Eight>,
    node: *const u8,
    mask: u32,
    count: &mut C,
) {
    if count.counters().is_some() {
        // SAFETY: as the caller promises.
        let (all, _) =
            unsafe { L::intersect_children::<F, _>(boxes, node, L::splat(f32::INFINITY.to_bits())) };
        for _ in 0..(all & !mask).count_ones() {
            count.early_out();
        }
    }
}
