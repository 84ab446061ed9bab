//! Motions one after the other.

use super::{Course, Motion, ROUNDING, SLACK, moved_by};
use crate::Aabb;
use std::sync::Arc;

impl Motion {
    /// The motions that this one is composed of, none of which is composed itself; the first is applied first.
    pub fn parts(&self) -> &[Motion] {
        match &self.course {
            Course::Chain(parts) => parts,
            _ => std::slice::from_ref(self),
        }
    }

    /// This motion, then `next`, as a chain. Neighbours that do not move become one transform.
    pub(super) fn followed_by(&self, next: &Motion) -> Motion {
        let (mut parts, mut rest) = (self.parts().to_vec(), next.parts());
        if let (Some(last), Some((first, others))) = (parts.last_mut(), rest.split_first())
            && let Some((a, b)) = last.static_transform().zip(first.static_transform())
        {
            *last = Motion::still(a.then(b));
            rest = others;
        }
        parts.extend_from_slice(rest);
        Motion { course: Course::Chain(Arc::new(parts)) }
    }
}

/// [`Motion::bounds_over`] of a chain: each part moves the box of the parts before it.
///
/// The product of all matrices is rounded to f32 once. That changes it by less than rounding each of them would, which
/// the box of each part allows for.
pub(super) fn bounds_over(parts: &[Motion], bounds: &Aabb, seconds: [f32; 2]) -> Aabb {
    parts.iter().fold(*bounds, |bounds, part| match part.static_transform() {
        Some(transform) => moved_by(transform, &bounds, ROUNDING),
        None => part.bounds_over(&bounds, seconds),
    })
}

/// [`Motion::stretch_over`] of a chain.
pub(super) fn stretch_over(parts: &[Motion], seconds: [f32; 2]) -> [f64; 2] {
    parts.iter().fold([1.0; 2], |[grow, shrink], part| {
        let [g, s] = part.stretch_over(seconds);
        [grow * g * SLACK, shrink * s * SLACK]
    })
}
