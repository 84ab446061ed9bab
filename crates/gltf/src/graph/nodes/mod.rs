//! The nodes of the scene with their transforms to world space.

use crate::document::data::DataReader;
use crate::document::extras::{CATEGORY, SURROUNDINGS};
use crate::document::json::JsonNode;
use crate::document::json_document::Document;
use crate::graph::animation::Pose;
use crate::graph::place;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::{DMat4, DVec3};

/// A node of the scene.
#[derive(Clone, Copy)]
pub(crate) struct Placed<'d> {
    pub(crate) node: JsonNode<'d>,
    /// Index of the node in the file.
    pub(crate) index: usize,
    /// The transform from its space to world space.
    pub(crate) world: DMat4,
    /// Whether its mesh and its lights are shown; cameras always are. [KHR_node_visibility]
    pub(crate) is_visible: bool,
    /// Kind of thing that the node is, by its own `extras` or else those of its parents; empty for none.
    pub(crate) category: &'d str,
}

/// The nodes of the scene that is shown.
pub(crate) struct Graph<'d> {
    /// Parents first, in the order of the file.
    pub(crate) nodes: Vec<Placed<'d>>,
    /// For each node of the file its index in `nodes`, if it is in the scene.
    order: Vec<Option<usize>>,
    /// True if the scene records all of its surroundings, as one does that Bilux wrote.
    pub(crate) has_surroundings: bool,
}

impl<'d> Graph<'d> {
    /// All nodes of the scene, as they are posed, with their positions relative to `origin`.
    ///
    /// # Errors
    /// If a node is reached twice, from two parents or from itself.
    pub(crate) fn read(
        pose: &Pose,
        origin: DVec3,
        data: &mut DataReader<'d, '_>,
    ) -> Result<Graph<'d>, FormatError> {
        let document = data.document;
        let count = document.root.list("nodes")?.len();
        data.take_bytes((count * size_of::<[Placed; 2]>()) as u64)?;
        let scene = shown_scene(document, data.diagnostics)?;
        let roots = scene.map_or(Ok(Vec::new()), |scene| scene.list("nodes"))?;
        let at_origin = DMat4::from_translation(-origin);
        let mut waiting: Vec<(JsonNode<'d>, DMat4, bool, &'d str)> =
            roots.into_iter().rev().map(|node| (node, at_origin, true, "")).collect();
        let (mut nodes, mut order) = (Vec::new(), vec![None; count]);
        while let Some((index, parent, is_parent_visible, inherited)) = waiting.pop() {
            let node = document.named("nodes", index)?;
            let number = index.as_count()?;
            if order[number].replace(nodes.len()).is_some() {
                let message = "this node has two parents, or is its own ancestor: a node has one parent";
                return Err(index.error(message));
            }
            let world = parent * place::local(node, number, pose)?;
            if !world.is_finite() {
                return Err(node.error("the transform of this node overflows to numbers that are not finite"));
            }
            let is_visible = is_parent_visible && is_visible(node, number, pose, data.diagnostics)?;
            let category = category(node).unwrap_or(inherited);
            nodes.push(Placed { node, index: number, world, is_visible, category });
            let children = node.list("children")?;
            waiting.extend(children.into_iter().rev().map(|child| (child, world, is_visible, category)));
        }
        let has_surroundings =
            scene.is_some_and(|scene| scene.get("extras").is_some_and(|own| own.get(SURROUNDINGS).is_some()));
        Ok(Graph { nodes, order, has_surroundings })
    }

    /// The transform of the node with this index in the file to world space; `None` if it is not in the scene.
    pub(crate) fn world_of(&self, node: usize) -> Option<DMat4> {
        self.order[node].map(|order| self.nodes[order].world)
    }
}

/// Kind of thing that a node or a mesh is, if its `extras` say it. Extras are anybody's own, so what is no text is no mistake.
pub(crate) fn category<'d>(holder: JsonNode<'d>) -> Option<&'d str> {
    holder.get("extras")?.get(CATEGORY)?.as_text().ok()
}

/// Whether a node is visible if its parents are.
fn is_visible(
    node: JsonNode,
    number: usize,
    pose: &Pose,
    diagnostics: &mut Diagnostics,
) -> Result<bool, FormatError> {
    let stated = match node.extension("KHR_node_visibility").and_then(|entry| entry.get("visible")) {
        Some(value) => value.as_switch()?,
        None => true,
    };
    let is_visible = pose.is_visible(number).unwrap_or(stated);
    if !is_visible {
        let what = "a node is hidden by KHR_node_visibility, and with it all nodes below it";
        diagnostics.remark(what, || node.at());
    }
    Ok(is_visible)
}

/// The scene that is shown, if the file has one: the default one, or else the first.
fn shown_scene<'d>(
    document: &Document<'d>,
    diagnostics: &mut Diagnostics,
) -> Result<Option<JsonNode<'d>>, FormatError> {
    let root = document.root;
    let scenes = root.list("scenes")?;
    let default = root.get("scene").map(|index| document.named("scenes", index)).transpose()?;
    if scenes.len() > 1 {
        let (count, at) = (scenes.len(), || root.at_key("scenes"));
        if default.is_some() {
            diagnostics.remark(&format!("the file has {count} scenes: the default one is shown"), at);
        } else {
            diagnostics.note(&format!("the file has {count} scenes and no default: the first is shown"), at);
        }
    }
    let scene = default.or(scenes.first().copied());
    if scene.is_none() && root.get("nodes").is_some() {
        diagnostics.note("the file has no scene, so nothing in it is rendered", || root.at());
    }
    Ok(scene)
}
