//! A scene file under construction, and the words that it is made of.

use bilux_import::bytes::xml::escaped;
use bilux_import::output::writing::UnusedNames;
use bilux_math::{Mat4, Rgb, Vec3};
use bilux_scene::{Mesh, SceneBuilder};
use std::collections::HashMap;

/// The file so far.
pub(super) struct Document<'s> {
    pub(super) scene: &'s SceneBuilder,
    pub(super) out: String,
    depth: usize,
    ids: UnusedNames,
    /// For each material of the scene, what its surfaces have.
    pub(super) looks: HashMap<usize, Look>,
    /// The files of meshes.
    pub(super) meshes: HashMap<*const Mesh, String>,
    /// Groups of shapes with several instances, by mesh and material.
    pub(super) groups: HashMap<(*const Mesh, usize), String>,
}

/// Properties that a surface has from its material.
#[derive(Clone, Debug, Default)]
pub(super) struct Look {
    /// The identifier of its bsdf.
    pub(super) bsdf: String,
    /// The element of the medium inside, without its place in the world.
    pub(super) medium: Option<Inside>,
    pub(super) emission: Option<Emission>,
}

/// The medium inside of a shape.
#[derive(Clone, Debug)]
pub(super) struct Inside {
    pub(super) absorption: Rgb,
    pub(super) scattering: Rgb,
    pub(super) anisotropy: f32,
    /// Density of the medium, where it varies.
    pub(super) density: Option<std::sync::Arc<bilux_scene::media::Grid>>,
}

/// Emission of a surface.
#[derive(Clone, Debug)]
pub(super) enum Emission {
    Even(Rgb, bool),
    /// A texture.
    Picture(String, bool),
}

impl<'s> Document<'s> {
    pub(super) fn new(scene: &'s SceneBuilder) -> Document<'s> {
        let (looks, meshes, groups) = Default::default();
        let ids = UnusedNames::default();
        Document { scene, out: String::new(), depth: 0, ids, looks, meshes, groups }
    }

    pub(super) fn line(&mut self, line: &str) {
        self.out.extend(std::iter::repeat_n(' ', 4 * self.depth));
        self.out.push_str(line);
        self.out.push('\n');
    }

    /// Begins an element, without its angle brackets, up to [`Document::close`].
    pub(super) fn open(&mut self, element: &str) {
        self.line(&format!("<{element}>"));
        self.depth += 1;
    }

    pub(super) fn close(&mut self, name: &str) {
        self.depth -= 1;
        self.line(&format!("</{name}>"));
    }

    pub(super) fn number(&mut self, name: &str, number: f32) {
        self.line(&format!("<float name=\"{name}\" value=\"{number}\"/>"));
    }

    pub(super) fn integer(&mut self, name: &str, number: i64) {
        self.line(&format!("<integer name=\"{name}\" value=\"{number}\"/>"));
    }

    pub(super) fn flag(&mut self, name: &str, is_set: bool) {
        self.line(&format!("<boolean name=\"{name}\" value=\"{is_set}\"/>"));
    }

    pub(super) fn text(&mut self, name: &str, text: &str) {
        self.line(&format!("<string name=\"{name}\" value=\"{}\"/>", escaped(text)));
    }

    pub(super) fn rgb(&mut self, name: &str, colour: Rgb) {
        self.line(&format!("<rgb name=\"{name}\" value=\"{}\"/>", numbers(&colour.to_array())));
    }

    pub(super) fn point(&mut self, name: &str, at: Vec3) {
        let [x, y, z] = at.to_array();
        self.line(&format!("<point name=\"{name}\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>"));
    }

    /// A matrix as the transform of this name; nothing for the identity.
    pub(super) fn matrix(&mut self, name: &str, matrix: Mat4) {
        if matrix == Mat4::IDENTITY {
            return;
        }
        self.open(&format!("transform name=\"{name}\""));
        self.line(&format!("<matrix value=\"{}\"/>", numbers(&matrix.transpose().to_cols_array())));
        self.close("transform");
    }

    /// An identifier that no other element has.
    pub(super) fn id(&mut self, wanted: &str, otherwise: &str) -> String {
        let wanted = if wanted.is_empty() { otherwise } else { wanted };
        // Points would separate parts of names; such as begin with an underscore are Mitsuba's own.
        let plain = |c: char| if c.is_control() || c == '.' || c == '$' { '-' } else { c };
        let wanted: String = wanted.trim_start_matches('_').chars().map(plain).collect();
        escaped(&self.ids.unused(if wanted.is_empty() { otherwise } else { &wanted }))
    }

    /// Writes within elements of their own: returns what was written.
    pub(super) fn aside<T>(&mut self, depth: usize, write: impl FnOnce(&mut Self) -> T) -> (String, T) {
        let (out, before) = (std::mem::take(&mut self.out), std::mem::replace(&mut self.depth, depth));
        let value = write(self);
        self.depth = before;
        (std::mem::replace(&mut self.out, out), value)
    }
}

/// Numbers as text that parses back to the same values.
pub(super) fn numbers(list: &[f32]) -> String {
    list.iter().map(f32::to_string).collect::<Vec<_>>().join(" ")
}
