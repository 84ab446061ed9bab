//! Writes pbrt-v4 scenes, with meshes as PLY files and images as PNG or EXR files.

mod document;
mod lights;
mod material_parameters;
mod materials;
mod objects;
mod shape_attributes;
mod textures;
mod view;

use bilux_import::FormatError;
use bilux_import::output::writing::Writing;
use bilux_scene::{Mesh, SceneBuilder};
use document::Document;
use objects::Objects;
use std::collections::HashMap;
use std::sync::Arc;

pub(super) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    let mut document = Document::new(scene);
    document.view(writing);
    document.line("WorldBegin");
    let mut shape_attributes = Vec::new();
    for spec in &scene.materials {
        shape_attributes.push(document.look(spec, writing)?);
    }
    for light in &scene.lights {
        document.light(light, writing)?;
    }
    let mut uses: HashMap<(*const Mesh, usize), usize> = HashMap::new();
    for object in &scene.objects {
        *uses.entry((Arc::as_ptr(&object.mesh), object.material)).or_default() += 1;
    }
    let mut objects = Objects::new(shape_attributes);
    for object in &scene.objects {
        let is_shared = uses[&(Arc::as_ptr(&object.mesh), object.material)] > 1;
        objects.object(object, is_shared, &mut document, writing)?;
    }
    writing.main = document.out.into_bytes();
    Ok(())
}
