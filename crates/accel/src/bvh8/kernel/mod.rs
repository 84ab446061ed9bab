//! Tree traversal: one body, written over what a level of instructions provides.
//!
//! Each wide level has one function per query that is compiled for its instructions, and all of the body is inlined
//! into it. The caller has checked that the machine supports them.
#![allow(unsafe_code)] // Loads by pointer and instructions of a level; each block says why it is sound.

/// The queries of a level, each compiled for its features with all of the body inlined.
#[cfg(target_arch = "x86_64")]
macro_rules! entries {
    ($level:ty, $features:literal) => {
        /// See [`super::closest`]; for [`crate::Query::PLAIN`].
        ///
        /// # Safety
        /// The machine must have the level, and the view must be sound; this applies to all that follow.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn closest<F: super::NodeFormat, C: $crate::counters::Count>(
            units: &[super::Unit],
            outline: &super::TreeSummary,
            ray: &$crate::Ray,
            count: &mut C,
        ) -> Option<$crate::Hit> {
            let view = super::TreeView { units, outline };
            // SAFETY: as the caller promises.
            unsafe { super::body::closest::<$level, F, C, true>(view, ray, &$crate::Query::PLAIN, count) }
        }

        /// See [`super::closest`].
        // SAFETY: as above.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn closest_by<F: super::NodeFormat, C: $crate::counters::Count>(
            view: super::TreeView<'_>,
            ray: &$crate::Ray,
            query: &$crate::Query,
            count: &mut C,
        ) -> Option<$crate::Hit> {
            // SAFETY: as the caller promises.
            unsafe { super::body::closest::<$level, F, C, false>(view, ray, query, count) }
        }

        /// See [`super::any`]; for [`crate::Query::PLAIN`].
        // SAFETY: as above.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn any<F: super::NodeFormat, C: $crate::counters::Count>(
            units: &[super::Unit],
            outline: &super::TreeSummary,
            ray: &$crate::Ray,
            count: &mut C,
        ) -> $crate::bvh8::kernel::Blocker {
            let view = super::TreeView { units, outline };
            // SAFETY: as the caller promises.
            unsafe { super::body::any::<$level, F, C, true>(view, ray, &$crate::Query::PLAIN, count) }
        }

        /// See [`super::any`].
        // SAFETY: as above.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn any_by<F: super::NodeFormat, C: $crate::counters::Count>(
            view: super::TreeView<'_>,
            ray: &$crate::Ray,
            query: &$crate::Query,
            count: &mut C,
        ) -> $crate::bvh8::kernel::Blocker {
            // SAFETY: as the caller promises.
            unsafe { super::body::any::<$level, F, C, false>(view, ray, query, count) }
        }
    };
}
#[cfg(target_arch = "x86_64")]
use entries;

/// The same for batches, at levels that support them.
#[cfg(target_arch = "x86_64")]
macro_rules! batch_entries {
    ($level:ty, $features:literal) => {
        /// See [`super::closest_each`].
        // SAFETY: as above.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn closest_each(
            view: super::TreeView<'_>,
            rays: &[$crate::Ray],
            query: &$crate::Query,
            hits: &mut [Option<$crate::Hit>],
        ) {
            let rays = &rays[..rays.len().min(hits.len())];
            // SAFETY: as the caller promises.
            unsafe { super::batch::each::<$level, false>(view, rays, query, |index, hit| hits[index] = hit) }
        }

        /// See [`super::any_each`].
        // SAFETY: as above.
        #[target_feature(enable = $features)]
        pub(super) unsafe fn any_each(
            view: super::TreeView<'_>,
            rays: &[$crate::Ray],
            query: &$crate::Query,
            blockers: &mut [$crate::bvh8::kernel::Blocker],
        ) {
            let rays = &rays[..rays.len().min(blockers.len())];
            let note = |index: usize, hit: Option<$crate::Hit>| {
                blockers[index] = hit.and_then(|hit| super::blocker(hit.primitive));
            };
            // SAFETY: as the caller promises.
            unsafe { super::batch::each::<$level, true>(view, rays, query, note) }
        }
    };
}
#[cfg(target_arch = "x86_64")]
use batch_entries;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod batch;
#[cfg(target_arch = "x86_64")]
mod block;
#[cfg(target_arch = "x86_64")]
mod body;
mod compact;
#[cfg(target_arch = "x86_64")]
mod doubles;
#[cfg(target_arch = "x86_64")]
mod lane_ray;
#[cfg(target_arch = "x86_64")]
mod leaf;
#[cfg(target_arch = "x86_64")]
mod level;
mod node_format;
#[cfg(target_arch = "x86_64")]
mod packet;
mod plain;
#[cfg(target_arch = "x86_64")]
mod sse42;
#[cfg(target_arch = "x86_64")]
mod stack;
#[cfg(target_arch = "x86_64")]
mod stream;

use super::layout::Unit;
use super::summary::TreeSummary;
use crate::counters::{Count, NoCounters};
use crate::cpu_level::CpuLevel;
use crate::ray::{Hit, Query, Ray};
use std::num::NonZero;

pub(super) use compact::Compact;
pub(super) use node_format::{NodeFormat, Wide};

/// A primitive that a ray hits, if there is one: its complement, so that the whole fits into one register. No primitive
/// has the number `u32::MAX`.
pub(super) type Blocker = Option<NonZero<u32>>;

#[inline(always)]
fn blocker(primitive: u32) -> Blocker {
    NonZero::new(!primitive)
}

/// The primitive of a [`Blocker`].
#[inline(always)]
pub(super) fn primitive(blocker: NonZero<u32>) -> u32 {
    !blocker.get()
}

/// The tree to traverse. The root is a node or a leaf of `units`, and so is everything that it refers to.
#[derive(Clone, Copy)]
pub(super) struct TreeView<'a> {
    pub(super) units: &'a [Unit],
    pub(super) outline: &'a TreeSummary,
}

impl<'a> TreeView<'a> {
    /// `None` for a tree without triangles.
    #[inline(always)]
    pub(super) fn of(units: &'a [Unit], outline: &'a TreeSummary) -> Option<TreeView<'a>> {
        (!units.is_empty()).then_some(TreeView { units, outline })
    }
}

/// One query at a level: by the kernel for [`Query::PLAIN`], or by the one for all other queries.
#[cfg(target_arch = "x86_64")]
macro_rules! ask {
    ($level:ident, $plain:ident, $other:ident, $view:expr, $ray:expr, $query:expr, $count:expr) => {
        // SAFETY: a structure holds a level that `available` found on this machine.
        unsafe {
            if $query.is_plain() {
                $level::$plain::<F, C>($view.units, $view.outline, $ray, $count)
            } else {
                $level::$other::<F, C>($view, $ray, $query, $count)
            }
        }
    };
}

/// The nearest hit.
#[inline(always)]
pub(super) fn closest<F: NodeFormat, C: Count>(
    level: CpuLevel,
    view: TreeView<'_>,
    ray: &Ray,
    query: &Query,
    count: &mut C,
) -> Option<Hit> {
    match level {
        #[cfg(target_arch = "x86_64")]
        CpuLevel::Avx512 => ask!(avx512, closest, closest_by, view, ray, query, count),
        #[cfg(target_arch = "x86_64")]
        CpuLevel::Avx2 => ask!(avx2, closest, closest_by, view, ray, query, count),
        _ => closest_at_lower_levels::<F, C>(level, view, ray, query, count),
    }
}

/// [`closest`] for the lower levels. Separate, so that the choice between the others stays two comparisons.
#[inline(never)]
fn closest_at_lower_levels<F: NodeFormat, C: Count>(
    level: CpuLevel,
    view: TreeView<'_>,
    ray: &Ray,
    query: &Query,
    count: &mut C,
) -> Option<Hit> {
    match level {
        #[cfg(target_arch = "x86_64")]
        CpuLevel::Sse42 => ask!(sse42, closest, closest_by, view, ray, query, count),
        _ => plain::closest::<F, C>(view, ray, query, count),
    }
}

/// A primitive that the ray hits, if there is one.
#[inline(always)]
pub(super) fn any<F: NodeFormat, C: Count>(
    level: CpuLevel,
    view: TreeView<'_>,
    ray: &Ray,
    query: &Query,
    count: &mut C,
) -> Blocker {
    match level {
        #[cfg(target_arch = "x86_64")]
        CpuLevel::Avx512 => ask!(avx512, any, any_by, view, ray, query, count),
        #[cfg(target_arch = "x86_64")]
        CpuLevel::Avx2 => ask!(avx2, any, any_by, view, ray, query, count),
        _ => any_at_lower_levels::<F, C>(level, view, ray, query, count),
    }
}

/// [`any`] for the lower levels. Separate, so that the choice between the others stays two comparisons.
#[inline(never)]
fn any_at_lower_levels<F: NodeFormat, C: Count>(
    level: CpuLevel,
    view: TreeView<'_>,
    ray: &Ray,
    query: &Query,
    count: &mut C,
) -> Blocker {
    match level {
        #[cfg(target_arch = "x86_64")]
        CpuLevel::Sse42 => ask!(sse42, any, any_by, view, ray, query, count),
        _ => plain::any::<F, C>(view, ray, query, count),
    }
}

/// The nearest hit of each ray.
pub(super) fn closest_each(
    level: CpuLevel,
    view: TreeView<'_>,
    rays: &[Ray],
    query: &Query,
    hits: &mut [Option<Hit>],
) {
    match level {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: a structure holds a level that `available` found on this machine.
        CpuLevel::Avx512 => unsafe { avx512::closest_each(view, rays, query, hits) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        CpuLevel::Avx2 => unsafe { avx2::closest_each(view, rays, query, hits) },
        _ => {
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = closest::<Wide, _>(level, view, ray, query, &mut NoCounters);
            }
        }
    }
}

/// For each ray a primitive that it hits, if there is one.
pub(super) fn any_each(
    level: CpuLevel,
    view: TreeView<'_>,
    rays: &[Ray],
    query: &Query,
    blockers: &mut [Blocker],
) {
    match level {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        CpuLevel::Avx512 => unsafe { avx512::any_each(view, rays, query, blockers) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        CpuLevel::Avx2 => unsafe { avx2::any_each(view, rays, query, blockers) },
        _ => {
            for (ray, blocker) in rays.iter().zip(blockers) {
                *blocker = any::<Wide, _>(level, view, ray, query, &mut NoCounters);
            }
        }
    }
}
