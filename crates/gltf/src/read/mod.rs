//! Converts the document to a scene.

pub(crate) mod extensions;
pub(crate) mod soundness;

use crate::document::container;
use crate::document::data::DataReader;
use crate::document::json::JsonNode;
use crate::document::json_document::Document;
use crate::geometry::meshes::Meshes;
use crate::geometry::primitive::Part;
use crate::graph::area_lights;
use crate::graph::cameras;
use crate::graph::instances::Instances;
use crate::graph::lights;
use crate::graph::nodes::{Placed, category};
use crate::graph::posed::Posed;
use crate::materials::pictures::Pictures;
use crate::validate;
use bilux_import::geometry::sharing::share_trees;
use bilux_import::input::authors::program;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::input::sink::Sink;
use bilux_import::world::movement::whole_movement;
use bilux_import::{FormatError, geometry::flat};
use bilux_math::motion::Motion;
use bilux_math::{DMat4, Transform};
use bilux_scene::{Object, SceneBuilder, Span};
use std::sync::Arc;

pub(crate) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let container = container::open(source)?;
    let mut sink = Sink::for_bare_files();
    for warning in &container.warnings {
        sink.diagnostics.note(warning, || bilux_import::bytes::text::whole_file(source.name));
    }
    let json = parse(reading, container.json, source)?;
    let root = JsonNode::root(&json, source.name);
    if !root.is_object() {
        return Err(root.error("this JSON is not glTF: it must be an object in braces"));
    }
    check_version(root)?;
    let generator = root.need("asset")?.text("generator").ok().flatten();
    sink.scene.written_by = generator.map(program).unwrap_or_default();
    extensions::check(root, &mut sink.diagnostics)?;
    let document = Document::load(root, &container, reading, source, &mut sink.diagnostics)?;
    #[cfg(feature = "draco")]
    let drawn = crate::geometry::draco::unpack(&document, &mut reading.budget)?;
    #[cfg(feature = "draco")]
    let document = document.with_drawn(drawn);
    let mut meshes = Meshes::default();
    meshes.materials.pictures = Pictures::decoded_ahead(&document, reading)?;
    place_all(&document, reading.options.time, &mut meshes, reading, &mut sink)?;
    check(&document, &meshes.materials.pictures, reading, &mut sink)?;
    if reading.options.whole_movement && sink.scene.inventory.moves() {
        let end = sink.scene.inventory.seconds();
        let place = |time, sink: &mut Sink| {
            meshes.forget_skinned();
            place_all(&document, time, &mut meshes, reading, sink)
        };
        sink.scene.movement = Some(whole_movement(end, place)?);
    }
    Ok(sink.finish())
}

/// Notes what is wrong with the document, whether or not it is shown.
fn check(
    document: &Document,
    pictures: &Pictures,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    if reading.options.validate {
        validate::document(document, &mut reading.budget, &mut sink.diagnostics);
        soundness::validate_images(document, pictures, reading, &mut sink.diagnostics)
    } else {
        soundness::check_data(&mut DataReader::new(document, &mut reading.budget, &mut sink.diagnostics))
    }
}

/// Adds all nodes to the scene, as they are at a time in seconds.
fn place_all<'d>(
    document: &'d Document<'d>,
    time: f32,
    meshes: &mut Meshes,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    let posed = Posed::read(document, time, reading, &mut sink.diagnostics)?;
    for placed in &posed.graph.nodes {
        place(placed, &posed, meshes, reading, sink)?;
    }
    let scene = &mut sink.scene;
    share_trees(scene);
    scene.environment_unspecified = !posed.graph.has_surroundings;
    scene.exposure_unspecified = !posed.graph.has_surroundings;
    let skins = document.root.list("skins")?;
    scene.inventory.skins = skins.iter().map(|skin| skin.name().to_owned()).collect();
    scene.inventory.animations = posed.pose.animations;
    scene.inventory.variants = posed.variants.names;
    if scene.objects.is_empty() && scene.lights.is_empty() {
        sink.diagnostics.note("there is nothing to render in this file", || document.root.at());
    }
    Ok(())
}

/// Adds what a node holds: a mesh, a camera, lights.
fn place<'d>(
    placed: &Placed<'d>,
    posed: &Posed<'d>,
    meshes: &mut Meshes,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    let (node, document) = (placed.node, posed.document);
    if let Some(index) = node.get("mesh").filter(|_| placed.is_visible) {
        let parts = meshes.parts(index, placed, posed, reading, sink)?;
        let first = sink.scene.objects.len();
        place_mesh(placed, &parts, document, reading, sink)?;
        let own = category(document.named("meshes", index)?);
        let category = if placed.category.is_empty() { own.unwrap_or_default() } else { placed.category };
        let bytes = category.len() * (sink.scene.objects.len() - first);
        reading.budget.take_bytes(bytes as u64, document.file())?;
        sink.scene.objects[first..].iter_mut().for_each(|object| category.clone_into(&mut object.category));
    }
    if let Some(index) = node.get("camera") {
        let camera = document.named("cameras", index)?;
        let spec = cameras::camera(camera, node, &placed.world, &mut sink.diagnostics)?;
        sink.scene.cameras.extend(spec);
    }
    if !placed.is_visible {
        return Ok(());
    }
    if let Some(light) = node.extension("KHR_lights_punctual") {
        let radius = reading.options.light_radius;
        let spec = lights::light(document.root, light, placed, radius, &mut sink.diagnostics)?;
        sink.scene.lights.extend(spec);
    }
    if let Some(light) = node.extension("EXT_lights_area") {
        area_lights::place(document.root, light, placed, sink)?;
    }
    Ok(())
}

/// Adds the parts of a node's mesh at each of its instances.
fn place_mesh<'d>(
    placed: &Placed<'d>,
    parts: &[Part],
    document: &'d Document<'d>,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    let node = placed.node;
    let name = if node.name().is_empty() { parts.first().map(|p| &*p.mesh.name) } else { Some(node.name()) };
    let name = name.unwrap_or_default();
    // A skinned mesh is in world space: its own node's transform is ignored. [glTF 2.0, 3.7.3.3]
    let places = match node.get("skin") {
        Some(_) => Instances::once(DMat4::IDENTITY),
        None => {
            let mut data = DataReader::new(document, &mut reading.budget, &mut sink.diagnostics);
            Instances::read(placed, &mut data)?
        }
    };
    for world in places.iter() {
        if let Some(transform) = Transform::from_matrix(world) {
            let motion = Motion::still(transform);
            let bytes = (size_of::<[Object; 2]>() + name.len()) * parts.len() + motion.heap_bytes();
            reading.budget.take_bytes(bytes as u64, document.file())?;
            for part in parts {
                let object = Object::new(name, part.mesh.clone(), part.material);
                sink.scene.objects.push(Object { motion: motion.clone(), ..object });
            }
        } else if is_flat(&world, node, sink) {
            for part in parts {
                let bytes = part.mesh.size() + (size_of::<[Object; 2]>() + name.len()) as u64;
                reading.budget.take_bytes(bytes, document.file())?;
                let mesh = Arc::new(flat::flattened(&part.mesh, &world));
                sink.scene.objects.push(Object::new(name, mesh, part.material));
            }
        }
    }
    Ok(())
}

/// Whether a transform that cannot be inverted leaves something to see: a scale of zero along one axis makes a mesh flat.
fn is_flat(world: &DMat4, node: JsonNode, sink: &mut Sink) -> bool {
    match flat::rank(world) {
        2 => true,
        // This is how files hide meshes. [glTF 2.0, 3.5.3]
        0 => {
            sink.diagnostics.remark("a node with a scale of zero is not shown", || node.at());
            false
        }
        _ => {
            let what = "a node is scaled to a line or to something that is not finite, and is not rendered";
            sink.diagnostics.note(what, || node.at());
            false
        }
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
