//! Motion between two times.

use super::document::ObjectInstance;
use super::state::Matrices;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::motion::{Motion, MotionKey};
use bilux_math::{DMat4, Transform};
use bilux_scene::Span;

/// The motion of a shape with these matrices, in an object instance if there is one.
///
/// The shape's own matrices and those of the instance are each interpolated on their own, as in pbrt: a shape moves along
/// an arc about the origin of an instance that turns.
pub(super) fn motion_within(
    used: Option<&ObjectInstance>,
    own: &Matrices,
    times: [f64; 2],
    at: &Span,
    diagnostics: &mut Diagnostics,
) -> Option<Motion> {
    let Some(used) = used else { return motion(own, times, at, diagnostics) };
    if own[0] == own[1] && used.matrices[0] == used.matrices[1] {
        let both = used.matrices[0] * own[0];
        return motion(&[both, both], times, at, diagnostics);
    }
    let own = motion(own, times, at, diagnostics)?;
    Some(own.then(&motion(&used.matrices, times, at, diagnostics)?))
}

/// Converts two matrices to a motion; `None`, with a warning, for a degenerate matrix.
fn motion(matrices: &Matrices, times: [f64; 2], at: &Span, diagnostics: &mut Diagnostics) -> Option<Motion> {
    let Some(start) = Transform::from_matrix(matrices[0]) else {
        diagnostics.note("objects with a scale of zero are not rendered", || at.clone());
        return None;
    };
    if matrices[0] == matrices[1] {
        return Some(Motion::still(start));
    }
    let key = |i: usize| {
        let (scale, rotation, translation) = matrices[i].to_scale_rotation_translation();
        let again = DMat4::from_scale_rotation_translation(scale, rotation, translation);
        let size = matrices[i].to_cols_array().iter().fold(0f64, |m, x| m.max(x.abs()));
        again.abs_diff_eq(matrices[i], 1e-4 * size).then(|| MotionKey {
            time_seconds: times[i] as f32,
            translation: translation.as_vec3(),
            rotation: rotation.as_quat(),
            scale: scale.as_vec3(),
        })
    };
    let moving = key(0).zip(key(1)).and_then(|(a, b)| Motion::from_keys(vec![a, b]));
    if moving.is_none() {
        let what = "a motion that is not made of translations, rotations and scales is not supported: the start \
                    is shown";
        diagnostics.note(what, || at.clone());
    }
    Some(moving.unwrap_or(Motion::still(start)))
}
