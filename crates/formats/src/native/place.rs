//! Placement of models: translation, rotation and scale, or a matrix; and keyframes of these.

use super::document::{Item, Table, TomlValue};
use super::plain::missing;
use bilux_import::FormatError;
use bilux_math::glam::{DQuat, DVec4};
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{DMat4, DVec3, Motion, MotionKey, Transform};
use bilux_scene::{SceneError, Span};

/// The keys that place a model.
pub(super) const KEYS: [&str; 5] = ["translate", "rotate", "scale", "matrix", "keyframes"];

/// The keys of a keyframe.
pub(super) const KEYFRAME_KEYS: [&str; 4] = ["time", "translate", "rotate", "scale"];

/// The motion of a model.
pub(super) fn motion(table: &Table) -> Result<Motion, FormatError> {
    let pose = Pose::default().changed_by(table)?;
    let frames = table.tables("keyframes")?;
    if let Some(matrix) = table.find("matrix") {
        if frames.is_empty() && !["translate", "rotate", "scale"].iter().any(|key| table.find(key).is_some())
        {
            return Ok(Motion::still(read_matrix(matrix)?));
        }
        let message = "'matrix' cannot be combined with translate, rotate, scale or keyframes: use either the matrix or the \
             others";
        return Err(SceneError::invalid(message, &matrix.at).into());
    }
    if frames.is_empty() {
        return Ok(Motion::still(pose.transform(&table.at)?));
    }
    let mut keys = Vec::new();
    for frame in frames {
        frame.check_keys("a model's keyframe", KEYFRAME_KEYS.into_iter())?;
        let time = frame.find("time").ok_or_else(|| missing("time (of the keyframe, in seconds)", frame))?;
        let next = (time.number("time")?, pose.changed_by(frame)?);
        if let Some((last_time, last)) = keys.last().cloned() {
            let steps = next.1.steps_from(&last, &frame.at)?;
            for step in 1..steps {
                let part = f64::from(step) / f64::from(steps);
                keys.push((last_time + (next.0 - last_time) * part, last.lerp(&next.1, part)));
            }
        }
        keys.push(next);
    }
    let keys = keys.iter().map(|(time, pose)| pose.key(*time)).collect();
    Motion::from_keys(keys).ok_or_else(|| {
        let message = "these keyframes are not a valid motion: times must increase, no scale may be 0 or change its \
                       sign, and numbers must be finite";
        SceneError::invalid(message, &table.at).into()
    })
}

/// A transform as scale, then rotation, then translation.
#[derive(Clone, Debug)]
struct Pose {
    translation: DVec3,
    rotation: Rotation,
    scale: DVec3,
}

#[derive(Clone, Debug)]
enum Rotation {
    /// Degrees about x, then y, then z.
    Euler(DVec3),
    /// Degrees about a unit axis.
    Axis(DVec3, f64),
    Quaternion(DQuat),
}

impl Default for Pose {
    fn default() -> Pose {
        Pose { translation: DVec3::ZERO, rotation: Rotation::Euler(DVec3::ZERO), scale: DVec3::ONE }
    }
}

impl Pose {
    fn changed_by(&self, table: &Table) -> Result<Pose, FormatError> {
        let mut pose = self.clone();
        if let Some(item) = table.find("translate") {
            pose.translation = vector(item, "translate")?;
        }
        if let Some(item) = table.find("rotate") {
            pose.rotation = Rotation::read(item)?;
        }
        if let Some(item) = table.find("scale") {
            pose.scale = match item.node {
                TomlValue::List(_) => vector(item, "scale")?,
                _ => DVec3::splat(item.number("scale")?),
            };
        }
        Ok(pose)
    }

    fn transform(&self, at: &Span) -> Result<Transform, FormatError> {
        let (scale, rotation) = (self.scale, self.rotation.quaternion());
        Transform::from_matrix(DMat4::from_scale_rotation_translation(scale, rotation, self.translation))
            .ok_or_else(|| {
                let message =
                    "this transform is not valid: no scale may be 0, and numbers must be finite and not huge";
                SceneError::invalid(message, at).into()
            })
    }

    fn key(&self, time: f64) -> MotionKey {
        MotionKey {
            time_seconds: time as f32,
            translation: self.translation.as_vec3(),
            rotation: self.rotation.quaternion().as_quat(),
            scale: self.scale.as_vec3(),
        }
    }

    /// The number of steps from another pose to this one.
    ///
    /// Between two keys of a motion, rotation takes the shorter way, on which a whole turn vanishes; steps of a
    /// quarter turn preserve the rotation as written.
    fn steps_from(&self, from: &Pose, at: &Span) -> Result<u32, FormatError> {
        let degrees = match (&from.rotation, &self.rotation) {
            (Rotation::Euler(a), Rotation::Euler(b)) => (*b - *a).abs().max_element(),
            (Rotation::Axis(axis, a), Rotation::Axis(same, b)) if axis == same => (b - a).abs(),
            _ => 0.0,
        };
        let steps = (degrees / 90.0).ceil().max(1.0);
        if steps > MAX_STEPS {
            let message = format!(
                "this is a rotation by {degrees} degrees between two keyframes: add keyframes in between"
            );
            return Err(SceneError::invalid(message, at).into());
        }
        Ok(steps as u32)
    }

    fn lerp(&self, to: &Pose, part: f64) -> Pose {
        let rotation = match (&self.rotation, &to.rotation) {
            (Rotation::Euler(a), Rotation::Euler(b)) => Rotation::Euler(a.lerp(*b, part)),
            (Rotation::Axis(axis, a), Rotation::Axis(_, b)) => Rotation::Axis(*axis, a + (b - a) * part),
            _ => to.rotation.clone(),
        };
        let translation = self.translation.lerp(to.translation, part);
        Pose { translation, rotation, scale: self.scale.lerp(to.scale, part) }
    }
}

/// The limit is a hundred turns between two keyframes.
const MAX_STEPS: f64 = 400.0;

impl Rotation {
    fn read(item: &Item) -> Result<Rotation, FormatError> {
        let TomlValue::Table(table) = &item.node else { return Ok(Rotation::Euler(vector(item, "rotate")?)) };
        table.check_keys("a rotation", ["axis", "degrees", "quaternion"].into_iter())?;
        if let Some(item) = table.find("quaternion") {
            let wanted = "four numbers [x, y, z, w], not all of them 0";
            let q = DVec4::from(item.numbers::<4>("quaternion", wanted)?);
            let q = q.try_normalize().ok_or_else(|| item.wrong("quaternion", wanted))?;
            return Ok(Rotation::Quaternion(DQuat::from_vec4(q)));
        }
        let axis = table.find("axis").ok_or_else(|| missing("axis (of the rotation)", table))?;
        let degrees = table.find("degrees").ok_or_else(|| missing("degrees (of the rotation)", table))?;
        let direction = vector(axis, "axis")?.try_normalize();
        let direction =
            direction.ok_or_else(|| axis.wrong("axis", "a direction: three numbers, not all of them 0"))?;
        Ok(Rotation::Axis(direction, degrees.number("degrees")?))
    }

    fn quaternion(&self) -> DQuat {
        let about = |axis: DVec3, degrees: f64| {
            let (sin, cos) = sin_cos_f64(degrees.to_radians() * 0.5);
            DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
        };
        match *self {
            Rotation::Euler(d) => about(DVec3::Z, d.z) * about(DVec3::Y, d.y) * about(DVec3::X, d.x),
            Rotation::Axis(axis, degrees) => about(axis, degrees),
            Rotation::Quaternion(q) => q,
        }
    }
}

fn vector(item: &Item, key: &str) -> Result<DVec3, FormatError> {
    Ok(DVec3::from(item.numbers::<3>(key, "three numbers [x, y, z]")?))
}

/// Reads four rows of four numbers, or 16 numbers in row-major order.
fn read_matrix(item: &Item) -> Result<Transform, FormatError> {
    let wanted = "four rows of four numbers, the last of them [0, 0, 0, 1]";
    let items = item.list("matrix", wanted)?;
    let numbers: [f64; 16] = match items {
        [a, b, c, d] => {
            let rows = [a, b, c, d].map(|row| row.numbers::<4>("matrix", wanted));
            let [a, b, c, d] = rows;
            let rows = [a?, b?, c?, d?];
            std::array::from_fn(|i| rows[i / 4][i % 4])
        }
        _ => item.numbers("matrix", wanted)?,
    };
    let matrix = DMat4::from_cols_array(&numbers).transpose();
    Transform::from_matrix(matrix).ok_or_else(|| {
        let message =
            "this matrix is not a valid transform: it must be invertible and finite, and end in the row [0, 0, 0, 1]";
        SceneError::invalid(message, &item.at).into()
    })
}
