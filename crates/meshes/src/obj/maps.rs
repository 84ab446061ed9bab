//! Textures of MTL: their options, and the parameters that they replace.

use super::draft::{Draft, Map};
use super::library::Library;
use super::surface::NUMBERS;
use bilux_import::FormatError;
use bilux_import::appearance::heights::{holds_normals, normals_of_heights};
use bilux_import::bytes::float::parse_f32;
use bilux_import::bytes::text::{in_quotes, name_of};
use bilux_import::geometry::displacement::{Along, Displacement, Moved};
use bilux_import::input::reading::Texels;
use bilux_math::Rgb;
use bilux_scene::texture::Channel;
use bilux_scene::{SceneBuilder, Span, Spec, Texture, Value};
use std::sync::Arc;

impl Library<'_, '_, '_> {
    /// Reads a file name and its options, which belong before it, but which some programs write after it.
    pub(super) fn map(&mut self, start: usize) -> Map {
        let mut map = Map {
            file: String::new(),
            at: self.places.at(start),
            offset: [0.0; 2],
            scale: [1.0; 2],
            is_clamped: false,
            bump: 1.0,
            range: [0.0, 1.0],
            channel: None,
        };
        self.map_options(start, &mut map);
        self.cursor.skip_blanks();
        let mut rest = self.cursor.clone();
        let line = rest.rest_of_line();
        if let Some((name, length)) = in_quotes(line) {
            map.file = name_of(name);
            self.cursor.seek(self.cursor.offset() + length);
            self.map_options(start, &mut map);
            self.cursor = rest;
            return map;
        }
        let name_length = without_options(line);
        if name_length < line.len() {
            self.cursor.seek(self.cursor.offset() + name_length);
            self.map_options(start, &mut map);
        }
        let is_all = self.cursor.peek_word().is_empty();
        // What is no option is part of the name, and so is what precedes it.
        map.file = self.without_comment(name_of(if is_all { &line[..name_length] } else { line }));
        self.cursor = rest;
        map
    }

    /// A name without a comment after it, if there is no file with the whole name.
    fn without_comment(&self, name: String) -> String {
        let Some((before, _)) = name.split_once(" #") else { return name };
        match self.reading.locator.locate(self.source.folder, &name, &Span::default()) {
            Ok(_) => name,
            Err(_) => before.trim_end().to_owned(),
        }
    }

    /// Reads the options of a texture, as far as they go.
    fn map_options(&mut self, start: usize, map: &mut Map) {
        loop {
            let option = self.cursor.peek_word();
            let Some(numbers) = numbers_of_option(option) else { return };
            self.cursor.word();
            let word = if numbers == 0 { self.cursor.word() } else { b"" };
            let mut given = Vec::new();
            while given.len() < numbers
                && let Some(number) = parse_f32(self.cursor.peek_word())
            {
                given.push(if number.is_finite() { number } else { 0.0 });
                self.cursor.word();
            }
            let pair = |default: f32| [0, 1].map(|i| given.get(i).copied().unwrap_or(default));
            match (option, word) {
                (b"-o", _) => map.offset = pair(0.0),
                // A single number applies to u only.
                (b"-s", _) => map.scale = pair(1.0),
                (b"-bm", _) => map.bump = given.first().copied().unwrap_or(1.0),
                (b"-mm", _) => {
                    map.range = [given.first().copied().unwrap_or(0.0), given.get(1).copied().unwrap_or(1.0)]
                }
                (b"-clamp", word) => map.is_clamped = word.eq_ignore_ascii_case(b"on"),
                (b"-imfchan", b"r") => map.channel = Some(Channel::R),
                (b"-imfchan", b"g") => map.channel = Some(Channel::G),
                (b"-imfchan", b"b") => map.channel = Some(Channel::B),
                (b"-imfchan", b"m") => map.channel = Some(Channel::A),
                // These are the defaults, or only affect speed.
                (b"-blendu" | b"-blendv" | b"-imfchan" | b"-type" | b"-colorspace" | b"-texres", _) => {}
                (option, _) => {
                    let (places, name) = (&self.places, String::from_utf8_lossy(option));
                    self.diagnostics.not_shown(&format!("'{name}' of textures"), || places.at(start));
                }
            }
        }
    }

    /// Replaces numbers and colours of a material by its textures.
    pub(super) fn put_maps(
        &mut self,
        draft: &Draft,
        spec: &mut Spec,
        scene: &mut SceneBuilder,
    ) -> Result<(), FormatError> {
        let known = |key: &str| spec.parameters.find(key).is_some();
        let diffuse = ["kd", "reflectance", "base_color"].into_iter().find(|key| known(key));
        let specular = Some("ks").filter(|key| known(key) && !draft.lacks_highlight());
        for (word, tint, key) in [("map_Kd", "Kd", diffuse), ("map_Ks", "Ks", specular)] {
            if let (Some(map), Some(key)) = (draft.maps.get(word), key) {
                // Black counts as white: many exporters write it next to every texture.
                let tint = draft.colour(tint).filter(|tint| !tint.is_black()).unwrap_or(Rgb::WHITE);
                let picture = self.colours(map, tint, scene)?;
                put(scene, spec, key, picture, map);
            }
        }
        if let Some(map) = draft.maps.get("map_Ke").filter(|_| spec.kind != "dielectric") {
            let picture = self.colours(map, Rgb::WHITE, scene)?;
            let light = draft.colour("Ke").filter(|light| !light.is_black()).unwrap_or(Rgb::WHITE);
            put(scene, spec, "emission", picture, map);
            spec.parameters.set_at("emission_scale", light.clamp(0.0, 1e12).into(), map.at.clone());
        }
        for (word, key) in NUMBERS.map(|(_, word, key)| (word, key)).into_iter().chain([("map_d", "opacity")])
        {
            let Some(map) = draft.maps.get(word) else { continue };
            let Some(picture) = self.numbers(map, scene)? else { continue };
            let is_opacity = key == "opacity";
            let channel = match map.channel {
                Some(channel) => channel,
                None if is_opacity && has_alpha(&picture) => Channel::A,
                None => Channel::R,
            };
            let factor = Rgb::grey(if is_opacity && !draft.is_glass { draft.opacity } else { 1.0 });
            put(scene, spec, key, Texture { channel: Some(channel), factor, ..picture }, map);
        }
        for word in ["norm", "map_bump"] {
            let Some(map) = draft.maps.get(word) else { continue };
            let Some(picture) = self.numbers(map, scene)? else { continue };
            let (normals, scale) = if word == "norm" || holds_normals(&picture) {
                (picture, map.bump)
            } else {
                self.reading
                    .budget
                    .take::<[u8; 4]>(picture.image.width * picture.image.height, self.source.name)?;
                (normals_of_heights(&picture, map.bump), 1.0)
            };
            put(scene, spec, "normal", normals, map);
            spec.parameters.set_at("normal_scale", scale.clamp(0.0, 10.0).into(), map.at.clone());
            break;
        }
        Ok(())
    }

    /// Moves the surfaces that have this material as its displacement map says.
    pub(super) fn displace(
        &mut self,
        draft: &Draft,
        material: usize,
        scene: &mut SceneBuilder,
    ) -> Result<(), FormatError> {
        let Some(map) = draft.maps.get("disp") else { return Ok(()) };
        let Some(picture) = self.numbers(map, scene)? else { return Ok(()) };
        let [base, gain] = map.range;
        let scale = gain * map.bump;
        if scale != 0.0 {
            self.reading.displacements.push((
                Moved::Material(material),
                Displacement {
                    map: map.placed(Texture { channel: map.channel, ..picture }),
                    along: Along::Normal,
                    scale,
                    middle: -base / scale,
                    at: map.at.clone(),
                },
            ));
        }
        Ok(())
    }

    /// A tinted texture of colours; a magenta checker, with a warning, if it cannot be read.
    fn colours(&mut self, map: &Map, tint: Rgb, scene: &mut SceneBuilder) -> Result<Texture, FormatError> {
        match self.reading.texture(self.source.folder, &map.file, Texels::Colours, &map.at) {
            Ok(texture) => Ok(Texture { factor: tint, ..(*texture).clone() }),
            Err(error @ FormatError::TooLarge { .. }) => Err(error),
            Err(error) => {
                let reason = error.without_place();
                scene.warn(format!("a texture is replaced by a magenta checker: {reason}"), map.at.clone());
                Ok(Texture::missing(&map.file))
            }
        }
    }

    /// A texture of numbers; `None`, with a warning, if it cannot be read.
    fn numbers(&mut self, map: &Map, scene: &mut SceneBuilder) -> Result<Option<Texture>, FormatError> {
        match self.reading.texture(self.source.folder, &map.file, Texels::Numbers(None), &map.at) {
            Ok(texture) => Ok(Some((*texture).clone())),
            Err(error @ FormatError::TooLarge { .. }) => Err(error),
            Err(error) => {
                let reason = error.without_place();
                scene.warn(format!("a data texture is left out: {reason}"), map.at.clone());
                Ok(None)
            }
        }
    }
}

/// The maximum count of numbers after an option of a texture; zero if a word follows it, and `None` if it is no option.
fn numbers_of_option(word: &[u8]) -> Option<usize> {
    match word {
        b"-o" | b"-s" | b"-t" => Some(3),
        b"-mm" => Some(2),
        b"-bm" | b"-boost" | b"-texres" => Some(1),
        b"-blendu" | b"-blendv" | b"-cc" | b"-clamp" | b"-imfchan" | b"-type" | b"-colorspace" => Some(0),
        _ => None,
    }
}

/// The length of what precedes the first option in the rest of a line; all of it if there is none.
fn without_options(line: &[u8]) -> usize {
    let mut before = 0;
    for word in line.split(u8::is_ascii_whitespace) {
        if before > 0 && numbers_of_option(word).is_some() {
            return line[..before].trim_ascii_end().len();
        }
        before += word.len() + 1;
    }
    line.len()
}

fn put(scene: &mut SceneBuilder, spec: &mut Spec, key: &str, texture: Texture, map: &Map) {
    scene.textures.push(Arc::new(map.placed(texture)));
    spec.parameters.set_at(key, Value::Texture(scene.textures.len() - 1), map.at.clone());
}

fn has_alpha(texture: &Texture) -> bool {
    Texture { channel: Some(Channel::A), ..texture.clone() }.texels().any(|alpha| alpha.r < 1.0)
}
