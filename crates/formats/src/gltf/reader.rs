//! Converts the document to a scene.

use super::animation::Pose;
use super::container;
use super::document::Document;
use super::graph::Placed;
use super::instances::Instances;
use super::json::JsonNode;
use super::material::{MaterialKey, UsedMaterial};
use super::primitive::{NodeMesh, Part};
use super::{cameras, extensions, flat, lights, validate};
use crate::FormatError;
use crate::oddities::Oddities;
use crate::reading::{Reading, Source};
use crate::sharing::share_trees;
use bilux_math::motion::Motion;
use bilux_math::{DMat4, Transform};
use bilux_scene::texture::Image;
use bilux_scene::{Object, SceneBuilder, Span};
use std::collections::HashMap;
use std::sync::Arc;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let container = container::open(source)?;
    let mut oddities = Oddities::default();
    for warning in &container.warnings {
        oddities.note(warning, || crate::text::whole_file(source.name));
    }
    let json = parse(reading, container.json, source)?;
    let root = JsonNode::root(&json, source.name);
    if !root.is_object() {
        return Err(root.error("this JSON is not glTF: it must be an object in braces"));
    }
    check_version(root)?;
    extensions::check(root, &mut oddities)?;
    let document = Document::load(root, &container, reading, source, &mut oddities)?;
    let time = reading.options.time;
    let mut gltf = Gltf::new(&document, source, reading, oddities, time);
    gltf.decode_ahead()?;
    gltf.scene()?;
    if gltf.reading.options.validate {
        validate::document(gltf.document, &mut gltf.reading.budget, &mut gltf.oddities);
        gltf.validate_images()?;
    } else {
        gltf.check_data()?;
    }
    let Gltf { mut scene, oddities, meshes, materials, images, .. } = gltf;
    if reading.options.whole_movement && scene.inventory.moves() {
        let cache = PassCache { meshes, materials, images };
        let end = scene.inventory.seconds();
        scene.movement = Some(Arc::new(movement(&document, source, reading, cache, end)?));
    }
    oddities.into_warnings(&mut scene);
    Ok(scene)
}

/// The results of one pass over a file that the next pass can reuse.
struct PassCache {
    meshes: HashMap<PosedMesh, Arc<Vec<Part>>>,
    materials: HashMap<MaterialKey, UsedMaterial>,
    images: HashMap<(usize, bool), Option<Named>>,
}

/// The number of intervals into which the animation is divided to find where objects move.
const MOMENTS: u32 = 8;

/// All objects at times from 0 to `end`, in seconds; meshes that do not deform are shared.
fn movement<'r>(
    document: &Document<'_>,
    source: &'r Source<'r>,
    reading: &'r mut Reading,
    mut cache: PassCache,
    end: f32,
) -> Result<SceneBuilder, FormatError> {
    let mut all = SceneBuilder::default();
    for moment in 0..=MOMENTS {
        let time = end * moment as f32 / MOMENTS as f32;
        let mut gltf = Gltf::new(document, source, &mut *reading, Oddities::default(), time);
        (gltf.meshes, gltf.materials, gltf.images) = (cache.meshes, cache.materials, cache.images);
        // The keys of skinned meshes do not include the time.
        gltf.meshes.retain(|(_, _, skin), _| skin.is_none());
        gltf.scene()?;
        let Gltf { scene, meshes, materials, images, .. } = gltf;
        all.objects.extend(scene.objects);
        cache = PassCache { meshes, materials, images };
    }
    Ok(all)
}

/// An image with its name.
pub(super) type Named = (String, Arc<Image>);

/// A mesh, the bits of its weights, and its skin.
type PosedMesh = (usize, Vec<u64>, Option<usize>);

/// The state while a file is converted to a scene.
pub(super) struct Gltf<'d, 'o, 'r> {
    pub(super) document: &'d Document<'d>,
    pub(super) source: &'r Source<'r>,
    pub(super) file: Arc<str>,
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) scene: SceneBuilder,
    pub(super) oddities: Oddities,
    /// For each node of the file its index in `nodes`, once it is placed.
    pub(super) order: Vec<Option<usize>>,
    /// The time, in seconds.
    pub(super) time: f32,
    /// The animated values at that time.
    pub(super) pose: Pose,
    /// The index of the selected variant.
    pub(super) variant: Option<usize>,
    /// All nodes of the scene, parents first.
    pub(super) nodes: Vec<Placed<'d>>,
    /// The parts of each mesh, keyed by its index, the weights of its morph targets and its skin.
    meshes: HashMap<PosedMesh, Arc<Vec<Part>>>,
    pub(super) materials: HashMap<MaterialKey, UsedMaterial>,
    /// Images with their names, by their index in the file and by whether they hold numbers; `None` for one that
    /// failed.
    pub(super) images: HashMap<(usize, bool), Option<Named>>,
}

impl<'d, 'o, 'r> Gltf<'d, 'o, 'r> {
    fn new(
        document: &'d Document<'d>,
        source: &'r Source<'r>,
        reading: &'r mut Reading<'o>,
        oddities: Oddities,
        time: f32,
    ) -> Gltf<'d, 'o, 'r> {
        Gltf {
            document,
            source,
            file: source.name.clone(),
            reading,
            scene: SceneBuilder {
                environment_unspecified: true,
                exposure_unspecified: true,
                ..SceneBuilder::default()
            },
            oddities,
            order: Vec::new(),
            time,
            pose: Pose::default(),
            variant: None,
            nodes: Vec::new(),
            meshes: HashMap::new(),
            materials: HashMap::new(),
            images: HashMap::new(),
        }
    }

    fn scene(&mut self) -> Result<(), FormatError> {
        self.variants()?;
        self.pose()?;
        self.nodes = self.nodes()?;
        for i in 0..self.nodes.len() {
            let placed = self.nodes[i];
            self.place(&placed)?;
        }
        share_trees(&mut self.scene);
        let root = self.document.root;
        let skins = root.list("skins")?;
        self.scene.inventory.skins = skins.iter().map(|skin| skin.name().to_owned()).collect();
        if self.scene.objects.is_empty() && self.scene.lights.is_empty() {
            self.oddities.note("there is nothing to render in this file", || root.at());
        }
        Ok(())
    }

    fn place(&mut self, placed: &Placed<'d>) -> Result<(), FormatError> {
        let node = placed.node;
        if let Some(index) = node.get("mesh").filter(|_| placed.is_visible) {
            self.place_mesh(placed, index)?;
        }
        if let Some(index) = node.get("camera") {
            let camera = self.document.named("cameras", index)?;
            let spec = cameras::camera(camera, node, &placed.world, &mut self.oddities)?;
            self.scene.cameras.extend(spec);
        }
        if !placed.is_visible {
            return Ok(());
        }
        if let Some(light) = node.extension("KHR_lights_punctual") {
            let radius = self.reading.options.light_radius;
            let spec = lights::light(self.document.root, light, placed, radius, &mut self.oddities)?;
            self.scene.lights.extend(spec);
        }
        if let Some(light) = node.extension("EXT_lights_area") {
            self.area_light(light, placed)?;
        }
        Ok(())
    }

    fn place_mesh(&mut self, placed: &Placed<'d>, index: JsonNode<'d>) -> Result<(), FormatError> {
        let node = placed.node;
        let parts = self.mesh(index, placed)?;
        let name =
            if node.name().is_empty() { parts.first().map(|p| &*p.mesh.name) } else { Some(node.name()) };
        let name = name.unwrap_or_default().to_owned();
        // A skinned mesh is in world space: its own node's transform is ignored. [glTF 2.0, 3.7.3.3]
        let places = match node.get("skin") {
            Some(_) => Instances::once(DMat4::IDENTITY),
            None => self.instances(placed)?,
        };
        for world in places.iter() {
            let Some(transform) = Transform::from_matrix(world) else {
                self.place_flattened(&name, &parts, &world, node)?;
                continue;
            };
            let motion = Motion::still(transform);
            let bytes = (size_of::<[Object; 2]>() + name.len()) * parts.len() + motion.heap_bytes();
            self.reading.budget.take_bytes(bytes as u64, &self.file)?;
            for part in &*parts {
                let object = Object::new(&name, part.mesh.clone(), part.material);
                self.scene.objects.push(Object { motion: motion.clone(), ..object });
            }
        }
        Ok(())
    }

    /// Places a mesh whose transform cannot be inverted: a scale of zero along one axis makes it flat.
    fn place_flattened(
        &mut self,
        name: &str,
        parts: &[Part],
        world: &DMat4,
        node: JsonNode<'d>,
    ) -> Result<(), FormatError> {
        match flat::rank(world) {
            2 => {}
            // This is how files hide meshes. [glTF 2.0, 3.5.3]
            0 => {
                self.oddities.remark("a node with a scale of zero is not shown", || node.at());
                return Ok(());
            }
            _ => {
                let what =
                    "a node is scaled to a line or to something that is not finite, and is not rendered";
                self.oddities.note(what, || node.at());
                return Ok(());
            }
        }
        for part in parts {
            let bytes = part.mesh.size() + (size_of::<[Object; 2]>() + name.len()) as u64;
            self.reading.budget.take_bytes(bytes, &self.file)?;
            let mesh = Arc::new(flat::flattened(&part.mesh, world));
            self.scene.objects.push(Object::new(name, mesh, part.material));
        }
        Ok(())
    }

    /// The parts of a mesh, made once for each combination of weights and skin.
    fn mesh(&mut self, index: JsonNode<'d>, user: &Placed<'d>) -> Result<Arc<Vec<Part>>, FormatError> {
        let mesh = self.document.named("meshes", index)?;
        let holder = if user.node.get("weights").is_some() { user.node } else { mesh };
        let weights: Vec<f64> = match self.pose.weights(user.index) {
            Some(posed) => posed.to_vec(),
            None => holder.list("weights")?.iter().map(JsonNode::as_number).collect::<Result<_, _>>()?,
        };
        let skin = user.node.get("skin");
        let bits = weights.iter().map(|w| w.to_bits()).collect();
        let key = (index.as_count()?, bits, skin.map(|skin| skin.as_count()).transpose()?);
        if let Some(parts) = self.meshes.get(&key) {
            return Ok(parts.clone());
        }
        let joints = skin.map(|skin| self.joints(skin)).transpose()?;
        let worn = NodeMesh { name: mesh.name(), weights: &weights, joints: joints.as_ref() };
        let mut parts = Vec::new();
        for primitive in mesh.need("primitives")?.items()? {
            parts.extend(self.primitive(primitive, &worn)?);
        }
        let parts = Arc::new(parts);
        self.meshes.insert(key, parts.clone());
        Ok(parts)
    }

    /// True if an image has been read, as numbers or as colours.
    pub(super) fn has_read(&self, image: usize, is_data: bool) -> bool {
        self.images.contains_key(&(image, is_data))
    }
}

/// Parses the JSON if the memory limit allows for the result.
fn parse(reading: &mut Reading, bytes: &[u8], source: &Source) -> Result<serde_json::Value, FormatError> {
    let values = bytes.iter().filter(|byte| matches!(byte, b',' | b'[' | b'{')).count();
    // A key with its value, in tables that may be half full; strings are as long as in the file.
    reading.budget.take_bytes(values as u64 * 160 + bytes.len() as u64, source.name)?;
    serde_json::from_slice(bytes).map_err(|error| {
        let (line, column) = (error.line() as u32, error.column() as u32);
        let text = error.to_string();
        let what = syntax_fault(text.split(" at line ").next().unwrap_or(&text));
        let message = format!("this is not JSON: {what}");
        FormatError::malformed(message, Span { file: source.name.clone(), line, column })
    })
}

/// Fragments of the JSON parser's errors, and what they mean.
const SYNTAX_FAULTS: &[(&str, &str)] = &[
    ("EOF", "the file ends in the middle of it: it was cut off"),
    ("expected value", "a value is missing here"),
    ("`,` or `}`", "a comma or a closing brace is missing here"),
    ("`,` or `]`", "a comma or a closing bracket is missing here"),
    ("`:`", "a colon is missing here"),
    ("expected ident", "a value is missing here"),
    ("trailing comma", "there is a comma before a closing bracket or brace"),
    ("trailing characters", "there is more text after its end"),
    ("key must be a string", "a name in double quotes is missing here"),
    ("control character", "a string contains a control character, which must be escaped"),
    ("escape", "a string has an escape that does not exist"),
    ("surrogate", "a string has half of a Unicode character"),
    ("unicode", "a string has a Unicode character that does not exist"),
    ("number out of range", "this number is too large"),
    ("invalid number", "this is not a number"),
    ("recursion", "lists and objects are nested too deeply"),
];

fn syntax_fault(report: &str) -> &'static str {
    let found = SYNTAX_FAULTS.iter().find(|(part, _)| report.contains(part));
    found.map_or("it has a mistake here", |(_, meaning)| meaning)
}

/// Major versions change the meaning of files; minor ones only extend it.
fn check_version(root: JsonNode) -> Result<(), FormatError> {
    let asset = root.need("asset")?;
    let parse = |node: JsonNode, key: &'static str| -> Result<Option<(u32, u32)>, FormatError> {
        let Some(text) = node.get(key) else { return Ok(None) };
        let parts = text.as_text()?.split_once('.');
        let version = parts.and_then(|(major, minor)| Some((major.parse().ok()?, minor.parse().ok()?)));
        version
            .map(Some)
            .ok_or_else(|| text.error("a version is two numbers separated by a point, such as 2.0"))
    };
    let wrong = |major: u32, minor: u32| {
        let message =
            format!("this is glTF {major}.{minor}, but only 2.0 can be read: export it as glTF 2.0");
        Err(FormatError::malformed(message, asset.at()))
    };
    let Some((major, minor)) = parse(asset, "version")? else {
        return Err(asset.error("'version' is missing here: it must be \"2.0\""));
    };
    match parse(asset, "minVersion")? {
        Some((major, minor)) if (major, minor) > (2, 0) => wrong(major, minor),
        _ if major != 2 => wrong(major, minor),
        _ => Ok(()),
    }
}
