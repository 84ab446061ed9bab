//! Transforms as scene files describe them.

use bilux_math::glam::DQuat;
use bilux_math::transcendental::{sin_cos_f64, tan_f64};
use bilux_math::{DMat4, DVec3, Mat3, Mat4, Quat, Vec3};
use bilux_scene::Parameters;

/// A rotation by an angle in degrees about an axis; `None` for a zero axis.
pub fn rotation(degrees: f64, axis: DVec3) -> Option<DMat4> {
    let axis = axis.try_normalize()?;
    let (sin, cos) = sin_cos_f64((degrees % 360.0).to_radians() * 0.5);
    Some(DMat4::from_quat(DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)))
}

/// The transform from world space to a camera that looks along +z with +x to the right.
///
/// `None` if the direction is zero or parallel to up.
pub fn look_at(eye: DVec3, at: DVec3, up: DVec3) -> Option<DMat4> {
    let forward = (at - eye).try_normalize()?;
    let right = up.try_normalize()?.cross(forward).try_normalize()?;
    let above = forward.cross(right);
    let columns = [right, above, forward].map(|axis| axis.extend(0.0));
    let to_world = DMat4::from_cols(columns[0], columns[1], columns[2], eye.extend(1.0));
    Some(to_world.inverse())
}

/// The tangent of half an angle in degrees.
pub fn half_tangent(degrees: f32) -> f64 {
    tan_f64(f64::from(degrees).to_radians() * 0.5)
}

/// The placement of a camera that looks along +z with +y up; `None` if its transform is flat.
pub fn view_of(to_world: &DMat4) -> Option<Parameters> {
    let position = to_world.w_axis.truncate();
    let axis = |v: DVec3| to_world.transform_vector3(v).try_normalize();
    let (forward, up) = axis(DVec3::Z).zip(axis(DVec3::Y))?;
    // Far from the origin, 32-bit floats may not resolve one metre.
    let ahead = position + forward * (1.0 + 1e-4 * position.abs().max_element());
    let mut parameters = Parameters::default();
    for (key, v) in [("position", position), ("look_at", ahead), ("up", up)] {
        parameters.set(key, v.as_vec3());
    }
    Some(parameters)
}

/// The place of something that looks along its own -z axis, with y upwards.
pub fn looking(position: Vec3, forward: Vec3, up: Vec3) -> Mat4 {
    let forward = forward.normalize_or(Vec3::NEG_Z);
    let right = forward.cross(up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
    let axes = Mat3::from_cols(right, right.cross(forward), -forward);
    Mat4::from_rotation_translation(Quat::from_mat3(&axes), position)
}
