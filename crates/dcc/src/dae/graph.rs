//! The nodes of the scene with their transforms to world space.

use super::document::Document;
use super::element::Element;
use super::posed::Posed;
use super::transforms::local;
use bilux_import::FormatError;
use bilux_import::budget::Budget;
use bilux_import::oddities::Oddities;
use bilux_math::{DMat4, DVec3};
use roxmltree::NodeId;
use std::collections::HashMap;

/// A node of the scene.
#[derive(Clone, Copy)]
pub(super) struct Placed<'d> {
    pub(super) node: Element<'d>,
    /// From its space to world space: metres, y up.
    pub(super) world: DMat4,
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
        oddities: &mut Oddities,
    ) -> Result<Graph<'d>, FormatError> {
        let document = posed.document;
        let to_world = DMat4::from_translation(-origin) * document.settings.to_world;
        let mut graph = Graph { nodes: Vec::new(), places: HashMap::new() };
        // The nodes between the scene and the current one.
        let mut open: Vec<NodeId> = Vec::new();
        let mut waiting: Vec<(Element, DMat4, bool, usize)> = Vec::new();
        push_children(scene, to_world, true, 0, document, &mut waiting, oddities);
        while let Some((node, parent, is_parent_visible, depth)) = waiting.pop() {
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
            let world = parent * local(node, posed, budget)?;
            if !world.is_finite() {
                return Err(node.error("the transform of this node overflows to numbers that are not finite"));
            }
            let is_visible = is_parent_visible && !is_hidden(node);
            if is_parent_visible && !is_visible {
                oddities.remark("a node is hidden", || node.at());
            }
            graph.places.entry(node.key()).or_insert(graph.nodes.len());
            graph.nodes.push(Placed { node, world, is_visible });
            push_children(node, world, is_visible, depth + 1, document, &mut waiting, oddities);
        }
        Ok(graph)
    }

    /// The transform of a node to world space, if it is in the scene.
    pub(super) fn world_of(&self, node: Element) -> Option<DMat4> {
        self.places.get(&node.key()).map(|&place| self.nodes[place].world)
    }
}

/// Adds the nodes in another one, so that the first comes first.
fn push_children<'d>(
    within: Element<'d>,
    world: DMat4,
    is_visible: bool,
    depth: usize,
    document: &Document<'d>,
    waiting: &mut Vec<(Element<'d>, DMat4, bool, usize)>,
    oddities: &mut Oddities,
) {
    let first = waiting.len();
    for child in within.children() {
        let node = match child.name() {
            "node" => Some(child),
            "instance_node" => {
                document.referred(child, "url", oddities).filter(|found| found.name() == "node")
            }
            _ => None,
        };
        waiting.extend(node.map(|node| (node, world, is_visible, depth)));
    }
    waiting[first..].reverse();
}

/// True if a program says that a node is not visible.
fn is_hidden(node: Element) -> bool {
    let techniques = node.children_named("extra").flat_map(|extra| extra.children_named("technique"));
    let mut stated = techniques.filter_map(|technique| technique.child("visibility")).map(Element::text);
    stated.any(|visibility| matches!(visibility, "0" | "0.0" | "0.000000" | "false"))
}
