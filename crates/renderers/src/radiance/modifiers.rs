//! Modifiers of surfaces: materials, and what modifies those.

use super::kinds::Kind;
use super::place::Place;
use super::statement::Primitive;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_math::DMat4;
use bilux_scene::error::nearest_name;
use std::collections::HashMap;
use std::rc::Rc;

/// Meaning of a name where it is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Reference {
    /// Nothing.
    Void,
    /// A modifier, by its index.
    To(usize),
    /// There is none of this name.
    Unknown,
}

/// A modifier as it is defined in one place.
pub(super) struct Modifier {
    pub(super) primitive: Rc<Primitive>,
    /// Modifier that modifies this one in turn.
    pub(super) under: Reference,
    /// The parts of a mixture, and the materials that an illum or a mirror has for eyes.
    pub(super) parts: Vec<Reference>,
    /// Matrix of the place where it is defined, if that changes what it means.
    pub(super) matrix: DMat4,
    /// The factor on its lengths there.
    pub(super) scale: f64,
}

/// All modifiers, each once, and the latest of each name.
#[derive(Default)]
pub(super) struct Modifiers {
    pub(super) list: Vec<Modifier>,
    names: HashMap<Rc<str>, usize>,
    known: HashMap<Key, usize>,
    /// Messages about names that nothing defines.
    unknown: HashMap<Rc<str>, String>,
}

/// Key by which a modifier is the same again.
#[derive(PartialEq, Eq, Hash)]
struct Key {
    primitive: *const Primitive,
    under: Reference,
    parts: Vec<Reference>,
    matrix: [u64; 16],
}

/// Names that are compared for the nearest one, and names that nothing defines of which that is said.
const COMPARED: usize = 100;
const LISTED: usize = 20;

impl Modifiers {
    /// Meaning of a name now. Says once where there is nothing of this name.
    pub(super) fn named(&mut self, name: &str, of: &Primitive, diagnostics: &mut Diagnostics) -> Reference {
        if name == "void" {
            return Reference::Void;
        }
        if let Some(index) = self.names.get(name) {
            return Reference::To(*index);
        }
        if !self.unknown.contains_key(name) && self.unknown.len() >= LISTED {
            diagnostics
                .note("nothing defines the modifiers of more surfaces: these are grey", || of.at.clone());
            return Reference::Unknown;
        }
        let what = self.unknown.entry(name.into()).or_insert_with(|| {
            let shown: String = name.chars().take(60).collect();
            let what = format!(
                "nothing defines the modifier '{shown}' before it is used: surfaces with it are grey"
            );
            // Sorted, so that the order in the table, which is another in each run, does not matter.
            let mut known: Vec<String> = self.names.keys().map(|known| known.to_string()).collect();
            known.sort_unstable();
            known.truncate(COMPARED);
            match nearest_name(name, &known) {
                Some(nearest) => format!("{what} (did you mean '{nearest}'?)"),
                None => format!(
                    "{what}; name the file that does with '!xform FILE', or render the .rif of the scene"
                ),
            }
        });
        diagnostics.note(what, || of.at.clone());
        Reference::Unknown
    }

    /// Defines a name from here on.
    pub(super) fn define(
        &mut self,
        primitive: &Rc<Primitive>,
        place: &Place,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<(), FormatError> {
        let index = match primitive.kind {
            Kind::Alias => self.alias(primitive, budget, diagnostics)?,
            _ => {
                let under = self.named(&primitive.modifier, primitive, diagnostics);
                let parts = self.parts(primitive, diagnostics);
                let is_placed = primitive.kind.depends_on_place() || primitive.sky.is_some();
                let matrix = if is_placed { place.matrix } else { DMat4::IDENTITY };
                Some(self.interned(primitive, under, parts, matrix, budget)?)
            }
        };
        if let Some(index) = index {
            self.names.insert(primitive.name.clone(), index);
        }
        Ok(())
    }

    /// Index of an alias: the same modifier under another name, and perhaps with another modifier of its own.
    fn alias(
        &mut self,
        alias: &Rc<Primitive>,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Option<usize>, FormatError> {
        let of = alias.strings.first().map_or("void", |name| name);
        let Reference::To(old) = self.named(of, alias, diagnostics) else { return Ok(None) };
        // This word keeps the modifier that there is.
        if &*alias.modifier == "inherit" {
            return Ok(Some(old));
        }
        let under = self.named(&alias.modifier, alias, diagnostics);
        let Modifier { primitive, parts, matrix, .. } = &self.list[old];
        let (primitive, parts, matrix) = (primitive.clone(), parts.clone(), *matrix);
        self.interned(&primitive, under, parts, matrix, budget).map(Some)
    }

    /// References that the words of a mixture, an illum or a mirror name.
    fn parts(&mut self, primitive: &Primitive, diagnostics: &mut Diagnostics) -> Vec<Reference> {
        use super::kinds::Finish::{Illum, Mirror};
        let count = match primitive.kind {
            Kind::Mixture => 2,
            Kind::Material(Illum | Mirror) => 1,
            _ => 0,
        };
        primitive.strings.iter().take(count).map(|name| self.named(name, primitive, diagnostics)).collect()
    }

    fn interned(
        &mut self,
        primitive: &Rc<Primitive>,
        under: Reference,
        parts: Vec<Reference>,
        matrix: DMat4,
        budget: &mut Budget,
    ) -> Result<usize, FormatError> {
        let bits = matrix.to_cols_array().map(f64::to_bits);
        let key = Key { primitive: Rc::as_ptr(primitive), under, parts: parts.clone(), matrix: bits };
        if let Some(index) = self.known.get(&key) {
            return Ok(*index);
        }
        budget.take_bytes((4 * size_of::<Modifier>() + 2 * size_of::<Key>()) as u64, &primitive.at.file)?;
        let scale = matrix.x_axis.truncate().length();
        self.list.push(Modifier { primitive: primitive.clone(), under, parts, matrix, scale });
        self.known.insert(key, self.list.len() - 1);
        Ok(self.list.len() - 1)
    }
}
