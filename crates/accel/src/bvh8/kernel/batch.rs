//! Many rays at once: prepared in vectors, then traced as a packet where they are coherent, else each on its own
//! path.

use super::blocker::somewhere;
use super::level::BatchLevel;
use super::node_format::Wide;
use super::packet::{self, Packet};
use super::view::TreeView;
use super::{body, plain, stream};
use crate::counters::NoCounters;
use crate::ray::{Hit, Query, Ray};

/// Batches of fewer rays than this are traced one by one, which is faster.
const FEW: usize = 8;

/// Answers each ray by its index: with its nearest hit or, where `ANY`, with a primitive
/// that it hits.
///
/// # Safety
/// The machine must have the level, and the view must be sound.
#[inline(always)]
pub(super) unsafe fn each<L: BatchLevel, const ANY: bool>(
    view: TreeView<'_>,
    rays: &[Ray],
    query: &Query,
    mut answer: impl FnMut(usize, Option<Hit>),
) {
    let mut packet = Packet::new();
    let mut begin = 0;
    while begin < rays.len() {
        let chunk = &rays[begin..rays.len().min(begin + packet::RAYS)];
        let mut answer = |index: usize, hit: Option<Hit>| answer(begin + index, hit);
        // SAFETY: as the caller promises.
        unsafe {
            if chunk.len() < FEW {
                for (index, ray) in chunk.iter().enumerate() {
                    answer(index, one::<L, ANY>(view, ray, query));
                }
            } else {
                let ready = packet.prepare::<L>(chunk, &view);
                if !packet::each::<L, ANY>(view, (&mut packet, &ready), chunk, query, &mut answer) {
                    irregular::<ANY>(view, (ready.irregular, chunk), query, &mut answer);
                    if query.is_plain() {
                        stream::each::<L, ANY, true>(view, (&mut packet, &ready), chunk, query, &mut answer);
                    } else {
                        stream::each::<L, ANY, false>(view, (&mut packet, &ready), chunk, query, &mut answer);
                    }
                }
            }
        }
        begin += chunk.len();
    }
}

/// # Safety
/// As for [`each`].
#[inline(always)]
unsafe fn one<L: BatchLevel, const ANY: bool>(view: TreeView<'_>, ray: &Ray, query: &Query) -> Option<Hit> {
    // SAFETY: as the caller promises.
    unsafe {
        if ANY {
            body::any::<L, Wide, NoCounters, false>(view, ray, query, &mut NoCounters).map(somewhere)
        } else {
            body::closest::<L, Wide, NoCounters, false>(view, ray, query, &mut NoCounters)
        }
    }
}

/// Answers those rays of a mask that are not regular.
#[inline(always)]
fn irregular<const ANY: bool>(
    view: TreeView<'_>,
    (mask, rays): (u64, &[Ray]),
    query: &Query,
    answer: &mut impl FnMut(usize, Option<Hit>),
) {
    let mut left = mask;
    while left != 0 {
        let index = left.trailing_zeros() as usize;
        left &= left - 1;
        if ANY {
            let found = plain::any::<Wide, _>(view, &rays[index], query, &mut NoCounters);
            answer(index, found.map(somewhere));
        } else {
            answer(index, plain::closest::<Wide, _>(view, &rays[index], query, &mut NoCounters));
        }
    }
}
