//! Animations: keyframes and their targets. [glTF 2.0, 3.11]

use super::accessors::format_words;
use super::meshes::target_count;
use super::nodes::{as_index, has_joints};
use super::{Check, Role, counted, is_off, text, whole};
use crate::document::json::JsonNode;
use std::collections::HashSet;

/// Checks all animations, after the objects that they animate.
pub(super) fn all<'d>(check: &mut Check<'d, '_>, _: JsonNode<'d>) {
    for animation in check.list("animations") {
        let samplers: Vec<_> =
            animation.get("samplers").into_iter().flat_map(|list| list.children()).collect();
        samplers.iter().for_each(|sampler| input(check, *sampler));
        let mut moved = HashSet::new();
        for channel in animation.get("channels").into_iter().flat_map(|list| list.children()) {
            let Some(target) = channel.get("target") else { continue };
            let path = text(target, "path").unwrap_or_default();
            if let Some(node) = whole(target, "node")
                && !moved.insert((node, path))
            {
                check.report(
                    target,
                    format!("another channel of this animation also animates the {path} of node {node}"),
                );
            }
            aim(check, target, path);
            let Some(index) = channel.get("sampler").and_then(as_index) else { continue };
            match samplers.get(index) {
                Some(sampler) => output(check, channel, *sampler, path),
                None => {
                    let have = counted(samplers.len(), "sampler");
                    check.report_key(
                        channel,
                        "sampler",
                        format!("there is no sampler {index}: the animation has {have}"),
                    );
                }
            }
        }
    }
}

/// Checks that a channel's target can be animated.
fn aim<'d>(check: &mut Check<'d, '_>, target: JsonNode<'d>, path: &str) {
    if let Some(pointer) = target.extension("KHR_animation_pointer") {
        if path != "pointer" {
            check.report_key(
                target,
                "path",
                format!("with KHR_animation_pointer the path must be pointer, not {path}"),
            );
        }
        if target.get("node").is_some() {
            check.report_key(target, "node", "with KHR_animation_pointer there must be no node here");
        }
        if text(pointer, "pointer").is_some_and(|pointer| !pointer.starts_with('/')) {
            check.report_key(pointer, "pointer", "a JSON pointer begins with '/'");
        }
        return;
    }
    if path == "pointer" {
        check.report_key(target, "path", "the path pointer needs the extension KHR_animation_pointer here");
    }
    let Some((_, node)) = check.named("nodes", target, "node") else { return };
    let mesh = check.named("meshes", node, "mesh").map(|(_, mesh)| mesh);
    if path == "weights" {
        if mesh.is_none_or(|mesh| target_count(mesh) == 0) {
            check.report(
                target,
                "the weights of this node are animated, but it has no mesh with morph targets",
            );
        }
    } else if node.get("matrix").is_some() {
        check.report(target, format!("the {path} of this node is animated, but the node has a matrix"));
    } else if node.get("skin").is_some() && mesh.is_some_and(has_joints) {
        check.report(
            target,
            format!("the {path} of a node with a skinned mesh has no effect: its joints position it"),
        );
    }
}

fn input<'d>(check: &mut Check<'d, '_>, sampler: JsonNode<'d>) {
    let Some((index, accessor)) = check.named("accessors", sampler, "input") else { return };
    if text(accessor, "type") != Some("SCALAR") || whole(accessor, "componentType") != Some(5126) {
        let message =
            format!("the times of keyframes must be SCALAR of FLOAT, not {}", format_words(accessor));
        return check.report_key(sampler, "input", message);
    }
    check.assign_role(sampler, accessor, Role::Animation);
    if accessor.get("min").is_none() || accessor.get("max").is_none() {
        check.report(accessor, "the times of keyframes need min and max");
    }
    if text(sampler, "interpolation") == Some("CUBICSPLINE") && whole(accessor, "count") == Some(1) {
        check
            .report(sampler, "CUBICSPLINE interpolation needs at least two keyframes, but there is only one");
    }
    let Some(times) = check.numbers(index).filter(|_| accessor.get("bufferView").is_some()) else { return };
    if times.first().is_some_and(|time| *time < 0.0) {
        check.report_key(
            sampler,
            "input",
            format!("the first keyframe is at {} s, before the start", times[0]),
        );
    }
    if let Some(at) =
        times.windows(2).position(|pair| pair[0].partial_cmp(&pair[1]) != Some(std::cmp::Ordering::Less))
    {
        let (before, after) = (times[at], times[at + 1]);
        let message = format!(
            "keyframe {} is at {after} s, but the one before it at {before} s: times must increase",
            at + 1
        );
        check.report_key(sampler, "input", message);
    }
}

fn output<'d>(check: &mut Check<'d, '_>, channel: JsonNode<'d>, sampler: JsonNode<'d>, path: &str) {
    let Some((index, accessor)) = check.named("accessors", sampler, "output") else { return };
    check.assign_role(sampler, accessor, Role::Animation);
    let (kind, may_be_normalized) = match path {
        "translation" | "scale" => ("VEC3", false),
        "rotation" => ("VEC4", true),
        "weights" => ("SCALAR", true),
        _ => return,
    };
    let code = whole(accessor, "componentType").unwrap_or(0);
    let is_normalized = accessor.value().get("normalized").is_some_and(|x| x == true);
    let fits = code == 5126 || may_be_normalized && is_normalized && matches!(code, 5120..=5123);
    if text(accessor, "type") != Some(kind) || !fits {
        let numbers = if may_be_normalized { "FLOAT or of normalized integers" } else { "FLOAT" };
        let message =
            format!("keyframes of a {path} must be {kind} of {numbers}, not {}", format_words(accessor));
        return check.report_key(channel, "sampler", message);
    }
    let is_cubic = text(sampler, "interpolation") == Some("CUBICSPLINE");
    let keys = check.named("accessors", sampler, "input").and_then(|(_, input)| whole(input, "count"));
    let targets = channel.get("target").and_then(|target| check.named("nodes", target, "node"));
    let mesh = targets.and_then(|(_, node)| check.named("meshes", node, "mesh"));
    let each = if path == "weights" { mesh.map_or(0, |(_, mesh)| target_count(mesh)) } else { 1 };
    let wanted = keys.and_then(|keys| keys.checked_mul(if is_cubic { 3 } else { 1 })?.checked_mul(each));
    let have = whole(accessor, "count");
    if let (Some(have), Some(wanted), true) = (have, wanted, each > 0)
        && have != wanted
    {
        let message = format!(
            "{} for {}: there must be {wanted}",
            counted(have, "value"),
            counted(keys.unwrap_or(0), "keyframe")
        );
        check.report_key(channel, "sampler", message);
    }
    if path == "rotation" && accessor.get("bufferView").is_some() {
        quaternions(check, channel, index, is_cubic);
    }
}

/// Rotations have length one; the tangents of a cubic spline need not.
fn quaternions<'d>(check: &mut Check<'d, '_>, channel: JsonNode<'d>, index: usize, is_cubic: bool) {
    let Some(numbers) = check.numbers(index) else { return };
    let length = |q: &[f32]| q.iter().map(|x| x * x).sum::<f32>().sqrt();
    let counts = |i: usize| !is_cubic || i % 3 == 1;
    let bad = numbers.chunks_exact(4).enumerate().find(|(i, q)| counts(*i) && is_off(length(q) - 1.0, 0.01));
    if let Some((at, q)) = bad {
        let message =
            format!("the rotation of element {at} has length {:.3}, but must have length 1", length(q));
        check.report_key(channel, "sampler", message);
    }
}
