//! The nodes of the scene with their transforms to world space.

use super::SURROUNDINGS;
use super::json::JsonNode;
use super::place;
use super::reader::Gltf;
use crate::FormatError;
use bilux_math::DMat4;

/// A node of the scene.
#[derive(Clone, Copy)]
pub(super) struct Placed<'d> {
    pub(super) node: JsonNode<'d>,
    /// Its index in the file.
    pub(super) index: usize,
    /// The transform from its space to world space.
    pub(super) world: DMat4,
    /// Whether its mesh and its lights are shown; cameras always are. [KHR_node_visibility]
    pub(super) is_visible: bool,
}

impl<'d> Gltf<'d, '_, '_> {
    /// All nodes of the scene, parents first, in the order of the file.
    ///
    /// # Errors
    /// If a node is reached twice, from two parents or from itself.
    pub(super) fn nodes(&mut self) -> Result<Vec<Placed<'d>>, FormatError> {
        let root = self.document.root;
        let count = root.list("nodes")?.len();
        self.reading.budget.take_bytes((count * size_of::<[Placed; 2]>()) as u64, &self.file)?;
        self.order = vec![None; count];
        let at_origin = DMat4::from_translation(-self.reading.origin);
        let mut waiting: Vec<(JsonNode<'d>, DMat4, bool)> =
            self.roots()?.into_iter().rev().map(|node| (node, at_origin, true)).collect();
        let mut placed = Vec::new();
        while let Some((index, parent, is_parent_visible)) = waiting.pop() {
            let node = self.document.named("nodes", index)?;
            let number = index.as_count()?;
            let slot = &mut self.order[number];
            if slot.replace(placed.len()).is_some() {
                let message = "this node has two parents, or is its own ancestor: a node has one parent";
                return Err(index.error(message));
            }
            let world = parent * place::local(node, number, &self.pose)?;
            if !world.is_finite() {
                return Err(node.error("the transform of this node overflows to numbers that are not finite"));
            }
            let is_visible = is_parent_visible && self.is_visible(node, number)?;
            placed.push(Placed { node, index: number, world, is_visible });
            let children = node.list("children")?;
            waiting.extend(children.into_iter().rev().map(|child| (child, world, is_visible)));
        }
        Ok(placed)
    }

    /// Whether a node is visible if its parents are.
    fn is_visible(&mut self, node: JsonNode<'d>, number: usize) -> Result<bool, FormatError> {
        let stated = match node.extension("KHR_node_visibility").and_then(|entry| entry.get("visible")) {
            Some(value) => value.as_switch()?,
            None => true,
        };
        let is_visible = self.pose.is_visible(number).unwrap_or(stated);
        if !is_visible {
            let what = "a node is hidden by KHR_node_visibility, and with it all nodes below it";
            self.oddities.remark(what, || node.at());
        }
        Ok(is_visible)
    }

    /// The indices of the scene's root nodes, as the file lists them.
    fn roots(&mut self) -> Result<Vec<JsonNode<'d>>, FormatError> {
        let root = self.document.root;
        let scenes = root.list("scenes")?;
        let scene = match root.get("scene") {
            Some(index) => Some(self.document.named("scenes", index)?),
            None => scenes.first().copied(),
        };
        if scenes.len() > 1 {
            let at = || root.at_key("scenes");
            match root.get("scene") {
                Some(_) => {
                    let what = format!("the file has {} scenes: the default one is shown", scenes.len());
                    self.oddities.remark(&what, at);
                }
                None => {
                    let what =
                        format!("the file has {} scenes and no default: the first is shown", scenes.len());
                    self.oddities.note(&what, at);
                }
            }
        }
        // A scene that Bilux wrote records all of its surroundings.
        let around = scene.as_ref().and_then(|scene| scene.get("extras")?.get(SURROUNDINGS));
        self.scene.environment_unspecified = around.is_none();
        self.scene.exposure_unspecified = around.is_none();
        match scene {
            Some(scene) => scene.list("nodes"),
            None => {
                if root.get("nodes").is_some() {
                    let what = "the file has no scene, so nothing in it is rendered";
                    self.oddities.note(what, || root.at());
                }
                Ok(Vec::new())
            }
        }
    }
}
