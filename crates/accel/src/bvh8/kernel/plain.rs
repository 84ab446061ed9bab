//! The reference that the wide kernels are tested against, for every machine and every ray: the box tests of
//! [`SlabRay`] and the triangle test itself.

use super::blocker::{Blocker, blocker};
use super::node_format::NodeFormat;
use super::view::TreeView;
use crate::bvh8::build::binary::MAX_DEPTH;
use crate::bvh8::layout::{LANES, NO_TRIANGLE, Ref, WIDTH};
use crate::counters::Count;
use crate::ray::{Hit, Query, Ray};
use crate::slab::SlabRay;
use crate::triangle::{Nearest, PreparedRay, hits};
use std::ops::ControlFlow;

#[inline(never)]
pub(super) fn closest<F: NodeFormat, C: Count>(
    view: TreeView<'_>,
    ray: &Ray,
    query: &Query,
    count: &mut C,
) -> Option<Hit> {
    let (prepared, slabs) = prepare(&view, ray)?;
    let mut nearest = Nearest::new(ray);
    let mut limit = slabs.limit(nearest.t);
    walk::<F, C>(view, &slabs, limit, count, |leaf, count| {
        let before = nearest.t;
        for (block, lane) in places::<F>(leaf) {
            let (corners, primitive) = F::triangle(view.units, block, lane);
            if primitive == NO_TRIANGLE {
                break;
            }
            nearest.test(&prepared, query, &corners, primitive);
        }
        count.triangles(leaf.blocks() * LANES);
        if query.early_out && nearest.t < before {
            limit = slabs.limit(nearest.t);
        }
        ControlFlow::Continue(limit)
    });
    nearest.hit()
}

#[inline(never)]
pub(super) fn any<F: NodeFormat, C: Count>(
    view: TreeView<'_>,
    ray: &Ray,
    query: &Query,
    count: &mut C,
) -> Blocker {
    let (prepared, slabs) = prepare(&view, ray)?;
    let limit = slabs.limit(ray.t_max);
    let mut found = None;
    walk::<F, C>(view, &slabs, limit, count, |leaf, count| {
        for (block, lane) in places::<F>(leaf) {
            let (corners, primitive) = F::triangle(view.units, block, lane);
            if primitive == NO_TRIANGLE {
                break;
            }
            count.triangles(1);
            if hits(&prepared, query, &corners, primitive) {
                found = blocker(primitive);
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(limit)
    });
    found
}

fn prepare(view: &TreeView<'_>, ray: &Ray) -> Option<(PreparedRay, SlabRay)> {
    let prepared = PreparedRay::new(ray)?;
    let pad = prepared.pad(&view.outline.bounds());
    Some((prepared, SlabRay::new(ray.origin, ray.direction, ray.t_min, pad)))
}

/// The first unit of each block of a leaf, with each lane of the block.
fn places<F: NodeFormat>(leaf: Ref) -> impl Iterator<Item = (usize, usize)> {
    let blocks = (0..leaf.blocks()).map(move |block| leaf.unit() + block * F::BLOCK_UNITS);
    blocks.flat_map(|block| (0..LANES).map(move |lane| (block, lane)))
}

/// A subtree that is still to be visited, and the distance at which the ray enters it.
#[derive(Clone, Copy)]
struct StackEntry {
    reference: Ref,
    enter: f32,
}

/// Visits the leaves that the ray hits up to `limit`, roughly nearest first.
#[inline(always)]
fn walk<F: NodeFormat, C: Count>(
    view: TreeView<'_>,
    ray: &SlabRay,
    mut limit: f32,
    count: &mut C,
    mut leaf: impl FnMut(Ref, &mut C) -> ControlFlow<(), f32>,
) {
    let mut stack =
        [StackEntry { reference: view.outline.root, enter: f32::NEG_INFINITY }; MAX_DEPTH * (WIDTH - 1) + 1];
    let mut height = 1;
    while height > 0 {
        height -= 1;
        let StackEntry { reference, enter } = stack[height];
        // The comparisons are written so that a NaN, which overflow may produce, excludes nothing.
        if enter > limit {
            count.early_out();
            continue;
        }
        count.node();
        if !reference.is_node() {
            match leaf(reference, count) {
                ControlFlow::Continue(lower) => limit = lower,
                ControlFlow::Break(()) => return,
            }
            continue;
        }
        let node = &view.units[reference.unit()..];
        let base = height;
        for child in 0..WIDTH {
            let (planes, reference) = F::child(node, child);
            let [enter, leave] = ray.span(&planes);
            if reference == Ref::EMPTY || enter > leave || leave < ray.nearest {
                continue;
            }
            if enter > limit {
                count.early_out();
                continue;
            }
            // Insertion sort, so that the nearest is popped first.
            let mut place = height;
            while place > base && stack[place - 1].enter < enter {
                stack[place] = stack[place - 1];
                place -= 1;
            }
            stack[place] = StackEntry { reference, enter };
            height += 1;
        }
    }
}
