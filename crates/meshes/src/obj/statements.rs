//! Parses one block of lines of an OBJ file by itself; results of earlier blocks are added when blocks are joined.

use super::block::{Backward, Block, End, StateChange, Stroke};
use super::index::{Index, index};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::bytes::float::{parse_f32, parse_relative};
use bilux_import::bytes::text::{Cursor, TextPosition, name_of, quoted, unquoted};
use bilux_import::geometry::colours::UNCOLOURED;
use bilux_import::geometry::normals::{BY_ANGLE, FLAT};
use bilux_import::meshes::indexed_faces::{Corner, NONE};
use bilux_math::{DVec3, Rgb, Vec2, Vec3};
use bilux_scene::Span;
use std::sync::Arc;

/// A face with more corners than this reserves memory while it is read.
const MANY: usize = 4096;

/// Reads a block of whole lines into an empty one.
pub(super) fn read_block(
    text: &[u8],
    file: &Arc<str>,
    origin: DVec3,
    budget: &Budget,
    block: Block,
) -> Block {
    let cursor = Cursor::joining_lines(text);
    let mut reader = Reader { cursor, file, origin, budget: budget.clone(), block };
    let failure = reader.statements().err();
    let spent = reader.budget.spent() - budget.spent();
    Block { lines: reader.cursor.lines(), spent, failure, ..reader.block }
}

/// The message about a malformed corner.
#[cold]
pub(super) fn bad_corner(word: &[u8]) -> String {
    format!(
        "{} is not a corner of a face, which is written vertex, vertex/uv, vertex//normal or vertex/uv/normal, each \
         counted from 1, or backwards from -1",
        quoted(word)
    )
}

/// Consequences for elements that cannot be read.
const VERTEX_LEFT_OUT: &str = ": this vertex is left out, together with the faces that use it";
const ATTRIBUTE_LEFT_OUT: &str = ": this normal or texture coordinate is set to 0";
const FACE_LEFT_OUT: &str = ": this face is left out";
/// This is known only when blocks are joined.
pub(super) const BACKWARD_LEFT_OUT: &str = ": this face counts back to a missing vertex, and is left out";

struct Reader<'a> {
    cursor: Cursor<'a>,
    file: &'a Arc<str>,
    /// The origin that positions are relative to.
    origin: DVec3,
    budget: Budget,
    block: Block,
}

impl<'a> Reader<'a> {
    fn statements(&mut self) -> Result<(), FormatError> {
        while !self.cursor.is_done() {
            self.cursor.skip_blanks();
            let start = self.cursor.place(self.cursor.offset());
            match self.cursor.word() {
                b"v" => self.vertex()?,
                b"vt" => self.texture_coordinates()?,
                b"vn" => self.normal()?,
                b"f" | b"fo" => self.face(start)?,
                b"l" => self.strokes(start, false)?,
                b"p" => self.strokes(start, true)?,
                b"o" | b"g" => {
                    let name = name_of(self.cursor.rest_of_line());
                    self.turn(StateChange::Name(name));
                }
                b"usemtl" => {
                    let name = name_of(unquoted(self.cursor.rest_of_line()));
                    self.turn(StateChange::Material(name, start));
                }
                b"mtllib" => {
                    let line = name_of(self.cursor.rest_of_line());
                    self.turn(StateChange::Libraries(line, start));
                }
                b"s" => self.smoothing_group(start)?,
                b"" => {}
                word if word.starts_with(b"#") => self.pass_line(),
                word => self.other_statement(word, start)?,
            }
            self.cursor.end_line();
        }
        Ok(())
    }

    /// Skips to the end of the line, so that a backslash there continues nothing.
    fn pass_line(&mut self) {
        self.cursor.rest_of_line();
    }

    /// The location of an offset on this line.
    fn at(&self, offset: usize) -> Span {
        self.cursor.place(offset).in_file(self.file)
    }

    fn note(&mut self, what: &str, at: TextPosition) {
        let file = self.file;
        self.block.diagnostics.note(what, || at.in_file(file));
    }

    fn turn(&mut self, turn: StateChange) {
        let (faces, turns) = (self.block.ends.len(), &mut self.block.turns);
        let is_drawn_with = self.block.strokes.last().is_some_and(|stroke| stroke.turns == turns.len());
        // Of several changes of one kind without a face between them, the last one counts.
        if let Some((before, last)) = turns.last_mut()
            && *before == faces
            && !is_drawn_with
            && !matches!(turn, StateChange::Libraries(..))
            && std::mem::discriminant(last) == std::mem::discriminant(&turn)
        {
            *last = turn;
            return;
        }
        turns.push((faces, turn));
    }

    /// `v x y z [w]` or `v x y z r g b`.
    fn vertex(&mut self) -> Result<(), FormatError> {
        let mut numbers = [0.0; 8];
        let mut again = (self.origin != DVec3::ZERO).then(|| self.cursor.clone());
        let mut count = self.numbers(&mut numbers, 3, VERTEX_LEFT_OUT);
        if count == 0 {
            // The vertex keeps its number, so that later faces refer to the right vertices.
            (numbers, count) = ([f32::NAN; 8], 3);
        } else if let Some(again) = &mut again {
            // Parses again as f64 to keep all digits.
            for (number, origin) in numbers.iter_mut().zip(self.origin.to_array()) {
                *number = parse_relative(again.word(), origin).unwrap_or(f32::NAN);
            }
        }
        self.budget.take::<Vec3>(1, self.file)?;
        let block = &mut self.block;
        block.positions.push(Vec3::from_slice(&numbers));
        let colour = match count {
            6 => Rgb::from_array([numbers[3], numbers[4], numbers[5]]),
            7.. => Rgb::from_array([numbers[4], numbers[5], numbers[6]]),
            _ => UNCOLOURED,
        };
        if count >= 6 || !block.colours.is_empty() {
            block.colours.resize(block.positions.len() - 1, UNCOLOURED);
            block.colours.push(colour);
        }
        Ok(())
    }

    fn texture_coordinates(&mut self) -> Result<(), FormatError> {
        let mut numbers = [0.0; 4];
        self.numbers(&mut numbers, 1, ATTRIBUTE_LEFT_OUT);
        self.budget.take::<Vec2>(1, self.file)?;
        self.block.uvs.push(Vec2::from_slice(&numbers));
        Ok(())
    }

    fn normal(&mut self) -> Result<(), FormatError> {
        let mut numbers = [0.0; 4];
        self.numbers(&mut numbers, 3, ATTRIBUTE_LEFT_OUT);
        self.budget.take::<Vec3>(1, self.file)?;
        self.block.normals.push(Vec3::from_slice(&numbers));
        Ok(())
    }

    /// Parses the numbers of a statement, at least `least` of them; returns their count, or 0 on failure.
    #[inline]
    fn numbers(&mut self, numbers: &mut [f32], least: usize, left_out: &str) -> usize {
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
                    let at = self.at(self.cursor.offset() - word.len());
                    self.fault(format!("{} is not a number", quoted(word)), left_out, at);
                    numbers.fill(0.0);
                    return 0;
                }
            }
        }
        if count < least {
            let at = self.at(self.cursor.offset());
            let cut_off = if self.cursor.is_done() { ": the file was cut off here" } else { "" };
            let message = format!("this line has {count} numbers, but needs {least}{cut_off}");
            self.fault(message, left_out, at);
            numbers.fill(0.0);
            return 0;
        }
        if odd {
            let what = "a vertex has numbers that are infinite or not numbers (NaN); it is kept";
            self.note(what, self.cursor.place(self.cursor.offset()));
        }
        count
    }

    /// Records that an element is left out, and why.
    #[cold]
    fn fault(&mut self, message: String, left_out: &str, at: Span) {
        if self.block.fault.is_none() {
            self.block.fault = Some(FormatError::malformed(message.clone(), at.clone()));
        }
        self.block.diagnostics.note_first(left_out, || message, || at);
        self.pass_line();
    }

    fn face(&mut self, start: TextPosition) -> Result<(), FormatError> {
        let (first, backward) = (self.block.corners.len(), self.block.backward.len());
        loop {
            let word = self.cursor.word();
            if word.is_empty() || word.starts_with(b"#") {
                break;
            }
            let Some(corner) = self.corner(word) else {
                self.block.corners.truncate(first);
                self.block.backward[backward..].iter_mut().for_each(|left_out| left_out.corner = None);
                let at = self.at(self.cursor.offset() - word.len());
                self.fault(bad_corner(word), FACE_LEFT_OUT, at);
                return Ok(());
            };
            self.block.corners.push(corner);
            if (self.block.corners.len() - first).is_multiple_of(MANY) {
                self.budget.take::<Corner>(MANY, self.file)?;
            }
        }
        let count = self.block.corners.len() - first;
        if count < 3 {
            self.block.corners.truncate(first);
            self.block.backward[backward..].iter_mut().for_each(|left_out| left_out.corner = None);
            self.note("a face has fewer than 3 corners and is left out", start);
            return Ok(());
        }
        self.budget.take::<Corner>(count % MANY, self.file)?;
        if self.block.corners.len() as u64 >= u64::from(NONE) {
            let message = "there are more than 4 billion corners: split the file";
            return Err(FormatError::malformed(message, start.in_file(self.file)));
        }
        self.budget.take::<[usize; 2]>(1, self.file)?;
        self.block.ends.push(self.block.corners.len() as u32);
        self.block.places.push(start);
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[inline]
    fn corner(&mut self, word: &[u8]) -> Option<Corner> {
        let mut corner = [NONE; 3];
        let mut rest = word;
        for part in 0..3 {
            let length = rest.iter().position(|&b| b == b'/').unwrap_or(rest.len());
            if length > 0 {
                corner[part] = match index(&rest[..length])? {
                    Index::Forward(index) => index,
                    Index::Backward(back) => self.backward(word, part, back),
                };
            }
            match rest.get(length + 1..) {
                Some(after) => rest = after,
                None => return Some(corner).filter(|corner| corner[0] != NONE),
            }
        }
        None
    }

    /// Records a part of a corner that counts backwards; returns a placeholder until the index is known.
    fn backward(&mut self, word: &[u8], part: usize, back: i64) -> u32 {
        let block = &mut self.block;
        let known = [block.positions.len(), block.uvs.len(), block.normals.len()][part];
        block.backward.push(Backward {
            corner: Some(block.corners.len() as u32),
            part: part as u8,
            index: known as i64 - back,
            offset: self.cursor.offset() - word.len(),
        });
        0
    }

    /// `p v1 v2 …` or `l v1 v2/vt …`: points, or one line through all of them.
    fn strokes(&mut self, place: TextPosition, are_points: bool) -> Result<(), FormatError> {
        let (first, mut last, mut count) = (self.block.strokes.len(), None, 0);
        loop {
            let word = self.cursor.word();
            if word.is_empty() || word.starts_with(b"#") {
                break;
            }
            let digits = word.split(|&b| b == b'/').next().unwrap_or_default();
            let end = match index(digits) {
                Some(Index::Forward(index)) => End::Whole(index),
                Some(Index::Backward(back)) => End::OfBlock(self.block.positions.len() as i64 - back),
                None => {
                    let at = self.at(self.cursor.offset() - word.len());
                    let message = format!(
                        "{} is not a vertex of a point or a line: write a number, counted from 1, or backwards from -1",
                        quoted(word)
                    );
                    self.block.strokes.truncate(first);
                    self.fault(message, ": this point or line is left out", at);
                    return Ok(());
                }
            };
            let ends = if are_points { Some([end; 2]) } else { last.map(|last| [last, end]) };
            if let Some(ends) = ends {
                self.budget.take::<Stroke>(1, self.file)?;
                let turns = self.block.turns.len();
                self.block.strokes.push(Stroke { turns, ends, is_point: are_points, place });
            }
            last = Some(end);
            count += 1;
        }
        if count < 2 - usize::from(are_points) {
            self.note("a line with fewer than 2 vertices, or a point without one, is left out", place);
        }
        Ok(())
    }

    /// `s off` and `s 0` are flat; any other number is a smoothing group.
    fn smoothing_group(&mut self, start: TextPosition) -> Result<(), FormatError> {
        let word = self.cursor.word();
        let number = std::str::from_utf8(word).ok().and_then(|text| text.parse::<u32>().ok());
        let smoothing = match (word, number) {
            (b"off" | b"", _) | (_, Some(0)) => FLAT,
            (b"on", _) => 1,
            (_, Some(group)) => group.min(BY_ANGLE - 1),
            _ => {
                let message = format!("{} is not a smoothing group: write a number or 'off'", quoted(word));
                self.fault(message, ": this line is left out", start.in_file(self.file));
                return Ok(());
            }
        };
        self.turn(StateChange::Smoothing(smoothing));
        Ok(())
    }

    fn other_statement(&mut self, word: &[u8], start: TextPosition) -> Result<(), FormatError> {
        let (diagnostics, at) = (&mut self.block.diagnostics, || start.in_file(self.file));
        match word {
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"curv" | b"curv2" | b"surf" | b"parm"
            | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" => {
                diagnostics.not_shown("free-form curves and surfaces", at);
            }
            b"maplib" | b"usemap" | b"call" | b"shadow_obj" | b"trace_obj" => {
                diagnostics.not_shown(&quoted(word), at);
            }
            b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"ctech" | b"stech" | b"mg" | b"t" | b"csh"
            | b"vw" => diagnostics.not_used(&quoted(word), at),
            _ if word.len() > 20 || !word.iter().all(u8::is_ascii_graphic) => {
                let message = format!("{} is not a statement of an OBJ file", quoted(word));
                return Err(FormatError::malformed(message, at()));
            }
            _ => diagnostics.note(&format!("the unknown statement {} is ignored", quoted(word)), at),
        }
        self.pass_line();
        Ok(())
    }
}
