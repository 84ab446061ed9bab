//! Writes objects: one prim for each, and classes for what occurs several times.

use super::attributes::{BY_FACE, BY_VERTEX, colours, extent};
use super::document::{Document, Look, MATERIALS, PROTOTYPES, ROOT};
use super::strokes;
use super::text::{Text, quoted};
use bilux_import::FormatError;
use bilux_import::output::bake::{corners, flat_normal, name_of};
use bilux_import::output::writing::Writing;
use bilux_math::{Motion, Rgb};
use bilux_scene::{Mesh, Object, Visibility};
use std::sync::Arc;

/// The schema of prims with a material, and that of prims with a label.
const BINDING: &str = "MaterialBindingAPI";
const LABELS: &str = "SemanticsLabelsAPI:category";

impl Document<'_> {
    /// Writes an object, which shares its mesh and its material with others if `is_shared`.
    pub(super) fn object(
        &mut self,
        object: &Object,
        is_shared: bool,
        writing: &mut Writing,
    ) -> Result<(), FormatError> {
        if object.mesh.is_empty() {
            return Ok(());
        }
        if !object.mesh.vertex_ks.is_empty() {
            writing.warn("USD files cannot store ks of vertices: left out");
        }
        let look = self.look(object.material, !object.mesh.vertex_kd.is_empty(), writing)?;
        let wanted = name_of(object);
        let name = self.names.unused(wanted, "object");
        let has = [(BINDING, !look.path.is_empty()), (LABELS, !object.category.is_empty())];
        let applied = has.into_iter().filter(|(_, is_there)| *is_there).map(|(schema, _)| schema);
        let mut metadata = schemas(&applied.collect::<Vec<_>>());
        if name != wanted && !wanted.is_empty() {
            metadata.push(format!("displayName = {}", quoted(wanted)));
        }
        let mut text = std::mem::replace(&mut self.prims, Text::at_depth(1));
        if is_shared {
            let class = self.class(object, &look);
            metadata.push("instanceable = true".to_owned());
            metadata.push(format!("prepend references = </{PROTOTYPES}/{class}>"));
            text.open(&format!("def Xform \"{name}\""), &metadata);
            self.own(object, &look, &mut text, writing);
        } else if let [(kind, write)] = self.kinds(&object.mesh)[..] {
            text.open(&format!("def {kind} \"{name}\""), &metadata);
            self.own(object, &look, &mut text, writing);
            write(self, &object.mesh, &look, &mut text);
        } else {
            text.open(&format!("def Xform \"{name}\""), &metadata);
            self.own(object, &look, &mut text, writing);
            self.geometry(&object.mesh, &look, &mut text);
        }
        text.close();
        self.prims = text;
        Ok(())
    }

    /// Writes what belongs to an object rather than to its mesh.
    fn own(&mut self, object: &Object, look: &Look, text: &mut Text, writing: &mut Writing) {
        if !look.path.is_empty() {
            text.line(&format!("rel material:binding = <{}>", look.path));
        }
        if !object.category.is_empty() {
            text.line(&format!("token[] semantics:labels:category = [{}]", quoted(&object.category)));
        }
        match object.visibility {
            Visibility::Full => {}
            Visibility::Hidden => text.line("token visibility = \"invisible\""),
            _ => {
                writing.warn("USD files cannot store which rays see an object: written as seen by all");
            }
        }
        let motion: &Motion = &object.motion;
        self.place(motion, text);
    }

    /// The class of a mesh with a material, written on first use.
    fn class(&mut self, object: &Object, look: &Look) -> String {
        let key = (Arc::as_ptr(&object.mesh), object.material);
        if let Some(name) = self.classes.get(&key) {
            return name.clone();
        }
        let name = self.prototype_names.unused(&object.mesh.name, name_of(object));
        let mut text = std::mem::replace(&mut self.prototypes, Text::at_depth(1));
        text.open(&format!("def Xform \"{name}\""), &[]);
        self.geometry(&object.mesh, look, &mut text);
        text.close();
        self.prototypes = text;
        self.classes.insert(key, name.clone());
        name
    }

    /// The prims of a mesh with several kinds of parts.
    fn geometry(&self, mesh: &Mesh, look: &Look, text: &mut Text) {
        for (kind, write) in self.kinds(mesh) {
            text.open(&format!("def {kind} \"{kind}\""), &[]);
            write(self, mesh, look, text);
            text.close();
        }
    }

    fn kinds(&self, mesh: &Mesh) -> Vec<(&'static str, WritePart)> {
        let all: [(&str, bool, WritePart); 3] = [
            ("Mesh", !mesh.triangles.is_empty(), |_, mesh, look, text| triangles(mesh, look, text)),
            ("Points", !mesh.points.is_empty(), |document, mesh, look, text| {
                strokes::points(document.scene, mesh, look, text);
            }),
            ("BasisCurves", !mesh.lines.is_empty(), |document, mesh, look, text| {
                strokes::lines(document.scene, mesh, look, text);
            }),
        ];
        all.into_iter().filter(|(_, is_there, _)| *is_there).map(|(kind, _, write)| (kind, write)).collect()
    }

    /// Writes triangles that are in place.
    pub(super) fn bare(&mut self, wanted: &str, mesh: &Mesh, look: &Look) {
        let name = self.names.unused(wanted, "object");
        let mut text = std::mem::replace(&mut self.prims, Text::at_depth(1));
        text.open(&format!("def Mesh \"{name}\""), &schemas(&[BINDING]));
        text.line(&format!("rel material:binding = <{}>", look.path));
        triangles(mesh, look, &mut text);
        text.close();
        self.prims = text;
    }

    /// The path of a material of this name.
    pub(super) fn material_path(name: &str) -> String {
        format!("/{ROOT}/{MATERIALS}/{name}")
    }
}

/// The metadata of a prim with these schemas.
fn schemas(applied: &[&str]) -> Vec<String> {
    let list: Vec<String> = applied.iter().map(|schema| quoted(schema)).collect();
    if list.is_empty() { Vec::new() } else { vec![format!("prepend apiSchemas = [{}]", list.join(", "))] }
}

type WritePart = fn(&Document, &Mesh, &Look, &mut Text);

fn triangles(mesh: &Mesh, look: &Look, text: &mut Text) {
    text.line(&format!("uniform bool doubleSided = {}", u8::from(look.has_two_sides)));
    extent(mesh, text);
    text.list("int[] faceVertexCounts", &mesh.triangles, |out, _| out.push(b'3'), "");
    text.integers("int[] faceVertexIndices", mesh.triangles.iter().flatten().copied());
    if mesh.normals.is_empty() {
        // Readers that find no normals make a surface smooth.
        let flat =
            mesh.triangles.iter().map(|t| corners(mesh, *t).map_or([0.0; 3], |t| flat_normal(t).into()));
        text.tuples("normal3f[] normals", flat, BY_FACE);
    } else {
        text.tuples("normal3f[] normals", mesh.normals.iter().map(|n| n.to_array()), BY_VERTEX);
    }
    text.tuples("point3f[] points", mesh.positions.iter().map(|p| p.to_array()), "");
    colours(mesh, look, text);
    for (name, uvs) in [("st", &mesh.uvs), ("st1", &mesh.uvs2)] {
        if !uvs.is_empty() {
            let attribute = format!("texCoord2f[] primvars:{name}");
            text.tuples(&attribute, uvs.iter().map(|uv| uv.to_array()), BY_VERTEX);
        }
    }
    text.line("uniform token subdivisionScheme = \"none\"");
}

impl Look {
    /// A surface that a material says nothing about but its colour and its opacity.
    pub(super) fn plain(colour: Option<Rgb>, opacity: Option<f32>) -> Look {
        let factor = colour.unwrap_or(Rgb::grey(0.7));
        Look { path: String::new(), colour, opacity, factor, has_two_sides: true }
    }
}
