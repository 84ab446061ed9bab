//! The model: resources, then the items to build.

use super::meshes::Welded;
use bilux_import::FormatError;
use bilux_import::bytes::xml::escaped;
use bilux_import::output::bake::name_of;
use bilux_import::output::writing::Writing;
use bilux_math::Rgb;
use bilux_scene::{Mesh, Object, SceneBuilder, Texture};
use std::collections::HashMap;
use std::fmt::Write;
use std::sync::Arc;

pub(super) struct Model<'s> {
    pub(super) scene: &'s SceneBuilder,
    pub(super) resources: String,
    items: String,
    /// The last identifier of a resource.
    last: usize,
    pub(super) looks: HashMap<usize, Look>,
    /// Objects by mesh and material; `None` for those without a triangle.
    pub(super) meshes: HashMap<(*const Mesh, usize), Option<usize>>,
    /// Meshes that are not closed.
    pub(super) open: usize,
}

/// Look of a mesh, from its material.
#[derive(Clone)]
pub(super) struct Look {
    /// The group of its base material, of which there is one.
    pub(super) group: usize,
    pub(super) colour: Rgb,
    /// Texture of the material, and the identifier of its resource.
    pub(super) picture: Option<(Arc<Texture>, usize)>,
}

/// The properties of the corners of all triangles, and their group.
pub(super) type Properties = (usize, Vec<[usize; 3]>);

impl<'s> Model<'s> {
    pub(super) fn new(scene: &'s SceneBuilder) -> Model<'s> {
        let (looks, meshes) = Default::default();
        Model { scene, resources: String::new(), items: String::new(), last: 0, looks, meshes, open: 0 }
    }

    /// The identifier of the next resource.
    pub(super) fn id(&mut self) -> usize {
        self.last += 1;
        self.last
    }

    /// Adds an object, whose mesh is written on first use.
    pub(super) fn object(&mut self, object: &Object, writing: &mut Writing) -> Result<(), FormatError> {
        if object.mesh.triangles.is_empty() {
            return Ok(());
        }
        if !object.motion.is_still() {
            writing.warn("the format cannot store motion: objects are written as they are at 0 seconds");
        }
        let key = (Arc::as_ptr(&object.mesh), object.material);
        let id = match self.meshes.get(&key) {
            Some(known) => *known,
            None => {
                let made = self.mesh(object, writing)?;
                self.meshes.insert(key, made);
                made
            }
        };
        let Some(id) = id else { return Ok(()) };
        let place = object.motion.at(0.0);
        let place = place.matrix();
        let columns = [place.x_axis, place.y_axis, place.z_axis, place.w_axis].map(|axis| axis.truncate());
        let numbers: Vec<String> = columns.iter().flat_map(|c| c.to_array()).map(|x| x.to_string()).collect();
        let name = escaped(name_of(object));
        let _ = writeln!(
            self.items,
            "    <item objectid=\"{id}\" transform=\"{}\" partnumber=\"{name}\"/>",
            numbers.join(" ")
        );
        Ok(())
    }

    fn mesh(&mut self, object: &Object, writing: &mut Writing) -> Result<Option<usize>, FormatError> {
        let welded = Welded::of(&object.mesh);
        if welded.dropped > 0 {
            writing
                .warn("3MF files cannot store triangles whose corners coincide or are not finite: left out");
        }
        if welded.triangles.is_empty() {
            return Ok(None);
        }
        let look = self.look(object.material, writing)?;
        let properties = self.properties(&object.mesh, &welded, &look, writing);
        let id = self.id();
        let is_closed = welded.is_closed();
        self.open += usize::from(!is_closed);
        let kind = if is_closed { "model" } else { "surface" };
        let name = escaped(if object.mesh.name.is_empty() { &object.name } else { &object.mesh.name });
        let out = &mut self.resources;
        let _ = writeln!(
            out,
            "    <object id=\"{id}\" type=\"{kind}\" name=\"{name}\" pid=\"{}\" pindex=\"{}\"><mesh><vertices>",
            look.group, 0
        );
        for p in &welded.positions {
            let _ = writeln!(out, "<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", p.x, p.y, p.z);
        }
        out.push_str("</vertices><triangles>\n");
        for (i, (triangle, _)) in welded.triangles.iter().enumerate() {
            let [a, b, c] = triangle;
            let _ = write!(out, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"");
            if let Some((group, corners)) = &properties {
                let [a, b, c] = corners[i];
                let _ = write!(out, " pid=\"{group}\" p1=\"{a}\" p2=\"{b}\" p3=\"{c}\"");
            }
            out.push_str("/>\n");
        }
        out.push_str("</triangles></mesh></object>\n");
        Ok(Some(id))
    }

    pub(super) fn finish(self) -> Vec<u8> {
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <model unit=\"millimeter\" xml:lang=\"en-US\" \
             xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
             xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\">\n\
             <metadata name=\"Application\">Bilux</metadata>\n<resources>\n{}</resources>\n<build>\n{}</build>\n</model>\n",
            self.resources, self.items
        )
        .into_bytes()
    }
}
