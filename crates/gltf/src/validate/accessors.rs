//! Accessors: the location of their elements, and their bounds. [glTF 2.0, 3.6.2]

use super::{Check, Role, counted, floats, text, whole};
use crate::document::accessor::Accessor;
use crate::document::json::JsonNode;
use bilux_import::FormatError;

/// Bytes of a component; 0 for an unknown type.
pub(super) fn component_size(code: usize) -> usize {
    match code {
        5120 | 5121 => 1,
        5122 | 5123 => 2,
        5125 | 5126 => 4,
        _ => 0,
    }
}

/// Components of an element; 0 for an unknown type.
pub(super) fn width(kind: &str) -> usize {
    match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" | "MAT2" => 4,
        "MAT3" => 9,
        "MAT4" => 16,
        _ => 0,
    }
}

/// The format in words, such as `VEC3 of FLOAT`.
pub(super) fn format_words(accessor: JsonNode) -> String {
    let component = match whole(accessor, "componentType") {
        Some(5120) => "BYTE",
        Some(5121) => "UNSIGNED_BYTE",
        Some(5122) => "SHORT",
        Some(5123) => "UNSIGNED_SHORT",
        Some(5125) => "UNSIGNED_INT",
        Some(5126) => "FLOAT",
        _ => "unknown numbers",
    };
    let normalized =
        if accessor.value().get("normalized").is_some_and(|x| x == true) { "normalized " } else { "" };
    format!("{} of {normalized}{component}", text(accessor, "type").unwrap_or("elements"))
}

pub(super) fn lies_within<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let is_sound = [("componentType", true), ("count", true), ("type", false)]
        .into_iter()
        .all(|(key, is_number)| node.value().get(key).is_some_and(|v| v.is_number() == is_number));
    let Some(number) = node.number_in_list().filter(|_| is_sound) else { return };
    let spent = check.budget.spent();
    let opened = Accessor::open(check.document, number, node, check.budget).map(|_| ());
    check.budget.release(check.budget.spent() - spent);
    if let Err(error @ FormatError::Malformed { .. }) = opened {
        // An invalid reference is reported at the reference itself.
        let names = |key| node.get(key).is_none_or(|_| check.named("bufferViews", node, key).is_some());
        if names("bufferView") {
            check.report(node, error.without_place());
        }
    }
}

pub(super) fn is_aligned<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let size = whole(node, "componentType").map_or(0, component_size);
    let Some((_, view)) = check.named("bufferViews", node, "bufferView").filter(|_| size > 0) else { return };
    let inside = whole(node, "byteOffset").unwrap_or(0);
    let start = inside.saturating_add(whole(view, "byteOffset").unwrap_or(0));
    let is_matrix = text(node, "type").is_some_and(|kind| kind.starts_with("MAT"));
    if is_matrix && !inside.is_multiple_of(4) {
        check.report_key(node, "byteOffset", "a matrix must begin at a multiple of 4 bytes");
    } else if !inside.is_multiple_of(size) {
        let message = format!("{inside} is not a multiple of the {size} bytes that its numbers take");
        check.report_key(node, "byteOffset", message);
    } else if !start.is_multiple_of(size) {
        let message = format!(
            "its elements begin at byte {start} of the buffer, which is not a multiple of the {size} bytes that its \
             numbers take"
        );
        check.report(node, message);
    }
}

pub(super) fn normalized<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let is_normalized = node.value().get("normalized").is_some_and(|x| x == true);
    if is_normalized && matches!(whole(node, "componentType"), Some(5125 | 5126)) {
        check.report_key(node, "normalized", "only integers of 8 or 16 bits can be normalized: remove it");
    }
}

pub(super) fn offset_alone<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    if node.get("byteOffset").is_some() && node.get("bufferView").is_none() {
        check.report_key(node, "byteOffset", "a byteOffset needs a bufferView: add one, or remove it");
    }
}

pub(super) fn sparse<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some(sparse) = node.get("sparse") else { return };
    let (count, all) = (whole(sparse, "count"), whole(node, "count"));
    if let (Some(count), Some(all)) = (count, all)
        && count > all
    {
        check.report_key(
            sparse,
            "count",
            format!("{} cannot replace {all}", counted(count, "sparse element")),
        );
    }
    for part in ["indices", "values"].into_iter().filter_map(|key| sparse.get(key)) {
        check.assign_role(part, part, Role::Sparse);
    }
}

pub(super) fn bounds<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let width = text(node, "type").map_or(0, width);
    let Some(index) = node.number_in_list().filter(|_| width > 0) else { return };
    for key in ["min", "max"] {
        if let Some(list) = floats(node, key)
            && list.len() != width
        {
            let message = format!("this has {}, but elements have {width}", counted(list.len(), "number"));
            return check.report_key(node, key, message);
        }
    }
    let has_data = node.get("bufferView").is_some() || node.get("sparse").is_some();
    let Some(all) = check.numbers(index).filter(|_| has_data) else { return };
    if let Some(at) = all.iter().position(|x| !x.is_finite()) {
        let bad = all.iter().filter(|x| !x.is_finite()).count();
        let what = if bad == 1 { "1 number is".to_owned() } else { format!("{bad} numbers are") };
        return check
            .report(node, format!("{what} not finite; the first is {} in element {}", all[at], at / width));
    }
    // Bounds apply to the stored numbers, before normalisation. [glTF 2.0, 3.6.2.5]
    let scale = stored_scale(node);
    for (key, sign) in [("min", 1.0f32), ("max", -1.0)] {
        let Some(declared) = floats(node, key) else { continue };
        for (component, &declared) in declared.iter().enumerate() {
            let column = all.iter().skip(component).step_by(width);
            let actual = column.fold(f32::INFINITY, |least, &x| least.min(sign * x)) * sign * scale;
            if !(actual - declared as f32).abs().le(&tolerance(scale, actual)) {
                let place = if width > 1 { format!(" in component {component}") } else { String::new() };
                let what = if key == "min" { "smallest" } else { "greatest" };
                let message = format!("{key} is {declared}{place}, but the {what} number there is {actual}");
                check.report_key(node, key, message);
                break;
            }
        }
    }
}

/// The factor from normalised numbers to the stored ones.
fn stored_scale(node: JsonNode) -> f32 {
    let is_normalized = node.value().get("normalized").is_some_and(|x| x == true);
    match (is_normalized, whole(node, "componentType")) {
        (true, Some(5120)) => 127.0,
        (true, Some(5121)) => 255.0,
        (true, Some(5122)) => 32767.0,
        (true, Some(5123)) => 65535.0,
        _ => 1.0,
    }
}

/// The bounds of floats are exact except for the digits that exporters write.
fn tolerance(scale: f32, actual: f32) -> f32 {
    if scale > 1.0 { 1.5 } else { 1e-6 * actual.abs() }
}
