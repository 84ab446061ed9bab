//! Reads MTL: maps its materials, which date from the 1990s, to Bilux's as `docs/formats/obj.md` describes.

use super::maps::Map;
use super::surface::{material, unit};
use crate::FormatError;
use crate::float::parse_f32;
use crate::oddities::Oddities;
use crate::reading::{Reading, Source};
use crate::text::{Cursor, Places, name_of, quoted};
use bilux_math::Rgb;
use bilux_scene::{SceneBuilder, Span};
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
        oddities: Oddities::default(),
    };
    let mut current: Option<Draft> = None;
    while !library.cursor.is_done() {
        library.cursor.skip_blanks();
        let start = library.cursor.offset();
        let key = library.cursor.word();
        match (key, &mut current) {
            (b"newmtl", _) => {
                library.finish(current.take(), scene, by_name)?;
                let name = name_of(library.cursor.rest_of_line());
                library.reading.budget.take::<(Draft, [u8; 1024])>(1, source.name)?;
                current = Some(Draft::new(name, library.places.at(start)));
            }
            (b"", _) => {}
            (key, _) if key.starts_with(b"#") => {
                library.cursor.rest_of_line();
            }
            (key, Some(draft)) => library.statement(key, start, draft)?,
            (_, None) => {
                let message =
                    format!("{} comes before the first 'newmtl', which begins a material", quoted(key));
                return Err(FormatError::malformed(message, library.places.at(start)));
            }
        }
        library.cursor.end_line();
    }
    library.finish(current, scene, by_name)?;
    library.oddities.into_warnings(scene);
    Ok(())
}

/// A material while its lines are read; `None` stands for what no line states.
#[derive(Default)]
pub(super) struct Draft {
    pub(super) name: String,
    pub(super) span: Span,
    colours: HashMap<&'static str, Rgb>,
    numbers: HashMap<&'static str, f32>,
    pub(super) maps: HashMap<&'static str, Map>,
}

impl Draft {
    fn new(name: String, span: Span) -> Draft {
        Draft { name, span, ..Draft::default() }
    }

    pub(super) fn colour(&self, key: &str) -> Option<Rgb> {
        self.colours.get(key).copied()
    }

    pub(super) fn number(&self, key: &str) -> Option<f32> {
        self.numbers.get(key).copied()
    }

    pub(super) fn illum(&self) -> i32 {
        self.number("illum").map_or(2, |n| n as i32)
    }

    /// The opacity, from 0 to 1.
    pub(super) fn opacity(&self) -> f32 {
        self.number("d").or(self.number("Tr").map(|t| 1.0 - t)).unwrap_or(1.0).clamp(0.0, 1.0)
    }

    /// The index of refraction, if a valid one is given.
    pub(super) fn eta(&self) -> Option<f32> {
        self.number("Ni").filter(|&n| n > 0.0).map(|n| n.clamp(0.1, 10.0))
    }

    /// The diffuse colour; white if there is only a texture.
    pub(super) fn diffuse(&self) -> Option<Rgb> {
        self.colour("Kd").map(unit).or(self.maps.contains_key("map_Kd").then_some(Rgb::WHITE))
    }
}

/// The supported keywords, by the type of their values.
const COLOURS: [&str; 6] = ["Kd", "Ks", "Ke", "Tf", "Kt", "Kr"];
const NUMBERS: [&str; 12] =
    ["Ns", "Ni", "d", "Tr", "illum", "Pr", "Pm", "Ps", "Pc", "Pcr", "aniso", "anisor"];
const MAPS: [&str; 11] = [
    "map_Kd", "map_Ks", "map_Ke", "map_d", "map_Pr", "map_Pm", "map_Ps", "map_Pc", "map_Pcr", "norm",
    "map_bump",
];
/// Other spellings of keywords.
const ALIASES: [(&str, &str); 4] =
    [("bump", "map_bump"), ("map_opacity", "map_d"), ("map_Kn", "norm"), ("map_norm", "norm")];
/// Ambient light follows kd in Bilux, and sharpness applies to reflection maps.
const WITHOUT_USE: [&str; 3] = ["Ka", "map_Ka", "sharpness"];

pub(super) struct Library<'a, 'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) source: &'a Source<'a>,
    pub(super) cursor: Cursor<'a>,
    pub(super) places: Places<'a>,
    pub(super) oddities: Oddities,
}

impl Library<'_, '_, '_> {
    fn statement(&mut self, key: &[u8], start: usize, draft: &mut Draft) -> Result<(), FormatError> {
        let is = |name: &str| name.as_bytes().eq_ignore_ascii_case(key);
        let alias = ALIASES.iter().find(|(other, _)| is(other)).map(|(_, name)| name.as_bytes());
        let key = alias.unwrap_or(key);
        let known = |names: &[&'static str]| {
            names.iter().copied().find(|name| name.as_bytes().eq_ignore_ascii_case(key))
        };
        if let Some(name) = known(&COLOURS) {
            if let Some(colour) = self.colour()? {
                draft.colours.insert(name, colour);
            }
        } else if let Some(name) = known(&NUMBERS) {
            if self.cursor.peek_word() == b"-halo" {
                self.cursor.word();
            }
            if let Some(number) = self.number()? {
                draft.numbers.insert(name, number);
            }
        } else if let Some(name) = known(&MAPS) {
            let map = self.map(start);
            self.reading.budget.take::<u8>(2 * map.file.len(), self.source.name)?;
            draft.maps.insert(name, map);
        } else {
            if known(&WITHOUT_USE).is_none() {
                let places = &self.places;
                let what = format!("{} of a material is ignored", quoted(key));
                self.oddities.note(&what, || places.at(start));
            }
            self.cursor.rest_of_line();
        }
        Ok(())
    }

    /// Three numbers, or one for all channels; `None` for a spectral file or another colour space.
    fn colour(&mut self) -> Result<Option<Rgb>, FormatError> {
        if [&b"spectral"[..], b"xyz"].contains(&self.cursor.peek_word()) {
            let (places, at) = (&self.places, self.cursor.offset());
            self.oddities.note("spectral and xyz colours are not used", || places.at(at));
            self.cursor.rest_of_line();
            return Ok(None);
        }
        let Some(r) = self.number()? else { return Ok(None) };
        let g = self.next_number()?;
        let b = self.next_number()?;
        Ok(Some(Rgb::new(r, g.unwrap_or(r), b.or(g).unwrap_or(r))))
    }

    fn next_number(&mut self) -> Result<Option<f32>, FormatError> {
        match self.cursor.peek_word() {
            b"" => Ok(None),
            word if word.starts_with(b"#") => Ok(None),
            _ => self.number(),
        }
    }

    /// A number; `None`, with a warning, if it is infinite or NaN.
    fn number(&mut self) -> Result<Option<f32>, FormatError> {
        let word = self.cursor.word();
        let offset = self.cursor.offset() - word.len();
        match parse_f32(word) {
            Some(value) if value.is_finite() => Ok(Some(value)),
            Some(_) => {
                let places = &self.places;
                let what = "a value of a material is infinite or not a number (NaN), and is ignored";
                self.oddities.note(what, || places.at(offset));
                Ok(None)
            }
            None => {
                let message =
                    format!("{} is not a number: write one, such as 0.5, or remove this line", quoted(word));
                Err(FormatError::malformed(message, self.places.at(offset)))
            }
        }
    }

    fn finish(
        &mut self,
        draft: Option<Draft>,
        scene: &mut SceneBuilder,
        by_name: &mut HashMap<String, usize>,
    ) -> Result<(), FormatError> {
        let Some(draft) = draft else { return Ok(()) };
        let mut spec = material(&draft);
        self.put_maps(&draft, &mut spec, scene)?;
        let index = scene.add_material(spec);
        by_name.entry(draft.name).or_insert(index);
        Ok(())
    }
}
