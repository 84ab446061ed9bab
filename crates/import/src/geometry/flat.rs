//! Meshes that a scale of zero along one axis makes flat.

use crate::FormatError;
use crate::bytes::budget::Budget;
use bilux_math::{DMat4, DVec3, Motion, Transform};
use bilux_scene::Mesh;
use std::sync::Arc;

/// The number of dimensions that an affine map leaves: 3 for one that can be inverted, and 1 also for one that is not
/// finite.
pub fn rank(map: &DMat4) -> usize {
    let axes = [map.x_axis, map.y_axis, map.z_axis].map(|axis| axis.truncate());
    let longest = axes.iter().map(|axis| axis.length()).fold(0.0, f64::max);
    if !(map.is_finite() && longest.is_finite()) {
        return 1;
    }
    if longest < f64::from(f32::MIN_POSITIVE) {
        return 0;
    }
    let [x, y, z] = axes.map(|axis| axis / longest);
    let widest = [x.cross(y), y.cross(z), z.cross(x)].iter().map(|area| area.length()).fold(0.0, f64::max);
    // Scales differ by this factor if the smaller one is rounding.
    const ROUNDING: f64 = 1e-12;
    match (widest > ROUNDING, x.cross(y).dot(z).abs() > ROUNDING) {
        (true, true) => 3,
        (true, false) => 2,
        (false, _) => 1,
    }
}

/// A mesh in world space. Its faces, and with them its normals, are those of the plane that it lies in.
pub fn flattened(mesh: &Mesh, world: &DMat4) -> Mesh {
    let place = |p: &bilux_math::Vec3| world.transform_point3(DVec3::from(*p)).as_vec3();
    let positions = mesh.positions.iter().map(place).collect();
    Mesh { positions, normals: Vec::new(), tangents: Vec::new(), ..mesh.clone() }
}

/// A mesh and where it is: as it is, or in world space if that makes it flat. `None` if nothing is left to see.
pub fn placed(
    mesh: &Arc<Mesh>,
    world: &DMat4,
    budget: &mut Budget,
    file: &str,
) -> Result<Option<(Arc<Mesh>, Motion)>, FormatError> {
    if let Some(transform) = Transform::from_matrix(*world) {
        let motion = Motion::still(transform);
        budget.take_bytes(motion.heap_bytes() as u64, file)?;
        return Ok(Some((mesh.clone(), motion)));
    }
    if rank(world) != 2 {
        return Ok(None);
    }
    budget.take_bytes(mesh.size(), file)?;
    Ok(Some((Arc::new(flattened(mesh, world)), Motion::REST)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rank_counts_the_dimensions_that_are_left() {
        let turn = DMat4::from_euler(bilux_math::glam::EulerRot::XYZ, 0.3, 1.1, -2.0);
        for scale in [1e-6, 1.0, 1e6] {
            for ([x, y, z], left) in
                [([1.0, 2.0, 3.0], 3), ([1.0, 0.0, 3.0], 2), ([0.0, 2.0, 0.0], 1), ([0.0; 3], 0)]
            {
                let map = turn * DMat4::from_scale(DVec3::new(x, y, z) * scale);
                assert_eq!(rank(&map), left, "{x} {y} {z} times {scale}");
            }
        }
        assert_eq!(rank(&DMat4::from_scale(DVec3::new(f64::INFINITY, 1.0, 1.0))), 1);
    }
}
