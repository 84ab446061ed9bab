//! A scene file under construction, and the words that it is made of.

use bilux_import::output::writing::UnusedNames;
use bilux_math::{Rgb, Vec3};
use bilux_scene::SceneBuilder;
use std::collections::HashMap;

/// The file so far.
pub(super) struct Document<'s> {
    pub(super) scene: &'s SceneBuilder,
    pub(super) out: String,
    /// The names of textures, materials and media.
    names: UnusedNames,
    /// Textures written so far, by content.
    pub(super) textures: HashMap<String, String>,
}

impl<'s> Document<'s> {
    /// An empty file.
    pub(super) fn new(scene: &'s SceneBuilder) -> Document<'s> {
        Document { scene, out: String::new(), names: UnusedNames::default(), textures: HashMap::new() }
    }

    pub(super) fn line(&mut self, line: &str) {
        self.out.push_str(line);
        self.out.push('\n');
    }

    /// A unique quoted name.
    pub(super) fn name(&mut self, wanted: &str, otherwise: &str) -> String {
        let wanted = if wanted.is_empty() { otherwise } else { wanted };
        let plain = |c: char| if c == '"' || c == '\\' || c.is_control() { '_' } else { c };
        self.names.unused(&wanted.chars().map(plain).collect::<String>())
    }
}

/// Numbers as text that parses back to the same values.
pub(super) fn numbers(list: &[f32]) -> String {
    list.iter().map(f32::to_string).collect::<Vec<_>>().join(" ")
}

pub(super) fn rgb(name: &str, colour: Rgb) -> String {
    format!(" \"rgb {name}\" [ {} ]", numbers(&colour.to_array()))
}

pub(super) fn point(name: &str, at: Vec3) -> String {
    format!(" \"point3 {name}\" [ {} ]", numbers(&at.to_array()))
}

pub(super) fn float(name: &str, number: f32) -> String {
    format!(" \"float {name}\" [ {number} ]")
}

/// The `from` and `to` parameters of a light.
pub(super) fn from_to(from: Vec3, to: Vec3) -> String {
    point("from", from) + &point("to", to)
}
