//! Tree traversal: one body, written over what a level of instructions provides.
//!
//! Each wide level has one function per query that is compiled for its instructions, and all of the body is inlined
//! into it. The caller has checked that the machine supports them.
#![allow(unsafe_code)] // Loads by pointer and instructions of a level; each block says why it is sound.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "x86_64")]
mod axes;
#[cfg(target_arch = "x86_64")]
mod batch;
#[cfg(target_arch = "x86_64")]
mod block;
mod blocker;
#[cfg(target_arch = "x86_64")]
mod body;
mod compact;
#[cfg(target_arch = "x86_64")]
mod doubles;
#[cfg(target_arch = "x86_64")]
mod entries;
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
mod units;
mod view;
#[cfg(target_arch = "x86_64")]
mod wide;

use crate::CpuLevel;
use crate::counters::{Count, NoCounters};
use crate::ray::{Hit, Query, Ray};

pub(super) use blocker::{Blocker, primitive};
pub(super) use compact::Compact;
pub(super) use node_format::{NodeFormat, Wide};
pub(super) use units::{HEADER, Units};
pub(super) use view::TreeView;

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
