//! The body of the wide kernels, which is the same for all levels.

use super::View;
use super::block::{BlockRay, Sheared};
use crate::bvh8::build::binary::MAX_DEPTH;
use crate::bvh8::layout::{BLOCK_UNITS, LANES, Ref, Unit, WIDTH};
use crate::bvh8::ray::WideRay;
use crate::counters::Count;
use crate::ray::{Hit, Query};
use crate::triangle::{Crossing, Nearest, counts};
use std::mem::MaybeUninit;

/// What a level of instructions does with a node. Distances are those of [`WideRay`] as the bits of floats that
/// are not negative, which compare like whole numbers.
///
/// # Safety
/// Functions must be called only on machines that have the level, with pointers to whole nodes and stacks
/// with room for [`WIDTH`] more.
pub(super) trait Level {
    /// A tame ray, a lane for each child.
    type Ray: Copy;
    /// Distances to the children.
    type Distances: Copy;

    unsafe fn ray(ray: &WideRay) -> Self::Ray;
    unsafe fn splat(bits: i32) -> Self::Distances;
    /// A bit for each child whose box the ray meets up to the limit, and where it enters them.
    unsafe fn meet(ray: &Self::Ray, node: *const u8, limit: Self::Distances) -> (u32, Self::Distances);
    unsafe fn array(distances: Self::Distances) -> [u32; WIDTH];
    /// Puts the children of the mask on the stack, the nearest on top.
    unsafe fn push_sorted(node: *const u8, mask: u32, enter: Self::Distances, stack: &mut Stack);
    /// Puts the children of the mask on the stack, in any order.
    unsafe fn push(node: *const u8, mask: u32, stack: &mut Stack);
}

/// Every node on the way down leaves at most seven others behind; a whole vector is written at the top.
const ROOM: usize = MAX_DEPTH * (WIDTH - 1) + 2 * WIDTH;

/// What is still to be visited, and the bits of where the ray enters it, the last three of no meaning.
pub(super) struct Stack {
    pub(super) references: [MaybeUninit<Ref>; ROOM],
    pub(super) enter: [MaybeUninit<u32>; ROOM],
    pub(super) height: usize,
}

impl Stack {
    #[inline(always)]
    fn new() -> Stack {
        Stack { references: [MaybeUninit::uninit(); ROOM], enter: [MaybeUninit::uninit(); ROOM], height: 0 }
    }

    #[inline(always)]
    pub(super) unsafe fn put(&mut self, reference: Ref, enter: u32) {
        // SAFETY: the tree is not deeper than there is room for.
        unsafe {
            self.references.get_unchecked_mut(self.height).write(reference);
            self.enter.get_unchecked_mut(self.height).write(enter);
        }
        self.height += 1;
    }

    #[inline(always)]
    unsafe fn take(&mut self) -> (Ref, u32) {
        self.height -= 1;
        // SAFETY: everything below the height has been written.
        unsafe {
            let reference = self.references.get_unchecked(self.height).assume_init();
            (reference, self.enter.get_unchecked(self.height).assume_init())
        }
    }
}

/// The reference to a child.
#[inline(always)]
pub(super) unsafe fn reference(node: *const u8, child: usize) -> Ref {
    // SAFETY: a node holds its references behind six rows of 32 bytes.
    unsafe { Ref(*node.add(192 + child * 4).cast::<u32>()) }
}

/// The nearest of the children of a mask that is not zero; the others go to the stack, the nearer on top.
#[inline(always)]
unsafe fn choose<L: Level>(node: *const u8, mask: u32, enter: L::Distances, stack: &mut Stack) -> Ref {
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
            let distances = L::array(enter);
            let (a, b) = (reference(node, first), reference(node, second));
            let (near, far) = (distances[first & 7], distances[second & 7]);
            let swap = far < near;
            stack.put(if swap { a } else { b }, if swap { near } else { far });
            return if swap { b } else { a };
        }
        L::push_sorted(node, mask, enter, stack);
        stack.take().0
    }
}

/// See [`super::closest`].
///
/// # Safety
/// The machine must have the level, the ray must be tame, and the view sound.
#[inline(always)]
pub(super) unsafe fn closest<L: Level, C: Count>(
    view: View<'_>,
    ray: &WideRay,
    query: &Query,
    count: &mut C,
) -> Option<Hit> {
    let base = view.units.as_ptr().cast::<u8>();
    let mut nearest = Nearest::new(&ray.prepared.ray);
    let mut stack = Stack::new();
    let mut current = view.root;
    // SAFETY: as the caller promises; references lead to whole nodes and leaves.
    unsafe {
        let (boxes, blocks) = (L::ray(ray), BlockRay::new(&ray.prepared));
        let mut limit_bits = ray.slabs.limit(nearest.t).to_bits();
        let mut limit = L::splat(limit_bits as i32);
        loop {
            count.node();
            let place = base.add(current.byte());
            if current.is_node() {
                let (mask, enter) = L::meet(&boxes, place, limit);
                count_early_outs::<L, C>(&boxes, place, mask, count);
                if mask != 0 {
                    current = choose::<L>(place, mask, enter, &mut stack);
                    continue;
                }
            } else {
                let before = nearest.t;
                for index in 0..current.blocks() {
                    let block = place.add(index * BLOCK_BYTES);
                    count.triangles(LANES);
                    let (mut mask, sheared) = blocks.signs(block);
                    while mask != 0 {
                        let lane = mask.trailing_zeros() as usize;
                        mask &= mask - 1;
                        if let Some(crossing) = cross(ray, &sheared, lane) {
                            nearest.offer(&ray.prepared, query.culling, crossing, primitive(block, lane));
                        }
                    }
                }
                if query.early_out && nearest.t < before {
                    limit_bits = ray.slabs.limit(nearest.t).to_bits();
                    limit = L::splat(limit_bits as i32);
                }
            }
            loop {
                if stack.height == 0 {
                    return nearest.hit();
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
pub(super) unsafe fn any<L: Level, C: Count>(
    view: View<'_>,
    ray: &WideRay,
    query: &Query,
    count: &mut C,
) -> bool {
    let base = view.units.as_ptr().cast::<u8>();
    let t_max = ray.prepared.ray.t_max;
    let mut stack = Stack::new();
    let mut current = view.root;
    // SAFETY: as the caller promises; references lead to whole nodes and leaves.
    unsafe {
        let (boxes, blocks) = (L::ray(ray), BlockRay::new(&ray.prepared));
        let limit = L::splat(ray.slabs.limit(t_max).to_bits() as i32);
        loop {
            count.node();
            let place = base.add(current.byte());
            if current.is_node() {
                let (mask, _) = L::meet(&boxes, place, limit);
                if mask != 0 {
                    L::push(place, mask, &mut stack);
                    current = stack.take().0;
                    continue;
                }
            } else {
                for index in 0..current.blocks() {
                    let block = place.add(index * BLOCK_BYTES);
                    count.triangles(LANES);
                    let (mut mask, sheared) = blocks.signs(block);
                    while mask != 0 {
                        let lane = mask.trailing_zeros() as usize;
                        mask &= mask - 1;
                        if cross(ray, &sheared, lane).is_some_and(|crossing| {
                            counts(&ray.prepared, query.culling, &crossing, primitive(block, lane), t_max)
                        }) {
                            return true;
                        }
                    }
                }
            }
            if stack.height == 0 {
                return false;
            }
            current = stack.take().0;
        }
    }
}

const BLOCK_BYTES: usize = BLOCK_UNITS * size_of::<Unit>();

#[inline(always)]
unsafe fn primitive(block: *const u8, lane: usize) -> u32 {
    // SAFETY: a block holds its primitives behind nine rows of 4 numbers.
    unsafe { *block.cast::<u32>().add(9 * LANES + lane) }
}

#[inline(always)]
unsafe fn cross(ray: &WideRay, sheared: &Sheared, lane: usize) -> Option<Crossing> {
    let corner = |corner: usize| {
        // SAFETY: the mask has a bit, so all of them have been written.
        std::array::from_fn(|axis| unsafe { sheared.0[axis][corner][lane & (LANES - 1)].assume_init() })
    };
    ray.prepared.cross_exactly(corner(0), corner(1), corner(2))
}

/// Subtrees left out because a hit is nearer, where anybody wants to know.
#[inline(always)]
unsafe fn count_early_outs<L: Level, C: Count>(boxes: &L::Ray, node: *const u8, mask: u32, count: &mut C) {
    if count.counters().is_some() {
        // SAFETY: as the caller promises.
        let (all, _) = unsafe { L::meet(boxes, node, L::splat(f32::INFINITY.to_bits() as i32)) };
        for _ in 0..(all & !mask).count_ones() {
            count.early_out();
        }
    }
}
