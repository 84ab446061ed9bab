//! From the document to a scene.

use super::accessor::Accessor;
use super::container;
use super::document::Document;
use super::graph::Placed;
use super::json::Node;
use super::material::UsedMaterial;
use super::primitive::Part;
use super::{cameras, extensions, lights};
use crate::FormatError;
use crate::reading::{Oddities, Reading, Source};
use bilux_math::Transform;
use bilux_math::motion::Motion;
use bilux_scene::texture::Image;
use bilux_scene::{Mesh, Object, SceneBuilder, Span};
use std::collections::HashMap;
use std::sync::Arc;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let container = container::open(source)?;
    let mut oddities = Oddities::default();
    for warning in &container.warnings {
        oddities.note(warning, || crate::text::whole_file(source.name));
    }
    let json = parse(reading, container.json, source)?;
    let root = Node::root(&json, source.name);
    if !root.is_object() {
        return Err(root.error("this JSON is no glTF, which begins with '{'"));
    }
    check_version(root)?;
    extensions::check(root, &mut oddities)?;
    let document = Document::load(root, &container, reading, source, &mut oddities)?;
    let mut gltf = Gltf {
        document: &document,
        source,
        file: source.name.clone(),
        reading,
        scene: SceneBuilder::default(),
        oddities,
        order: Vec::new(),
        meshes: HashMap::new(),
        materials: HashMap::new(),
        images: HashMap::new(),
    };
    gltf.scene()?;
    let Gltf { mut scene, oddities, .. } = gltf;
    oddities.into_warnings(&mut scene);
    Ok(scene)
}

/// A picture with its name.
pub(super) type Named = (String, Arc<Image>);

/// A file on its way to a scene.
pub(super) struct Gltf<'d, 'o, 'r> {
    pub(super) document: &'d Document<'d>,
    pub(super) source: &'r Source<'r>,
    pub(super) file: Arc<str>,
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) scene: SceneBuilder,
    pub(super) oddities: Oddities,
    /// For each node of the file its number in the scene, once it is placed.
    pub(super) order: Vec<Option<usize>>,
    /// The parts of each mesh, by its index and the weights of its morph targets.
    meshes: HashMap<(usize, Vec<u64>), Arc<Vec<Part>>>,
    /// By index in the file; the default one is none.
    pub(super) materials: HashMap<Option<usize>, UsedMaterial>,
    /// Pictures with their names, by index in the file and whether they are numbers; none where one cannot be had.
    pub(super) images: HashMap<(usize, bool), Option<Named>>,
}

/// Meshes that stand in the scene several times are kept once where copies would have more triangles than this.
const MOST_COPIED: usize = 1 << 18;

impl<'d> Gltf<'d, '_, '_> {
    fn scene(&mut self) -> Result<(), FormatError> {
        let nodes = self.nodes()?;
        for placed in &nodes {
            self.place(placed)?;
        }
        self.share_trees();
        self.check_accessors()?;
        let root = self.document.root;
        if root.get("animations").is_some() {
            let what = "animation is not applied: everything stands as its nodes say";
            self.oddities.note(what, || root.at_key("animations"));
        }
        if self.scene.objects.is_empty() && self.scene.lights.is_empty() {
            self.oddities.note("there is nothing to see in this file", || root.at());
        }
        Ok(())
    }

    /// Tells of what is broken, though nothing that is shown needs it.
    fn check_accessors(&mut self) -> Result<(), FormatError> {
        for node in self.document.root.list("accessors")? {
            match Accessor::open(self.document, node, &mut self.reading.budget) {
                Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                Err(error) => self.oddities.note(&error.without_place(), || node.at()),
                Ok(_) => {}
            }
        }
        Ok(())
    }

    fn place(&mut self, placed: &Placed<'d>) -> Result<(), FormatError> {
        let node = placed.node;
        if let Some(index) = node.get("mesh") {
            self.place_mesh(placed, index)?;
        }
        if let Some(index) = node.get("camera") {
            let camera = self.document.named("cameras", index)?;
            let spec = cameras::camera(camera, node, &placed.world, &mut self.oddities)?;
            self.scene.cameras.extend(spec);
        }
        if let Some(light) = node.extension("KHR_lights_punctual") {
            let spec = lights::light(self.document.root, light, placed, &mut self.oddities)?;
            self.scene.lights.extend(spec);
        }
        Ok(())
    }

    fn place_mesh(&mut self, placed: &Placed<'d>, index: Node<'d>) -> Result<(), FormatError> {
        let node = placed.node;
        let parts = self.mesh(index, node)?;
        let name =
            if node.name().is_empty() { parts.first().map(|p| &*p.mesh.name) } else { Some(node.name()) };
        let name = name.unwrap_or_default().to_owned();
        if node.get("skin").is_some() {
            self.oddities.note("skins are not applied: the mesh stands as it is", || node.at());
        }
        for world in self.instances(placed)? {
            let Some(transform) = Transform::from_matrix(world) else {
                self.oddities.note("a node is scaled to nothing and not drawn", || node.at());
                continue;
            };
            let bytes = (size_of::<[Object; 2]>() + name.len()) * parts.len();
            self.reading.budget.take_bytes(bytes as u64, &self.file)?;
            for part in &*parts {
                let motion = Motion::still(transform);
                let object = Object::new(&name, part.mesh.clone(), part.material);
                self.scene.objects.push(Object { motion, ..object });
            }
        }
        Ok(())
    }

    /// The parts of a mesh, made once for each choice of weights.
    fn mesh(&mut self, index: Node<'d>, user: Node<'d>) -> Result<Arc<Vec<Part>>, FormatError> {
        let mesh = self.document.named("meshes", index)?;
        let holder = if user.get("weights").is_some() { user } else { mesh };
        let weights: Vec<f64> =
            holder.list("weights")?.iter().map(Node::as_number).collect::<Result<_, _>>()?;
        let key = (index.as_count()?, weights.iter().map(|w| w.to_bits()).collect());
        if let Some(parts) = self.meshes.get(&key) {
            return Ok(parts.clone());
        }
        let mut parts = Vec::new();
        for primitive in mesh.need("primitives")?.items()? {
            parts.extend(self.primitive(primitive, mesh.name(), &weights)?);
        }
        let parts = Arc::new(parts);
        self.meshes.insert(key, parts.clone());
        Ok(parts)
    }

    /// Keeps one tree for meshes that stand in the scene often.
    fn share_trees(&mut self) {
        let mut uses: HashMap<*const Mesh, usize> = HashMap::new();
        for object in &self.scene.objects {
            *uses.entry(Arc::as_ptr(&object.mesh)).or_default() += 1;
        }
        for object in &mut self.scene.objects {
            let copies = uses[&Arc::as_ptr(&object.mesh)] - 1;
            object.instanced = copies * object.mesh.triangles.len() > MOST_COPIED;
        }
    }
}

/// The JSON, if there is memory for what it becomes.
fn parse(reading: &mut Reading, bytes: &[u8], source: &Source) -> Result<serde_json::Value, FormatError> {
    let values = bytes.iter().filter(|byte| matches!(byte, b',' | b'[' | b'{')).count();
    // A key with its value, in tables that may be half full; texts are as long as in the file.
    reading.budget.take_bytes(values as u64 * 160 + bytes.len() as u64, source.name)?;
    serde_json::from_slice(bytes).map_err(|error| {
        let (line, column) = (error.line() as u32, error.column() as u32);
        let text = error.to_string();
        let what = text.split(" at line ").next().unwrap_or(&text);
        let message = format!("this is no JSON: {what}; export the file again");
        FormatError::malformed(message, Span { file: source.name.clone(), line, column })
    })
}

/// Major versions change the meaning of files, minor ones add to it.
fn check_version(root: Node) -> Result<(), FormatError> {
    let asset = root.need("asset")?;
    let parse = |node: Node, key: &'static str| -> Result<Option<(u32, u32)>, FormatError> {
        let Some(text) = node.get(key) else { return Ok(None) };
        let parts = text.as_text()?.split_once('.');
        let version = parts.and_then(|(major, minor)| Some((major.parse().ok()?, minor.parse().ok()?)));
        version.map(Some).ok_or_else(|| text.error("a version is two numbers, as in \"2.0\""))
    };
    let wrong = |major: u32, minor: u32| {
        let message = format!("this is glTF {major}.{minor}, and 2.0 is read: export it as glTF 2.0");
        Err(FormatError::malformed(message, asset.at()))
    };
    let Some((major, minor)) = parse(asset, "version")? else {
        return Err(asset.error("the version is missing here; it has to be \"2.0\""));
    };
    match parse(asset, "minVersion")? {
        Some((major, minor)) if (major, minor) > (2, 0) => wrong(major, minor),
        _ if major != 2 => wrong(major, minor),
        _ => Ok(()),
    }
}
