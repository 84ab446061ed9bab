//! Converts a document to a scene.

use super::document::Document;
use super::graph::{Graph, Placed};
use super::meshes::Meshes;
use super::posed::Posed;
use super::tree::Tree;
use crate::FormatError;
use crate::reading::{Reading, Source};
use crate::sharing::share_trees;
use crate::sink::Sink;
use bilux_scene::SceneBuilder;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut sink = Sink::for_bare_files();
    let tree = Tree::read(source, &mut reading.budget)?;
    let document = Document::load(&tree, &mut reading.budget, &mut sink.oddities)?;
    let posed = Posed::still(&document);
    place_all(&posed, &mut Meshes::default(), reading, &mut sink)?;
    Ok(sink.finish())
}

/// Adds all nodes to the scene, as they are posed.
fn place_all<'d>(
    posed: &Posed<'d>,
    meshes: &mut Meshes,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    let graph = Graph::read(posed, reading.origin, &mut reading.budget, &mut sink.oddities)?;
    for placed in &graph.nodes {
        place(placed, posed, &graph, meshes, reading, sink)?;
    }
    share_trees(&mut sink.scene);
    if sink.scene.objects.is_empty() && sink.scene.lights.is_empty() {
        let at = || posed.document.tree.whole();
        sink.oddities.note("there is nothing to render in this file", at);
    }
    Ok(())
}

/// Adds what belongs to a node.
fn place<'d>(
    placed: &Placed,
    posed: &Posed<'d>,
    graph: &Graph,
    meshes: &mut Meshes,
    reading: &mut Reading,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    if placed.is_visible {
        meshes.place(placed, posed, graph, reading, sink)?;
    }
    Ok(())
}
