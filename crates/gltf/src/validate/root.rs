//! Rules for the document as a whole, cameras and lights.

use super::extension_kinds::{ANYWHERE, EXTENSIONS, WITHOUT_OBJECT};
use super::schema::singular;
use super::{Check, number, text};
use crate::document::json::JsonNode;
use std::collections::HashSet;
use std::f64::consts::PI;

pub(super) fn version<'d>(check: &mut Check<'d, '_>, root: JsonNode<'d>) {
    let Some(asset) = root.get("asset") else { return };
    let pair = |key| {
        let (major, minor) = text(asset, key)?.split_once('.')?;
        Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
    };
    if let Some((2, minor @ 1..)) = pair("version") {
        let message = format!("glTF 2.{minor} is newer than 2.0, which is what this program reads");
        check.report_key(asset, "version", message);
    }
    if let (Some(version), Some(least)) = (pair("version"), pair("minVersion"))
        && least > version
    {
        let message = "minVersion is greater than the version of the file";
        check.report_key(asset, "minVersion", message);
    }
}

pub(super) fn extensions<'d>(check: &mut Check<'d, '_>, root: JsonNode<'d>) {
    let names =
        |key| -> Vec<JsonNode<'d>> { root.get(key).map(|l| l.children().collect()).unwrap_or_default() };
    let (used, required) = (names("extensionsUsed"), names("extensionsRequired"));
    let contains =
        |list: &[JsonNode<'d>], name: &str| list.iter().any(|item| item.value().as_str() == Some(name));
    for &item in &used {
        let Some(name) = item.value().as_str() else { continue };
        let is_word =
            |part: &str, is_letter: fn(char) -> bool| !part.is_empty() && part.chars().all(is_letter);
        let fits = name.split_once('_').is_some_and(|(vendor, rest)| {
            is_word(vendor, |c| c.is_ascii_uppercase() || c.is_ascii_digit())
                && is_word(rest, |c| c.is_ascii_alphanumeric() || c == '_')
        });
        if !fits {
            let message = format!("'{name}' is not the name of an extension, such as KHR_materials_unlit");
            check.report(item, message);
        }
        let is_known = EXTENSIONS.iter().any(|row| row.name == name);
        if is_known && !check.extensions.contains(name) {
            check.report(item, format!("{name} is declared here, but nothing in the file uses it"));
        }
        if name == "KHR_mesh_quantization" && !contains(&required, name) {
            check.report(item, "KHR_mesh_quantization must be in extensionsRequired too");
        }
    }
    for &item in &required {
        let Some(name) = item.value().as_str() else { continue };
        if !contains(&used, name) {
            check.report(item, format!("{name} is required, so it must also be in extensionsUsed"));
        }
    }
    let mut undeclared: Vec<_> =
        check.extensions.iter().copied().filter(|name| !contains(&used, name)).collect();
    undeclared.sort_unstable();
    for name in undeclared {
        check.report_key(root, "extensionsUsed", format!("{name} is in the file, but not in extensionsUsed"));
    }
}

/// Reports objects that nothing references, unless unknown extensions may reference them.
pub(super) fn unused<'d>(check: &mut Check<'d, '_>, root: JsonNode<'d>) {
    let is_known = |name: &&str| {
        EXTENSIONS.iter().any(|row| row.name == *name && !row.kind.is_open)
            || WITHOUT_OBJECT.contains(name)
            || ANYWHERE.contains(name)
    };
    if !check.extensions.iter().all(is_known) {
        return;
    }
    let nodes_of_scenes = check.list("scenes").into_iter().any(|scene| scene.get("nodes").is_some());
    let lists = ["accessors", "bufferViews", "buffers", "cameras", "images", "materials", "meshes"];
    for list in lists.into_iter().chain(["samplers", "skins", "textures"]) {
        for (index, item) in check.list(list).into_iter().enumerate() {
            if !check.used.contains(&(list, index)) {
                check.report(item, format!("nothing in the file uses this {}", singular(list)));
            }
        }
    }
    for (index, item) in check.list("nodes").into_iter().enumerate().filter(|_| nodes_of_scenes) {
        if !check.used.contains(&("nodes", index)) {
            check.report(item, "this node is in no scene");
        }
    }
    let names: HashSet<_> = root.entries().map(|(key, _)| key).collect();
    if names.contains("scenes") && !names.contains("nodes") && !nodes_of_scenes {
        check.report_key(root, "scenes", "no scene in this file has a node");
    }
}

pub(super) fn camera<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some(kind) = text(node, "type") else { return };
    for lens in ["perspective", "orthographic"] {
        match node.get(lens) {
            None if lens == kind => {
                check.report(node, format!("'{lens}' is missing here; the camera's type requires it"))
            }
            Some(found) if lens != kind => {
                check.report(found, format!("the type of this camera is {kind}: remove '{lens}'"));
            }
            _ => {}
        }
    }
}

fn near_and_far<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    if let (Some(near), Some(far)) = (number(node, "znear"), number(node, "zfar"))
        && far <= near
    {
        check.report_key(
            node,
            "zfar",
            format!("zfar is {far}, but must be greater than znear, which is {near}"),
        );
    }
}

pub(super) fn orthographic<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    near_and_far(check, node);
    for key in ["xmag", "ymag"] {
        if let Some(size) = number(node, key).filter(|size| *size <= 0.0) {
            check.report_key(node, key, format!("{key} is {size}, but must be greater than 0"));
        }
    }
}

pub(super) fn perspective<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    near_and_far(check, node);
    if let Some(angle) = number(node, "yfov").filter(|angle| *angle >= PI) {
        let message =
            format!("yfov is {angle} radians, but must be less than π: angles are not in degrees here");
        check.report_key(node, "yfov", message);
    }
}

pub(super) fn spot<'d>(check: &mut Check<'d, '_>, node: JsonNode<'d>) {
    let Some(kind) = text(node, "type") else { return };
    if kind == "directional" && node.get("range").is_some() {
        check.report_key(node, "range", "a directional light has no range: remove it");
    }
    let Some(cone) = node.get("spot") else {
        if kind == "spot" {
            check.report(node, "'spot' is missing here; a light of type spot needs it");
        }
        return;
    };
    if kind != "spot" {
        check.report(cone, format!("the type of this light is {kind}: remove 'spot'"));
    }
    let inner = number(cone, "innerConeAngle").unwrap_or(0.0);
    let outer = number(cone, "outerConeAngle").unwrap_or(PI / 4.0);
    if inner >= outer {
        let message =
            format!("the outer cone angle is {outer}, but must be greater than the inner one, {inner}");
        check.report(cone, message);
    }
}
