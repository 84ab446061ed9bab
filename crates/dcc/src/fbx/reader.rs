//! Converts a document to a scene.

use super::document::Document;
use super::graph::Graph;
use super::meshes::Meshes;
use super::posed::Posed;
use super::tree::Tree;
use super::{cameras, deform, lights};
use bilux_import::FormatError;
use bilux_import::geometry::sharing::share_trees;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::input::sink::Sink;
use bilux_import::world::movement::whole_movement;
use bilux_scene::SceneBuilder;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut sink = Sink::for_bare_files();
    let tree = Tree::read(source, &mut reading.budget)?;
    let document = Document::load(&tree, source, &mut reading.budget, &mut sink.diagnostics)?;
    sink.scene.written_by.clone_from(&document.settings.creator);
    let mut meshes = Meshes::new(&document);
    place_all(&document, reading.options.time, &mut meshes, reading, &mut sink)?;
    if reading.options.whole_movement && sink.scene.inventory.moves() {
        let end = sink.scene.inventory.seconds();
        let place = |time, sink: &mut Sink| place_all(&document, time, &mut meshes, reading, sink);
        sink.scene.movement = Some(whole_movement(end, place)?);
    }
    Ok(sink.finish())
}

/// Adds all nodes to the scene, as they are at a time in seconds.
fn place_all<'d>(
    document: &'d Document<'d>,
    time: f32,
    meshes: &mut Meshes<'d>,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    let posed = Posed::read(document, time, reading, &mut sink.diagnostics)?;
    let graph = Graph::read(&posed, reading.origin, &mut reading.budget, &mut sink.diagnostics)?;
    for placed in graph.nodes.iter().filter(|placed| placed.is_visible) {
        meshes.place(placed, &posed, &graph, reading, sink)?;
    }
    let bounds = sink.scene.bounds(0.0);
    let middle = if bounds.is_empty() {
        bilux_math::DVec3::ZERO
    } else {
        ((bounds.min + bounds.max) * 0.5).as_dvec3()
    };
    for placed in &graph.nodes {
        sink.scene.cameras.extend(cameras::camera(placed, &posed, &graph, &mut sink.diagnostics));
        if placed.is_visible {
            lights::place(placed, &posed, &graph, middle, reading.options.light_radius, sink);
        }
    }
    let scene = &mut sink.scene;
    share_trees(scene);
    scene.inventory.animations = posed.pose.animations;
    scene.inventory.skins = deform::skin_names(document);
    if scene.objects.is_empty() && scene.lights.is_empty() {
        let at = || document.tree.whole();
        sink.diagnostics.note("there is nothing to render in this file", at);
    }
    Ok(())
}
