//! `plymesh`: triangles from a PLY file, which may be compressed.

use super::super::document::ShapeGeometry;
use super::super::parameters::ParameterList;
use super::maker::ShapeMaker;
use bilux_import::FormatError;
use bilux_import::input::reading::Source;
use bilux_scene::{Mesh, SceneError};
use std::path::Path;
use std::sync::Arc;

pub(super) fn make(
    maker: &mut ShapeMaker,
    list: &ParameterList,
) -> Result<Option<ShapeGeometry>, FormatError> {
    let Some(name) = list.text("filename")? else {
        let what = "filename (of the PLY file)".to_owned();
        return Err(SceneError::Missing { what, at: list.at.clone() }.into());
    };
    let at = list.place("filename");
    if list.has("displacement") {
        maker.loader.note("displacement of a mesh is not supported", || list.place("displacement"));
        list.has("edgelength");
    }
    let path = maker.loader.reading.locator.locate(maker.loader.folder.as_deref(), name, &at)?;
    let key = (path.clone(), maker.reverses);
    if let Some(mesh) = maker.cache.files.get(&key) {
        return Ok(Some(ShapeGeometry::Mesh(mesh.clone())));
    }
    let bytes = maker.loader.reading.load(&path)?;
    let shown: Arc<str> = Path::new(&*at.file).with_file_name(name).display().to_string().into();
    let source = Source { bytes: &bytes, name: &shown, folder: path.parent() };
    // In pbrt, a mesh without normals is flat.
    let crease_angle = std::mem::replace(&mut maker.loader.reading.crease_angle, 0.0);
    let model = maker.loader.reading.read_named("ply", &source);
    maker.loader.reading.crease_angle = crease_angle;
    let mut model = model?;
    maker.loader.reading.release(bytes);
    maker.cache.warnings.append(&mut model.warnings);
    maker.cache.notes.append(&mut model.notes);
    let mut meshes = model.objects.into_iter().map(|object| Arc::unwrap_or_clone(object.mesh));
    let mesh = meshes.next().unwrap_or_default();
    // pbrt ignores vertex colours.
    let mesh = Mesh { vertex_kd: Vec::new(), vertex_ks: Vec::new(), ..mesh };
    let form = maker.finished(mesh, list)?;
    if let Some(ShapeGeometry::Mesh(mesh)) = &form {
        maker.cache.files.insert(key, mesh.clone());
    }
    Ok(form)
}
