//! Motions one after the other.

use super::{Course, Motion, Pose, ROUNDING, moved_by, similarity};
use crate::Aabb;
use std::sync::Arc;

impl Motion {
    /// First this motion, then `next`, at each time.
    pub fn then(&self, next: &Motion) -> Motion {
        match (self.static_transform(), next.static_transform()) {
            (Some(first), Some(next)) => return Motion::still(first.then(next)),
            (Some(first), None) if first.is_identity() => return next.clone(),
            (None, Some(next)) if next.is_identity() => return self.clone(),
            _ => {}
        }
        self.keys_moved_by(next).unwrap_or_else(|| self.followed_by(next))
    }

    /// A motion by keys, then a transform that is a similarity (a rotation, a uniform scale and a translation; uniform
    /// and orthogonal to within a thousandth), for which other keys describe the same motion.
    fn keys_moved_by(&self, next: &Motion) -> Option<Motion> {
        let Course::Keys(poses) = &self.course else { return None };
        let (scale, rotation, translation) = similarity(next.static_transform()?)?;
        let moved = poses.iter().map(|pose| Pose {
            time: pose.time,
            translation: translation + rotation * (pose.translation * scale),
            rotation: rotation * pose.rotation,
            scale: pose.scale * scale,
        });
        Some(Motion { course: Course::Keys(Arc::new(moved.collect())) })
    }

    /// The motions that this one is composed of, none of which is composed itself; the first is applied first.
    pub fn parts(&self) -> &[Motion] {
        match &self.course {
            Course::Chain(parts) => parts,
            _ => std::slice::from_ref(self),
        }
    }

    /// This motion, then `next`, as a chain. Neighbours that do not move become one transform.
    fn followed_by(&self, next: &Motion) -> Motion {
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

    /// [`Motion::bounds_over`] of a chain: each part moves the box of the parts before it.
    ///
    /// The product of all matrices is rounded to f32 once. That changes it by less than rounding each of them would, which
    /// the box of each part allows for.
    pub(super) fn bounds_of_all(parts: &[Motion], bounds: &Aabb, seconds: [f32; 2]) -> Aabb {
        parts.iter().fold(*bounds, |bounds, part| match part.static_transform() {
            Some(transform) => moved_by(transform, &bounds, ROUNDING),
            None => part.bounds_over(&bounds, seconds),
        })
    }

    /// [`Motion::stretch_over`] of a chain: the parts' bounds multiplied.
    ///
    /// Rounding the product to f32 changes no length by more than a part of the largest stretch, which may be much of the
    /// smallest.
    pub(super) fn stretch_of_all(parts: &[Motion], seconds: [f32; 2]) -> [f64; 2] {
        let [grow, shrink] = parts.iter().fold([1.0; 2], |[grow, shrink], part| {
            let [g, s] = part.stretch_over(seconds);
            [grow * g, shrink * s]
        });
        let rounding = grow * ROUNDING;
        [grow + rounding, 1.0 / (1.0 / shrink - rounding).max(f64::MIN_POSITIVE)]
    }
}
