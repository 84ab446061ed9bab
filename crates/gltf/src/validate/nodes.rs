//! Nodes: their transforms, and that they form trees. [glTF 2.0, 3.5]

use super::meshes::target_count;
use super::{Check, counted, floats, whole};
use crate::document::json::JsonNode;
use bilux_math::DVec3;

pub(super) fn transform<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some(matrix) = node.get("matrix") else { return };
    if let Some(other) = ["translation", "rotation", "scale"].iter().find(|key| node.get(key).is_some()) {
        check.report(matrix, format!("this node has both a matrix and a {other}: it needs one of them"));
    }
    let Some(m) = floats(node, "matrix").filter(|m| m.len() == 16) else { return };
    let axis = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
    let axes = [axis(0), axis(1), axis(2)];
    let is_skewed = (0..3).any(|i| {
        let (a, b) = (axes[i], axes[(i + 1) % 3]);
        a.dot(b).abs() > 1e-3 * a.length() * b.length()
    });
    if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] || is_skewed {
        let message = "this matrix must be made of a translation, a rotation and a scale, but is not";
        check.report(matrix, message);
    }
}

pub(super) fn rotation<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some(q) = floats(node, "rotation").filter(|q| q.len() == 4) else { return };
    let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
    // Exporters write at least four digits.
    if (length - 1.0).abs() > 5e-4 {
        check.report_key(
            node,
            "rotation",
            format!("this rotation has length {length:.4}, but must have length 1"),
        );
    }
}

/// True if a primitive of the mesh has joints.
pub(super) fn has_joints(mesh: JsonNode) -> bool {
    mesh.get("primitives")
        .into_iter()
        .flat_map(|list| list.children())
        .any(|primitive| primitive.get("attributes").is_some_and(|a| a.value().get("JOINTS_0").is_some()))
}

pub(super) fn mesh<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    for key in ["skin", "weights"] {
        if node.get(key).is_some() && node.get("mesh").is_none() {
            check.report_key(node, key, format!("'{key}' has no effect on a node without a mesh"));
        }
    }
    let Some((_, mesh)) = check.named("meshes", node, "mesh") else { return };
    let (has_skin, has_joints) = (node.get("skin").is_some(), has_joints(mesh));
    if has_skin && !has_joints {
        check.report(node, "this node has a skin, but no primitive of its mesh has JOINTS_0 and WEIGHTS_0");
    } else if has_joints && !has_skin {
        check.report(node, "the mesh of this node has joints, but the node has no skin: it keeps its shape");
    }
    let Some(weights) = node.get("weights").filter(|list| list.value().is_array()) else { return };
    let (have, wanted) = (weights.children().count(), target_count(mesh));
    if have != wanted {
        let message = format!("{} for {}", counted(have, "weight"), counted(wanted, "morph target"));
        check.report(weights, message + ": the numbers must be equal");
    } else if mesh.get("weights").is_some() {
        check.report_key(mesh, "weights", "these weights are not used, since the node has its own");
    }
}

/// The transforms of a skinned mesh's node and of its ancestors have no effect.
pub(super) fn skinned_place<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some((_, mesh)) = check.named("meshes", node, "mesh") else { return };
    if node.get("skin").is_none() || !has_joints(mesh) {
        return;
    }
    let stands = |node: JsonNode| {
        ["matrix", "translation", "rotation", "scale"].iter().any(|key| node.value().get(key).is_some())
    };
    if stands(node) {
        check.report(
            node,
            "the transform of a node with a skinned mesh has no effect: its joints position it",
        );
    }
    let parents = parents(check);
    let mut above = node.number_in_list().and_then(|index| *parents.get(index)?);
    for _ in 0..parents.len() {
        let Some(index) = above else { break };
        if check.root.item("nodes", index).is_some_and(stands) {
            let message =
                "the transforms of the nodes above a skinned mesh have no effect: its joints position it";
            return check.report(node, message);
        }
        above = parents[index];
    }
}

/// The parent of each node; the first one if it has several.
pub(super) fn parents(check: &Check<'_, '_>) -> Vec<Option<usize>> {
    let nodes = check.list("nodes");
    let mut parents = vec![None; nodes.len()];
    for (index, node) in nodes.into_iter().enumerate() {
        for child in node.get("children").into_iter().flat_map(|list| list.children()) {
            let child = child.value().as_u64().and_then(|child| usize::try_from(child).ok());
            if let Some(slot) = child.and_then(|child| parents.get_mut(child)) {
                slot.get_or_insert(index);
            }
        }
    }
    parents
}

pub(super) fn roots<'d>(check: &mut Check<'d, '_>, scene: JsonNode<'d>) {
    let parents = parents(check);
    for item in scene.get("nodes").into_iter().flat_map(|list| list.children()) {
        let index = item.value().as_u64().and_then(|index| usize::try_from(index).ok());
        if let Some(parent) = index.and_then(|index| *parents.get(index)?) {
            check.report(
                item,
                format!(
                    "a scene may list only root nodes, but node {parent} is the parent of this \
                                        one"
                ),
            );
        }
    }
}

pub(super) fn trees<'d>(check: &mut Check<'d, '_>, _: JsonNode<'d>) {
    let parents = parents(check);
    for (index, node) in check.list("nodes").into_iter().enumerate() {
        for child in node.get("children").into_iter().flat_map(|list| list.children()) {
            let number = child.value().as_u64().and_then(|child| usize::try_from(child).ok());
            let first = number.and_then(|child| *parents.get(child)?);
            if first.is_some_and(|first| first != index) {
                let other = first.unwrap_or(0);
                check.report(
                    child,
                    format!("this node is already a child of node {other}: a node has one parent"),
                );
            }
        }
        let (mut above, mut steps) = (parents[index], 0);
        while let Some(parent) = above.filter(|_| steps < parents.len()) {
            if parent == index {
                check.report(node, "this node is its own ancestor: nodes must form a tree");
                break;
            }
            (above, steps) = (parents[parent], steps + 1);
        }
    }
}

/// The index of a node's root.
pub(super) fn root_of(parents: &[Option<usize>], mut index: usize) -> usize {
    for _ in 0..parents.len() {
        match parents.get(index).copied().flatten() {
            Some(parent) => index = parent,
            None => break,
        }
    }
    index
}

/// The value as an index.
pub(super) fn as_index(node: JsonNode) -> Option<usize> {
    node.value().as_u64().and_then(|index| usize::try_from(index).ok())
}

/// The nodes that `key` of a node or a skin lists.
pub(super) fn named_nodes<'d>(node: JsonNode<'d>, key: &'d str) -> Vec<usize> {
    node.get(key).into_iter().flat_map(|list| list.children()).filter_map(as_index).collect()
}

/// The index of a node's skin.
pub(super) fn skin_of(node: JsonNode) -> Option<usize> {
    whole(node, "skin")
}
