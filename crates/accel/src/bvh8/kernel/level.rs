//! The operations on a node that a level of instructions provides.

use super::axes::Reorder;
use super::doubles::Doubles;
use super::node_format::{NodeFormat, reference};
use super::stack::Stack;
use super::view::TreeView;
use super::wide::Wide;
use crate::bvh8::layout::{Ref, WIDTH};
use crate::ray::Ray;
use std::arch::x86_64::__m256i;

/// A level, as the traversal by a single ray needs it. Distances are the bits of non-negative floats.
///
/// # Safety
/// Functions must be called only on machines that have the level, with pointers to whole nodes and with stacks that
/// have space for [`WIDTH`] more entries.
pub(in crate::bvh8) trait Level: Reorder {
    /// A distance for each child.
    type Eight: Copy;
    /// A ray that is prepared for boxes.
    type LaneRay: Boxes<Eight = Self::Eight>;
    /// A number for each triangle of a block, for the exact stage.
    type Doubles: Doubles;
    // SAFETY: as the trait says.
    /// `None` for rays that are not regular, or can hit nothing.
    unsafe fn prepare(ray: &Ray, view: &TreeView<'_>) -> Option<Self::LaneRay>;
    /// Copies a distance into all lanes.
    unsafe fn splat(bits: u32) -> Self::Eight;
    /// A bit for each lane where the first is less than or equal to the second.
    unsafe fn at_most(enter: Self::Eight, leave: Self::Eight) -> u32;
    /// A bit for each child whose box the ray hits up to the limit, and the distances at which it enters them.
    #[inline(always)]
    unsafe fn intersect_children<F: NodeFormat, B: Boxes<Eight = Self::Eight>>(
        ray: &B,
        node: *const u8,
        limit: Self::Eight,
    ) -> (u32, Self::Eight) {
        // SAFETY: as the trait demands.
        unsafe {
            let (enter, leave) = ray.span::<F>(node, limit);
            (Self::at_most(enter, leave) & F::occupied(node), enter)
        }
    }
    /// Puts the children of the mask on the stack, the nearest on top.
    ///
    /// By insertion sort.
    // SAFETY: as the trait demands.
    #[inline(always)]
    unsafe fn push_sorted<F: NodeFormat>(node: *const u8, mask: u32, enter: Self::Eight, stack: &mut Stack) {
        // SAFETY: as the trait demands.
        unsafe {
            let distances = lanes::<Self>(enter);
            let (references, enters) = (stack.references(), stack.distances());
            let (mut left, mut size) = (mask, 0);
            while left != 0 {
                let child = left.trailing_zeros() as usize & 7;
                left &= left - 1;
                let mut place = size;
                size += 1;
                while place > 0 && *enters.add(place - 1) < distances[child] {
                    *enters.add(place) = *enters.add(place - 1);
                    *references.add(place) = *references.add(place - 1);
                    place -= 1;
                }
                *enters.add(place) = distances[child];
                *references.add(place) = reference::<F>(node, child).0;
            }
            stack.grow(size);
        }
    }
    /// Puts the children of the mask on the stack, in any order.
    // SAFETY: as the trait demands.
    #[inline(always)]
    unsafe fn push<F: NodeFormat>(node: *const u8, mask: u32, stack: &mut Stack) {
        let mut left = mask;
        while left != 0 {
            let child = left.trailing_zeros() as usize;
            left &= left - 1;
            // SAFETY: as the trait demands.
            unsafe { stack.put(reference::<F>(node, child), 0) };
        }
    }
}

/// A level, as batches of rays need it.
///
/// # Safety
/// As for [`Level`].
pub(super) trait BatchLevel: Level<Eight = __m256i> {
    /// The vector type that holds a group of rays.
    type Wide: Wide;
    // SAFETY: as the trait says.
    /// Pushes the node onto the stack once for each child of the mask, the nearest on top; the last three bits of the
    /// distance say which child.
    unsafe fn push_children(node: Ref, mask: u32, enter: __m256i, stack: &mut Stack);
}

/// A ray that can be tested against boxes.
pub(in crate::bvh8) trait Boxes {
    /// A distance for each child.
    type Eight;

    /// The distances at which the ray enters the children of a node, and at which it leaves them or reaches the
    /// limit.
    ///
    /// # Safety
    /// The machine must have the level that the ray was prepared for, and `node` must point to a node.
    unsafe fn span<F: NodeFormat>(&self, node: *const u8, limit: Self::Eight) -> (Self::Eight, Self::Eight);

    /// The bits of the smallest distance, as in [`Boxes::span`], that no hit at `t` or before can exceed; `t` is not
    /// negative, or nothing can be hit.
    fn limit_bits(&self, t: f32) -> u32;
}

/// The distances, one by one.
#[inline(always)]
pub(super) fn lanes<L: Level + ?Sized>(distances: L::Eight) -> [u32; WIDTH] {
    const { assert!(size_of::<L::Eight>() == size_of::<[u32; WIDTH]>()) }
    // SAFETY: both are 32 bytes, and every bit pattern is an integer.
    unsafe { std::mem::transmute_copy(&distances) }
}
