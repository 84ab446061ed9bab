//! Transforms that change with time: keyframes of translation, rotation and scale.

mod chain;
pub mod numbers;

use crate::transcendental::{atan2_f64, sin_f64};
use crate::{Aabb, Transform};
use glam::{DMat3, DMat4, DQuat, DVec3, Quat, Vec3};
use std::sync::Arc;

/// A transform as a function of time. Between keys, translation and scale are interpolated linearly, and rotation
/// along the shorter great arc at constant speed [Shoemake 1985]; before the first and after the last key the
/// transform is constant. Motions are [composed](Motion::then) as they are at each time: a point that is placed on a
/// turning object moves along an arc.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    course: Course,
}

/// The pose of an object at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionKey {
    /// Time of the key, in seconds.
    pub time_seconds: f32,
    /// Applied last.
    pub translation: Vec3,
    /// Applied second; of any non-zero length.
    pub rotation: Quat,
    /// Applied first; no component may be zero.
    pub scale: Vec3,
}

/// Shared between copies: a scene of a million instances holds each one several times.
#[derive(Clone, Debug, PartialEq)]
enum Course {
    /// The identity, to the bit.
    Rest,
    Still(Arc<Transform>),
    /// At least two poses, in order of time.
    Keys(Arc<Vec<Pose>>),
    /// At least two motions, none of them a chain; the first is applied first.
    Chain(Arc<Vec<Motion>>),
}

/// A key in f64, its rotation normalised.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    time: f64,
    translation: DVec3,
    rotation: DQuat,
    scale: DVec3,
}

/// Scales and translations beyond this (2⁶⁰), and scales below its inverse, are rejected, so that every interpolated
/// matrix and its inverse are finite in f32.
const EXTREME: f64 = (1u64 << 60) as f64;

/// Number of pieces in which a segment is sampled for its bounds.
const PIECES: usize = 16;

impl Motion {
    /// No motion, and the identity transform.
    pub const REST: Motion = Motion { course: Course::Rest };

    /// No motion, with a constant transform.
    pub fn still(transform: Transform) -> Motion {
        let bits =
            |t: &Transform| [*t.matrix(), *t.inverse_matrix()].map(|m| m.to_cols_array().map(f32::to_bits));
        if bits(&transform) == bits(&Transform::IDENTITY) {
            return Motion::REST;
        }
        Motion { course: Course::Still(Arc::new(transform)) }
    }

    /// The transform, if it has no keys and so is the same at all times.
    #[inline]
    pub fn static_transform(&self) -> Option<&Transform> {
        match &self.course {
            Course::Rest => Some(&Transform::IDENTITY),
            Course::Still(transform) => Some(transform),
            Course::Keys(_) | Course::Chain(_) => None,
        }
    }

    /// Bytes that it holds on the heap, shared with its copies.
    pub fn heap_bytes(&self) -> usize {
        match &self.course {
            Course::Rest => 0,
            Course::Still(_) => size_of::<(Transform, [usize; 2])>(),
            Course::Keys(poses) => size_of::<(Vec<Pose>, [usize; 2])>() + size_of_val(poses.as_slice()),
            Course::Chain(parts) => {
                let inner: usize = parts.iter().map(Motion::heap_bytes).sum();
                size_of::<(Vec<Motion>, [usize; 2])>() + size_of_val(parts.as_slice()) + inner
            }
        }
    }

    fn poses(&self) -> &[Pose] {
        match &self.course {
            Course::Keys(poses) => poses,
            _ => &[],
        }
    }

    /// Motion through keys; `None` when there are none, when their times do not increase, when a number is not finite
    /// or beyond 2⁶⁰, when a scale is below 2⁻⁶⁰ or changes its sign between keys (it would pass through zero), or
    /// when a rotation is zero.
    pub fn from_keys(keys: Vec<MotionKey>) -> Option<Motion> {
        let poses = keys.iter().map(Pose::new).collect::<Option<Vec<_>>>()?;
        let in_order = poses.windows(2).all(|pair| pair[0].time < pair[1].time);
        let keeps_signs = poses.windows(2).all(|pair| (pair[0].scale * pair[1].scale).min_element() > 0.0);
        if !(in_order && keeps_signs) {
            return None;
        }
        match poses.as_slice() {
            [] => None,
            [only] => Some(Motion::still(only.transform())),
            _ => Some(Motion { course: Course::Keys(Arc::new(poses)) }),
        }
    }

    /// The transform at a time in seconds. The same time always gives the same bits; a NaN time means the first key's
    /// time.
    pub fn at(&self, time_seconds: f32) -> Transform {
        if let Some(transform) = self.static_transform() {
            return *transform;
        }
        Transform::from_matrix(self.matrix_at(f64::from(time_seconds))).unwrap_or_default()
    }

    fn matrix_at(&self, time: f64) -> DMat4 {
        if let Some(transform) = self.static_transform() {
            return transform.matrix().as_dmat4();
        }
        if let Course::Chain(parts) = &self.course {
            return parts.iter().fold(DMat4::IDENTITY, |all, part| part.matrix_at(time) * all);
        }
        let poses = self.poses();
        let next = poses.partition_point(|pose| pose.time <= time);
        match (next.checked_sub(1).map(|i| &poses[i]), poses.get(next)) {
            (Some(from), Some(to)) => Segment::new(from, to).at(from.fraction(to, time)).matrix(),
            (Some(pose), None) | (None, Some(pose)) => pose.matrix(),
            (None, None) => DMat4::IDENTITY,
        }
    }

    /// The keys, in order of time, with rotations of unit length; empty if there were none or only one, and for motions
    /// of several [parts](Motion::parts), each of which has its own.
    pub fn keys(&self) -> Vec<MotionKey> {
        let key = |pose: &Pose| MotionKey {
            time_seconds: pose.time as f32,
            translation: pose.translation.as_vec3(),
            rotation: pose.rotation.as_quat(),
            scale: pose.scale.as_vec3(),
        };
        self.poses().iter().map(key).collect()
    }

    /// True when it never moves.
    pub fn is_still(&self) -> bool {
        if let Course::Chain(parts) = &self.course {
            return parts.iter().all(Motion::is_still);
        }
        self.poses().windows(2).all(|pair| pair[0].same_place(&pair[1]))
    }

    /// True when [`Motion::at`] is the same, to the bit, for all times in this closed interval.
    pub fn is_still_over(&self, seconds: [f32; 2]) -> bool {
        if let Course::Chain(parts) = &self.course {
            return parts.iter().all(|part| part.is_still_over(seconds));
        }
        self.segments_over(seconds).all(|(segment, _)| segment.from.same_place(&segment.to))
    }

    /// A box that contains `bounds` moved by [`Motion::at`] at any time in this closed interval.
    ///
    /// Each segment is sampled in pieces. Along a piece of length `h` (as a fraction of the segment) a point deviates
    /// from the chord between its samples by at most `h²/8` times its maximum acceleration, which is
    /// `θ² |S p| + 2 θ |ΔS p|` for a rotation by `θ`; the chord itself lies in the samples' box. The error of
    /// rounding to f32 is below `8 · 2⁻²⁴` of the coordinates.
    pub fn bounds_over(&self, bounds: &Aabb, seconds: [f32; 2]) -> Aabb {
        if bounds.is_empty() {
            return Aabb::EMPTY;
        }
        if let Some(transform) = self.static_transform() {
            return moved_by(transform, bounds, EXACT);
        }
        if let Course::Chain(parts) = &self.course {
            return Motion::bounds_of_all(parts, bounds, seconds);
        }
        let segments = self.segments_over(seconds);
        // As for the segments: in a chain, the matrix is rounded only with those of the other parts.
        let rests = [self.at(seconds[0]), self.at(seconds[1])].map(|t| moved_by(&t, bounds, ROUNDING));
        segments.fold(rests[0].union(rests[1]), |all, (segment, span)| {
            all.union(segment.bounds_over(bounds, span))
        })
    }

    /// Bounds, over these times, on how much the transform and its inverse stretch lengths (the largest singular
    /// values of both).
    pub fn stretch_over(&self, seconds: [f32; 2]) -> [f64; 2] {
        let stretch = |transform: &Transform| {
            let linear = DMat3::from_mat4(transform.matrix().as_dmat4());
            [frobenius(linear), frobenius(linear.inverse())]
        };
        if let Some(transform) = self.static_transform() {
            return stretch(transform);
        }
        if let Course::Chain(parts) = &self.course {
            return Motion::stretch_of_all(parts, seconds);
        }
        let still = [self.at(seconds[0]), self.at(seconds[1])].map(|transform| stretch(&transform));
        let larger = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
        self.segments_over(seconds).fold(larger(still[0], still[1]), |all, (segment, _)| {
            let (s, r) = (segment.from.scale.abs(), segment.to.scale.abs());
            larger(all, [s.max(r).max_element() * SLACK, SLACK / s.min(r).min_element()])
        })
    }

    /// The segments that overlap an interval, each with the overlapping part of it, in `0..=1`.
    fn segments_over(&self, seconds: [f32; 2]) -> impl Iterator<Item = (Segment, [f64; 2])> {
        let poses = self.poses();
        let [start, end] = [f64::from(seconds[0].min(seconds[1])), f64::from(seconds[0].max(seconds[1]))];
        poses.windows(2).filter(move |pair| pair[0].time <= end && pair[1].time >= start).map(move |pair| {
            let span = [start, end].map(|time| pair[0].fraction(&pair[1], time));
            (Segment::new(&pair[0], &pair[1]), span)
        })
    }
}

/// Scale, rotation and translation of a transform that has only these.
fn similarity(transform: &Transform) -> Option<(f64, DQuat, DVec3)> {
    let matrix = transform.matrix().as_dmat4();
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate());
    let scale = (x.length() + y.length() + z.length()) / 3.0;
    let even = [x, y, z].iter().all(|axis| (axis.length() / scale - 1.0).abs() < 1e-3);
    let square = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|dot| dot.abs() < 1e-3 * scale * scale);
    let upright = x.cross(y).dot(z) > 0.0;
    (even && square && upright).then(|| {
        let rotation = DQuat::from_mat3(&DMat3::from_cols(x / scale, y / scale, z / scale)).normalize();
        (scale, rotation, matrix.w_axis.truncate())
    })
}

impl Pose {
    fn new(key: &MotionKey) -> Option<Pose> {
        let (translation, scale) = (key.translation.as_dvec3(), key.scale.as_dvec3());
        let rotation = key.rotation.as_dquat();
        let length = rotation.dot(rotation).sqrt();
        let sound = key.time_seconds.is_finite()
            && translation.is_finite()
            && translation.abs().max_element() <= EXTREME
            && scale.is_finite()
            && scale.abs().max_element() <= EXTREME
            && scale.abs().min_element() >= 1.0 / EXTREME
            && length.is_finite()
            && length > 0.0;
        let time = f64::from(key.time_seconds);
        sound.then(|| Pose { time, translation, rotation: rotation * (1.0 / length), scale })
    }

    fn same_place(&self, other: &Pose) -> bool {
        (self.translation, self.rotation, self.scale) == (other.translation, other.rotation, other.scale)
    }

    /// The position of a time between two poses, clamped to `0..=1`.
    fn fraction(&self, next: &Pose, time: f64) -> f64 {
        ((time - self.time) / (next.time - self.time)).clamp(0.0, 1.0)
    }

    fn matrix(&self) -> DMat4 {
        DMat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }

    /// Never fails on what [`Pose::new`] accepts.
    fn transform(&self) -> Transform {
        Transform::from_matrix(self.matrix()).unwrap_or_default()
    }
}

/// The interpolation from one pose to the next.
struct Segment {
    from: Pose,
    to: Pose,
    /// Half the angle of the rotation between them, radians.
    half_angle: f64,
}

impl Segment {
    fn new(from: &Pose, to: &Pose) -> Segment {
        let mut to = *to;
        // A rotation has two quaternions; the closer one gives the shorter arc.
        if from.rotation.dot(to.rotation) < 0.0 {
            to.rotation = -to.rotation;
        }
        let length = |q: DQuat| q.dot(q).sqrt();
        let half_angle =
            2.0 * atan2_f64(length(to.rotation - from.rotation), length(to.rotation + from.rotation));
        Segment { from: *from, to, half_angle }
    }

    fn at(&self, fraction: f64) -> Pose {
        let (from, to) = (&self.from, &self.to);
        if from.same_place(to) {
            return *from;
        }
        let turn = |part: f64| {
            let whole = sin_f64(self.half_angle);
            if whole > 1e-9 { sin_f64(part * self.half_angle) / whole } else { part }
        };
        let rotation = from.rotation * turn(1.0 - fraction) + to.rotation * turn(fraction);
        Pose {
            time: from.time,
            translation: from.translation.lerp(to.translation, fraction),
            rotation: rotation * (1.0 / rotation.dot(rotation).sqrt()),
            scale: from.scale.lerp(to.scale, fraction),
        }
    }

    fn bounds_over(&self, bounds: &Aabb, [start, end]: [f64; 2]) -> Aabb {
        let corners = bounds.corners().map(|corner| corner.as_dvec3());
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for step in 0..=PIECES {
            let matrix = self.at(start + (end - start) * step as f64 / PIECES as f64).matrix();
            for corner in corners {
                let p = matrix.transform_point3(corner);
                (low, high) = (low.min(p), high.max(p));
            }
        }
        let reach = bounds.min.abs().max(bounds.max.abs()).as_dvec3();
        let (s, r) = (self.from.scale, self.to.scale);
        let radius = (reach * s.abs().max(r.abs())).length();
        let growth = (reach * (r - s).abs()).length();
        let angle = 2.0 * self.half_angle;
        let piece = (end - start) / PIECES as f64;
        let bulge = piece * piece / 8.0 * (angle * angle * radius + 2.0 * angle * growth);
        let far = self.from.translation.abs().max(self.to.translation.abs()).max_element() + radius;
        expanded_outwards(low, high, bulge * (1.0 + 1e-6) + far * ROUNDING)
    }
}

/// 8 units of f32 rounding: an entry of a rotation times a scale is rounded once, and the sum over a row of the
/// entries' magnitudes is at most √3 times the length of the scaled point.
const ROUNDING: f64 = 8.0 / 16_777_216.0;

/// The relative error of f64 arithmetic, for a matrix that is not rounded.
const EXACT: f64 = 1e-14;

/// The factor, 1 + 2⁻²⁰, that covers how the rounding of a matrix to f32 changes its stretch.
const SLACK: f64 = 1.0 + 1.0 / 1_048_576.0;

fn frobenius(m: DMat3) -> f64 {
    m.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The bounding box of a box transformed by a matrix with this relative error.
fn moved_by(transform: &Transform, bounds: &Aabb, error: f64) -> Aabb {
    let matrix = transform.matrix().as_dmat4();
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut far = 0f64;
    for corner in bounds.corners().map(|corner| corner.as_dvec3()) {
        let p = matrix.transform_point3(corner);
        (low, high) = (low.min(p), high.max(p));
        let sum = DMat3::from_mat4(matrix).abs() * corner.abs() + matrix.w_axis.truncate().abs();
        far = far.max(sum.max_element());
    }
    expanded_outwards(low, high, far * error)
}

/// An f32 box that contains an f64 box enlarged by `margin`.
fn expanded_outwards(low: DVec3, high: DVec3, margin: f64) -> Aabb {
    let margin = DVec3::splat(margin);
    let (low, high) = ((low - margin).as_vec3(), (high + margin).as_vec3());
    Aabb {
        min: Vec3::new(low.x.next_down(), low.y.next_down(), low.z.next_down()),
        max: Vec3::new(high.x.next_up(), high.y.next_up(), high.z.next_up()),
    }
}

#[cfg(test)]
mod tests {
    use super::numbers::MotionNumbers;
    use super::*;
    use crate::hash::{hash_words, unit_f32};

    fn key(time_seconds: f32, translation: Vec3, rotation: Quat, scale: Vec3) -> MotionKey {
        MotionKey { time_seconds, translation, rotation, scale }
    }

    fn spin() -> Motion {
        let turned = Quat::from_xyzw(0.0, 0.0, 1.0, 0.0);
        Motion::from_keys(vec![
            key(1.0, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE),
            key(3.0, Vec3::new(4.0, 0.0, 0.0), turned, Vec3::splat(3.0)),
        ])
        .unwrap()
    }

    #[test]
    fn rests_before_and_after_its_keys() {
        let motion = spin();
        assert_eq!(motion.at(-5.0), motion.at(1.0));
        assert_eq!(motion.at(9.0), motion.at(3.0));
        assert_eq!(motion.at(f32::NAN), motion.at(1.0));
        assert!(motion.at(0.0).is_identity());
        assert_eq!(Motion::from_keys(motion.keys()), Some(motion.clone()));
        assert!(!motion.is_still() && motion.is_still_over([-1.0, 0.5]) && !motion.is_still_over([0.0, 1.5]));
    }

    /// A chain moves while any of its parts does.
    #[test]
    fn a_chain_is_still_only_while_all_of_it_is() {
        let place = Motion::still(Transform::translate(Vec3::X).unwrap());
        for chain in [place.then(&spin()), spin().then(&place), spin().then(&spin())] {
            assert!(!chain.is_still_over([0.5, 2.0]) && !chain.is_still(), "{chain:?}");
            assert!(chain.is_still_over([3.5, 9.0]), "{chain:?}");
        }
    }

    #[test]
    fn midway_is_half_the_distance_half_the_angle_and_the_mean_scale() {
        let p = spin().at(2.0).point(Vec3::X);
        // Half of a half turn about z takes x to y, scaled by 2, moved by 2.
        assert!((p - Vec3::new(2.0, 2.0, 0.0)).length() < 1e-6, "{p}");
    }

    #[test]
    fn a_motion_followed_by_a_similarity_is_the_composed_motion() {
        let turn = Quat::from_xyzw(0.0, 0.6, 0.0, 0.8);
        let next = DMat4::from_scale_rotation_translation(
            DVec3::splat(2.0),
            turn.as_dquat(),
            DVec3::new(1.0, -2.0, 3.0),
        );
        let next = Transform::from_matrix(next).unwrap();
        let both = spin().then(&Motion::still(next));
        assert_eq!(both.keys().len(), 2, "keys of its own");
        for time in [0.0, 1.0, 1.7, 2.5, 4.0] {
            let p = Vec3::new(0.3, -0.7, 1.1);
            let apart = both.at(time).point(p) - next.point(spin().at(time).point(p));
            assert!(apart.length() < 1e-5, "{time}: {apart}");
        }
    }

    #[test]
    fn what_is_placed_on_a_turning_object_moves_along_an_arc() {
        // A half turn about z in 2 s, seen at 60 degrees: the point (1/2, 0, 0) of an object at (2, 0, 0).
        let half_turn = |time_seconds, rotation| key(time_seconds, Vec3::ZERO, rotation, Vec3::ONE);
        let turn = Motion::from_keys(vec![
            half_turn(0.0, Quat::IDENTITY),
            half_turn(2.0, Quat::from_xyzw(0.0, 0.0, 1.0, 0.0)),
        ]);
        let place = Motion::still(Transform::translate(Vec3::X * 2.0).unwrap());
        let flattened = Motion::still(Transform::scale(Vec3::new(1.0, 0.5, 1.0)).unwrap());
        let orbit = place.then(&turn.unwrap()).then(&flattened);
        let (sin, cos) = crate::transcendental::sin_cos(60f32.to_radians());
        let expected = Vec3::new(2.5 * cos, 2.5 * sin * 0.5, 0.0);
        let p = orbit.at(2.0 / 3.0).point(Vec3::X * 0.5);
        assert!(p.abs_diff_eq(expected, 1e-6), "{p} instead of {expected}");
        assert_eq!(orbit.parts().len(), 3);
        assert!(!orbit.is_still() && orbit.is_still_over([2.5, 3.0]) && orbit.static_transform().is_none());
        assert_eq!(place.then(&flattened).parts().len(), 1, "what is still is one transform");
    }

    /// Transforms on both sides of a joint become one, in the order in which they are applied.
    #[test]
    fn what_follows_a_motion_is_applied_in_its_order() {
        let uneven = Transform::scale(Vec3::new(2.0, 0.5, 1.0)).unwrap();
        let turned = Transform::rotate(Vec3::new(1.0, 2.0, 3.0), 0.8).unwrap();
        let moved = Transform::translate(Vec3::new(3.0, -1.0, 0.5)).unwrap();
        let after = [uneven, turned, moved];
        let chain = after.iter().fold(spin(), |chain, next| chain.then(&Motion::still(*next)));
        assert_eq!(chain.parts().len(), 2, "what is still is one transform");
        for time in [0.0, 1.7, 2.5, 4.0] {
            let p = Vec3::new(0.3, -0.7, 1.1);
            let wanted = after.iter().fold(spin().at(time).point(p), |p, next| next.point(p));
            let apart = chain.at(time).point(p) - wanted;
            assert!(apart.length() < 1e-5, "{time}: {apart}");
        }
    }

    #[test]
    fn rejects_keys_without_an_invertible_transform_between_them() {
        let sound = key(0.0, Vec3::ZERO, Quat::IDENTITY, Vec3::ONE);
        let refused = |keys: &[MotionKey]| assert_eq!(Motion::from_keys(keys.to_vec()), None);
        refused(&[]);
        refused(&[sound, sound]);
        refused(&[sound, MotionKey { time_seconds: 1.0, scale: Vec3::new(1.0, -1.0, 1.0), ..sound }]);
        refused(&[MotionKey { scale: Vec3::new(1.0, 0.0, 1.0), ..sound }]);
        refused(&[MotionKey { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..sound }]);
        refused(&[MotionKey { translation: Vec3::new(f32::NAN, 0.0, 0.0), ..sound }]);
        assert!(Motion::from_keys(vec![sound]).unwrap().is_still());
    }

    #[test]
    fn the_same_pose_twice_is_still_to_the_bit() {
        let pose = key(0.0, Vec3::X, Quat::from_xyzw(0.1, 0.2, 0.3, 0.4), Vec3::new(0.3, 1.0, 7.0));
        let motion = Motion::from_keys(vec![pose, MotionKey { time_seconds: 1.0, ..pose }]).unwrap();
        assert!(motion.is_still());
        assert!((0..100).all(|i| motion.at(i as f32 / 99.0) == motion.at(0.0)));
    }

    fn random_motion(seed: u64) -> Motion {
        let number = |i: u64| unit_f32(hash_words([seed, i]) as u32) * 2.0 - 1.0;
        let vector = |i: u64| Vec3::new(number(i), number(i + 1), number(i + 2));
        let keys = (0..3).map(|k| {
            let turn =
                Quat::from_xyzw(number(k * 20), number(k * 20 + 1), number(k * 20 + 2), number(k * 20 + 3));
            let scale = vector(k * 20 + 4).abs() * 3.0 + Vec3::splat(0.01);
            key(k as f32, vector(k * 20 + 8) * 10.0, turn, scale)
        });
        Motion::from_keys(keys.collect()).unwrap()
    }

    /// Two motions and a transform that is no similarity between them.
    fn random_chain(seed: u64) -> Motion {
        let place = DMat4::from_translation(DVec3::new(0.3, -5.0, 1.0))
            * DMat4::from_scale(DVec3::new(0.2, 1.0, 3.0));
        let uneven = Motion::still(Transform::from_matrix(place).unwrap());
        random_motion(seed).then(&uneven).then(&random_motion(seed + 1000))
    }

    /// Number of sampled points of moving boxes that lie outside the boxes' bounds, shrunk by `shrink` of their size.
    fn escapes(of: fn(u64) -> Motion, shrink: f64) -> usize {
        let mut escaped = 0;
        for seed in 0..200 {
            let motion = of(seed);
            let local = Aabb { min: Vec3::new(-2.0, 0.5, -1.0), max: Vec3::new(1.0, 0.75, 3.0) };
            let window =
                [unit_f32(hash_words([seed, 99]) as u32), 0.8 + unit_f32(hash_words([seed, 98]) as u32)];
            let outer = motion.bounds_over(&local, window);
            let margin = (outer.extent() * shrink as f32).max(Vec3::ZERO);
            let (low, high) = ((outer.min + margin).as_dvec3(), (outer.max - margin).as_dvec3());
            for i in 0..=200 {
                let time = window[0] + (window[1] - window[0]) * i as f32 / 200.0;
                let matrix = motion.at(time).matrix().as_dmat4();
                for corner in local.corners() {
                    let p = matrix.transform_point3(corner.as_dvec3());
                    escaped += usize::from(p.cmplt(low).any() || p.cmpgt(high).any());
                }
            }
        }
        escaped
    }

    #[test]
    fn its_numbers_give_the_same_motion() {
        let place =
            Transform::rotate(Vec3::Y, 0.7).unwrap().then(&Transform::translate(Vec3::X * 3.0).unwrap());
        let moved = spin().then(&Motion::still(Transform::rotate(Vec3::X, 0.3).unwrap()));
        let orbit = Motion::still(place).then(&moved);
        for motion in [Motion::REST, Motion::still(place), spin(), moved, orbit] {
            assert_eq!(Motion::from_numbers(&motion.numbers()), Some(motion));
        }
        let mut wrong = spin().numbers();
        if let MotionNumbers::Keys(keys) = &mut wrong {
            keys.swap(0, 1);
        }
        assert_eq!(Motion::from_numbers(&wrong), None);
        assert_eq!(Motion::from_numbers(&MotionNumbers::Still([f32::NAN; 32])), None);
    }

    #[test]
    fn bounds_hold_every_moment_and_a_slightly_smaller_box_does_not() {
        assert_eq!(escapes(random_motion, 0.0), 0);
        assert!(escapes(random_motion, 0.02) > 0);
        assert_eq!(escapes(random_chain, 0.0), 0);
        // The bounds of a chain are those of a box that moves, so they are wider than the motion.
        assert!(escapes(random_chain, 0.4) > 0);
    }

    /// Through a pose that takes a place a million metres away to the origin, with digits that an f32 does not have, and which
    /// another motion turns on.
    #[test]
    fn bounds_of_a_chain_hold_while_a_part_of_it_rests() {
        let far = Vec3::new(1e6, 2e6, -1e6);
        for seed in 0..100 {
            let number = |i: u64| unit_f32(hash_words([seed, i]) as u32) * 2.0 - 1.0;
            let turn = |i: u64| Quat::from_xyzw(number(i), number(i + 1), number(i + 2), 1.0).normalize();
            let back = |turn: Quat| -(turn.as_dquat() * far.as_dvec3()).as_vec3();
            let before = [turn(0), turn(4)].map(|turn| (back(turn), turn));
            let moves = |seconds: [f32; 2], places: [(Vec3, Quat); 2]| {
                let keys = seconds.iter().zip(places);
                let keys = keys.map(|(time, (place, turn))| key(*time, place, turn, Vec3::ONE));
                Motion::from_keys(keys.collect()).unwrap()
            };
            let after = [(Vec3::ZERO, turn(8)), (Vec3::X, turn(12))];
            let chain = moves([0.0, 1.0], before).then(&moves([5.0, 6.0], after));
            let local = Aabb::of_points([far]);
            let bounds = chain.bounds_over(&local, [5.0, 6.0]);
            let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
            for i in 0..=20 {
                let matrix = chain.at(5.0 + i as f32 / 20.0).matrix().as_dmat4();
                let p = matrix.transform_point3(far.as_dvec3());
                assert!(p.cmpge(low).all() && p.cmple(high).all(), "{seed}: {p} is not in {bounds:?}");
            }
        }
    }

    /// A hundred thousand times larger on two axes, between rotations: rounding the product changes its smallest stretch.
    fn uneven_chain(seed: u64) -> Motion {
        let number = |i: u64| unit_f32(hash_words([seed, i]) as u32) * 2.0 - 1.0;
        let turning = |i: u64| {
            let turn = |i: u64| Quat::from_xyzw(number(i), number(i + 1), number(i + 2), number(i + 3));
            let pose = |time: f32, i: u64| key(time, Vec3::ZERO, turn(i), Vec3::ONE);
            Motion::from_keys(vec![pose(0.0, i), pose(2.0, i + 4)]).unwrap()
        };
        let uneven = Transform::scale(Vec3::new(1.0, 1e5, 1e5)).unwrap();
        turning(0).then(&Motion::still(uneven)).then(&turning(8))
    }

    /// By multiplication: a direction is turned to the one that is stretched most.
    fn largest_stretch(matrix: DMat3) -> f64 {
        let twice = matrix.transpose() * matrix;
        let direction = (0..100).fold(DVec3::ONE, |d, _| (twice * d).normalize());
        (matrix * direction).length()
    }

    #[test]
    fn stretch_bounds_how_lengths_change() {
        let motions = |seed| [random_motion(seed), random_chain(seed), uneven_chain(seed)];
        for motion in (0..100).flat_map(motions) {
            let [grow, shrink] = motion.stretch_over([0.0, 2.0]);
            for i in 0..=100 {
                let matrix = DMat3::from_mat4(motion.at(i as f32 / 50.0).matrix().as_dmat4());
                assert!(largest_stretch(matrix) <= grow && largest_stretch(matrix.inverse()) <= shrink);
            }
        }
    }
}
