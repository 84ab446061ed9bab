//! Converts a document to a scene.

use super::animation::Pose;
use super::document::Document;
use super::element::Element;
use super::graph::Graph;
use super::meshes::Meshes;
use super::posed::Posed;
use super::{cameras, lights};
use bilux_import::FormatError;
use bilux_import::bytes::xml::Xml;
use bilux_import::geometry::sharing::share_trees;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::input::sink::Sink;
use bilux_import::world::movement::whole_movement;
use bilux_math::DVec3;
use bilux_scene::SceneBuilder;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let text = String::from_utf8_lossy(source.bytes);
    let xml = Xml::parse(&text, source.name, &mut reading.budget)?;
    let mut sink = Sink::for_bare_files();
    let document = Document::load(Element::root(&xml), source, &mut reading.budget, &mut sink.diagnostics)?;
    sink.scene.written_by.clone_from(&document.settings.tool);
    note_unused(&document, &mut sink);
    let Some(scene) = shown_scene(&document, &mut sink) else {
        return Err(document.root.error("the file has no <visual_scene>, so there is nothing to show"));
    };
    let mut meshes = Meshes::default();
    place_all(&document, scene, reading.options.time, &mut meshes, reading, &mut sink)?;
    if reading.options.whole_movement && sink.scene.inventory.moves() {
        let end = sink.scene.inventory.seconds();
        let place = |time, sink: &mut Sink| place_all(&document, scene, time, &mut meshes, reading, sink);
        sink.scene.movement = Some(whole_movement(end, place)?);
    }
    Ok(sink.finish())
}

/// The scene that the file says is to be shown, or the first.
fn shown_scene<'d>(document: &Document<'d>, sink: &mut Sink) -> Option<Element<'d>> {
    let instance = document.root.path(&["scene", "instance_visual_scene"]);
    let is_scene = |element: &Element| element.name() == "visual_scene";
    let stated = instance.and_then(|instance| document.referred(instance, "url", &mut sink.diagnostics));
    let shown =
        stated.filter(is_scene).or_else(|| document.library("library_visual_scenes").find(is_scene))?;
    let mut others = document.library("library_visual_scenes").filter(is_scene);
    if let Some(other) = others.find(|other| other.key() != shown.key()) {
        sink.diagnostics.not_shown("other scenes", || other.at());
    }
    Some(shown)
}

/// Says what else is in the file.
fn note_unused(document: &Document, sink: &mut Sink) {
    for child in document.root.children() {
        let what = match child.name() {
            "library_physics_scenes" | "library_rigid_constraints" => "physics",
            "library_kinematics_scenes" | "library_articulated_systems" => "kinematics",
            _ => continue,
        };
        if child.children().next().is_some() {
            sink.diagnostics.not_used(what, || child.at());
        }
    }
}

/// Adds all nodes to the scene, as they are at a time in seconds.
fn place_all<'d>(
    document: &Document<'d>,
    visual_scene: Element<'d>,
    time: f32,
    meshes: &mut Meshes<'d>,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    let wanted = reading.options.animation.as_deref();
    let pose = Pose::read(document, time, wanted, &mut reading.budget, &mut sink.diagnostics)?;
    let posed = Posed { document, pose };
    let graph =
        Graph::read(visual_scene, &posed, reading.origin, &mut reading.budget, &mut sink.diagnostics)?;
    for placed in graph.nodes.iter().filter(|placed| placed.is_visible) {
        meshes.place(placed, &posed, &graph, reading, sink)?;
    }
    let bounds = sink.scene.bounds(0.0);
    let middle = if bounds.is_empty() { DVec3::ZERO } else { ((bounds.min + bounds.max) * 0.5).as_dvec3() };
    for placed in &graph.nodes {
        cameras::place(placed, &posed, sink)?;
        if placed.is_visible {
            lights::place(placed, &posed, middle, reading.options.light_radius, sink)?;
        }
    }
    let scene = &mut sink.scene;
    share_trees(scene);
    scene.inventory.animations = posed.pose.animations;
    let controllers = document.library("library_controllers");
    let skins = controllers.filter(|controller| controller.child("skin").is_some());
    scene.inventory.skins = skins.map(Element::label).collect();
    if scene.objects.is_empty() && scene.lights.is_empty() {
        sink.diagnostics.note("there is nothing to render in this file", || document.root.at());
    }
    Ok(())
}
