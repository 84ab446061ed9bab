//! Conversions for formats that support neither transforms nor motion nor procedural textures.

use crate::geometry::normals::unit_face_normal;
use crate::input::reading::plain_material;
use crate::output::writing::Writing;
use bilux_math::{Transform, Vec3};
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Value};
use std::borrow::Cow;
use std::sync::Arc;

/// Scene without the media that have no surface, in formats that cannot hold them: as objects they would be opaque boxes.
pub fn without_media<'a>(
    scene: &'a SceneBuilder,
    capabilities: &[&str],
    writing: &mut Writing,
) -> Cow<'a, SceneBuilder> {
    let is_medium =
        |material: usize| scene.materials.get(material).is_some_and(|spec| spec.kind == "interface");
    if capabilities.contains(&"media") || !scene.objects.iter().any(|object| is_medium(object.material)) {
        return Cow::Borrowed(scene);
    }
    let mut kept = scene.clone();
    kept.objects.retain(|object| !is_medium(object.material));
    for object in scene.objects.iter().filter(|object| is_medium(object.material)) {
        writing.warn(format!("the format cannot store fog and smoke: '{}' is left out", name_of(object)));
    }
    Cow::Owned(kept)
}

/// Replaces procedural textures by images if the format does not support them.
pub fn with_pictures<'a>(
    scene: &'a SceneBuilder,
    capabilities: &[&str],
    writing: &mut Writing,
) -> Cow<'a, SceneBuilder> {
    let can = |what: &str| capabilities.contains(&what);
    let holds_formulas = can("procedural textures") || !can("textures");
    if holds_formulas || scene.textures.iter().all(|texture| texture.formula().is_none()) {
        return Cow::Borrowed(scene);
    }
    let mut scene = scene.clone();
    let SceneBuilder { textures, materials, .. } = &mut scene;
    for (index, texture) in textures.iter_mut().enumerate() {
        // A texture with its own placement cannot be packed with the other textures of its material.
        let may_move = can("moved textures") && materials.iter().all(|spec| is_only_texture(spec, index));
        let Some((picture, is_same)) = texture.baked(may_move) else { continue };
        if !is_same {
            let (name, width, height) = (&texture.name, picture.width(), picture.height());
            writing.warn(format!(
                "the format cannot store procedural textures: '{name}' is written as a repeating picture of {width} x \
                 {height} texels"
            ));
        }
        *texture = Arc::new(picture);
    }
    Cow::Owned(scene)
}

/// True if the material uses no other texture next to this one, or does not use this one.
fn is_only_texture(spec: &Spec, index: usize) -> bool {
    let all = || {
        spec.parameters.0.iter().filter_map(|(_, value, _)| match value {
            Value::Texture(index) => Some(*index),
            _ => None,
        })
    };
    all().all(|other| other != index) || all().count() == 1
}

/// An object's mesh, transformed to its position at time 0.
pub fn in_place<'a>(object: &'a Object, writing: &mut Writing) -> Cow<'a, Mesh> {
    if !object.motion.is_still() {
        writing.warn("the format cannot store motion: objects are written as they are at 0 seconds");
    }
    let transform = object.motion.at(0.0);
    if transform.is_identity() {
        return Cow::Borrowed(&object.mesh);
    }
    Cow::Owned(transformed(&object.mesh, &transform))
}

/// A copy of the mesh with its vertices transformed.
pub fn transformed(mesh: &Mesh, transform: &Transform) -> Mesh {
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

/// The name of the object, or of its mesh if the object has none.
pub fn name_of(object: &Object) -> &str {
    if object.name.is_empty() { &object.mesh.name } else { &object.name }
}

/// The positions of a triangle's corners, if its indices are valid.
pub fn corners(mesh: &Mesh, triangle: [u32; 3]) -> Option<[Vec3; 3]> {
    let [a, b, c] = triangle.map(|i| mesh.positions.get(i as usize).copied());
    Some([a?, b?, c?])
}

/// The unit normal of the triangle by the right-hand rule; zero for a degenerate triangle.
pub fn flat_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    unit_face_normal(&[a, b, c])
}

/// Warns about what vertices add to a material beyond reflectance, which no format stores.
pub fn warn_of_vertices(scene: &SceneBuilder, writing: &mut Writing) {
    let any = |has: fn(&Mesh) -> bool| scene.objects.iter().any(|object| has(&object.mesh));
    let parts = [
        ("colours that vertices emit", any(|mesh| mesh.emission_by_kd)),
        ("opacities of vertices", any(|mesh| !mesh.vertex_opacity.is_empty())),
        ("widths of single points", any(|mesh| !mesh.point_widths.is_empty())),
    ];
    for (what, _) in parts.into_iter().filter(|(_, is_there)| *is_there) {
        writing.warn(format!("no format of scene files stores {what}: left out"));
    }
}

/// Warns about everything that a format of bare meshes leaves out.
pub fn warn_of_scene(scene: &SceneBuilder, format: &str, writing: &mut Writing) {
    let parts = [
        ("lights", scene.lights.len()),
        ("cameras", scene.cameras.len()),
        ("render settings", scene.settings.0.len()),
    ];
    for (what, count) in parts.into_iter().filter(|&(_, count)| count > 0) {
        writing.warn(format!("{format} files cannot store {what}: {count} left out"));
    }
}

/// Warns about materials if the format supports none: all except the plain ones.
pub fn warn_of_materials(scene: &SceneBuilder, format: &str, writing: &mut Writing) {
    let is_plain = |object: &Object| {
        let (kd, ks) = (!object.mesh.vertex_kd.is_empty(), !object.mesh.vertex_ks.is_empty());
        let spec = scene.materials.get(object.material);
        spec.is_none_or(|spec| {
            let plain = plain_material(kd, ks);
            (&spec.kind, &spec.parameters) == (&plain.kind, &plain.parameters)
        })
    };
    if !scene.objects.iter().all(is_plain) {
        writing.warn(format!("{format} files cannot store materials: left out"));
    }
}
