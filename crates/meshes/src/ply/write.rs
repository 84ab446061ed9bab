//! Writes PLY.

use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::output::bake::{in_place, warn_of_materials, warn_of_scene};
use bilux_import::output::ply::encode;
use bilux_import::output::writing::Writing;
use bilux_import::world::frame::statement;
use bilux_scene::{Mesh, SceneBuilder};
use std::borrow::Cow;

pub(super) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    warn_of_scene(scene, "PLY", writing);
    warn_of_materials(scene, "PLY", writing);
    if scene.objects.len() > 1 {
        writing.warn("PLY files hold one object: all objects are merged");
    }
    let meshes: Vec<Cow<Mesh>> = scene.objects.iter().map(|object| in_place(object, writing)).collect();
    let meshes: Vec<&Mesh> = meshes.iter().map(|mesh| &**mesh).collect();
    if !holds_all(&meshes) {
        writing.warn(
            "a PLY file holds faces, lines or points: only the first kind that the scene has is written",
        );
    }
    let ascii = writing.options.ascii;
    match encode(&meshes, ascii, statement(scene).as_deref()) {
        Some(bytes) => writing.main = bytes,
        None => {
            let message = "a PLY file holds at most 2,147,483,647 vertices: split the scene";
            return Err(FormatError::malformed(message, whole_file(&writing.stem.as_str().into())));
        }
    }
    Ok(())
}

/// True if a file can hold everything that the meshes draw: only triangles, only lines, or only points.
fn holds_all(meshes: &[&Mesh]) -> bool {
    let any = |has: fn(&Mesh) -> bool| meshes.iter().any(|mesh| has(mesh));
    let kinds =
        [any(|m| !m.triangles.is_empty()), any(|m| !m.lines.is_empty()), any(|m| !m.points.is_empty())];
    kinds.iter().filter(|has| **has).count() <= 1
}
