//! Reads OFF.

use super::columns::{Columns, FLAT_COMMENT};
use bilux_import::FormatError;
use bilux_import::bytes::float::{parse_f32, parse_relative};
use bilux_import::bytes::text::{Cursor, Places, no_text, quoted};
use bilux_import::geometry::colours::{Stored, decode};
use bilux_import::geometry::normals::{BY_ANGLE, FLAT, Smoothing};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::input::sink::Sink;
use bilux_import::meshes::indexed_faces::{Corner, FaceColour, IndexedFaces, NONE, Run, assemble};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::SceneBuilder;
use std::collections::HashMap;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let places = Places::new(source.name, source.bytes);
    let mut reader = Off {
        reading,
        source,
        places: &places,
        cursor: Cursor::new(source.bytes),
        indexed: IndexedFaces::default(),
        smoothing: BY_ANGLE,
        diagnostics: Diagnostics::default(),
    };
    let columns = reader.first_word().map_err(|error| no_text(error, source.bytes))?;
    let [vertices, faces] = reader.counts()?;
    reader.vertices(vertices, columns)?;
    reader.faces(faces, columns)?;
    reader.finish()
}

struct Off<'a, 'o, 'r> {
    reading: &'r mut Reading<'o>,
    source: &'a Source<'a>,
    places: &'a Places<'a>,
    cursor: Cursor<'a>,
    indexed: IndexedFaces,
    /// The smoothing of faces without normals.
    smoothing: Smoothing,
    diagnostics: Diagnostics,
}

/// The first numbers of a line; the others are only counted.
struct Row {
    numbers: [f32; 12],
    count: usize,
    start: usize,
}

impl<'a> Off<'a, '_, '_> {
    fn first_word(&mut self) -> Result<Columns, FormatError> {
        let start = self.next_line("its first word, OFF")?;
        let word = self.cursor.word();
        let Some((columns, length)) = Columns::of_word(word) else {
            let known = "an OFF file begins with OFF, preceded only by ST, C and N, in this order";
            let message = match word.ends_with(b"OFF") {
                true => format!("{} has other columns or dimensions: {known}", quoted(word)),
                false => format!("{} is not expected here: {known}", quoted(word)),
            };
            return Err(FormatError::malformed(message, self.places.at(start)));
        };
        self.cursor.seek(start + length);
        if self.cursor.peek_word() == b"BINARY" {
            let message = "this OFF file is binary: write it as text";
            return Err(FormatError::malformed(message, self.places.at(start)));
        }
        Ok(columns)
    }

    /// Reads the numbers of vertices and faces; the number of edges is not used and may be missing.
    fn counts(&mut self) -> Result<[u64; 2], FormatError> {
        let start = self.next_line("its numbers of vertices and faces")?;
        let mut counts = [0; 2];
        for count in &mut counts {
            *count = integer(self.cursor.word()).ok_or_else(|| {
                let message = "this line gives the numbers of vertices, faces and edges, such as '8 6 12'";
                FormatError::malformed(message, self.places.at(start))
            })?;
        }
        self.cursor.end_line();
        if counts[0] >= u64::from(NONE) {
            let message = "there are more than 4 billion vertices: split the file";
            return Err(FormatError::malformed(message, self.places.at(start)));
        }
        Ok(counts)
    }

    fn vertices(&mut self, count: u64, columns: Columns) -> Result<(), FormatError> {
        for _ in 0..count {
            self.reading.budget.take::<f32>(columns.width(), self.source.name)?;
            let row = self.row("all of its vertices")?;
            let Some(extra) = row.count.checked_sub(columns.width()) else {
                let (have, need) = (row.count, columns.width());
                let message = format!("a vertex has {need} numbers here, but this line has {have}");
                return Err(FormatError::malformed(message, self.places.at(row.start)));
            };
            let opacity = usize::from(columns.colours && extra == 1);
            let (position, mut rest) = row.numbers.split_at(3);
            self.indexed.positions.push(Vec3::from_slice(position));
            if columns.normals {
                self.indexed.normals.push(Vec3::from_slice(rest));
                rest = &rest[3..];
            }
            if columns.colours {
                self.indexed.colours.push(Rgb::new(rest[0], rest[1], rest[2]));
                rest = &rest[3 + opacity..];
            }
            if columns.uvs {
                self.indexed.uvs.push(Vec2::from_slice(rest));
            }
            self.note_odd(&row, extra > opacity);
        }
        decode(&mut self.indexed.colours, Stored::Numbers);
        Ok(())
    }

    fn note_odd(&mut self, row: &Row, is_long: bool) {
        let places = self.places;
        if is_long {
            let what = "a vertex has more numbers than the first word of the file says; they are left out";
            self.diagnostics.note(what, || places.at(row.start));
        }
        if row.numbers.iter().any(|x| !x.is_finite()) {
            let what = "a vertex has numbers that are infinite or not numbers (NaN); it is kept";
            self.diagnostics.note(what, || places.at(row.start));
        }
    }

    fn faces(&mut self, count: u64, columns: Columns) -> Result<(), FormatError> {
        let of_vertex = |given: bool, vertex: u32| if given { vertex } else { NONE };
        let mut corners = Vec::new();
        for _ in 0..count {
            let start = self.next_line("all of its faces")?;
            corners.clear();
            for _ in 0..self.index("a face begins with its number of corners")? {
                if matches!(self.cursor.peek_word(), [] | [b'#', ..]) {
                    // Some programs break the lines of long faces.
                    self.next_line("all of its faces")?;
                }
                let vertex = self.index("a face lists the indices of its vertices, counted from 0")?;
                self.reading.budget.take::<Corner>(1, self.source.name)?;
                let (uv, normal) = (of_vertex(columns.uvs, vertex), of_vertex(columns.normals, vertex));
                corners.push([vertex, uv, normal]);
            }
            let colour = self.face_colour(start);
            self.cursor.end_line();
            if self.end_face(&corners, start)?
                && let Some(colour) = colour
            {
                self.reading.budget.take::<FaceColour>(1, self.source.name)?;
                self.indexed.face_colours.set(self.indexed.faces.len() - 1, colour);
            }
        }
        self.indexed.face_colours.decode(Stored::Numbers);
        if columns.colours && !self.indexed.face_colours.is_empty() {
            let places = self.places;
            self.indexed.face_colours.clear();
            self.diagnostics.not_shown("colours of faces, since vertices have colours", || places.whole());
        }
        Ok(())
    }

    /// The colour at the end of a face's line, as stored: three numbers, and perhaps an opacity. A single number is
    /// the index of a colour of the program that wrote the file.
    fn face_colour(&mut self, start: usize) -> Option<Rgb> {
        let (mut numbers, mut count, places) = ([0.0; 3], 0, self.places);
        while !matches!(self.cursor.peek_word(), [] | [b'#', ..]) {
            let Some(number) = parse_f32(self.cursor.word()) else {
                self.diagnostics.note("a face has more than vertices and a colour", || places.at(start));
                return None;
            };
            if let Some(slot) = numbers.get_mut(count) {
                *slot = number;
            }
            count += 1;
        }
        if matches!(count, 1 | 2) {
            self.diagnostics.not_shown("colours of faces that are indices into a table", || places.at(start));
        }
        (count >= 3).then(|| Rgb::from_array(numbers))
    }

    /// Adds a face; false if it is left out.
    fn end_face(&mut self, corners: &[Corner], start: usize) -> Result<bool, FormatError> {
        let (indexed, places) = (&mut self.indexed, self.places);
        if corners.len() < 3 {
            self.diagnostics.note("a face has fewer than 3 corners and is left out", || places.at(start));
            return Ok(false);
        }
        self.reading.budget.take::<[usize; 2]>(1, self.source.name)?;
        if (indexed.faces.corner_count() + corners.len()) as u64 >= u64::from(NONE) {
            let message = "there are more than 4 billion corners: split the file";
            return Err(FormatError::malformed(message, places.at(start)));
        }
        indexed.smooth(self.smoothing);
        indexed.faces.push(corners);
        indexed.places.push(start as u64);
        Ok(true)
    }

    fn finish(self) -> Result<SceneBuilder, FormatError> {
        let Off { reading, source, places, mut indexed, diagnostics, .. } = self;
        if indexed.faces.is_empty() {
            return Err(FormatError::malformed("it contains no faces", places.whole()));
        }
        indexed.runs.push(Run { first_face: 0, name: source.stem(), material: None });
        let place = |offset: u64| places.at(offset as usize);
        let mut sink = Sink { scene: SceneBuilder::default(), diagnostics };
        assemble(reading, source, &place, indexed, HashMap::new(), &mut sink)?;
        Ok(sink.finish())
    }

    /// Skips empty lines and comments; returns the start of the next line.
    fn next_line(&mut self, wanted: &str) -> Result<usize, FormatError> {
        loop {
            self.cursor.skip_blanks();
            match self.cursor.peek_word() {
                [b'#', ..] => {
                    let comment = self.cursor.rest_of_line();
                    if comment[1..].trim_ascii() == FLAT_COMMENT {
                        self.smoothing = FLAT;
                    }
                }
                [] if self.cursor.is_done() => {
                    let message = format!("the file ends before {wanted}: it was cut off");
                    return Err(FormatError::malformed(message, self.places.at(self.cursor.offset())));
                }
                [] => {}
                _ => return Ok(self.cursor.offset()),
            }
            self.cursor.end_line();
        }
    }

    /// The numbers of the next line.
    fn row(&mut self, wanted: &str) -> Result<Row, FormatError> {
        let origin = self.reading.origin.to_array();
        let mut row = Row { numbers: [0.0; 12], count: 0, start: self.next_line(wanted)? };
        loop {
            let word = self.cursor.word();
            if matches!(word, [] | [b'#', ..]) {
                self.cursor.end_line();
                return Ok(row);
            }
            let origin = origin.get(row.count).copied().unwrap_or(0.0);
            let number = parse_relative(word, origin);
            let number = number.ok_or_else(|| self.no_number(word, "a vertex has numbers"))?;
            if let Some(slot) = row.numbers.get_mut(row.count) {
                *slot = number;
            }
            row.count += 1;
        }
    }

    fn index(&mut self, wanted: &str) -> Result<u32, FormatError> {
        let word = self.cursor.word();
        let index = integer(word).and_then(|index| u32::try_from(index).ok()).filter(|&i| i != NONE);
        index.ok_or_else(|| self.no_number(word, wanted))
    }

    /// The error for the word that was just read.
    fn no_number(&self, word: &'a [u8], wanted: &str) -> FormatError {
        let message = match word {
            b"" => format!("the line ends too early: {wanted}"),
            word => format!("{} is not expected here: {wanted}", quoted(word)),
        };
        FormatError::malformed(message, self.places.at(self.cursor.offset() - word.len()))
    }
}

fn integer(word: &[u8]) -> Option<u64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}
