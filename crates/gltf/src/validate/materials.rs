//! Materials, and which of their extensions can be combined.

use super::{Check, floats, number, text, whole};
use crate::document::json::JsonNode;
use std::collections::HashSet;

pub(super) fn cutoff<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let mode = text(node, "alphaMode").unwrap_or("OPAQUE");
    if node.get("alphaCutoff").is_some() && matches!(mode, "OPAQUE" | "BLEND") {
        let message =
            format!("alphaCutoff has no effect where alphaMode is {mode}: set that to MASK, or remove it");
        check.report_key(node, "alphaCutoff", message);
    }
}

pub(super) fn go_together<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some(extensions) = node.get("extensions") else { return };
    let has = |name| extensions.get(name);
    for alone in ["KHR_materials_unlit", "KHR_materials_pbrSpecularGlossiness"] {
        let Some(extension) = has(alone) else { continue };
        let other =
            extensions.entries().find(|(name, _)| *name != alone && name.starts_with("KHR_materials_"));
        if let Some((other, _)) = other {
            check.report(
                extension,
                format!("{alone} and {other} cannot be combined: one of them has no effect"),
            );
        }
    }
    if let Some(volume) = has("KHR_materials_volume") {
        let transmits = has("KHR_materials_transmission").or(has("KHR_materials_diffuse_transmission"));
        if transmits.is_none() {
            let message = "a volume has no effect if no light enters it: add KHR_materials_transmission";
            check.report(volume, message);
        }
        let is_walled = number(volume, "thicknessFactor").is_some_and(|x| x > 0.0);
        if is_walled && node.value().get("doubleSided").is_some_and(|x| x == true) {
            let message = "a material with a volume should not be double-sided: its surfaces have an inside";
            check.report(volume, message);
        }
    }
    if let Some(dispersion) = has("KHR_materials_dispersion")
        && has("KHR_materials_volume").is_none()
    {
        check.report(dispersion, "dispersion has no effect without a volume: add KHR_materials_volume");
    }
    if let Some(strength) = has("KHR_materials_emissive_strength") {
        let colour = floats(node, "emissiveFactor").unwrap_or_default();
        if colour.iter().all(|x| *x == 0.0) {
            let message =
                "an emissive strength has no effect where emissiveFactor is black, as it is by default";
            check.report(strength, message);
        }
    }
}

/// The set of texture coordinates that a texture reference uses.
pub(super) fn coordinates(info: JsonNode) -> usize {
    let moved = info.extension("KHR_texture_transform").and_then(|moved| whole(moved, "texCoord"));
    moved.or_else(|| whole(info, "texCoord")).unwrap_or(0)
}

pub(super) fn same_coordinates<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some(normal) = node.get("normalTexture") else { return };
    let others = [
        ("KHR_materials_anisotropy", "anisotropyTexture", "anisotropy"),
        ("KHR_materials_clearcoat", "clearcoatNormalTexture", "clearcoat normal"),
    ];
    for (extension, key, what) in others {
        let Some(other) = node.extension(extension).and_then(|extension| extension.get(key)) else {
            continue;
        };
        if coordinates(other) != coordinates(normal) {
            let message =
                format!("the normal and the {what} texture should use the same set of texture coordinates");
            check.report(other, message);
        }
    }
}

pub(super) fn thickness<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some(film) = node.extension("KHR_materials_iridescence") else { return };
    let range = [("iridescenceThicknessMinimum", 100.0), ("iridescenceThicknessMaximum", 400.0)];
    let [least, greatest] = range.map(|(key, default)| number(film, key).unwrap_or(default));
    match film.get("iridescenceThicknessTexture") {
        None if film.get(range[0].0).is_some() => {
            let message = "the minimum thickness has no effect without iridescenceThicknessTexture";
            check.report_key(film, range[0].0, message);
        }
        Some(texture) if least == greatest => {
            check.report(
                texture,
                "this texture has no effect, since the minimum and maximum thickness are equal",
            );
        }
        _ => {}
    }
}

/// Checks `KHR_materials_variants` on a primitive.
pub(super) fn mappings<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let variants = check.root.extension("KHR_materials_variants").and_then(|e| e.get("variants"));
    let count = variants.map_or(0, |variants| variants.children().count());
    let mut seen = HashSet::new();
    for mapping in node.get("mappings").into_iter().flat_map(|list| list.children()) {
        let Some(list) = mapping.get("variants") else { continue };
        check.items(list, |check, item| {
            let index = item.value().as_u64();
            match index {
                Some(index) if index < count as u64 && !seen.insert(index) => {
                    check.report(item, format!("variant {index} is mapped twice in this primitive"));
                }
                Some(index) if index >= count as u64 => {
                    check.report(item, format!("there is no variant {index}: the file has {count}"));
                }
                index => check.expect(item, index.is_some(), "a whole number, 0 or more"),
            }
        });
    }
}
