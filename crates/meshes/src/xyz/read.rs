//! Reads XYZ.

use super::columns::{Columns, Comma, MAX, words_of};
use bilux_import::FormatError;
use bilux_import::bytes::float::parse_f64;
use bilux_import::bytes::text::{Cursor, Places, no_text, quoted};
use bilux_import::geometry::colours::{Stored, UNCOLOURED, decode};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_import::meshes::cloud::{Cloud, SAMPLES};
use bilux_math::colour::srgb_decode;
use bilux_math::{DVec3, Rgb};
use bilux_scene::SceneBuilder;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let places = Places::new(source.name, source.bytes);
    let mut reader = Xyz {
        reading,
        source,
        places: &places,
        cursor: Cursor::new(source.bytes),
        comma: Comma::of_text(source.bytes),
        cloud: Cloud::default(),
        colours: Vec::new(),
        intensities: Vec::new(),
        diagnostics: Diagnostics::default(),
    };
    reader.lines().map_err(|error| no_text(error, source.bytes))?;
    reader.finish()
}

struct Xyz<'a, 'o, 'r> {
    reading: &'r mut Reading<'o>,
    source: &'a Source<'a>,
    places: &'a Places<'a>,
    cursor: Cursor<'a>,
    comma: Comma,
    cloud: Cloud,
    /// As stored in the file.
    colours: Vec<Rgb>,
    intensities: Vec<f32>,
    diagnostics: Diagnostics,
}

/// A line of numbers.
struct Row {
    numbers: [f64; MAX],
    count: usize,
    start: usize,
}

/// The type of a line.
enum Line {
    Nothing,
    Numbers(Row),
    Words(Vec<String>),
}

/// The number of points that are examined to determine the columns.
const FIRST: usize = 32;

impl Xyz<'_, '_, '_> {
    fn lines(&mut self) -> Result<(), FormatError> {
        let mut columns: Option<Columns> = None;
        let mut lines = 0;
        while !self.cursor.is_done() {
            let start = self.cursor.offset();
            let line = self.line()?;
            self.cursor.end_line();
            match line {
                Line::Nothing => continue,
                Line::Numbers(row) if row.count == 1 && lines == 0 => self.refuse_molecule()?,
                // Some scanners write the size of their grid before the points.
                Line::Numbers(row) if row.count < 3 && columns.is_none() => {}
                Line::Numbers(row) => {
                    let columns = match columns {
                        Some(known) => known,
                        None => *columns.insert(self.guessed_columns(row.count, start)?),
                    };
                    if self.cloud.positions.is_empty() {
                        self.cloud = self.cloud_around(&columns, start)?;
                    }
                    self.point(&row, &columns)?;
                }
                Line::Words(names) if lines == 0 => columns = self.named_columns(&names, start),
                Line::Words(_) => {
                    let words = "a line has words instead of numbers and is left out";
                    let places = self.places;
                    if self.cloud.positions.is_empty() {
                        let message = "a point is expected here: three numbers or more, x y z [r g b]";
                        return Err(FormatError::malformed(message, places.at(start)));
                    }
                    self.diagnostics.note(words, || places.at(start));
                }
            }
            lines += 1;
        }
        Ok(())
    }

    /// The columns by their numbers, from this offset on.
    fn guessed_columns(&mut self, count: usize, start: usize) -> Result<Columns, FormatError> {
        let columns = Columns::guessed(count, &self.rows_from(start, FIRST)?);
        if (0..count).any(|column| !columns.shows(column)) {
            let places = self.places;
            self.diagnostics.not_used("further numbers of each point", || places.at(start));
        }
        Ok(columns)
    }

    /// The columns by their names, if these are there; names those that are not shown.
    fn named_columns(&mut self, names: &[String], start: usize) -> Option<Columns> {
        let (columns, places) = (Columns::from_header(names)?, self.places);
        for (_, name) in names.iter().enumerate().filter(|(column, _)| !columns.shows(*column)) {
            self.diagnostics.not_used(&quoted(name.as_bytes()), || places.at(start));
        }
        Some(columns)
    }

    /// Parses the current line.
    fn line(&mut self) -> Result<Line, FormatError> {
        let start = self.cursor.offset();
        let line = self.cursor.rest_of_line();
        let text = line.split(|&b| b == b'#').next().unwrap_or_default();
        let is_comment = text.starts_with(b"//");
        let text = if is_comment { &text[2..] } else { text };
        let words = words_of(text, self.comma);
        if words.is_empty() {
            return Ok(Line::Nothing);
        }
        let mut row = Row { numbers: [0.0; MAX], count: words.len(), start };
        for (number, word) in row.numbers.iter_mut().zip(&words) {
            match parse_f64(word) {
                Some(value) => *number = value,
                None if words.len() > 64 || word.iter().any(|b| b.is_ascii_control()) => {
                    let message = format!("{} is not a number", quoted(word));
                    return Err(FormatError::malformed(message, self.places.at(start)));
                }
                None => {
                    // A comma between names is no decimal point.
                    let words = words_of(text, Comma::Separates);
                    let names = words.iter().map(|word| String::from_utf8_lossy(word).into_owned());
                    return Ok(Line::Words(names.collect()));
                }
            }
        }
        Ok(if is_comment { Line::Nothing } else { Line::Numbers(row) })
    }

    /// A single count begins PTS files, but also chemists' XYZ files, in which element symbols follow.
    fn refuse_molecule(&mut self) -> Result<(), FormatError> {
        let mut ahead = self.cursor.clone();
        let mut at = ahead.offset();
        let mut words = words_of(ahead.rest_of_line(), self.comma);
        if words.len() < 4 || parse_f64(words[1]).is_none() {
            // A comment line comes first.
            ahead.end_line();
            at = ahead.offset();
            words = words_of(ahead.rest_of_line(), self.comma);
        }
        let is_atom = |word: &[u8]| word.first().is_some_and(u8::is_ascii_alphabetic) && word.len() <= 3;
        let are_numbers = |words: &[&[u8]]| words.iter().take(3).all(|word| parse_f64(word).is_some());
        match words.split_first() {
            Some((atom, rest)) if is_atom(atom) && rest.len() >= 3 && are_numbers(rest) => {
                let message = "this is an XYZ file of a molecule, not a point cloud: it cannot be read";
                Err(FormatError::malformed(message, self.places.at(at)))
            }
            _ => Ok(()),
        }
    }

    /// An empty cloud near the points from this offset on.
    fn cloud_around(&mut self, columns: &Columns, start: usize) -> Result<Cloud, FormatError> {
        let position = |row: &[f64; MAX]| DVec3::from(columns.position.map(|column| row[column]));
        let first = self.rows_from(start, 1)?.first().map(position).unwrap_or_default();
        let (rest, mut samples) = (self.source.bytes.len() - start, Vec::new());
        for sample in 0..SAMPLES {
            // From the next whole line on.
            let mut ahead = self.cursor.clone();
            ahead.seek(start + rest / SAMPLES * sample);
            ahead.end_line();
            samples.extend(self.rows_from(ahead.offset(), 1)?.first().map(position));
        }
        Ok(Cloud::around(first, &samples))
    }

    /// The numbers of the first points from this offset.
    fn rows_from(&mut self, start: usize, most: usize) -> Result<Vec<[f64; MAX]>, FormatError> {
        let back = self.cursor.clone();
        self.cursor.seek(start);
        let mut rows = Vec::new();
        while rows.len() < most && !self.cursor.is_done() {
            if let Line::Numbers(row) = self.line()? {
                rows.push(row.numbers);
            }
            self.cursor.end_line();
        }
        self.cursor = back;
        Ok(rows)
    }

    fn point(&mut self, row: &Row, columns: &Columns) -> Result<(), FormatError> {
        let (places, start) = (self.places, row.start);
        if columns.position.iter().any(|&column| column >= row.count) {
            let what = "a line has too few numbers for a point, and is left out";
            self.diagnostics.note(what, || places.at(start));
            return Ok(());
        }
        self.reading.budget.take::<(DVec3, u32)>(1, self.source.name)?;
        if self.cloud.positions.len() as u64 >= u64::from(u32::MAX) - 1 {
            let message = "there are more than 4 billion points: split the file";
            return Err(FormatError::malformed(message, places.at(start)));
        }
        let p = DVec3::from(columns.position.map(|column| row.numbers[column]));
        if !p.is_finite() {
            let what = "a point has numbers that are infinite or not numbers (NaN), and is left out";
            self.diagnostics.note(what, || places.at(start));
            return Ok(());
        }
        self.cloud.push(p);
        if let Some(colour) = columns.colour {
            self.reading.budget.take::<Rgb>(1, self.source.name)?;
            let stored = || Rgb::from_array(colour.map(|column| row.numbers[column] as f32));
            let is_there = colour.iter().all(|&column| column < row.count);
            self.colours.push(if is_there { stored() } else { UNCOLOURED });
        } else if let Some(column) = columns.intensity {
            self.reading.budget.take::<f32>(1, self.source.name)?;
            self.intensities.push(row.numbers[column] as f32);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<SceneBuilder, FormatError> {
        if self.cloud.positions.is_empty() {
            let message = "it contains no points: each is a line of three numbers or more, x y z [r g b]";
            return Err(FormatError::malformed(message, self.places.whole()));
        }
        self.reading.budget.take::<Rgb>(self.cloud.positions.len(), self.source.name)?;
        decode(&mut self.colours, Stored::Numbers);
        self.cloud.colours = self.colours;
        if let Some(grey) = greys(&self.intensities) {
            self.cloud.colours = grey;
        }
        let mut scene = self.cloud.into_scene(self.source.stem());
        self.diagnostics.into_warnings(&mut scene);
        Ok(scene)
    }
}

/// Converts intensities to greys, from the 2nd to the 98th percentile; `None` if these are equal.
fn greys(intensities: &[f32]) -> Option<Vec<Rgb>> {
    let mut sorted = intensities.to_vec();
    sorted.sort_by(f32::total_cmp);
    let place = |part: f64| sorted.get((sorted.len() as f64 * part) as usize).copied();
    let (dark, bright) = (place(0.02)?, place(0.98)?);
    let part = |i: &f32| ((i - dark) / (bright - dark)).clamp(0.0, 1.0);
    let grey = |i: &f32| Rgb::grey(srgb_decode(0.15 + 0.8 * part(i)));
    (bright > dark && (bright - dark).is_finite()).then(|| intensities.iter().map(grey).collect())
}
