//! Skins: their joints and matrices. [glTF 2.0, 3.7.3]

use super::accessors::format_words;
use super::nodes::{named_nodes, parents, root_of, skin_of};
use super::{Check, Role, counted, text, whole};
use crate::document::json::JsonNode;

pub(super) fn matrices<'d>(check: &mut Check<'d, '_>, skin: JsonNode<'d>) {
    let Some((index, accessor)) = check.named("accessors", skin, "inverseBindMatrices") else { return };
    let key = "inverseBindMatrices";
    if text(accessor, "type") != Some("MAT4") || whole(accessor, "componentType") != Some(5126) {
        let message = format!("inverse bind matrices must be MAT4 of FLOAT, not {}", format_words(accessor));
        return check.report_key(skin, key, message);
    }
    check.assign_role(skin, accessor, Role::InverseBindMatrices);
    let (have, wanted) = (whole(accessor, "count").unwrap_or(0), named_nodes(skin, "joints").len());
    if have < wanted {
        let message = format!("there are only {have} inverse bind matrices for {}", counted(wanted, "joint"));
        check.report_key(skin, key, message);
    }
    let Some(numbers) = check.numbers(index).filter(|_| accessor.get("bufferView").is_some()) else { return };
    let is_affine = |m: &[f32]| [m[3], m[7], m[11], m[15]] == [0.0, 0.0, 0.0, 1.0];
    if let Some(bad) = numbers.chunks_exact(16).position(|m| !is_affine(m)) {
        let message = format!("the last row of inverse bind matrix {bad} must be 0, 0, 0, 1");
        check.report_key(skin, key, message);
    }
}

pub(super) fn common_root<'d>(check: &mut Check<'d, '_>, skin: JsonNode<'d>) {
    let parents = parents(check);
    let joints: Vec<usize> = named_nodes(skin, "joints").into_iter().filter(|&j| j < parents.len()).collect();
    let Some(&first) = joints.first() else { return };
    let root = root_of(&parents, first);
    if joints.iter().any(|&joint| root_of(&parents, joint) != root) {
        return check.report_key(skin, "joints", "these joints have no common root: put them below one node");
    }
    let Some((skeleton, _)) = check.named("nodes", skin, "skeleton") else { return };
    let is_below = |&joint: &usize| {
        let mut at = Some(joint);
        for _ in 0..=parents.len() {
            match at {
                Some(index) if index == skeleton => return true,
                Some(index) => at = parents[index],
                None => break,
            }
        }
        false
    };
    if !joints.iter().all(is_below) {
        check.report_key(skin, "skeleton", "the skeleton is not above all joints of this skin");
    }
}

/// Checks that a skinned mesh and its joints belong to the same scene.
pub(super) fn in_scene<'d>(check: &mut Check<'d, '_>, _: JsonNode<'d>) {
    let parents = parents(check);
    let nodes = check.list("nodes");
    for scene in check.list("scenes") {
        let roots = named_nodes(scene, "nodes");
        for (index, node) in nodes.iter().enumerate() {
            let Some(skin) = skin_of(*node).and_then(|skin| check.root.item("skins", skin)) else { continue };
            let is_in = |index: usize| index < parents.len() && roots.contains(&root_of(&parents, index));
            let joints = named_nodes(skin, "joints");
            if node.get("mesh").is_some() && is_in(index) && !joints.iter().all(|&joint| is_in(joint)) {
                let message = "the joints of this skinned mesh are not in its scene";
                check.report(*node, message);
            }
        }
    }
}
