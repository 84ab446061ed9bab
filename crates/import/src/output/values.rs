//! Reads parameters of a spec, for writers.

use crate::output::writing::Writing;
use bilux_math::{Rgb, Vec3};
use bilux_scene::materials::{self, AsPrincipled, SHARED};
use bilux_scene::{MATERIALS, SceneBuilder, Spec, Value};

/// The number under a key, if there is one.
pub fn number(spec: &Spec, key: &str) -> Option<f32> {
    spec.number(key)
}

/// The colour under a key, if there is one; white for a texture.
pub fn colour(spec: &Spec, key: &str) -> Option<Rgb> {
    spec.colour(key)
}

/// The point or direction under a key, if there is one.
pub fn vector(spec: &Spec, key: &str) -> Option<Vec3> {
    match spec.parameters.find(key)?.0 {
        Value::List(_) => colour(spec, key).map(|c| Vec3::from_array(c.to_array())),
        _ => None,
    }
}

/// The index of the texture under a key, if there is one.
pub fn texture(spec: &Spec, key: &str) -> Option<usize> {
    match spec.parameters.find(key)?.0 {
        Value::Texture(index) => Some(*index),
        _ => None,
    }
}

/// The material parameters that a format supports.
pub struct MaterialSupport<'a> {
    pub format: &'static str,
    /// The parameters of each kind; other kinds are reported elsewhere.
    pub of_kinds: &'a [(&'a str, &'a [&'a str])],
    /// The parameters that every kind has.
    pub of_any: &'a [&'a str],
    /// The parameters that may be textures; `None` if that is reported elsewhere.
    pub textured: Option<&'a [&'a str]>,
}

impl MaterialSupport<'_> {
    /// Warns about parameters of a material that the format does not support.
    pub fn warn_unsupported(&self, spec: &Spec, writing: &mut Writing) {
        let MaterialSupport { format, of_kinds, of_any, textured } = self;
        let Some((kind, of_kind)) = of_kinds.iter().find(|(kind, _)| *kind == spec.kind) else { return };
        let Some(row) = MATERIALS.iter().find(|row| row.entry.name == *kind) else { return };
        for key in spec.differing(&row.entry) {
            if !of_kind.contains(&key) && !of_any.contains(&key) {
                writing.warn(format!("{format} files cannot store '{key}' of a {kind} material: left out"));
            } else if texture(spec, key).is_some() && textured.is_some_and(|held| !held.contains(&key)) {
                writing.warn(format!("{format} files cannot store a texture of '{key}': left out"));
            }
        }
    }
}

/// A material as `principled`, with warnings about what that leaves out; `None` where it is not described so.
pub fn as_principled(spec: &Spec, format: &'static str, writing: &mut Writing) -> Option<Spec> {
    let row = MATERIALS.iter().find(|row| row.entry.name == spec.kind)?;
    let AsPrincipled { keeps, differs, .. } = row.principled?;
    if !differs.is_empty() {
        let kind = row.entry.name;
        writing.warn(format!("a {kind} material is written as metallic-roughness, which {differs}"));
    }
    let of_kinds = &[(row.entry.name, keeps)];
    MaterialSupport { format, of_kinds, of_any: SHARED, textured: None }.warn_unsupported(spec, writing);
    materials::as_principled(spec)
}

/// A material of any kind as `principled`, for formats that know no other, with warnings about what that leaves out.
pub fn nearest_principled(
    spec: &Spec,
    scene: &SceneBuilder,
    format: &'static str,
    writing: &mut Writing,
) -> Spec {
    if spec.kind == "principled" {
        return spec.clone();
    }
    let spec = &*materials::with_indices(spec);
    if let Some(principled) = as_principled(spec, format, writing) {
        return principled;
    }
    let first = spec.parameters.find("a").and_then(|(value, _)| match value {
        Value::Material(index) => scene.materials.get(*index),
        _ => None,
    });
    let instead = if first.is_some() { "its first part is" } else { "a plain one with its name is" };
    writing
        .warn(format!("{format} files cannot store the material '{}': {instead} written instead", spec.kind));
    match first.filter(|first| first.kind != "mix") {
        Some(first) => Spec { name: spec.name.clone(), ..nearest_principled(first, scene, format, writing) },
        None => Spec::new(&spec.name, "principled"),
    }
}
