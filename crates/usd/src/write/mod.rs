//! Writes USD: a layer of text, with pictures beside it or in one package.

mod attributes;
mod cameras;
mod document;
mod draft;
mod lights;
mod materials;
mod names;
mod objects;
mod placement;
mod strokes;
mod text;
mod textures;

use bilux_import::FormatError;
use bilux_import::bytes::zipped::{Members, zipped};
use bilux_import::output::writing::Writing;
use bilux_scene::{Mesh, SceneBuilder};
use document::Document;
use std::collections::HashMap;
use std::sync::Arc;

/// Writes a layer.
pub(crate) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    writing.main = layer(scene, writing)?;
    Ok(())
}

/// Writes a package: the layer first, then its pictures.
pub(crate) fn write_package(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    let layer = layer(scene, writing)?;
    let mut members = vec![(format!("{}.usda", writing.stem), layer)];
    members.extend(writing.take_beside());
    writing.main = zipped(&members, Members::Aligned)?;
    Ok(())
}

fn layer(scene: &SceneBuilder, writing: &mut Writing) -> Result<Vec<u8>, FormatError> {
    if !scene.settings.0.is_empty() {
        writing.warn("USD files cannot store render settings: left out");
    }
    let mut document = Document::new(scene);
    let mut uses: HashMap<(*const Mesh, usize), usize> = HashMap::new();
    for object in &scene.objects {
        *uses.entry((Arc::as_ptr(&object.mesh), object.material)).or_default() += 1;
    }
    for object in &scene.objects {
        let is_shared = uses[&(Arc::as_ptr(&object.mesh), object.material)] > 1;
        document.object(object, is_shared, writing)?;
    }
    for light in &scene.lights {
        document.light(light, writing)?;
    }
    for camera in &scene.cameras {
        document.camera(camera, writing);
    }
    Ok(document.finish())
}
