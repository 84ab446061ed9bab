//! Objects as formats hold them that know neither transforms nor motion.

use crate::normals::unit_face_normal;
use crate::reading::plain_material;
use crate::writing::Writing;
use bilux_math::{Transform, Vec3};
use bilux_scene::{Mesh, Object, SceneBuilder};
use std::borrow::Cow;

/// An object's mesh moved to its place at time 0.
pub(crate) fn in_place<'a>(object: &'a Object, writing: &mut Writing) -> Cow<'a, Mesh> {
    if !object.motion.is_still() {
        writing.warn("the format holds no motion: objects are written where they are at 0 seconds");
    }
    let transform = object.motion.at(0.0);
    if transform.is_identity() {
        return Cow::Borrowed(&object.mesh);
    }
    Cow::Owned(transformed(&object.mesh, &transform))
}

/// A mesh with its vertices moved.
pub(crate) fn transformed(mesh: &Mesh, transform: &Transform) -> Mesh {
    let mut mesh = mesh.clone();
    for p in &mut mesh.positions {
        *p = transform.point(*p);
    }
    for n in &mut mesh.normals {
        *n = transform.normal(*n).normalize_or_zero();
    }
    for t in &mut mesh.tangents {
        let along = transform.vector(t.truncate()).normalize_or_zero();
        *t = along.extend(if transform.mirrors() { -t.w } else { t.w });
    }
    if transform.mirrors() {
        for triangle in &mut mesh.triangles {
            triangle.swap(1, 2);
        }
    }
    mesh
}

/// The name of an object, or else of its mesh.
pub(crate) fn name_of(object: &Object) -> &str {
    if object.name.is_empty() { &object.mesh.name } else { &object.name }
}

/// The corners' positions of a triangle, if it has them.
pub(crate) fn corners(mesh: &Mesh, triangle: [u32; 3]) -> Option<[Vec3; 3]> {
    let [a, b, c] = triangle.map(|i| mesh.positions.get(i as usize).copied());
    Some([a?, b?, c?])
}

/// The unit normal of a triangle of points, by the right-hand rule; zero where it has none.
pub(crate) fn flat_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    unit_face_normal(&[a, b, c])
}

/// Warns of all that a format of bare meshes leaves out.
pub(crate) fn warn_of_scene(scene: &SceneBuilder, format: &str, writing: &mut Writing) {
    let parts = [
        ("lights", scene.lights.len()),
        ("cameras", scene.cameras.len()),
        ("render settings", scene.settings.0.len()),
    ];
    for (what, count) in parts.into_iter().filter(|&(_, count)| count > 0) {
        writing.warn(format!("{format} files hold no {what}: {count} left out"));
    }
}

/// Warns of materials where a format holds none: all but the plain ones.
pub(crate) fn warn_of_materials(scene: &SceneBuilder, format: &str, writing: &mut Writing) {
    let is_plain = |object: &Object| {
        let (kd, ks) = (!object.mesh.vertex_kd.is_empty(), !object.mesh.vertex_ks.is_empty());
        let spec = scene.materials.get(object.material);
        spec.is_none_or(|spec| {
            let plain = plain_material(kd, ks);
            (&spec.kind, &spec.parameters) == (&plain.kind, &plain.parameters)
        })
    };
    if !scene.objects.iter().all(is_plain) {
        writing.warn(format!("{format} files hold no materials: left out"));
    }
}
