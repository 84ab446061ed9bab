//! Writes objects: meshes as files of their own, and what has several instances as objects of pbrt.

use super::document::{Document, numbers};
use super::shape_attributes::ShapeAttributes;
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::output::ply::encode;
use bilux_import::output::writing::Writing;
use bilux_math::Transform;
use bilux_scene::{Mesh, Object};
use std::collections::HashMap;
use std::fmt::Write;
use std::sync::Arc;

/// Objects, as far as they have been written.
pub(super) struct Objects {
    /// For each material of the scene, its name here and the attributes of its shapes.
    shape_attributes: Vec<ShapeAttributes>,
    /// The files of meshes.
    meshes: HashMap<*const Mesh, String>,
    /// Objects with several instances, by mesh and material.
    shared: HashMap<(*const Mesh, usize), String>,
}

impl Objects {
    /// None, of these materials.
    pub(super) fn new(shape_attributes: Vec<ShapeAttributes>) -> Objects {
        Objects { shape_attributes, meshes: HashMap::new(), shared: HashMap::new() }
    }

    /// Writes an object, which shares its mesh and its material with others if `is_shared`.
    pub(super) fn object(
        &mut self,
        object: &Object,
        is_shared: bool,
        document: &mut Document,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
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
            let _ = write!(document.out, "AttributeBegin\n{}{}AttributeEnd\n", placed(&place), shape(&look));
            return Ok(());
        }
        let key = (Arc::as_ptr(&object.mesh), object.material);
        let name = match self.shared.get(&key) {
            Some(name) => name.clone(),
            None => {
                let name = document.name(&object.name, "object");
                let _ = write!(document.out, "ObjectBegin \"{name}\"\n{}ObjectEnd\n", shape(&look));
                self.shared.insert(key, name.clone());
                name
            }
        };
        let _ = write!(
            document.out,
            "AttributeBegin\n{}ObjectInstance \"{name}\"\nAttributeEnd\n",
            placed(&place)
        );
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
        let Some(bytes) = encode(&[&bare], writing.options.ascii, None) else {
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
