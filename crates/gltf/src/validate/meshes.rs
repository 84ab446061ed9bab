//! Mesh primitives: counts, indices and morph targets. [glTF 2.0, 3.7.2]

use super::materials::coordinates;
use super::{Check, Role, counted, text, whole};
use crate::document::json::JsonNode;

/// The attributes of a primitive, each with its accessor and the accessor's index.
pub(super) fn attributes<'d>(
    check: &Check<'d, '_>,
    holder: JsonNode<'d>,
) -> Vec<(&'d str, usize, JsonNode<'d>)> {
    let found = |(name, index): (&'d str, JsonNode<'d>)| {
        let index = usize::try_from(index.value().as_u64()?).ok()?;
        Some((name, index, check.root.item("accessors", index)?))
    };
    holder.entries().filter_map(found).collect()
}

/// The attributes under `attributes`.
pub(super) fn of_primitive<'d>(
    check: &Check<'d, '_>,
    node: JsonNode<'d>,
) -> Vec<(&'d str, usize, JsonNode<'d>)> {
    node.get("attributes").map(|holder| attributes(check, holder)).unwrap_or_default()
}

fn targets<'d>(node: JsonNode<'d>) -> Vec<JsonNode<'d>> {
    node.get("targets").map(|list| list.children().collect()).unwrap_or_default()
}

/// The number of morph targets of a mesh's first primitive.
pub(super) fn target_count(mesh: JsonNode) -> usize {
    let first = mesh.get("primitives").and_then(|list| list.children().next());
    first.map_or(0, |primitive| targets(primitive).len())
}

pub(super) fn weights<'d>(check: &mut Check<'d, '_>, mesh: JsonNode<'d>) {
    let Some(weights) = mesh.get("weights").filter(|list| list.value().is_array()) else { return };
    let (have, wanted) = (weights.children().count(), target_count(mesh));
    if have != wanted {
        let message = format!("{} for {}", counted(have, "weight"), counted(wanted, "morph target"));
        check.report(weights, message + ": the numbers must be equal");
    }
}

pub(super) fn same_targets<'d>(check: &mut Check<'d, '_>, mesh: JsonNode<'d>) {
    let wanted = target_count(mesh);
    for primitive in mesh.get("primitives").into_iter().flat_map(|list| list.children()) {
        let have = targets(primitive).len();
        if have != wanted {
            let (have, wanted) = (counted(have, "morph target"), counted(wanted, "morph target"));
            let message = format!("this primitive has {have}, but the first of the mesh has {wanted}");
            check.report_key(primitive, "targets", message);
        }
    }
}

pub(super) fn position_bounds<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let mut all = of_primitive(check, node);
    all.extend(targets(node).into_iter().flat_map(|target| attributes(check, target)));
    for (_, _, accessor) in all.into_iter().filter(|(name, ..)| *name == "POSITION") {
        if accessor.get("min").is_none() || accessor.get("max").is_none() {
            check.report(accessor, "positions need min and max, which programs use to frame the model");
        }
    }
}

pub(super) fn counts<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let all = of_primitive(check, node);
    let Some((first, _, accessor)) = all.first() else { return };
    let wanted = whole(*accessor, "count");
    for (name, _, accessor) in &all[1..] {
        let have = whole(*accessor, "count");
        if let (Some(have), Some(wanted)) = (have, wanted)
            && have != wanted
        {
            let message =
                format!("{name} has {have} elements but {first} has {wanted}: the numbers must be equal");
            check.report_key(node, "attributes", message);
        }
    }
}

pub(super) fn indices<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let vertices =
        of_primitive(check, node).iter().filter_map(|(_, _, accessor)| whole(*accessor, "count")).min();
    let mode = whole(node, "mode").unwrap_or(4);
    let mut corners = vertices;
    if let Some((index, accessor)) = check.named("accessors", node, "indices") {
        let code = whole(accessor, "componentType");
        if text(accessor, "type") != Some("SCALAR") || !matches!(code, Some(5121 | 5123 | 5125)) {
            let have = super::accessors::format_words(accessor);
            let message = format!(
                "indices must be SCALAR of UNSIGNED_BYTE, UNSIGNED_SHORT or UNSIGNED_INT, not {have}"
            );
            check.report_key(node, "indices", message);
            return;
        }
        check.assign_role(node, accessor, Role::Indices);
        corners = whole(accessor, "count");
        if let (Some(all), Some(vertices)) = (check.indices(index), vertices) {
            index_values(check, node, &all, vertices, code == Some(5121), code == Some(5123));
            if mode == 4 {
                degenerate(check, node, &all);
            }
        }
    }
    let Some(corners) = corners else { return };
    let fits = match mode {
        1 => corners >= 2 && corners % 2 == 0,
        2 | 3 => corners >= 2,
        4 => corners >= 3 && corners % 3 == 0,
        5 | 6 => corners >= 3,
        _ => true,
    };
    if !fits {
        let names = [
            "points",
            "lines",
            "a line loop",
            "a line strip",
            "triangles",
            "a triangle strip",
            "a triangle fan",
        ];
        let what = names.get(mode).copied().unwrap_or("this mode");
        check.report(node, format!("{} cannot make {what}", counted(corners, "corner")));
    }
}

fn index_values<'d>(
    check: &mut Check<'d, '_>,
    node: JsonNode<'d>,
    all: &[u32],
    vertices: usize,
    is_byte: bool,
    is_short: bool,
) {
    let restart = if is_byte {
        255
    } else if is_short {
        65535
    } else {
        u32::MAX
    };
    if let Some(at) = all.iter().position(|&index| index == restart) {
        let message = format!(
            "index {restart}, in element {at}, is reserved for primitive restart, which glTF does not have"
        );
        check.report_key(node, "indices", message);
    }
    let beyond = |index: &u32| *index as usize >= vertices && *index != restart;
    if let Some(at) = all.iter().position(beyond) {
        let message = format!(
            "element {at} refers to vertex {}, but there are only {vertices}, counted from 0",
            all[at]
        );
        check.report_key(node, "indices", message);
    }
}

fn degenerate<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>, all: &[u32]) {
    let is_flat = |t: &&[u32]| t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
    let count = all.chunks_exact(3).filter(is_flat).count();
    if count > 0 {
        let message = format!("{} no area, since two of the corners are the same", have(count, "triangle"));
        check.report_key(node, "indices", message);
    }
}

/// A count with its noun and verb: `1 triangle has`, `2 triangles have`.
pub(super) fn have(count: usize, noun: &str) -> String {
    format!("{} {}", counted(count, noun), if count == 1 { "has" } else { "have" })
}

pub(super) fn morph<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    if let Some(list) = node.get("targets") {
        check.items(list, |check, target| {
            if !target.is_object() || target.entries().next().is_none() {
                return check.report(
                    target,
                    "a morph target must name the attribute that it moves, such as POSITION",
                );
            }
            target.entries().for_each(|(_, index)| check.index(index, "accessors"));
        });
    }
    let base = of_primitive(check, node);
    for target in targets(node) {
        for (name, _, accessor) in attributes(check, target) {
            if name.starts_with('_') {
                continue;
            }
            match base.iter().find(|(other, ..)| *other == name) {
                None => {
                    check.report_key(
                        target,
                        name,
                        format!("a morph target moves {name}, which the primitive does not have"),
                    );
                }
                Some((_, _, moved)) if whole(*moved, "count") != whole(accessor, "count") => {
                    let message = format!(
                        "a morph target has another number of elements than the {name} that it moves"
                    );
                    check.report_key(target, name, message);
                }
                _ => check.assign_role(target, accessor, Role::Vertices),
            }
        }
    }
}

/// Every texture reference in a material, with its key.
fn texture_infos<'d>(node: JsonNode<'d>, found: &mut Vec<(&'d str, JsonNode<'d>)>) {
    for (key, value) in node.entries() {
        if key.ends_with("Texture") && value.get("index").is_some() {
            found.push((key, value));
        } else if value.is_object() && key != "extras" {
            texture_infos(value, found);
        }
    }
}

pub(super) fn material<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some((_, material)) = check.named("materials", node, "material") else { return };
    let Some(holder) = node.get("attributes") else { return };
    let has = |name: &str| holder.value().get(name).is_some();
    let mut infos = Vec::new();
    texture_infos(material, &mut infos);
    let missing = infos.iter().map(|(key, info)| (key, coordinates(*info)));
    let missing = missing.into_iter().find(|(_, set)| !has(&format!("TEXCOORD_{set}")));
    if let Some((key, set)) = missing {
        let message =
            format!("the {key} of this material needs TEXCOORD_{set}, which the primitive does not have");
        check.report_key(node, "material", message);
    }
    let directed = infos.iter().find(|(key, _)| matches!(*key, "normalTexture" | "clearcoatNormalTexture"));
    let is_brushed = material.extension("KHR_materials_anisotropy").is_some();
    if has("TANGENT") {
        if directed.is_none() && !is_brushed {
            check.remark(holder, "the tangents are not used, since the material has no normal texture");
        }
    } else if directed.is_some_and(|(key, _)| *key == "normalTexture") {
        let message = "the primitive has no TANGENT for its normal texture: tangents are computed, and programs differ in how";
        check.remark(node.get("material").unwrap_or(node), message);
    } else if directed.is_some() || is_brushed {
        let message = "the material needs tangent directions, but the primitive has no TANGENT and the material no normal texture";
        check.report_key(node, "material", message);
    }
}
