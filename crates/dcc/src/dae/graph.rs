//! The nodes of the scene with their transforms to world space.

use super::document::Document;
use super::element::Element;
use super::posed::Posed;
use super::settings::Frame;
use super::transforms::local;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::{DMat4, DVec3};
use roxmltree::NodeId;
use std::collections::HashMap;

/// A node of the scene.
#[derive(Clone, Copy)]
pub(super) struct Placed<'d> {
    pub(super) node: Element<'d>,
    /// From its space to world space: metres, y up.
    pub(super) world: DMat4,
    /// The axes and the unit of its space.
    pub(super) frame: Frame,
    pub(super) is_visible: bool,
}

/// All nodes, parents first. A node is there once for each time it is instanced.
pub(super) struct Graph<'d> {
    pub(super) nodes: Vec<Placed<'d>>,
    /// The first place of each node.
    places: HashMap<NodeId, usize>,
}

/// Longer chains of nodes are refused.
const MAX_DEPTH: usize = 2000;

impl<'d> Graph<'d> {
    /// All nodes as they are posed, with their positions relative to `origin`.
    pub(super) fn read(
        scene: Element<'d>,
        posed: &Posed<'_, 'd>,
        origin: DVec3,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Graph<'d>, FormatError> {
        let document = posed.document;
        // An asset is of the element that it is in. [Collada 1.4.1, asset]
        let mut frame = document.settings.frame;
        let library = document.root.children_named("library_visual_scenes");
        for around in library.filter(|library| library.children().any(|child| child.key() == scene.key())) {
            frame = frame.within(around, diagnostics);
        }
        frame = frame.within(scene, diagnostics);
        let to_world = DMat4::from_translation(-origin) * frame.to_world();
        let mut graph = Graph { nodes: Vec::new(), places: HashMap::new() };
        // The nodes between the scene and the current one.
        let mut open: Vec<NodeId> = Vec::new();
        let mut waiting: Vec<Waiting> = Vec::new();
        let first = Parent { world: to_world, frame, is_visible: true, depth: 0 };
        push_children(scene, first, document, &mut waiting, diagnostics);
        while let Some((node, parent)) = waiting.pop() {
            let depth = parent.depth;
            open.truncate(depth);
            if open.contains(&node.key()) {
                return Err(
                    node.error("this node is its own ancestor, by way of <instance_node>: remove one")
                );
            }
            if depth >= MAX_DEPTH {
                return Err(node.error(format!("nodes are nested more than {MAX_DEPTH} levels deep")));
            }
            open.push(node.key());
            budget.take::<(Placed, [usize; 6], [(Element, DMat4); 1])>(1, node.file())?;
            let frame = parent.frame.within(node, diagnostics);
            let world = parent.world * parent.frame.from(frame) * local(node, posed, budget)?;
            if !world.is_finite() {
                return Err(node.error("the transform of this node overflows to numbers that are not finite"));
            }
            let is_visible = parent.is_visible && !is_hidden(node);
            if parent.is_visible && !is_visible {
                diagnostics.remark("a node is hidden", || node.at());
            }
            graph.places.entry(node.key()).or_insert(graph.nodes.len());
            graph.nodes.push(Placed { node, world, frame, is_visible });
            let around = Parent { world, frame, is_visible, depth: depth + 1 };
            push_children(node, around, document, &mut waiting, diagnostics);
        }
        Ok(graph)
    }

    /// The transform of a node to world space, if it is in the scene.
    pub(super) fn world_of(&self, node: Element) -> Option<DMat4> {
        self.places.get(&node.key()).map(|&place| self.nodes[place].world)
    }
}

/// Values that nodes take over from the one that they are in.
#[derive(Clone, Copy)]
struct Parent {
    world: DMat4,
    frame: Frame,
    is_visible: bool,
    depth: usize,
}

/// A node that is to be placed.
type Waiting<'d> = (Element<'d>, Parent);

/// Adds the nodes in another one, so that the first comes first.
fn push_children<'d>(
    within: Element<'d>,
    parent: Parent,
    document: &Document<'d>,
    waiting: &mut Vec<Waiting<'d>>,
    diagnostics: &mut Diagnostics,
) {
    let first = waiting.len();
    for child in within.children() {
        let node = match child.name() {
            "node" => Some(child),
            "instance_node" => {
                document.referred(child, "url", diagnostics).filter(|found| found.name() == "node")
            }
            _ => None,
        };
        waiting.extend(node.map(|node| (node, parent)));
    }
    waiting[first..].reverse();
}

/// True if a program says that a node is not visible.
fn is_hidden(node: Element) -> bool {
    let techniques = node.children_named("extra").flat_map(|extra| extra.children_named("technique"));
    let mut stated = techniques.filter_map(|technique| technique.child("visibility")).map(Element::text);
    stated.any(|visibility| matches!(visibility, "0" | "0.0" | "0.000000" | "false"))
}
