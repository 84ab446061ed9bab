//! All numbers of a motion, to the bit, so that it can be sent to another machine.

use super::{Course, Motion, Pose};
use crate::Transform;
use glam::{DQuat, DVec3, Mat4};
use std::sync::Arc;

/// Numbers that a motion consists of.
#[derive(Clone, Debug, PartialEq)]
pub enum MotionNumbers {
    /// The identity.
    Rest,
    /// A constant transform: the columns of its matrix, then those of the inverse.
    Still([f32; 32]),
    /// At least two keys, each with its time in seconds, translation (3), rotation (4, of unit length) and scale (3).
    Keys(Vec<[f64; 11]>),
    /// At least two motions of the other kinds, the first of which is applied first.
    Chain(Vec<MotionNumbers>),
}

impl Motion {
    /// All of its numbers. [`Motion::keys`] rounds them instead.
    pub fn numbers(&self) -> MotionNumbers {
        match &self.course {
            Course::Rest => MotionNumbers::Rest,
            Course::Still(transform) => {
                let mut numbers = [0.0; 32];
                numbers[..16].copy_from_slice(&transform.matrix().to_cols_array());
                numbers[16..].copy_from_slice(&transform.inverse_matrix().to_cols_array());
                MotionNumbers::Still(numbers)
            }
            Course::Keys(poses) => MotionNumbers::Keys(poses.iter().map(Pose::numbers).collect()),
            Course::Chain(parts) => MotionNumbers::Chain(parts.iter().map(Motion::numbers).collect()),
        }
    }

    /// The motion of these numbers; `None` when one is not finite, a matrix is not affine, keys are not as
    /// [`Motion::from_keys`] wants them, or a chain contains another.
    pub fn from_numbers(numbers: &MotionNumbers) -> Option<Motion> {
        match numbers {
            MotionNumbers::Rest => Some(Motion::REST),
            MotionNumbers::Still(numbers) => {
                let (forward, inverse) = numbers.split_at(16);
                let matrix = |columns: &[f32]| Some(Mat4::from_cols_array(columns.try_into().ok()?));
                Some(Motion::still(Transform::from_inverses(matrix(forward)?, matrix(inverse)?)?))
            }
            MotionNumbers::Keys(keys) => {
                let poses = keys.iter().map(Pose::from_numbers).collect::<Option<Vec<_>>>()?;
                let is_next = |pair: &[Pose]| {
                    pair[0].time < pair[1].time && (pair[0].scale * pair[1].scale).min_element() > 0.0
                };
                let is_sound = poses.len() >= 2 && poses.windows(2).all(is_next);
                is_sound.then(|| Motion { course: Course::Keys(Arc::new(poses)) })
            }
            MotionNumbers::Chain(parts) => {
                if parts.len() < 2 || parts.iter().any(|part| matches!(part, MotionNumbers::Chain(_))) {
                    return None;
                }
                let parts = parts.iter().map(Motion::from_numbers).collect::<Option<Vec<_>>>()?;
                Some(Motion { course: Course::Chain(Arc::new(parts)) })
            }
        }
    }
}

impl Pose {
    fn numbers(&self) -> [f64; 11] {
        let ([tx, ty, tz], [sx, sy, sz]) = (self.translation.to_array(), self.scale.to_array());
        let [x, y, z, w] = self.rotation.to_array();
        [self.time, tx, ty, tz, x, y, z, w, sx, sy, sz]
    }

    fn from_numbers(&[time, tx, ty, tz, x, y, z, w, sx, sy, sz]: &[f64; 11]) -> Option<Pose> {
        let (translation, scale) = (DVec3::new(tx, ty, tz), DVec3::new(sx, sy, sz));
        let rotation = DQuat::from_xyzw(x, y, z, w);
        let length = rotation.dot(rotation);
        let is_finite = time.is_finite() && translation.is_finite() && scale.is_finite();
        let is_sound = is_finite && scale.abs().min_element() > 0.0 && (length - 1.0).abs() < 1e-6;
        is_sound.then_some(Pose { time, translation, rotation, scale })
    }
}
