//! Primitives that block a ray.

#[cfg(target_arch = "x86_64")]
use crate::ray::Hit;
use std::num::NonZero;

/// A primitive that a ray hits, if there is one: its complement, so that the whole fits into one register. No primitive
/// has the number `u32::MAX`.
pub(in crate::bvh8) type Blocker = Option<NonZero<u32>>;

/// The [`Blocker`] of a primitive.
#[inline(always)]
pub(super) fn blocker(primitive: u32) -> Blocker {
    NonZero::new(!primitive)
}

/// The primitive of a [`Blocker`].
#[inline(always)]
pub(in crate::bvh8) fn primitive(blocker: NonZero<u32>) -> u32 {
    !blocker.get()
}

/// A hit somewhere on what a ray hits.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(super) fn somewhere(blocker: NonZero<u32>) -> Hit {
    on(primitive(blocker))
}

/// A hit somewhere on a primitive.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub(super) fn on(primitive: u32) -> Hit {
    Hit { t: 0.0, u: 0.0, v: 0.0, primitive, instance: 0 }
}
