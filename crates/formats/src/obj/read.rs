//! Reading the statements of an OBJ file.

use super::mtl::read_library;
use crate::FormatError;
use crate::float::parse_f32;
use crate::normals::{BY_ANGLE, FLAT, Smoothing};
use crate::reading::{Oddities, Reading, Source};
use crate::soup::{Corner, NONE, Run, Soup, assemble};
use crate::text::{Cursor, Places, name_of, no_text, quoted};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Object, SceneBuilder};
use std::collections::HashMap;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut reader = Obj {
        reading,
        source,
        cursor: Cursor::joining_lines(source.bytes),
        places: Places::new(source.name, source.bytes),
        soup: Soup { first_vertex: 1, ..Soup::default() },
        scene: SceneBuilder::default(),
        materials: HashMap::new(),
        oddities: Oddities::default(),
        name: String::new(),
        material: None,
        smoothing: BY_ANGLE,
        in_run: false,
    };
    reader.statements().map_err(|error| no_text(error, source))?;
    reader.finish()
}

struct Obj<'a, 'o, 'r> {
    reading: &'r mut Reading<'o>,
    source: &'a Source<'a>,
    cursor: Cursor<'a>,
    places: Places<'a>,
    soup: Soup,
    scene: SceneBuilder,
    /// Index of each material, by its name.
    materials: HashMap<String, usize>,
    oddities: Oddities,
    name: String,
    material: Option<(String, usize)>,
    smoothing: Smoothing,
    /// False when the next face begins a new run.
    in_run: bool,
}

impl Obj<'_, '_, '_> {
    fn statements(&mut self) -> Result<(), FormatError> {
        while !self.cursor.is_done() {
            self.cursor.skip_blanks();
            let start = self.cursor.offset();
            match self.cursor.word() {
                b"v" => self.vertex()?,
                b"vt" => self.texture_coordinates()?,
                b"vn" => self.normal()?,
                b"f" | b"fo" => self.face(start)?,
                b"o" | b"g" => {
                    let name = self.cursor.rest_of_line();
                    self.name = name_of(name);
                    self.in_run = false;
                }
                b"usemtl" => {
                    let name = self.cursor.rest_of_line();
                    self.material = Some((name_of(name), start));
                    self.in_run = false;
                }
                b"mtllib" => self.libraries(start)?,
                b"s" => self.smoothing_group(start)?,
                b"" => {}
                word if word.starts_with(b"#") => self.pass_line(),
                word => self.other_statement(word, start)?,
            }
            self.cursor.end_line();
        }
        Ok(())
    }

    /// Goes to the line's end, so that a backslash there continues nothing.
    fn pass_line(&mut self) {
        self.cursor.rest_of_line();
    }

    /// `v x y z [w]` or `v x y z r g b`.
    fn vertex(&mut self) -> Result<(), FormatError> {
        let mut numbers = [0.0; 8];
        let count = self.numbers(&mut numbers, 3)?;
        self.reading.budget.take::<Vec3>(1, self.source.name)?;
        let soup = &mut self.soup;
        soup.positions.push(Vec3::from_slice(&numbers));
        let colour = match count {
            6 => Rgb::from_array([numbers[3], numbers[4], numbers[5]]),
            7.. => Rgb::from_array([numbers[4], numbers[5], numbers[6]]),
            _ => Rgb::WHITE,
        };
        if count >= 6 || !soup.colours.is_empty() {
            let added = soup.positions.len() - soup.colours.len();
            self.reading.budget.take::<Rgb>(added, self.source.name)?;
            soup.colours.resize(soup.positions.len() - 1, Rgb::WHITE);
            soup.colours.push(colour);
        }
        self.check_room(self.soup.positions.len())
    }

    fn texture_coordinates(&mut self) -> Result<(), FormatError> {
        let mut numbers = [0.0; 4];
        self.numbers(&mut numbers, 1)?;
        self.reading.budget.take::<Vec2>(1, self.source.name)?;
        self.soup.uvs.push(Vec2::from_slice(&numbers));
        self.check_room(self.soup.uvs.len())
    }

    fn normal(&mut self) -> Result<(), FormatError> {
        let mut numbers = [0.0; 4];
        self.numbers(&mut numbers, 3)?;
        self.reading.budget.take::<Vec3>(1, self.source.name)?;
        self.soup.normals.push(Vec3::from_slice(&numbers));
        self.check_room(self.soup.normals.len())
    }

    /// Indices are 32-bit numbers, and the last one means that there is none.
    fn check_room(&self, count: usize) -> Result<(), FormatError> {
        if (count as u64) < u64::from(NONE) {
            return Ok(());
        }
        let message = "there are more than 4 billion of these: cut the file into several";
        Err(FormatError::malformed(message, self.places.at(self.cursor.offset())))
    }

    /// The numbers of a statement, `least` of them or more; how many there are.
    #[inline]
    fn numbers(&mut self, numbers: &mut [f32], least: usize) -> Result<usize, FormatError> {
        let mut count = 0;
        let mut odd = false;
        while count < numbers.len() {
            let word = self.cursor.word();
            match parse_f32(word) {
                Some(value) => {
                    odd |= !value.is_finite();
                    numbers[count] = value;
                    count += 1;
                }
                None if word.is_empty() || word.starts_with(b"#") => break,
                None => {
                    let at = self.places.at(self.cursor.offset() - word.len());
                    return Err(FormatError::malformed(format!("{} is no number", quoted(word)), at));
                }
            }
        }
        if count < least {
            let at = self.places.at(self.cursor.offset());
            let cut_off = if self.cursor.is_done() { ": the file was cut off here" } else { "" };
            let message =
                format!("there are {count} numbers on this line, where {least} are needed{cut_off}");
            return Err(FormatError::malformed(message, at));
        }
        if odd {
            let (places, offset) = (&self.places, self.cursor.offset());
            let what = "a vertex has numbers that are infinite or no numbers; it is kept";
            self.oddities.note(what, || places.at(offset));
        }
        Ok(count)
    }

    fn face(&mut self, start: usize) -> Result<(), FormatError> {
        let first = self.soup.corners.len();
        loop {
            let word = self.cursor.word();
            if word.is_empty() || word.starts_with(b"#") {
                break;
            }
            let corner = self.corner(word)?;
            self.soup.corners.push(corner);
        }
        let count = self.soup.corners.len() - first;
        if count < 3 {
            self.soup.corners.truncate(first);
            let places = &self.places;
            let what = "a face has fewer than 3 corners and is left out";
            self.oddities.note(what, || places.at(start));
            return Ok(());
        }
        self.reading.budget.take::<Corner>(count, self.source.name)?;
        self.reading.budget.take::<[usize; 2]>(1, self.source.name)?;
        self.check_room(self.soup.corners.len())?;
        if !self.in_run {
            self.begin_run()?;
        }
        self.soup.ends.push(self.soup.corners.len() as u32);
        self.soup.offsets.push(start);
        self.soup.smoothing.push(self.smoothing);
        Ok(())
    }

    fn begin_run(&mut self) -> Result<(), FormatError> {
        self.in_run = true;
        let first_face = self.soup.ends.len();
        let run = Run { first_face, name: self.name.clone(), material: self.material.clone() };
        let same = |last: &Run| last.name == run.name && last.material_name() == run.material_name();
        if self.soup.runs.last().is_some_and(same) {
            return Ok(());
        }
        let text = run.name.len() + run.material.as_ref().map_or(0, |(name, _)| name.len());
        self.reading.budget.take::<(Run, Object, bilux_scene::Mesh)>(1, self.source.name)?;
        self.reading.budget.take::<u8>(2 * text, self.source.name)?;
        self.soup.runs.push(run);
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[inline]
    fn corner(&self, word: &[u8]) -> Result<Corner, FormatError> {
        let soup = &self.soup;
        let counts = [soup.positions.len(), soup.uvs.len(), soup.normals.len()];
        let mut corner = [NONE; 3];
        let mut rest = word;
        for (part, count) in counts.into_iter().enumerate() {
            let length = rest.iter().position(|&b| b == b'/').unwrap_or(rest.len());
            if length > 0 {
                corner[part] = index(&rest[..length], count).ok_or_else(|| self.bad_corner(word))?;
            }
            match rest.get(length + 1..) {
                Some(after) => rest = after,
                None if corner[0] == NONE => return Err(self.bad_corner(word)),
                None => return Ok(corner),
            }
        }
        Err(self.bad_corner(word))
    }

    #[cold]
    fn bad_corner(&self, word: &[u8]) -> FormatError {
        let at = self.places.at(self.cursor.offset() - word.len());
        let message = format!(
            "{} is no corner of a face: it has to be a vertex, vertex/uv, vertex//normal or vertex/uv/normal, each \
             counted from 1, or backwards from -1",
            quoted(word)
        );
        FormatError::malformed(message, at)
    }

    /// `s off` and `s 0` are flat, any other number is a group that is smooth.
    fn smoothing_group(&mut self, start: usize) -> Result<(), FormatError> {
        let word = self.cursor.word();
        let number = std::str::from_utf8(word).ok().and_then(|text| text.parse::<u32>().ok());
        self.smoothing = match (word, number) {
            (b"off" | b"", _) | (_, Some(0)) => FLAT,
            (b"on", _) => 1,
            (_, Some(group)) => group.min(BY_ANGLE - 1),
            _ => {
                let message =
                    format!("{} is no smoothing group: it has to be a number or 'off'", quoted(word));
                return Err(FormatError::malformed(message, self.places.at(start)));
            }
        };
        Ok(())
    }

    /// `mtllib NAME…`: names with blanks are tried whole first.
    fn libraries(&mut self, start: usize) -> Result<(), FormatError> {
        let line = name_of(self.cursor.rest_of_line());
        let at = self.places.at(start);
        let folder = self.source.folder;
        let names = match self.reading.locate(folder, &line, &at) {
            Ok(_) => vec![line],
            Err(_) => split_names(&line),
        };
        for name in names {
            let located = self.reading.locate(folder, &name, &at);
            let loaded = located.and_then(|path| Ok((self.reading.load(&path)?, path)));
            let (bytes, path) = match loaded {
                Ok(loaded) => loaded,
                Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                Err(error) => {
                    self.scene.warn(format!("materials are missing: {}", error.without_place()), at.clone());
                    continue;
                }
            };
            let shown = std::path::Path::new(&**self.source.name).with_file_name(&name).display().to_string();
            let library = Source { bytes: &bytes, name: &shown.into(), folder: path.parent() };
            read_library(self.reading, &library, &mut self.scene, &mut self.materials)?;
            self.reading.release(bytes);
        }
        Ok(())
    }

    fn other_statement(&mut self, word: &[u8], start: usize) -> Result<(), FormatError> {
        let what = match word {
            b"l" | b"p" => "lines and points are not drawn".to_owned(),
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm"
            | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" => {
                "free-form curves and surfaces are not drawn".to_owned()
            }
            b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj" | b"ctech"
            | b"stech" | b"mg" | b"maplib" | b"usemap" | b"vw" | b"t" | b"call" | b"csh" => {
                format!("the statement {} is left out", quoted(word))
            }
            _ => {
                let readable = word.iter().all(|b| b.is_ascii_graphic()) && word.len() <= 20;
                if !readable {
                    let message = format!("{} is no statement of an OBJ file", quoted(word));
                    return Err(FormatError::malformed(message, self.places.at(start)));
                }
                format!("the unknown statement {} is left out", quoted(word))
            }
        };
        let places = &self.places;
        self.oddities.note(&what, || places.at(start));
        self.pass_line();
        Ok(())
    }

    fn finish(self) -> Result<SceneBuilder, FormatError> {
        let Obj { reading, source, mut scene, materials, mut oddities, soup, places, .. } = self;
        if soup.ends.is_empty() {
            let message = if soup.positions.is_empty() {
                "there is no face in it: is this an OBJ file?"
            } else {
                "there is no face in it, only points or lines, which are not drawn"
            };
            return Err(FormatError::malformed(message, places.whole()));
        }
        assemble(reading, source, &places, soup, materials, &mut scene, &mut oddities)?;
        oddities.into_warnings(&mut scene);
        Ok(scene)
    }
}

/// Names with blanks between; a backslash keeps a blank in a name.
fn split_names(line: &str) -> Vec<String> {
    let mut names = vec![String::new()];
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        let last = names.len() - 1;
        match letter {
            '\\' if letters.peek().is_some_and(|next| next.is_whitespace()) => {
                names[last].extend(letters.next());
            }
            c if c.is_whitespace() => names.push(String::new()),
            c => names[last].push(c),
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

/// An index as OBJ counts (from 1, or backwards from -1) as one from 0; whether forward ones exist is looked
/// at when the file has been read.
#[inline]
fn index(text: &[u8], count: usize) -> Option<u32> {
    let (negative, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    };
    if digits.is_empty() || digits.len() > 10 {
        return None;
    }
    let mut number = 0u64;
    for &digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        number = number * 10 + u64::from(digit - b'0');
    }
    let from_zero = if negative { (count as u64).checked_sub(number)? } else { number.checked_sub(1)? };
    (number > 0).then_some(())?;
    u32::try_from(from_zero).ok().filter(|&i| i != NONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_count_from_one_or_backwards() {
        assert_eq!(index(b"1", 0), Some(0));
        assert_eq!(index(b"+7", 3), Some(6));
        assert_eq!(index(b"-1", 8), Some(7));
        assert_eq!(index(b"-8", 8), Some(0));
        for bad in ["0", "-0", "-9", "", "-", "1.5", "4294967296", "99999999999"] {
            assert_eq!(index(bad.as_bytes(), 8), None, "{bad}");
        }
    }

    #[test]
    fn names_with_escaped_blanks() {
        assert_eq!(split_names(r"a.mtl b\ c.mtl  d\e.mtl"), ["a.mtl", "b c.mtl", r"d\e.mtl"]);
    }
}
