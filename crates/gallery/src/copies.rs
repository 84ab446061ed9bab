//! The paper's script: copies of a model, each at a fixed offset from the last.

use bilux_math::{DMat4, Motion, Transform, Vec3};
use bilux_scene::{Object, SceneBuilder};

/// The scene with `count` copies of each object; copy `i` (from 0, the original) is moved by `i * offset`.
///
/// The copies share meshes and materials; lights, cameras and settings stay as they are.
pub fn copies(scene: &SceneBuilder, count: u32, offset: Vec3) -> SceneBuilder {
    let mut result = scene.clone();
    result.objects = (0..count)
        .flat_map(|i| {
            let by = (offset.as_dvec3() * f64::from(i)).as_vec3();
            scene.objects.iter().map(move |object| moved(object, i, by))
        })
        .collect();
    result
}

fn moved(object: &Object, i: u32, by: Vec3) -> Object {
    if i == 0 {
        return object.clone();
    }
    let shift = Transform::from_matrix(DMat4::from_translation(by.as_dvec3())).unwrap_or_default();
    let motion = object.motion.then(&Motion::still(shift));
    Object { name: format!("{} {}", object.name, i + 1), motion, ..object.clone() }
}
