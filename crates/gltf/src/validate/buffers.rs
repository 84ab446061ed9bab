//! Buffers and their views. [glTF 2.0, 3.6.1]

use super::{Check, counted, text, whole};
use crate::document::json::JsonNode;
use crate::document::meshopt;
use crate::document::uri;

pub(super) fn has_bytes<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some(index) = node.number_in_list() else { return };
    let wanted = whole(node, "byteLength").unwrap_or(0);
    let have = check.document.buffer_length(index);
    let (is_first, has_binary) = (index == 0, check.document.has_binary());
    if node.get("uri").is_none() && node.extension(meshopt::NAME).is_none() && !(is_first && has_binary) {
        check.report(node, "this buffer has no uri, and there is no binary chunk with its bytes");
    } else if node.get("uri").is_none() && is_first && have > wanted.saturating_add(3) {
        let more = counted(have - wanted, "byte");
        check.report(node, format!("the binary chunk of the GLB file has {more} more than this buffer"));
    } else if node.get("uri").is_some_and(|uri| uri.value().is_string()) && have < wanted {
        let have = counted(have, "byte");
        check.report(node, format!("byteLength is {wanted}, but the buffer has only {have}: it was cut off"));
    }
}

pub(super) fn mime_type<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some((kind, _)) = text(node, "uri").and_then(uri::data) else {
        return;
    };
    let kind = kind.split(';').next().unwrap_or_default();
    if !matches!(kind, "application/octet-stream" | "application/gltf-buffer") {
        let message = format!(
            "the type of a buffer's data URI must be application/octet-stream or application/gltf-buffer, not '{kind}'"
        );
        check.report_key(node, "uri", message);
    }
}

pub(super) fn in_glb<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    if check.document.has_binary() && text(node, "uri").is_some_and(|uri| uri::data(uri).is_some()) {
        let message = "a GLB file should keep its data in its binary chunk, not in a data URI, which takes a third more";
        check.report_key(node, "uri", message);
    }
}

pub(super) fn view<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    if check.named("buffers", node, "buffer").is_none() || whole(node, "byteLength").is_none_or(|n| n == 0) {
        return;
    }
    let offset = whole(node, "byteOffset").unwrap_or(0);
    let declared = check.named("buffers", node, "buffer").and_then(|(_, buffer)| whole(buffer, "byteLength"));
    let end = offset.saturating_add(whole(node, "byteLength").unwrap_or(0));
    if let Some(declared) =
        declared.filter(|&declared| declared < end && node.extension(meshopt::NAME).is_none())
    {
        let declared = counted(declared, "byte");
        check.report(node, format!("this buffer view ends at byte {end}, but its buffer has {declared}"));
    } else if let Ok(Some(what)) = check.document.check_view(node) {
        check.report_key(node, "byteStride", what);
    }
}

pub(super) fn stride_target<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    if node.get("byteStride").is_some() && whole(node, "target") == Some(34963) {
        let message =
            "byteStride is for vertex attributes, but the target says that these are indices: remove it";
        check.report_key(node, "byteStride", message);
    }
}
