//! Meshes from files of other formats.

use super::attributes::select;
use super::maker::{FileKey, Piece, ShapeMaker};
use super::solids::upwards;
use crate::mitsuba::plugin::Plugin;
use bilux_import::FormatError;
use bilux_import::input::names::shortened;
use bilux_import::input::reading::Source;
use bilux_math::DMat4;
use bilux_math::colour::srgb_encode;
use bilux_scene::Mesh;
use std::rc::Rc;
use std::sync::Arc;

pub(super) fn obj(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    make(maker, plugin, "obj", true)
}

pub(super) fn ply(maker: &mut ShapeMaker, plugin: &Rc<Plugin>) -> Result<Vec<Piece>, FormatError> {
    make(maker, plugin, "ply", false)
}

fn make(
    maker: &mut ShapeMaker,
    plugin: &Rc<Plugin>,
    format: &str,
    flips_by_default: bool,
) -> Result<Vec<Piece>, FormatError> {
    let (name, at) = plugin.file()?;
    plugin.ignore(&["load_materials", "max_smooth_angle", "collapse", "srgb"]);
    let flips = plugin.flag("flip_normals", false)?;
    let is_flat = plugin.flag("face_normals", false)?;
    let v_upwards = plugin.flag("flip_tex_coords", flips_by_default)?;
    let (path, _) = maker.maker.files().locate(name, &at, maker.maker.reading)?;
    let attribute = match maker.maker.document.part_of(plugin, "bsdf")? {
        Some(bsdf) if format == "ply" => maker.maker.document.attribute(&bsdf)?,
        _ => None,
    };
    let key: FileKey = (path.clone(), 0, [flips, is_flat, v_upwards], attribute.clone());
    if let Some(meshes) = maker.cache.files.get(&key) {
        let meshes = meshes.clone();
        return maker.placed(plugin, meshes, &DMat4::IDENTITY);
    }
    let reading = &mut *maker.maker.reading;
    let mut bytes = reading.load(&path)?;
    if format == "obj" {
        without_materials(&mut bytes);
    }
    let is_coloured = attribute.as_ref().is_some_and(|name| select(&mut bytes, name));
    if let Some(name) = attribute.filter(|_| !is_coloured) {
        let what =
            format!("a mesh has no attribute '{}' of three numbers: it is taken as 1", shortened(&name));
        maker.maker.diagnostics.note(&what, || at.clone());
    }
    let reading = &mut *maker.maker.reading;
    let shown: Arc<str> = path.display().to_string().into();
    let source = Source { bytes: &bytes, name: &shown, folder: path.parent() };
    // A mesh without normals is smooth all over, or not at all.
    let crease_angle = std::mem::replace(&mut reading.crease_angle, if is_flat { 0.0 } else { 180.0 });
    let model = reading.read_named(format, &source);
    reading.crease_angle = crease_angle;
    let mut model = model?;
    reading.release(bytes);
    maker.cache.warnings.append(&mut model.warnings);
    maker.cache.notes.append(&mut model.notes);
    let mut meshes = Vec::new();
    for object in model.objects {
        let mesh = Arc::unwrap_or_clone(object.mesh);
        let mut mesh = Mesh { vertex_ks: Vec::new(), ..mesh };
        if is_coloured {
            // They are linear numbers there; our reader takes those of PLY files as sRGB.
            mesh.vertex_kd.iter_mut().for_each(|colour| *colour = colour.map(srgb_encode));
        } else {
            mesh.vertex_kd = Vec::new();
        }
        if is_flat {
            mesh.normals.clear();
        }
        let mesh = if v_upwards { mesh } else { upwards(mesh) };
        meshes.push(maker.finished(mesh, flips, plugin)?);
    }
    maker.cache.files.insert(key, meshes.clone());
    maker.placed(plugin, meshes, &DMat4::IDENTITY)
}

/// Makes comments of the lines that name materials, which belong to the scene here.
fn without_materials(bytes: &mut [u8]) {
    let mut starts_line = true;
    for i in 0..bytes.len() {
        let rest = &bytes[i..];
        if starts_line && (rest.starts_with(b"mtllib") || rest.starts_with(b"usemtl")) {
            bytes[i] = b'#';
        }
        starts_line = matches!(bytes[i], b'\n' | b'\r');
    }
}
