//! Images: where they are stored, the format that they declare, and the format that they have. [glTF 2.0, 3.8.3]

use super::{Check, Role, text, whole};
use crate::document::json::JsonNode;
use crate::document::uri;
use bilux_import::input::diagnostics::Diagnostics;

pub(super) fn source<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    match (node.get("uri"), node.get("bufferView")) {
        (None, None) => check.report(node, "this image has neither a uri nor a bufferView: it needs one"),
        (Some(_), Some(_)) => {
            check.report(node, "this image has both a uri and a bufferView: it needs one of them");
        }
        (None, Some(_)) if node.get("mimeType").is_none() => {
            check.report(node, "'mimeType' is missing here; an image in a buffer view needs it");
        }
        _ => {}
    }
    check.assign_role(node, node, Role::Image);
    if check.document.has_binary() && text(node, "uri").is_some_and(|uri| uri::data(uri).is_some()) {
        let message = "a GLB file should keep its images in its binary chunk, not in a data URI, which takes a third more";
        check.report_key(node, "uri", message);
    }
    if let Some((kind, _)) = text(node, "uri").and_then(uri::data) {
        let kind = kind.split(';').next().unwrap_or_default();
        if !kind.starts_with("image/") {
            let message =
                format!("the type of an image's data URI must be an image, such as image/png, not '{kind}'");
            check.report_key(node, "uri", message);
        }
    }
}

/// The MIME type that the first bytes indicate.
fn recognised(bytes: &[u8]) -> Option<&'static str> {
    let kinds: [(&[u8], &str); 4] = [
        (b"\x89PNG\r\n\x1a\n", "image/png"),
        (b"\xff\xd8\xff", "image/jpeg"),
        (b"RIFF", "image/webp"),
        (b"\xabKTX 20\xbb", "image/ktx2"),
    ];
    kinds.into_iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, kind)| kind)
}

/// The extension that an image of this type requires.
fn extension_for(kind: &str) -> Option<&'static str> {
    match kind {
        "image/webp" => Some("EXT_texture_webp"),
        "image/ktx2" => Some("KHR_texture_basisu"),
        _ => None,
    }
}

/// Compares the bytes of an image, which is the one of this number, with the document's description of it.
pub(crate) fn compare(
    image: JsonNode,
    number: usize,
    bytes: &[u8],
    root: JsonNode,
    diagnostics: &mut Diagnostics,
) {
    let in_uri = || uri::data(text(image, "uri")?)?.0.split(';').next();
    let declared = text(image, "mimeType").or_else(in_uri).filter(|kind| kind.starts_with("image/"));
    let Some(found) = recognised(bytes) else {
        let what = "this image is neither PNG nor JPEG, the only two formats in glTF without extensions";
        return diagnostics.note(what, || image.at());
    };
    if let Some(declared) = declared.filter(|declared| *declared != found) {
        let what = format!("this image is declared as {declared}, but is {found}");
        diagnostics.note(&what, || image.at());
    }
    let Some(extension) = extension_for(found) else { return };
    let declares = root
        .get("extensionsUsed")
        .is_some_and(|list| list.children().any(|name| name.value().as_str() == Some(extension)));
    if !declares {
        let what = format!("an image of type {found} needs the extension {extension}");
        diagnostics.note(&what, || image.at());
    }
    for texture in root.get("textures").into_iter().flat_map(|list| list.children()) {
        if whole(texture, "source") == Some(number) {
            let what =
                format!("the source of a texture must be PNG or JPEG, not {found}: name it in {extension}");
            diagnostics.note(&what, || texture.at());
        }
    }
}
