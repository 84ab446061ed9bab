//! Reading MTL: materials of the 1990s, mapped to ours as `docs/formats/obj.md` says.

use crate::FormatError;
use crate::float::parse_f32;
use crate::reading::{Oddities, Reading, Source, Texels};
use crate::text::{Cursor, Places, name_of, quoted};
use bilux_math::Rgb;
use bilux_scene::{SceneBuilder, Span, Spec, Texture, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// Adds every material of a library to the scene; `by_name` gets their indices, the first of a name wins.
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
                let message = format!("{} stands before the first 'newmtl'", quoted(key));
                return Err(FormatError::malformed(message, library.places.at(start)));
            }
        }
        library.cursor.end_line();
    }
    library.finish(current, scene, by_name)?;
    library.oddities.into_warnings(scene);
    Ok(())
}

/// A material while its lines are read; `None` is what no line says.
#[derive(Default)]
struct Draft {
    name: String,
    span: Span,
    colours: HashMap<&'static str, Rgb>,
    numbers: HashMap<&'static str, f32>,
    maps: HashMap<&'static str, (String, Span)>,
}

impl Draft {
    fn new(name: String, span: Span) -> Draft {
        Draft { name, span, ..Draft::default() }
    }

    fn colour(&self, key: &str) -> Option<Rgb> {
        self.colours.get(key).copied()
    }

    fn number(&self, key: &str) -> Option<f32> {
        self.numbers.get(key).copied()
    }
}

/// What is read, by the kind of what follows.
const COLOURS: [&str; 6] = ["Kd", "Ks", "Ke", "Tf", "Kt", "Kr"];
const NUMBERS: [&str; 5] = ["Ns", "Ni", "d", "Tr", "illum"];
const MAPS: [&str; 2] = ["map_Kd", "map_Ks"];

struct Library<'a, 'o, 'r> {
    reading: &'r mut Reading<'o>,
    source: &'a Source<'a>,
    cursor: Cursor<'a>,
    places: Places<'a>,
    oddities: Oddities,
}

impl Library<'_, '_, '_> {
    fn statement(&mut self, key: &[u8], start: usize, draft: &mut Draft) -> Result<(), FormatError> {
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
            let file = self.map_file(start);
            self.reading.budget.take::<u8>(2 * file.len(), self.source.name)?;
            draft.maps.insert(name, (file, self.places.at(start)));
        } else {
            // Ambient light follows kd here, and sharpness is of reflection maps.
            if !key.eq_ignore_ascii_case(b"Ka") && !key.eq_ignore_ascii_case(b"sharpness") {
                let places = &self.places;
                let what = format!("{} of a material is not used", quoted(key));
                self.oddities.note(&what, || places.at(start));
            }
            self.cursor.rest_of_line();
        }
        Ok(())
    }

    /// Three numbers, or one for all; `None` for a spectral file or another colour space.
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

    /// A number; `None`, with a warning, when it is infinite or none.
    fn number(&mut self) -> Result<Option<f32>, FormatError> {
        let word = self.cursor.word();
        let offset = self.cursor.offset() - word.len();
        match parse_f32(word) {
            Some(value) if value.is_finite() => Ok(Some(value)),
            Some(_) => {
                let places = &self.places;
                let what = "a value of a material is infinite or no number; it is not used";
                self.oddities.note(what, || places.at(offset));
                Ok(None)
            }
            None => {
                let message = format!("{} stands where a number should", quoted(word));
                Err(FormatError::malformed(message, self.places.at(offset)))
            }
        }
    }

    /// The file's name behind a map's options, which are not applied.
    fn map_file(&mut self, start: usize) -> String {
        let mut options = false;
        loop {
            let arguments = match self.cursor.peek_word() {
                b"-o" | b"-s" | b"-t" => 1..=3,
                b"-mm" => 2..=2,
                b"-bm" | b"-boost" | b"-texres" => 1..=1,
                b"-blendu" | b"-blendv" | b"-cc" | b"-clamp" | b"-imfchan" | b"-type" | b"-colorspace" => {
                    0..=0
                }
                _ => break,
            };
            options = true;
            self.cursor.word();
            if *arguments.end() == 0 {
                self.cursor.word();
            }
            let mut taken = 0;
            while taken < *arguments.end() && parse_f32(self.cursor.peek_word()).is_some() {
                self.cursor.word();
                taken += 1;
            }
        }
        self.cursor.skip_blanks();
        if options {
            let places = &self.places;
            self.oddities.note("options of a texture are not applied", || places.at(start));
        }
        name_of(self.cursor.rest_of_line())
    }

    fn finish(
        &mut self,
        draft: Option<Draft>,
        scene: &mut SceneBuilder,
        by_name: &mut HashMap<String, usize>,
    ) -> Result<(), FormatError> {
        let Some(draft) = draft else { return Ok(()) };
        let mut spec = material(&draft);
        for (map, tint, keys) in [("map_Kd", "Kd", ["kd", "reflectance"]), ("map_Ks", "Ks", ["ks", "ks"])] {
            let Some((file, at)) = draft.maps.get(map) else { continue };
            let Some(key) = keys.into_iter().find(|key| spec.parameters.find(key).is_some()) else {
                continue;
            };
            if let Some(texture) = self.texture(file, at, scene)? {
                scene.textures.push(tinted(texture, draft.colour(tint).unwrap_or(Rgb::WHITE)));
                spec.parameters.set_at(key, Value::Texture(scene.textures.len() - 1), at.clone());
            }
        }
        let index = scene.add_material(spec);
        by_name.entry(draft.name).or_insert(index);
        Ok(())
    }

    /// A texture, or a warning that there is none.
    fn texture(
        &mut self,
        file: &str,
        at: &Span,
        scene: &mut SceneBuilder,
    ) -> Result<Option<Arc<Texture>>, FormatError> {
        match self.reading.texture(self.source.folder, file, Texels::Colours, at) {
            Ok(texture) => Ok(Some(texture)),
            Err(error @ FormatError::TooLarge { .. }) => Err(error),
            Err(error) => {
                let reason = error.without_place();
                scene.warn(format!("a colour stands in place of a texture: {reason}"), at.clone());
                Ok(None)
            }
        }
    }
}

/// A texture times a colour. Black is taken as white: many exporters write it beside every texture.
fn tinted(texture: Arc<Texture>, tint: Rgb) -> Arc<Texture> {
    if tint == Rgb::WHITE || tint.is_black() {
        return texture;
    }
    Arc::new(Texture { factor: tint, ..(*texture).clone() })
}

/// Our material for an MTL one.
fn material(draft: &Draft) -> Spec {
    let illum = draft.number("illum").map_or(2, |n| n as i32);
    let opacity = draft.number("d").or(draft.number("Tr").map(|t| 1.0 - t)).unwrap_or(1.0).clamp(0.0, 1.0);
    let unit = |c: Rgb| c.clamp(0.0, 1.0);
    let kd = draft.colour("Kd").map(unit);
    let ks = draft.colour("Ks").map_or(Rgb::BLACK, unit);
    let eta = draft.number("Ni").filter(|&n| n > 0.0).map(|n| n.clamp(0.1, 10.0));
    let emission = draft.colour("Ke").map_or(Rgb::BLACK, |c| c.clamp(0.0, 1e12));
    let kind = match illum {
        4 | 6 | 7 | 9 => "dielectric",
        3 | 5 | 8 if draft.colour("Kr").is_none() && kd.is_none_or(|c| c.is_black()) && !ks.is_black() => {
            "mirror"
        }
        _ => "phong",
    };
    let mut spec = Spec { span: draft.span.clone(), ..Spec::new(&draft.name, kind) };
    let mut set = |key: &str, value: Value| spec.parameters.set_at(key, value, draft.span.clone());
    match kind {
        "dielectric" => {
            set("eta", eta.unwrap_or(1.5).into());
            if let Some(tint) = draft.colour("Tf") {
                set("tint", unit(tint).into());
            }
        }
        "mirror" => set("reflectance", ks.into()),
        _ => {
            if let Some(kd) = kd.or(draft.maps.contains_key("map_Kd").then_some(Rgb::WHITE)) {
                set("kd", (kd * opacity).into());
            }
            set("ks", if illum < 2 { Rgb::BLACK } else { ks }.into());
            if let Some(exponent) = draft.number("Ns") {
                set("exponent", exponent.clamp(0.0, 1e5).into());
            }
            let reflects = if matches!(illum, 3 | 5 | 8) { 1.0 } else { 0.0 };
            set("reflectivity", draft.colour("Kr").map_or(reflects, |c| unit(c).max_channel()).into());
            let through = draft
                .colour("Kt")
                .map(unit)
                .or((opacity < 1.0).then(|| draft.colour("Tf").map_or(Rgb::WHITE, unit) * (1.0 - opacity)));
            if let Some(kt) = through.filter(|kt| !kt.is_black()) {
                set("kt", kt.into());
                // Opacity says nothing of refraction: light goes straight on.
                set("thin", (draft.colour("Kt").is_none()).into());
            }
            if let Some(eta) = eta {
                set("eta", eta.into());
            }
        }
    }
    if kind != "dielectric" && !emission.is_black() {
        set("emission", emission.into());
    }
    spec
}
