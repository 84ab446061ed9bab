//! Writes scenes of Mitsuba 3, with meshes as PLY files and images as PNG or EXR files.

mod bsdfs;
mod document;
mod emitters;
mod materials;
mod media;
mod sensors;
mod shapes;
mod textures;

use bilux_import::FormatError;
use bilux_import::output::writing::Writing;
use bilux_scene::{Mesh, SceneBuilder};
use document::Document;
use std::collections::HashMap;
use std::sync::Arc;

pub(super) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    let mut document = Document::new(scene);
    document.line("<!-- Bilux -->");
    document.open("scene version=\"3.0.0\"");
    document.settings(writing);
    for camera in &scene.cameras {
        document.sensor(camera, writing);
    }
    for light in &scene.lights {
        document.emitter(light, writing)?;
    }
    let mut uses: HashMap<(*const Mesh, usize), usize> = HashMap::new();
    for object in &scene.objects {
        *uses.entry((Arc::as_ptr(&object.mesh), object.material)).or_default() += 1;
    }
    for object in &scene.objects {
        let is_shared = uses[&(Arc::as_ptr(&object.mesh), object.material)] > 1;
        document.object(object, is_shared, writing)?;
    }
    document.close("scene");
    let emits = document.looks.values().any(|look| look.emission.is_some());
    if scene.lights.is_empty() && !emits && !scene.describes_all_light && !scene.objects.is_empty() {
        writing.warn("the scene has no light, and Mitsuba adds none: it is black there");
    }
    writing.main = document.out.into_bytes();
    Ok(())
}
