//! A ray at a leaf.
//!
//! The ray is prepared for triangles here, each time: many rays reach no leaf, and most reach one. The black box
//! keeps the compiler from hoisting that work to before it is known to be needed.

use super::block::{BlockRay, Crossings};
use super::blocker::{Blocker, blocker};
use super::level::Level;
use super::node_format::NodeFormat;
use crate::bvh8::layout::{LANES, Unit};
use crate::ray::{Culling, Hit, Query, Ray};
use std::hint::black_box;

/// Address of a leaf, and its number of blocks.
pub(super) type Leaf = (*const u8, usize);

pub(super) const fn block_bytes<F: NodeFormat>() -> usize {
    F::BLOCK_UNITS * size_of::<Unit>()
}

/// Keeps the nearest hit, ties to the lowest primitive. No mesh has a primitive as high as the one that stands for no
/// hit.
///
/// # Safety
/// The machine must have the level, the ray must be regular, and the leaf must be one.
#[inline(always)]
pub(super) unsafe fn closest<L: Level, F: NodeFormat, const PLAIN: bool>(
    ray: &Ray,
    (leaf, blocks): Leaf,
    query: &Query,
    nearest: &mut Hit,
) {
    // SAFETY: as the caller promises.
    unsafe {
        let block_ray = BlockRay::new::<L>(black_box(ray));
        for index in 0..blocks {
            let block = leaf.add(index * block_bytes::<F>());
            let candidates = block_ray.signs::<L, F>(block, ray.exclude.index);
            if candidates.is_empty() {
                continue;
            }
            let culling = if PLAIN { Culling::None } else { query.culling };
            let crossings = block_ray.cross::<L::Doubles>(&candidates, (ray.t_min, nearest.t), culling);
            let mask = crossings.mask();
            if mask == 0 {
                continue;
            }
            if PLAIN && mask & (mask - 1) == 0 {
                let lane = mask.trailing_zeros() as usize & (LANES - 1);
                let (t, [u, v]) = (crossings.t(), crossings.weights());
                let (t, primitive) = (t[lane], primitive::<F>(block, lane));
                if t < nearest.t || primitive < nearest.primitive {
                    *nearest = Hit { t, u: u[lane], v: v[lane], primitive, instance: 0 };
                }
            } else {
                update_nearest::<F, PLAIN>(block, &crossings, query, nearest);
            }
        }
    }
}

/// # Safety
/// As for [`closest`].
#[inline(always)]
unsafe fn update_nearest<F: NodeFormat, const PLAIN: bool>(
    block: *const u8,
    crossings: &Crossings,
    query: &Query,
    nearest: &mut Hit,
) {
    // SAFETY: as the caller promises.
    unsafe {
        let mut left = crossings.mask();
        let (t, weights) = (crossings.t(), crossings.weights());
        while left != 0 {
            let lane = left.trailing_zeros() as usize & (LANES - 1);
            left &= left - 1;
            let primitive = primitive::<F>(block, lane);
            if t[lane] < nearest.t || (t[lane] == nearest.t && primitive < nearest.primitive) {
                let hit =
                    Hit { t: t[lane], u: weights[0][lane], v: weights[1][lane], primitive, instance: 0 };
                if PLAIN || query.accepts(&hit) {
                    *nearest = hit;
                }
            }
        }
    }
}

/// A primitive that the ray hits, if there is one.
///
/// # Safety
/// As for [`closest`].
#[inline(always)]
pub(super) unsafe fn any<L: Level, F: NodeFormat, const PLAIN: bool>(
    ray: &Ray,
    (leaf, blocks): Leaf,
    query: &Query,
) -> Blocker {
    // SAFETY: as the caller promises.
    unsafe {
        let block_ray = BlockRay::new::<L>(black_box(ray));
        for index in 0..blocks {
            let block = leaf.add(index * block_bytes::<F>());
            let candidates = block_ray.signs::<L, F>(block, ray.exclude.index);
            if candidates.is_empty() {
                continue;
            }
            let culling = if PLAIN { Culling::None } else { query.culling };
            let crossings = block_ray.cross::<L::Doubles>(&candidates, (ray.t_min, ray.t_max), culling);
            if crossings.mask() == 0 {
                continue;
            }
            if PLAIN {
                let lane = crossings.mask().trailing_zeros() as usize & (LANES - 1);
                return blocker(primitive::<F>(block, lane));
            }
            let found = accepted::<F>(block, &crossings, query);
            if found.is_some() {
                return found;
            }
        }
    }
    None
}

/// The primitive of a crossing that the filter lets count.
///
/// # Safety
/// As for [`closest`].
#[inline(never)]
unsafe fn accepted<F: NodeFormat>(block: *const u8, crossings: &Crossings, query: &Query) -> Blocker {
    // SAFETY: as the caller promises.
    let (t, [u, v], mask) = unsafe { (crossings.t(), crossings.weights(), crossings.mask()) };
    (0..LANES).filter(|lane| mask >> lane & 1 == 1).find_map(|lane| {
        // SAFETY: as above.
        let primitive = unsafe { primitive::<F>(block, lane) };
        let hit = Hit { t: t[lane], u: u[lane], v: v[lane], primitive, instance: 0 };
        if query.accepts(&hit) { blocker(primitive) } else { None }
    })
}

/// The primitive of a triangle.
///
/// # Safety
/// `block` must point to a block, and `lane` be below [`LANES`].
#[inline(always)]
unsafe fn primitive<F: NodeFormat>(block: *const u8, lane: usize) -> u32 {
    // SAFETY: a block has four primitives.
    unsafe { *block.add(F::PRIMITIVES).cast::<u32>().add(lane) }
}
