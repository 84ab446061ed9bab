//! Attributes of primitives: names, formats and layout. [glTF 2.0, 3.7.2.1]

use super::accessors::{component_size, format_words, width};
use super::meshes::{attributes, of_primitive};
use super::{Check, Role, text, whole};
use crate::document::json::JsonNode;

/// The formats that an attribute allows: types, then component type codes without and with normalisation.
struct Semantic {
    name: &'static str,
    is_numbered: bool,
    types: &'static [&'static str],
    plain: &'static [usize],
    normalized: &'static [usize],
}

const FLOAT: &[usize] = &[5126];

const SEMANTICS: &[Semantic] = &[
    Semantic { name: "POSITION", is_numbered: false, types: &["VEC3"], plain: FLOAT, normalized: &[] },
    Semantic { name: "NORMAL", is_numbered: false, types: &["VEC3"], plain: FLOAT, normalized: &[] },
    Semantic { name: "TANGENT", is_numbered: false, types: &["VEC4"], plain: FLOAT, normalized: &[] },
    Semantic {
        name: "TEXCOORD",
        is_numbered: true,
        types: &["VEC2"],
        plain: FLOAT,
        normalized: &[5121, 5123],
    },
    Semantic {
        name: "COLOR",
        is_numbered: true,
        types: &["VEC3", "VEC4"],
        plain: FLOAT,
        normalized: &[5121, 5123],
    },
    Semantic { name: "JOINTS", is_numbered: true, types: &["VEC4"], plain: &[5121, 5123], normalized: &[] },
    Semantic {
        name: "WEIGHTS",
        is_numbered: true,
        types: &["VEC4"],
        plain: FLOAT,
        normalized: &[5121, 5123],
    },
];

/// The semantic with this name; `None` for one that glTF does not define.
fn semantic(name: &str) -> Option<&'static Semantic> {
    let (stem, number) = match name.split_once('_') {
        Some((stem, number)) => (stem, Some(number)),
        None => (name, None),
    };
    let is_number = |text: &str| text.parse::<u16>().is_ok_and(|n| n.to_string() == text);
    let fits = |s: &&Semantic| s.name == stem && s.is_numbered == number.is_some();
    SEMANTICS.iter().find(fits).filter(|_| number.is_none_or(is_number))
}

pub(super) fn names<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some(holder) = node.get("attributes") else { return };
    let targets = node.get("targets").into_iter().flat_map(|list| list.children());
    for (name, at) in holder.entries().chain(targets.flat_map(|target| target.entries())) {
        if semantic(name).is_none() && !name.starts_with('_') {
            let known = "POSITION, NORMAL, TANGENT, TEXCOORD_0, COLOR_0, JOINTS_0 and WEIGHTS_0";
            let message = format!(
                "'{name}' is not an attribute of glTF, which are {known}; names of your own begin with '_'"
            );
            check.report(at, message);
        }
    }
    let has = |name: &str| holder.value().get(name).is_some();
    if !has("POSITION") {
        check.report(holder, "this primitive has no POSITION, so it is invisible");
    }
    if has("TANGENT") && !has("NORMAL") {
        check.report_key(holder, "TANGENT", "tangents need normals: add NORMAL, or remove TANGENT");
    }
    let count = |stem: &str| {
        let is_of = |name: &str| semantic(name).is_some_and(|s| s.name == stem);
        holder.entries().filter(|(name, _)| is_of(name)).count()
    };
    for stem in ["TEXCOORD", "COLOR", "JOINTS", "WEIGHTS"] {
        if let Some(gap) = (0..count(stem)).find(|i| !has(&format!("{stem}_{i}"))) {
            check.report(holder, format!("{stem}_{gap} is missing: the numbers must count up from 0"));
        }
    }
    let (joints, weights) = (count("JOINTS"), count("WEIGHTS"));
    if joints != weights {
        let message =
            format!("there must be as many sets of JOINTS as of WEIGHTS, not {joints} and {weights}");
        check.report(holder, message);
    }
}

pub(super) fn formats<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let required = check.root.get("extensionsRequired");
    let is_quantized = required.is_some_and(|list| {
        list.children().any(|name| name.value().as_str() == Some("KHR_mesh_quantization"))
    });
    for (name, index, accessor) in of_primitive(check, node) {
        let code = whole(accessor, "componentType").unwrap_or(0);
        if code == 5125 {
            check.report_key(
                node,
                "attributes",
                format!("{name} is UNSIGNED_INT, which only indices may be"),
            );
            continue;
        }
        let Some(semantic) = semantic(name) else { continue };
        let is_normalized = accessor.value().get("normalized").is_some_and(|x| x == true);
        let codes = if is_normalized { semantic.normalized } else { semantic.plain };
        let is_type = text(accessor, "type").is_some_and(|kind| semantic.types.contains(&kind));
        let is_direction = !matches!(semantic.name, "JOINTS" | "WEIGHTS" | "COLOR");
        let fits = codes.contains(&code) || is_quantized && is_direction && component_size(code) <= 2;
        if !is_type || !fits {
            let types = semantic.types.join(" or ");
            let numbers = match (semantic.plain == FLOAT, semantic.normalized.is_empty()) {
                (true, true) => "FLOAT",
                (true, false) => "FLOAT, or of normalized UNSIGNED_BYTE or UNSIGNED_SHORT",
                _ => "UNSIGNED_BYTE or UNSIGNED_SHORT",
            };
            let have = format_words(accessor);
            let message = format!("{name} must be {types} of {numbers}; accessor {index} is {have}");
            check.report_key(node, "attributes", message);
        }
    }
}

pub(super) fn layout<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let mut all = of_primitive(check, node);
    let targets = node.get("targets").into_iter().flat_map(|list| list.children());
    all.extend(targets.flat_map(|target| attributes(check, target)));
    for (name, index, accessor) in all {
        check.assign_role(node, accessor, Role::Vertices);
        let Some((number, view)) = check.named("bufferViews", accessor, "bufferView") else { continue };
        let size = whole(accessor, "componentType").map_or(0, component_size)
            * text(accessor, "type").map_or(0, width);
        let stride = whole(view, "byteStride").unwrap_or(size);
        let offset = whole(accessor, "byteOffset").unwrap_or(0);
        let start = offset.saturating_add(whole(view, "byteOffset").unwrap_or(0));
        if !offset.is_multiple_of(4) || !start.is_multiple_of(4) || !stride.is_multiple_of(4) {
            let message = format!("each element of {name} must begin at a multiple of 4 bytes");
            check.report(accessor, message);
        }
        let sharing = check.attributes_in.entry(number).or_default();
        sharing.insert(index);
        if sharing.len() == 2 && view.get("byteStride").is_none() {
            let message = "this buffer view holds several attributes, so it needs a byteStride";
            check.report(view, message);
        }
    }
}
