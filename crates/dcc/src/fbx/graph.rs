//! The nodes of the scene, which the format calls models, with their transforms to world space.

use super::document::{Document, Index, ROOT};
use super::posed::Posed;
use super::transform::{Inherited, Local, geometric};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::{DMat4, DVec3};
use std::collections::HashMap;

/// A node of the scene.
#[derive(Clone, Copy)]
pub(super) struct Placed {
    pub(super) model: Index,
    /// From its space to world space: metres, y up.
    pub(super) world: DMat4,
    /// From the space of its mesh to its own.
    pub(super) geometric: DMat4,
    pub(super) is_visible: bool,
}

/// All nodes, parents first.
pub(super) struct Graph {
    pub(super) nodes: Vec<Placed>,
    /// From the axes and the unit of the file to world space.
    pub(super) to_world: DMat4,
    /// The place of each model in `nodes`.
    order: HashMap<Index, usize>,
}

impl Graph {
    /// All nodes as they are posed, with their positions relative to `origin`.
    pub(super) fn read(
        posed: &Posed,
        origin: DVec3,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Graph, FormatError> {
        let document = posed.document;
        let to_world = DMat4::from_translation(-origin) * document.settings.to_world;
        let mut graph = Graph { nodes: Vec::new(), to_world, order: HashMap::new() };
        let root = (Inherited::root(), true);
        let mut waiting: Vec<(Index, Inherited, bool)> =
            roots(document).into_iter().rev().map(|model| (model, root.0, root.1)).collect();
        while let Some((model, parent, is_parent_visible)) = waiting.pop() {
            let node = document.object(model).node;
            if graph.order.contains_key(&model) {
                diagnostics
                    .note("a node has two parents, or is its own ancestor: its first place counts", || {
                        node.at()
                    });
                continue;
            }
            budget.take::<(Placed, [usize; 6], [Inherited; 2])>(1, node.file())?;
            let properties = posed.properties(model);
            let inherited = parent.child(&Local::of(&properties));
            let own_visibility = properties.number("Visibility").unwrap_or(1.0) > 0.0
                && properties.integer("Show").unwrap_or(1) != 0;
            let inherits = properties.integer("Visibility Inheritance").unwrap_or(1) != 0;
            let is_visible = own_visibility && (is_parent_visible || !inherits);
            if !is_visible {
                diagnostics.remark("a node is hidden", || node.at());
            }
            let world = to_world * inherited.matrix;
            if !world.is_finite() {
                return Err(node.error("the transform of this node overflows to numbers that are not finite"));
            }
            graph.order.insert(model, graph.nodes.len());
            graph.nodes.push(Placed { model, world, geometric: geometric(&properties), is_visible });
            let shows_one = is_level_group(document, model);
            let children: Vec<Index> = document.sources_of_class(model, "Model").collect();
            for (number, &child) in children.iter().enumerate().rev() {
                let is_left_out = shows_one && number > 0;
                if is_left_out {
                    diagnostics.remark("of the levels of detail of a group the first is shown", || node.at());
                }
                waiting.push((child, inherited, is_visible && !is_left_out));
            }
        }
        if document
            .indices()
            .any(|index| document.class(index) == b"Model" && !graph.order.contains_key(&index))
        {
            let what = "some nodes are their own ancestors, and are left out";
            diagnostics.note(what, || document.tree.whole());
        }
        Ok(graph)
    }

    /// The transform of a model to world space, if it is in the scene.
    pub(super) fn world_of(&self, model: Index) -> Option<DMat4> {
        self.order.get(&model).map(|&order| self.nodes[order].world)
    }
}

/// The models without a parent among models, in the order of the scene's connections and then of the file.
fn roots(document: &Document) -> Vec<Index> {
    let mut roots: Vec<Index> = document.sources_of_class(ROOT, "Model").collect();
    let is_free = |&model: &Index| {
        let mut links = document.targets(model).filter(|link| link.property.is_none());
        document.class(model) == b"Model"
            && !links.any(|link| link.target == ROOT || document.class(link.target) == b"Model")
    };
    roots.extend(document.indices().filter(is_free));
    roots
}

/// True for a node whose children are the same thing in more and more coarse levels.
fn is_level_group(document: &Document, model: Index) -> bool {
    let is_group = |index: Index| document.object(index).kind == b"LodGroup";
    is_group(model) || document.sources_of_class(model, "NodeAttribute").any(is_group)
}
