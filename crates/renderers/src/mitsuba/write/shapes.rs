//! Writes objects: meshes as PLY files, and what has several instances as groups of shapes.

use super::document::{Document, Emission, Look};
use super::emitters::APART;
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::output::ply::encode;
use bilux_import::output::writing::Writing;
use bilux_math::{DMat4, Mat4, Transform};
use bilux_scene::{Mesh, Object, Visibility};
use std::sync::Arc;

impl Document<'_> {
    /// Writes an object, which shares its mesh and its material with others if `is_shared`.
    pub(super) fn object(
        &mut self,
        object: &Object,
        is_shared: bool,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        if object.mesh.triangles.is_empty() || object.visibility == Visibility::Hidden {
            return Ok(());
        }
        if object.visibility != Visibility::Full {
            writing.warn("Mitsuba files cannot store which rays see an object: written as seen by all");
        }
        if !object.motion.is_still() {
            writing.warn("moving objects are written as they are at 0 seconds");
        }
        let look = self.look(object.material, writing)?;
        let place = object.motion.at(0.0);
        // Instances neither emit in Mitsuba nor have media of their own.
        if is_shared && look.emission.is_none() && look.medium.is_none() {
            return self.instance(object, &look, &place, writing);
        }
        let file = self.mesh(&object.mesh, writing)?;
        let id = self.id(&object.name, "object");
        self.shape(&object.mesh, &file, &look, Some((&id, &place)), false, writing);
        let is_double = match &look.emission {
            Some(Emission::Even(_, both) | Emission::Picture(_, both)) => *both && !object.mesh.is_closed(),
            None => false,
        };
        if is_double {
            // Shapes emit from their fronts.
            let back = behind(&object.mesh);
            let file = self.written(&back, writing)?;
            let id = self.id(&object.name, "object");
            self.shape(&back, &file, &look, Some((&id, &place)), true, writing);
        }
        Ok(())
    }

    fn instance(
        &mut self,
        object: &Object,
        look: &Look,
        place: &Transform,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        let key = (Arc::as_ptr(&object.mesh), object.material);
        let group = match self.groups.get(&key) {
            Some(group) => group.clone(),
            None => {
                let file = self.mesh(&object.mesh, writing)?;
                let group = self.id(&object.mesh.name, "group");
                self.open(&format!("shape type=\"shapegroup\" id=\"{group}\""));
                self.shape(&object.mesh, &file, look, None, false, writing);
                self.close("shape");
                self.groups.insert(key, group.clone());
                group
            }
        };
        let id = self.id(&object.name, "object");
        self.open(&format!("shape type=\"instance\" id=\"{id}\""));
        self.line(&format!("<ref id=\"{group}\"/>"));
        self.matrix("to_world", *place.matrix());
        self.close("shape");
        Ok(())
    }

    fn shape(
        &mut self,
        mesh: &Mesh,
        file: &str,
        look: &Look,
        own: Option<(&str, &Transform)>,
        flips: bool,
        writing: &mut Writing,
    ) {
        let id = own.map_or_else(String::new, |(id, _)| format!(" id=\"{id}\""));
        self.open(&format!("shape type=\"ply\"{id}"));
        self.text("filename", file);
        if mesh.normals.is_empty() {
            self.flag("face_normals", true);
        }
        if !mesh.uvs.is_empty() {
            // v points downwards in Mitsuba.
            self.flag("flip_tex_coords", true);
        }
        if flips {
            self.flag("flip_normals", true);
        }
        let place = own.map_or(Mat4::IDENTITY, |(_, place)| *place.matrix());
        self.matrix("to_world", place);
        if !look.bsdf.is_empty() {
            self.line(&format!("<ref id=\"{}\"/>", look.bsdf));
        }
        if let Some(inside) = &look.medium {
            self.interior(inside, DMat4::from_cols_array(&place.as_dmat4().to_cols_array()), writing);
        }
        if let Some(emission) = &look.emission {
            self.open("emitter type=\"area\"");
            match emission {
                Emission::Even(radiance, _) => self.rgb("radiance", *radiance),
                Emission::Picture(texture, _) => self.out.push_str(texture),
            }
            self.close("emitter");
        }
        self.close("shape");
    }

    /// The file of a mesh, written on first use.
    fn mesh(&mut self, mesh: &Arc<Mesh>, writing: &mut Writing) -> Result<String, FormatError> {
        if let Some(file) = self.meshes.get(&Arc::as_ptr(mesh)) {
            return Ok(file.clone());
        }
        let file = self.written(mesh, writing)?;
        self.meshes.insert(Arc::as_ptr(mesh), file.clone());
        Ok(file)
    }

    fn written(&self, mesh: &Mesh, writing: &mut Writing) -> Result<String, FormatError> {
        if !mesh.vertex_kd.is_empty() || !mesh.vertex_ks.is_empty() {
            writing.warn("Mitsuba files cannot store vertex colours: left out");
        }
        if !mesh.uvs2.is_empty() {
            writing.warn("Mitsuba files store one set of texture coordinates: the second is left out");
        }
        let bare = Mesh { vertex_kd: Vec::new(), vertex_ks: Vec::new(), uvs2: Vec::new(), ..mesh.clone() };
        let Some(bytes) = encode(&[&bare], false, None) else {
            let message = "a mesh has more vertices than its file can hold";
            return Err(FormatError::malformed(message, whole_file(&writing.stem.as_str().into())));
        };
        Ok(writing.add_numbered("mesh", writing.count() + 1, "ply", bytes))
    }
}

/// A mesh a little behind another.
fn behind(mesh: &Mesh) -> Mesh {
    let step = APART * mesh.bounds().extent().length();
    let normals = mesh.smooth_normals();
    let mut back = mesh.clone();
    back.positions.iter_mut().zip(normals).for_each(|(p, normal)| *p -= normal * step);
    back
}
