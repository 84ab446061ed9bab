//! Reads MTL: maps its materials, which date from the 1990s, to Bilux's as `docs/formats/obj.md` describes. A line that
//! cannot be read costs only itself.

use super::draft::Draft;
use super::habits::habit_of;
use super::library::Library;
use super::surface::material;
use bilux_import::FormatError;
use bilux_import::bytes::float::parse_f32;
use bilux_import::bytes::text::{Cursor, Places, name_of, quoted, unquoted};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_math::Rgb;
use bilux_scene::SceneBuilder;
use std::collections::HashMap;

/// Adds every material of a library to the scene and its index to `by_name`; the first material of a name wins.
pub(super) fn read_library(
    reading: &mut Reading,
    source: &Source,
    scene: &mut SceneBuilder,
    by_name: &mut HashMap<String, usize>,
) -> Result<(), FormatError> {
    let mut library = Library {
        reading,
        source,
        cursor: Cursor::joining_lines(source.bytes),
        places: Places::new(source.name, source.bytes),
        diagnostics: Diagnostics::default(),
        habit: habit_of(source.bytes),
    };
    let mut drafts: Vec<Draft> = Vec::new();
    while !library.cursor.is_done() {
        library.cursor.skip_blanks();
        let start = library.cursor.offset();
        let key = library.cursor.word();
        match (key, drafts.last_mut()) {
            (b"newmtl", _) => {
                let name = name_of(unquoted(library.cursor.rest_of_line()));
                library.reading.budget.take::<(Draft, [u8; 1024])>(1, source.name)?;
                drafts.push(Draft::new(name, library.places.at(start), start));
            }
            (b"", _) => {}
            (key, _) if key.starts_with(b"#") => {
                library.cursor.rest_of_line();
            }
            (key, Some(draft)) => library.statement(key, start, draft)?,
            (key, None) => {
                let places = &library.places;
                let what = " comes before the first 'newmtl', which begins a material: this line is left out";
                library.diagnostics.note_first(what, || quoted(key), || places.at(start));
            }
        }
        library.cursor.end_line();
    }
    library.decide_transparency(&mut drafts);
    for draft in drafts {
        let mut spec = material(&draft, library.habit);
        library.remark_highlight(&draft);
        library.put_maps(&draft, &mut spec, scene)?;
        let index = scene.add_material(spec);
        library.displace(&draft, index, scene)?;
        by_name.entry(draft.name).or_insert(index);
    }
    library.diagnostics.into_warnings(scene);
    Ok(())
}

/// The supported keywords, by the type of their values.
const COLOURS: [&str; 6] = ["Kd", "Ks", "Ke", "Tf", "Kt", "Kr"];
const NUMBERS: [&str; 12] =
    ["Ns", "Ni", "d", "Tr", "illum", "Pr", "Pm", "Ps", "Pc", "Pcr", "aniso", "anisor"];
const MAPS: [&str; 12] = [
    "map_Kd", "map_Ks", "map_Ke", "map_d", "map_Pr", "map_Pm", "map_Ps", "map_Pc", "map_Pcr", "norm",
    "map_bump", "disp",
];
/// Other spellings of keywords.
const ALIASES: [(&str, &str); 5] = [
    ("bump", "map_bump"),
    ("map_opacity", "map_d"),
    ("map_Kn", "norm"),
    ("map_norm", "norm"),
    ("map_disp", "disp"),
];
/// Ambient light follows kd in Bilux, and sharpness applies to reflection maps.
const WITHOUT_USE: [&str; 3] = ["Ka", "map_Ka", "sharpness"];
/// Keywords that would show if Bilux had them.
const NOT_SHOWN: [&str; 5] = ["refl", "map_refl", "decal", "map_Ns", "map_Tr"];

impl Library<'_, '_, '_> {
    fn statement(&mut self, key: &[u8], start: usize, draft: &mut Draft) -> Result<(), FormatError> {
        let is = |name: &str| name.as_bytes().eq_ignore_ascii_case(key);
        let alias = ALIASES.iter().find(|(other, _)| is(other)).map(|(_, name)| name.as_bytes());
        let key = alias.unwrap_or(key);
        let known = |names: &[&'static str]| {
            names.iter().copied().find(|name| name.as_bytes().eq_ignore_ascii_case(key))
        };
        // Blender keeps there how metallic a surface is.
        let ambient = self.habit.and_then(|_| known(&["Ka"]));
        if let Some(name) = known(&COLOURS).or(ambient) {
            if let Some(colour) = self.colour() {
                draft.colours.insert(name, (colour, start));
            }
        } else if let Some(name) = known(&NUMBERS) {
            if self.cursor.peek_word() == b"-halo" {
                self.cursor.word();
            }
            if let Some(number) = self.number() {
                draft.numbers.insert(name, (number, start));
            }
        } else if let Some(name) = known(&MAPS) {
            let map = self.map(start);
            if map.file.is_empty() {
                let (places, what) = (&self.places, " has no file name, and is left out");
                self.diagnostics.note_first(what, || quoted(name.as_bytes()), || places.at(start));
                return Ok(());
            }
            if name != "disp" && map.range != [0.0, 1.0] {
                let places = &self.places;
                self.diagnostics.not_shown("'-mm' of textures", || places.at(start));
            }
            self.reading.budget.take::<u8>(2 * map.file.len(), self.source.name)?;
            draft.maps.insert(name, map);
        } else {
            let places = &self.places;
            if let Some(name) = known(&NOT_SHOWN) {
                self.diagnostics.not_shown(&format!("'{name}' of materials"), || places.at(start));
            } else if known(&WITHOUT_USE).is_none() {
                let what = format!("{} of a material is ignored", quoted(key));
                self.diagnostics.note(&what, || places.at(start));
            }
            self.cursor.rest_of_line();
        }
        Ok(())
    }

    fn remark_highlight(&mut self, draft: &Draft) {
        let is_stated =
            self.habit.is_none() && draft.illum() >= 2 && draft.colour("Ks").is_some_and(|ks| !ks.is_black());
        if is_stated && draft.has_exponent_of_zero() && draft.lacks_highlight() {
            let what = "'Ns 0' is read as no highlight, as MeshLab, Asset Forge and others mean it";
            let (places, offset) = (&self.places, draft.offset("Ns"));
            self.diagnostics.remark(what, || places.at(offset));
        }
    }

    /// Three numbers, or one for all channels; `None`, with a warning, for anything else.
    fn colour(&mut self) -> Option<Rgb> {
        if [&b"spectral"[..], b"xyz"].contains(&self.cursor.peek_word()) {
            let (places, at) = (&self.places, self.cursor.offset());
            self.diagnostics.not_shown("spectral and xyz colours of materials", || places.at(at));
            self.cursor.rest_of_line();
            return None;
        }
        let r = self.number()?;
        let g = if self.has_more() { Some(self.number()?) } else { None };
        let b = if self.has_more() { Some(self.number()?) } else { None };
        Some(Rgb::new(r, g.unwrap_or(r), b.or(g).unwrap_or(r)))
    }

    /// True if something other than a comment follows on the line.
    fn has_more(&self) -> bool {
        let word = self.cursor.peek_word();
        !word.is_empty() && !word.starts_with(b"#")
    }

    /// A number; `None`, with a warning, if it is missing, infinite or NaN, or if it is none.
    fn number(&mut self) -> Option<f32> {
        let word = self.cursor.word();
        let offset = self.cursor.offset() - word.len();
        let what = match parse_f32(word) {
            Some(value) if value.is_finite() => return Some(value),
            Some(_) => "a value of a material is infinite or not a number (NaN), and is ignored",
            None if word.is_empty() => "a number is missing here: this line is left out",
            None => " is not a number: write one, such as 0.5; this line is left out",
        };
        let places = &self.places;
        let first = || if what.starts_with(' ') { quoted(word) } else { String::new() };
        self.diagnostics.note_first(what, first, || places.at(offset));
        None
    }
}
