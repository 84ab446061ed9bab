//! Vertex data: directions, colours and skin weights. [glTF 2.0, 3.7.2.1 and 3.7.3.3]

use super::meshes::{have, of_primitive};
use super::{Check, is_off, text, whole};
use crate::document::json::JsonNode;

/// The tolerance on unit lengths; bytes and halves stay within it.
const LENGTH_TOLERANCE: f32 = 0.01;
const SUM_TOLERANCE: f32 = 0.01;

pub(super) fn values<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let all = of_primitive(check, node);
    for &(name, index, accessor) in &all {
        let is_vec4 = text(accessor, "type") == Some("VEC4");
        let report: fn(&[f32]) -> Option<String> = match name.split('_').next().unwrap_or(name) {
            "NORMAL" => normals,
            "TANGENT" => tangents,
            "COLOR" => colours,
            "WEIGHTS" => negative_weights,
            _ => continue,
        };
        if matches!(name, "TANGENT") && !is_vec4 || name == "NORMAL" && text(accessor, "type") != Some("VEC3")
        {
            continue;
        }
        let has_data = accessor.get("bufferView").is_some() || accessor.get("sparse").is_some();
        let Some(numbers) = check.numbers(index).filter(|_| has_data) else { continue };
        if let Some(message) = report(&numbers) {
            check.report_key(node, "attributes", format!("{name}: {message}"));
        }
    }
    influences(check, node, &all);
}

/// Counts the elements with a fault, and states the first.
fn counted_faults(faults: impl Iterator<Item = bool>, noun: &str, rest: &str) -> Option<String> {
    let at: Vec<usize> = faults.enumerate().filter(|(_, bad)| *bad).map(|(i, _)| i).collect();
    let first = at.first()?;
    Some(format!("{} {rest}; the first is that of vertex {first}", have(at.len(), noun)))
}

fn is_off_unit(v: &[f32]) -> bool {
    let squared: f32 = v.iter().map(|x| x * x).sum();
    is_off(squared.sqrt() - 1.0, LENGTH_TOLERANCE)
}

fn normals(all: &[f32]) -> Option<String> {
    counted_faults(all.chunks_exact(3).map(is_off_unit), "normal", "not length one")
}

fn tangents(all: &[f32]) -> Option<String> {
    let off = counted_faults(all.chunks_exact(4).map(|t| is_off_unit(&t[..3])), "tangent", "not length one");
    let signs = || {
        let is_off = |t: &[f32]| t[3].abs() != 1.0;
        counted_faults(all.chunks_exact(4).map(is_off), "tangent", "a fourth number other than 1 and -1")
    };
    off.or_else(signs)
}

fn colours(all: &[f32]) -> Option<String> {
    let bad = all.iter().filter(|x| !(0.0..=1.0).contains(*x)).count();
    (bad > 0).then(|| format!("{bad} of its numbers are not from 0 to 1"))
}

fn negative_weights(all: &[f32]) -> Option<String> {
    let bad = all.iter().filter(|x| **x < 0.0).count();
    (bad > 0).then(|| format!("{bad} of its numbers are negative"))
}

/// All joints and weights of a primitive, per vertex, over all sets.
fn influences<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>, all: &[(&'d str, usize, JsonNode<'d>)]) {
    let find = |name: String| all.iter().find(|(other, ..)| **other == name);
    let (mut sets, mut count) = (Vec::new(), usize::MAX);
    for set in 0.. {
        let (Some(joints), Some(weights)) = (find(format!("JOINTS_{set}")), find(format!("WEIGHTS_{set}")))
        else {
            break;
        };
        let is_vec4 = [joints.2, weights.2].iter().all(|accessor| text(*accessor, "type") == Some("VEC4"));
        let has_data = [joints.2, weights.2].iter().all(|accessor| accessor.get("bufferView").is_some());
        let (Some(joints), Some(weights)) = (check.numbers(joints.1), check.numbers(weights.1)) else {
            return;
        };
        if !is_vec4 || !has_data {
            return;
        }
        count = count.min(joints.len() / 4).min(weights.len() / 4);
        sets.push((joints, weights));
    }
    if sets.is_empty() {
        return;
    }
    let limit = joint_limit(check, node);
    let (mut sums, mut twice, mut idle, mut beyond) = (0, 0, 0, None);
    for vertex in 0..count {
        let (mut joints, mut sum) = (Vec::with_capacity(4 * sets.len()), 0.0);
        for (indices, weights) in &sets {
            let part = 4 * vertex..4 * vertex + 4;
            for (&joint, &weight) in indices[part.clone()].iter().zip(&weights[part]) {
                sum += weight;
                if weight == 0.0 {
                    idle += usize::from(joint != 0.0);
                    continue;
                }
                twice += usize::from(joints.contains(&joint));
                joints.push(joint);
                if limit.is_some_and(|limit| joint as usize >= limit) {
                    beyond.get_or_insert((vertex, joint as usize));
                }
            }
        }
        sums += usize::from(is_off(sum - 1.0f32, SUM_TOLERANCE));
    }
    let mut report = |message: String| check.report_key(node, "attributes", message);
    if let (Some((vertex, joint)), Some(limit)) = (beyond, limit) {
        report(format!(
            "vertex {vertex} refers to joint {joint}, but its skin has only {limit}, counted from 0"
        ));
    }
    if sums > 0 {
        report(format!(
            "{} weights that do not add up to one",
            have(sums, "vertex").replace("vertexs", "vertices")
        ));
    }
    if twice > 0 {
        report(format!("a vertex refers to the same joint twice ({twice} times in this primitive)"));
    }
    if idle > 0 {
        report(format!("joints with a weight of zero should be joint 0 ({idle} are not)"));
    }
}

/// The smallest number of joints of any skin that is used with the mesh of a primitive.
fn joint_limit<'d>(check: &Check<'d, '_>, primitive: JsonNode<'d>) -> Option<usize> {
    let mesh = primitive.number_of_parent()?;
    let wearing = check.list("nodes").into_iter().filter(|node| whole(*node, "mesh") == Some(mesh));
    let skins = wearing.filter_map(|node| check.named("skins", node, "skin"));
    skins.filter_map(|(_, skin)| Some(skin.get("joints")?.children().count())).min()
}
