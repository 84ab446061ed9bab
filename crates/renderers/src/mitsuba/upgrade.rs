//! The names of older versions, as Mitsuba 3 upgrades them.

use super::plugin::{Plugin, Property, Value};
use bilux_scene::Span;
use roxmltree::Node;
use std::cell::Cell;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

/// The version of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Version(u32);

impl Version {
    /// The version that the outermost element states; the newest if it states none.
    pub(super) fn of(root: &Node) -> Version {
        let text = root.attribute("version").unwrap_or("3");
        Version(text.split('.').next().and_then(|major| major.trim().parse().ok()).unwrap_or(3))
    }

    /// True if names are in camel case: before version 2.
    pub(super) fn is_old(self) -> bool {
        self.0 < 2
    }
}

/// The name in version 3 of a property: `toWorld` is `to_world`, `specularTransmission` is `spec_trans`.
pub(super) fn name_of_version_3(name: &str) -> String {
    let snake = snake_case(name);
    let known = NAMES.iter().find(|(old, _)| *old == snake);
    known.map_or(snake, |(_, new)| (*new).to_owned())
}

/// Names that became others, in snake case.
const NAMES: [(&str, &str); 3] =
    [("specular_transmission", "spec_trans"), ("specular_tint", "spec_tint"), ("subsurface", "flatness")];

/// Renderers for teaching have the lobes of [Burley 2012] as types of their own: each is `principled` with this number.
const LOBES: [(&str, &str, f64); 3] = [
    ("disneydiffuse", "specular", 0.0),
    ("disneymetal", "metallic", 1.0),
    ("disneyglass", "spec_trans", 1.0),
];

/// Adds what a plugin of before version 2 has unsaid.
///
/// A shape with a medium and no material is an invisible boundary there. [Mitsuba 0.6, 8.1]
pub(super) fn complete(
    tag: &str,
    kind: &str,
    properties: &mut Vec<Property>,
    ids: &HashMap<Arc<str>, Rc<Plugin>>,
    at: &Span,
) {
    let added = |name: &str, value: Value| Property {
        name: name.to_owned(),
        value,
        at: at.clone(),
        used: Cell::new(false),
    };
    if let Some((_, name, number)) = LOBES.iter().find(|(lobe, ..)| *lobe == kind) {
        properties.push(added(name, Value::Number(*number)));
    }
    let tag_of = |property: &Property| match &property.value {
        Value::Object(object) => Some(object.tag),
        Value::Reference(id) => ids.get(id).map(|object| object.tag),
        _ => None,
    };
    let has = |wanted: &str| properties.iter().any(|property| tag_of(property) == Some(wanted));
    if tag == "shape" && has("medium") && !has("bsdf") {
        let boundary = Plugin::new("bsdf", "null".to_owned(), String::new(), Vec::new(), at.clone());
        properties.push(added("", Value::Object(Rc::new(boundary))));
    }
}

/// A name in camel case in snake case: `intIOR` is `int_ior`.
fn snake_case(name: &str) -> String {
    let mut snake = String::with_capacity(name.len() + 4);
    let mut was_lower = false;
    for letter in name.chars() {
        if letter.is_ascii_uppercase() && was_lower {
            snake.push('_');
        }
        was_lower = letter.is_ascii_lowercase();
        snake.push(letter.to_ascii_lowercase());
    }
    snake
}

/// The type of plugin that older ones are read as.
pub(super) fn kind_of_version_3(kind: &str) -> &str {
    match kind {
        "roughcoating" => "coating",
        "bump" => "bumpmap",
        "difftrans" => "difftrans",
        "gridtexture" => "checkerboard",
        "ldrtexture" | "exrtexture" => "bitmap",
        "ldrfilm" | "tonemapfilm" | "mfilm" => "hdrfilm",
        "microfacet" | "lambertian" => {
            if kind == "lambertian" {
                "diffuse"
            } else {
                "roughplastic"
            }
        }
        "vertexcolors" => "mesh_attribute",
        "disneybsdf" | "disneydiffuse" | "disneymetal" | "disneyglass" => "principled",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_older_versions_become_those_of_version_3() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("fovAxis", "fov_axis"),
            ("specularReflectance", "specular_reflectance"),
            ("sigmaT", "sigma_t"),
            ("alphaU", "alpha_u"),
            ("sampleCount", "sample_count"),
            ("radiance", "radiance"),
            ("specularTransmission", "spec_trans"),
            ("specularTint", "spec_tint"),
        ] {
            assert_eq!(name_of_version_3(old), new);
        }
    }
}
