//! Transforms: lists of steps, and keyframes of them.

use super::values::{numbers, numbers_of};
use bilux_import::FormatError;
use bilux_import::world::placement::{look_at, rotation};
use bilux_math::motion::{Motion, MotionKey};
use bilux_math::transcendental::sin_cos_f64;
use bilux_math::{DMat3, DMat4, DVec3, Transform};
use bilux_scene::Span;

/// A transform at one time or at several, in order of time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Placement(pub(super) Vec<(f64, DMat4)>);

impl Placement {
    /// The first matrix.
    pub(super) fn start(&self) -> DMat4 {
        self.0.first().map_or(DMat4::IDENTITY, |(_, matrix)| *matrix)
    }

    /// Placement after a constant transform of what it places.
    pub(super) fn after(&self, first: &DMat4) -> Placement {
        Placement(self.0.iter().map(|(time, matrix)| (*time, *matrix * *first)).collect())
    }

    /// As a motion; `None` for a scale of zero. The flag says whether the motion could not be kept.
    pub(super) fn motion(&self) -> (Option<Motion>, bool) {
        let still = Transform::from_matrix(self.start()).map(Motion::still);
        if self.0.len() < 2 || self.0.iter().all(|(_, matrix)| *matrix == self.0[0].1) {
            return (still, false);
        }
        let keys = self.0.iter().map(|(time, matrix)| {
            let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
            let again = DMat4::from_scale_rotation_translation(scale, rotation, translation);
            let size = matrix.to_cols_array().iter().fold(0f64, |m, x| m.max(x.abs()));
            again.abs_diff_eq(*matrix, 1e-4 * size).then(|| MotionKey {
                time_seconds: *time as f32,
                translation: translation.as_vec3(),
                rotation: rotation.as_quat(),
                scale: scale.as_vec3(),
            })
        });
        match keys.collect::<Option<Vec<_>>>().and_then(Motion::from_keys) {
            Some(motion) => (Some(motion), false),
            None => (still, true),
        }
    }
}

impl Default for Placement {
    fn default() -> Placement {
        Placement(vec![(0.0, DMat4::IDENTITY)])
    }
}

/// The matrix of a step; `attribute` gives the attributes of its element. Before version 2 the axis of a rotation is normalised.
pub(super) fn step(
    word: &str,
    attribute: &dyn Fn(&str) -> Result<Option<String>, FormatError>,
    is_old: bool,
    at: &Span,
) -> Result<Option<DMat4>, FormatError> {
    let vector = |default: f64| triple(attribute, default, at);
    let named = |name: &str| -> Result<Option<DVec3>, FormatError> {
        attribute(name)?.map(|text| numbers_of::<3>(&text, name, at)).transpose().map(|v| v.map(DVec3::from))
    };
    let fail = |message: &str| Err(FormatError::malformed(message, at.clone()));
    let matrix = match word {
        "translate" => DMat4::from_translation(vector(0.0)?),
        "scale" => DMat4::from_scale(vector(1.0)?),
        "rotate" => {
            let angle = attribute("angle")?.map(|text| numbers_of::<1>(&text, "angle", at)).transpose()?;
            let (angle, axis) = (angle.map_or(0.0, |[angle]| angle), vector(0.0)?);
            match rotation(angle, axis) {
                Some(_) if !is_old && (axis.length() - 1.0).abs() > 1e-4 => about(axis, angle),
                Some(matrix) => matrix,
                None => return fail("this rotation has no axis: give x, y or z"),
            }
        }
        "matrix" => {
            let text = attribute("value")?.unwrap_or_default();
            matrix(&numbers(&text, "value", at)?, at)?
        }
        "lookat" | "lookAt" => {
            let (origin, target) =
                (named("origin")?.unwrap_or_default(), named("target")?.unwrap_or_default());
            let forward = (target - origin).normalize_or_zero();
            // Any direction across is up if none is given.
            let up = named("up")?.filter(|up| *up != DVec3::ZERO);
            let up = up
                .unwrap_or_else(|| forward.try_normalize().map_or(DVec3::Y, |f| f.any_orthonormal_vector()));
            match look_at(origin, target, up) {
                Some(to_camera) => to_camera.inverse(),
                None => {
                    return fail("'lookat' must not look along its own up direction, nor at its own origin");
                }
            }
        }
        _ => return Ok(None),
    };
    if matrix.is_finite() { Ok(Some(matrix)) } else { fail("this transform overflows") }
}

/// Matrix by Mitsuba's formula for a rotation. With an axis that is not of length 1, it also scales and skews.
fn about(axis: DVec3, degrees: f64) -> DMat4 {
    let (sin, cos) = sin_cos_f64((degrees % 360.0).to_radians());
    let column = |e: DVec3| e * cos + axis * (axis.dot(e) * (1.0 - cos)) + axis.cross(e) * sin;
    DMat4::from_mat3(DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)))
}

/// x, y and z as attributes of their own, or as one value, which may be a single number.
fn triple(
    attribute: &dyn Fn(&str) -> Result<Option<String>, FormatError>,
    default: f64,
    at: &Span,
) -> Result<DVec3, FormatError> {
    if let Some(text) = attribute("value")? {
        return match *numbers(&text, "value", at)?.as_slice() {
            [all] => Ok(DVec3::splat(all)),
            [x, y, z] => Ok(DVec3::new(x, y, z)),
            _ => Err(FormatError::malformed("'value' takes one number or three", at.clone())),
        };
    }
    let mut vector = DVec3::splat(default);
    for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
        if let Some(text) = attribute(name)? {
            [vector[i]] = numbers_of::<1>(&text, name, at)?;
        }
    }
    Ok(vector)
}

/// A matrix of 16 or 9 numbers, row by row.
fn matrix(list: &[f64], at: &Span) -> Result<DMat4, FormatError> {
    match list.len() {
        16 => {
            let mut matrix = DMat4::from_cols_slice(list).transpose();
            let last = matrix.row(3);
            if last.truncate() != DVec3::ZERO || last.w == 0.0 {
                let message = "a matrix must end in the row 0 0 0 1: projections are not supported";
                return Err(FormatError::malformed(message, at.clone()));
            }
            matrix *= last.w.recip();
            Ok(matrix)
        }
        9 => {
            let row = |i: usize| DVec3::from_slice(&list[3 * i..]).extend(0.0);
            Ok(DMat4::from_cols(row(0), row(1), row(2), bilux_math::glam::DVec4::W).transpose())
        }
        count => {
            Err(FormatError::malformed(format!("a matrix has 16 or 9 numbers, not {count}"), at.clone()))
        }
    }
}
