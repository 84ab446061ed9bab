//! Writes glTF: `.glb` as one file, `.gltf` with a separate binary file.
//!
//! Materials become metallic-roughness with extensions for the rest; area and sphere lights become emissive
//! meshes.

mod buffer;
mod kinds;
mod material;
mod nodes;
mod pictures;

use crate::document::extras::{CATEGORY, SURROUNDINGS};
use bilux_import::FormatError;
use bilux_import::output::bake::name_of;
use bilux_import::output::writing::Writing;
use bilux_scene::{Mesh, Object, SceneBuilder, Visibility};
use buffer::Buffer;
use serde_json::{Map, Value as Json, json};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// A document under construction.
pub(crate) struct Document<'s> {
    pub(crate) scene: &'s SceneBuilder,
    buffer: Buffer,
    /// The lists of the document by name, in the order of their indices.
    lists: BTreeMap<&'static str, Vec<Json>>,
    extensions: BTreeSet<&'static str>,
    /// Samplers and images written so far, by content.
    pub(crate) known: HashMap<String, usize>,
    meshes: HashMap<(*const Mesh, usize), usize>,
    /// The root nodes of the scene.
    roots: Vec<usize>,
}

pub(crate) fn write(scene: &SceneBuilder, writing: &mut Writing) -> Result<(), FormatError> {
    if !scene.settings.0.is_empty() {
        writing.warn("glTF files cannot store render settings: left out");
    }
    let mut document = Document {
        scene,
        buffer: Buffer::default(),
        lists: BTreeMap::new(),
        extensions: BTreeSet::new(),
        known: HashMap::new(),
        meshes: HashMap::new(),
        roots: Vec::new(),
    };
    for spec in &scene.materials {
        let material = document.material(spec, writing)?;
        document.push("materials", material);
    }
    for object in &scene.objects {
        document.object(object, writing)?;
    }
    for camera in &scene.cameras {
        document.camera(camera, writing);
    }
    for light in &scene.lights {
        document.light(light, writing);
    }
    document.finish(writing);
    Ok(())
}

impl Document<'_> {
    /// Adds an item to a list of the document, and returns its index.
    pub(crate) fn push(&mut self, list: &'static str, item: Json) -> usize {
        let list = self.lists.entry(list).or_default();
        list.push(item);
        list.len() - 1
    }

    /// Records that an extension is used.
    pub(crate) fn uses(&mut self, extension: &'static str) -> &'static str {
        self.extensions.insert(extension);
        extension
    }

    /// Adds a root node to the scene.
    pub(crate) fn root(&mut self, node: Json) -> usize {
        let index = self.push("nodes", node);
        self.roots.push(index);
        index
    }

    fn object(&mut self, object: &Object, writing: &mut Writing) -> Result<(), FormatError> {
        if object.mesh.is_empty() {
            return Ok(());
        }
        let mesh = self.mesh(&object.mesh, object.material, writing)?;
        let name = name_of(object);
        if object.visibility != Visibility::Full {
            writing.warn("glTF files cannot store which rays see an object: written as seen by all");
        }
        let mut child = None;
        // The node with the mesh, within one node for each further part of its motion.
        for motion in object.motion.parts() {
            let mut node = Map::new();
            match child {
                None => node.insert("mesh".into(), json!(mesh)),
                Some(child) => node.insert("children".into(), json!([child])),
            };
            if child.is_none() && !name.is_empty() {
                node.insert("name".into(), json!(name));
            }
            if child.is_none() && !object.category.is_empty() {
                node.insert("extras".into(), json!({ CATEGORY: object.category }));
            }
            let (place, keys) = (motion.at(0.0), motion.keys());
            if keys.is_empty() && !place.is_identity() {
                node.insert("matrix".into(), json!(place.matrix().to_cols_array()));
            }
            let index = self.push("nodes", Json::Object(node));
            if !keys.is_empty() {
                self.animate(index, &keys, writing);
            }
            child = Some(index);
        }
        self.roots.extend(child);
        Ok(())
    }

    /// A mesh with one primitive each for its triangles, points and lines.
    ///
    /// All objects with the same mesh and material share it.
    fn mesh(
        &mut self,
        mesh: &Arc<Mesh>,
        material: usize,
        writing: &mut Writing,
    ) -> Result<usize, FormatError> {
        if let Some(known) = self.meshes.get(&(Arc::as_ptr(mesh), material)) {
            return Ok(*known);
        }
        if !mesh.vertex_ks.is_empty() {
            writing.warn("glTF files cannot store ks of vertices: left out");
        }
        let mut attributes = Map::new();
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
        attributes.insert("POSITION".into(), json!(self.buffer.vectors(&positions, true)));
        if !mesh.normals.is_empty() {
            let normals: Vec<_> =
                mesh.normals.iter().map(|n| n.normalize_or(bilux_math::Vec3::Y).to_array()).collect();
            attributes.insert("NORMAL".into(), json!(self.buffer.vectors(&normals, false)));
        }
        for (name, uvs) in [("TEXCOORD_0", &mesh.uvs), ("TEXCOORD_1", &mesh.uvs2)] {
            if !uvs.is_empty() {
                let downwards: Vec<_> = uvs.iter().map(|uv| [uv.x, 1.0 - uv.y]).collect();
                attributes.insert(name.into(), json!(self.buffer.vectors(&downwards, false)));
            }
        }
        if !mesh.tangents.is_empty() {
            let tangents: Vec<_> = mesh.tangents.iter().map(|t| t.to_array()).collect();
            attributes.insert("TANGENT".into(), json!(self.buffer.vectors(&tangents, false)));
        }
        if !mesh.vertex_kd.is_empty() {
            let colours: Vec<_> = mesh.vertex_kd.iter().map(|c| c.to_array()).collect();
            attributes.insert("COLOR_0".into(), json!(self.buffer.vectors(&colours, false)));
        }
        // Primitive modes. [glTF 2.0, 5.24.4]
        const POINTS: u32 = 0;
        const LINES: u32 = 1;
        let mut primitives = Vec::new();
        let kinds = [
            (None, mesh.triangles.as_flattened()),
            (Some(POINTS), &mesh.points[..]),
            (Some(LINES), mesh.lines.as_flattened()),
        ];
        for (mode, corners) in kinds.into_iter().filter(|(_, corners)| !corners.is_empty()) {
            let indices = self.buffer.indices(corners);
            let mut primitive = json!({ "attributes": attributes, "indices": indices, "material": material });
            if let Some(mode) = mode {
                primitive["mode"] = json!(mode);
            }
            primitives.push(primitive);
        }
        let named = if mesh.name.is_empty() { json!({}) } else { json!({ "name": mesh.name }) };
        let mut whole = named;
        whole["primitives"] = json!(primitives);
        let index = self.push("meshes", whole);
        self.meshes.insert((Arc::as_ptr(mesh), material), index);
        Ok(index)
    }

    fn finish(mut self, writing: &mut Writing) {
        let mut root = Map::new();
        root.insert("asset".into(), json!({ "version": "2.0", "generator": "Bilux" }));
        root.insert("scene".into(), json!(0));
        let mut scene = if self.roots.is_empty() { json!({}) } else { json!({ "nodes": self.roots }) };
        // Light of surfaces that emit is light too.
        let has_light = !self.scene.lights.is_empty() || self.scene.describes_all_light;
        if !self.scene.environment_unspecified && has_light {
            scene["extras"] = json!({ SURROUNDINGS: "none" });
        }
        root.insert("scenes".into(), json!([scene]));
        let lights = self.lists.remove("lights");
        if let Some(lights) = lights {
            root.insert("extensions".into(), json!({ "KHR_lights_punctual": { "lights": lights } }));
        }
        for (list, items) in self.lists {
            root.insert(list.into(), Json::Array(items));
        }
        if !self.extensions.is_empty() {
            root.insert("extensionsUsed".into(), json!(self.extensions));
        }
        let (views, accessors, binary) = self.buffer.finish();
        let is_glb = writing.extension != "gltf";
        if !binary.is_empty() {
            let mut buffer = json!({ "byteLength": binary.len() });
            if !is_glb {
                let name = writing.add("bin", binary.clone());
                buffer["uri"] = json!(name.replace('%', "%25").replace(' ', "%20"));
            }
            root.insert("buffers".into(), json!([buffer]));
            root.insert("bufferViews".into(), Json::Array(views));
            root.insert("accessors".into(), Json::Array(accessors));
            root.retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
        }
        let text = Json::Object(root).to_string().into_bytes();
        writing.main = if is_glb { buffer::container(text, binary) } else { text };
    }
}
