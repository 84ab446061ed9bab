//! Writes pbrt-v4 scenes, with meshes as PLY files and images as PNG or EXR files.

mod lights;
mod material_parameters;
mod materials;
mod shape_attributes;
mod textures;
mod view;

use crate::FormatError;
use crate::ply::encode;
use crate::text::whole_file;
use crate::writing::{UnusedNames, Writing};
use bilux_math::{Rgb, Transform, Vec3};
use bilux_scene::{Mesh, Object, SceneBuilder};
use shape_attributes::ShapeAttributes;
use std::collections::HashMap;
use std::fmt::Write;
use std::sync::Arc;

/// A scene file under construction.
struct Document<'s> {
    scene: &'s SceneBuilder,
    out: String,
    /// The names of textures, materials and media.
    names: UnusedNames,
    /// Textures written so far, by content.
    textures: HashMap<String, String>,
    /// For each material of the scene, its name here and the attributes of its shapes.
    shape_attributes: Vec<ShapeAttributes>,
    /// The files of meshes.
    meshes: HashMap<*const Mesh, String>,
    /// Objects with several instances, by mesh and material.
    shared: HashMap<(*const Mesh, usize), String>,
}

pub(super) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    let mut document = Document {
        scene,
        out: String::new(),
        names: UnusedNames::default(),
        textures: HashMap::new(),
        shape_attributes: Vec::new(),
        meshes: HashMap::new(),
        shared: HashMap::new(),
    };
    document.view(writing);
    document.line("WorldBegin");
    for spec in &scene.materials {
        let look = document.look(spec, writing)?;
        document.shape_attributes.push(look);
    }
    for light in &scene.lights {
        document.light(light, writing)?;
    }
    let mut uses: HashMap<(*const Mesh, usize), usize> = HashMap::new();
    for object in &scene.objects {
        *uses.entry((Arc::as_ptr(&object.mesh), object.material)).or_default() += 1;
    }
    for object in &scene.objects {
        let is_shared = uses[&(Arc::as_ptr(&object.mesh), object.material)] > 1;
        document.object(object, is_shared, writing)?;
    }
    writing.main = document.out.into_bytes();
    Ok(())
}

impl Document<'_> {
    fn line(&mut self, line: &str) {
        self.out.push_str(line);
        self.out.push('\n');
    }

    /// A unique quoted name.
    fn name(&mut self, wanted: &str, otherwise: &str) -> String {
        let wanted = if wanted.is_empty() { otherwise } else { wanted };
        let plain = |c: char| if c == '"' || c == '\\' || c.is_control() { '_' } else { c };
        self.names.unused(&wanted.chars().map(plain).collect::<String>())
    }

    fn object(&mut self, object: &Object, is_shared: bool, writing: &mut Writing) -> Result<(), FormatError> {
        if object.mesh.triangles.is_empty() {
            return Ok(());
        }
        if !object.motion.is_still() {
            writing.warn("moving objects are written as they are at 0 seconds");
        }
        let place = object.motion.at(0.0);
        let look = self.shape_attributes.get(object.material).cloned().unwrap_or_default();
        let file = self.mesh(&object.mesh, writing)?;
        let shape = |look: &ShapeAttributes| {
            let mut out = look.begin.clone();
            let _ = writeln!(out, "Shape \"plymesh\" \"string filename\" \"{file}\"{}", look.alpha);
            out
        };
        // Surfaces of object instances do not emit in pbrt.
        if !is_shared || look.glows {
            let _ = write!(self.out, "AttributeBegin\n{}{}AttributeEnd\n", placed(&place), shape(&look));
            return Ok(());
        }
        let key = (Arc::as_ptr(&object.mesh), object.material);
        let name = match self.shared.get(&key) {
            Some(name) => name.clone(),
            None => {
                let name = self.name(&object.name, "object");
                let _ = write!(self.out, "ObjectBegin \"{name}\"\n{}ObjectEnd\n", shape(&look));
                self.shared.insert(key, name.clone());
                name
            }
        };
        let _ =
            write!(self.out, "AttributeBegin\n{}ObjectInstance \"{name}\"\nAttributeEnd\n", placed(&place));
        Ok(())
    }

    /// The file of a mesh, written on first use.
    fn mesh(&mut self, mesh: &Arc<Mesh>, writing: &mut Writing) -> Result<String, FormatError> {
        if let Some(file) = self.meshes.get(&Arc::as_ptr(mesh)) {
            return Ok(file.clone());
        }
        if !mesh.vertex_kd.is_empty() || !mesh.vertex_ks.is_empty() {
            writing.warn("pbrt files cannot store vertex colours: left out");
        }
        if !mesh.uvs2.is_empty() {
            writing.warn("pbrt files store one set of texture coordinates: the second is left out");
        }
        let bare =
            Mesh { vertex_kd: Vec::new(), vertex_ks: Vec::new(), uvs2: Vec::new(), ..(**mesh).clone() };
        let Some(bytes) = encode(&[&bare], writing.options.ascii) else {
            let message = "a mesh has more vertices than its file can hold";
            return Err(FormatError::malformed(message, whole_file(&writing.stem.as_str().into())));
        };
        let file = writing.add_numbered("mesh", self.meshes.len() + 1, "ply", bytes);
        self.meshes.insert(Arc::as_ptr(mesh), file.clone());
        Ok(file)
    }
}

/// The directive that applies a transform.
fn placed(place: &Transform) -> String {
    if place.is_identity() {
        return String::new();
    }
    format!("Transform [ {} ]\n", numbers(&place.matrix().to_cols_array()))
}

/// Numbers as text that parses back to the same values.
fn numbers(list: &[f32]) -> String {
    list.iter().map(f32::to_string).collect::<Vec<_>>().join(" ")
}

fn rgb(name: &str, colour: Rgb) -> String {
    format!(" \"rgb {name}\" [ {} ]", numbers(&colour.to_array()))
}

fn point(name: &str, at: Vec3) -> String {
    format!(" \"point3 {name}\" [ {} ]", numbers(&at.to_array()))
}

fn float(name: &str, number: f32) -> String {
    format!(" \"float {name}\" [ {number} ]")
}
