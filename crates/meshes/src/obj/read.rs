//! Reads an OBJ file block by block.

use super::block::{Block, StateChange, Stroke};
use super::mtl::read_library;
use super::statements::{BACKWARD_LEFT_OUT, bad_corner, read_block};
use super::strokes::Strokes;
use bilux_import::FormatError;
use bilux_import::bytes::blocks::Blocks;
use bilux_import::bytes::text::{Cursor, Places, TextPosition, no_text, unquoted, whole_file};
use bilux_import::geometry::colours::{Stored, UNCOLOURED, decode};
use bilux_import::geometry::normals::{BY_ANGLE, Smoothing};
use bilux_import::input::reading::{Reading, Source};
use bilux_import::input::sink::Sink;
use bilux_import::meshes::indexed_faces::{IndexedFaces, NONE, Run, assemble};
use bilux_math::Rgb;
use bilux_math::parallel::{map, threads};
use bilux_scene::{Mesh, Object, SceneBuilder, Span};
use std::collections::HashMap;
use std::io::Read;
use std::path::Path;

/// The size of a block in bytes: large enough that the cost of joining blocks is negligible.
const BLOCK: usize = 1 << 20;

pub(super) fn read(
    reading: &mut Reading,
    source: &Source,
    from: &mut dyn Read,
) -> Result<SceneBuilder, FormatError> {
    read_in_blocks(reading, source, from, BLOCK)
}

/// Holds the text only while it is read: as many blocks as there are threads.
fn read_in_blocks(
    reading: &mut Reading,
    source: &Source,
    from: &mut dyn Read,
    size: usize,
) -> Result<SceneBuilder, FormatError> {
    let mut reader = Obj {
        reading,
        source,
        lines: 0,
        indexed: IndexedFaces { first_vertex: 1, leaves_out: true, ..IndexedFaces::default() },
        sink: Sink::for_bare_files(),
        materials: HashMap::new(),
        name: String::new(),
        material: None,
        smoothing: BY_ANGLE,
        in_run: false,
        strokes: Strokes::default(),
    };
    reader.blocks(&mut Blocks::new(from, size)).map_err(|error| no_text(error, source.bytes))?;
    reader.finish()
}

struct Obj<'a, 'o, 'r> {
    reading: &'r mut Reading<'o>,
    source: &'a Source<'a>,
    /// The number of lines before the block that is being joined.
    lines: u32,
    indexed: IndexedFaces,
    sink: Sink,
    /// The index of each material by name.
    materials: HashMap<String, usize>,
    name: String,
    material: Option<(String, u64)>,
    smoothing: Smoothing,
    /// False if the next face begins a new run.
    in_run: bool,
    strokes: Strokes,
}

impl Obj<'_, '_, '_> {
    /// Reads blocks in parallel and joins them in order, so that the result does not depend on the number of
    /// threads.
    fn blocks(&mut self, blocks: &mut Blocks) -> Result<(), FormatError> {
        let file = self.source.name;
        let mut spare: Vec<Block> = Vec::new();
        loop {
            let mut texts = Vec::new();
            while texts.len() < threads() {
                let failed =
                    |source| FormatError::Io { path: Path::new(&**file).into(), action: "read it", source };
                let Some(text) = blocks.next(self.reading.budget.left()).map_err(failed)? else { break };
                self.reading.budget.take_bytes(text.len() as u64, file)?;
                texts.push(text);
            }
            let (budget, origin) = (&self.reading.budget, self.reading.origin);
            spare.resize_with(texts.len(), Block::default);
            let parse = |(block, text): (Block, &Vec<u8>)| read_block(text, file, origin, budget, block);
            let parts: Vec<Block> = match texts.len() {
                0 => return Ok(()),
                1 => spare.drain(..).zip(&texts).map(parse).collect(),
                _ => map(spare.drain(..).zip(&texts), parse),
            };
            for (mut block, text) in parts.into_iter().zip(texts) {
                self.join(&mut block, &text)?;
                spare.push(block.emptied());
                self.reading.budget.release(text.len() as u64);
                blocks.recycle(text);
            }
        }
    }

    /// Appends the contents of a block to those of the earlier blocks.
    fn join(&mut self, block: &mut Block, text: &[u8]) -> Result<(), FormatError> {
        self.reading.budget.take_bytes(block.spent, self.source.name)?;
        self.resolve_backward_indices(block, text);
        self.sink.diagnostics.append(std::mem::take(&mut block.diagnostics), self.lines);
        self.add_colours(block)?;
        let before = self.indexed.positions.len();
        let indexed = &mut self.indexed;
        indexed.positions.append(&mut block.positions);
        indexed.uvs.append(&mut block.uvs);
        indexed.normals.append(&mut block.normals);
        let corners = indexed.faces.corner_count() + block.corners.len();
        let most = [indexed.positions.len(), indexed.uvs.len(), indexed.normals.len(), corners];
        self.add_faces(block, before)?;
        let end = TextPosition { line: 1, column: 1 }.after(self.lines).after(block.lines);
        self.lines = self.lines.saturating_add(block.lines);
        let before = end.line - 1 - block.lines;
        if let Some(fault) = block.fault.take().map(|fault| moved_down(fault, before)) {
            self.set_fault(fault);
        }
        match block.failure.take() {
            Some(error) => Err(moved_down(error, before)),
            // Indices are 32-bit numbers, and the largest one stands for a missing index.
            None if most.iter().any(|&count| count as u64 >= u64::from(NONE)) => {
                let message = "there are more than 4 billion vertices or corners: split the file";
                Err(FormatError::malformed(message, end.in_file(self.source.name)))
            }
            None => Ok(()),
        }
    }

    /// Keeps the fault that comes first in the file.
    fn set_fault(&mut self, fault: FormatError) {
        let line = |fault: &FormatError| match fault {
            FormatError::Malformed { at, .. } => at.line,
            _ => 0,
        };
        if self.indexed.first_fault.as_ref().is_none_or(|first| line(&fault) < line(first)) {
            self.indexed.first_fault = Some(fault);
        }
    }

    /// Resolves the corners with indices that count backwards.
    fn resolve_backward_indices(&mut self, block: &mut Block, text: &[u8]) {
        let before = [self.indexed.positions.len(), self.indexed.uvs.len(), self.indexed.normals.len()];
        let mut is_first = true;
        for backward in &block.backward {
            let index = before[backward.part as usize] as i64 + backward.index;
            let index = u32::try_from(index).ok().filter(|&index| index != NONE).unwrap_or_else(|| {
                // Counts lines only once per block: a file may have as many of these faults as it has corners.
                if !std::mem::take(&mut is_first) {
                    self.sink.diagnostics.note(BACKWARD_LEFT_OUT, || whole_file(self.source.name));
                    return NONE;
                }
                let mut cursor = Cursor::joining_lines(text);
                cursor.seek(backward.offset);
                let mut at = Places::new(self.source.name, text).at(backward.offset);
                at.line = at.line.saturating_add(self.lines);
                let message = bad_corner(cursor.word());
                self.set_fault(FormatError::malformed(message.clone(), at.clone()));
                self.sink.diagnostics.note_first(BACKWARD_LEFT_OUT, || message, || at);
                NONE
            });
            // A faulty face may have ended before this corner.
            let corner = backward.corner.and_then(|corner| block.corners.get_mut(corner as usize));
            if let Some(corner) = corner {
                corner[backward.part as usize] = index;
            }
        }
    }

    /// If one vertex has a colour, all vertices have one.
    fn add_colours(&mut self, block: &Block) -> Result<(), FormatError> {
        let indexed = &mut self.indexed;
        if !block.colours.is_empty() || !indexed.colours.is_empty() {
            let count = indexed.positions.len() + block.positions.len();
            self.reading.budget.take::<Rgb>(count - indexed.colours.len(), self.source.name)?;
            indexed.colours.resize(indexed.positions.len(), UNCOLOURED);
            indexed.colours.extend_from_slice(&block.colours);
            indexed.colours.resize(count, UNCOLOURED);
        }
        Ok(())
    }

    /// Adds faces, points and lines; `before` is the number of vertices in earlier blocks.
    fn add_faces(&mut self, block: &mut Block, before: usize) -> Result<(), FormatError> {
        let (mut next, mut strokes) = (0, block.strokes.iter().peekable());
        for (turns, (face, turn)) in std::mem::take(&mut block.turns).into_iter().enumerate() {
            self.faces_up_to(face, &mut next, block)?;
            while let Some(stroke) = strokes.next_if(|stroke| stroke.turns <= turns) {
                self.add_stroke(stroke, before)?;
            }
            match turn {
                StateChange::Name(name) => (self.name, self.in_run) = (name, false),
                StateChange::Material(name, place) => {
                    self.material = Some((name, place.after(self.lines).key()));
                    self.in_run = false;
                }
                StateChange::Smoothing(smoothing) => self.smoothing = smoothing,
                StateChange::Libraries(line, place) => {
                    self.libraries(line, &place.after(self.lines).in_file(self.source.name))?;
                }
            }
        }
        self.faces_up_to(block.ends.len(), &mut next, block)?;
        strokes.try_for_each(|stroke| self.add_stroke(stroke, before))
    }

    fn add_stroke(&mut self, stroke: &Stroke, before: usize) -> Result<(), FormatError> {
        self.reading.budget.take::<[u32; 2]>(1, self.source.name)?;
        let place = stroke.place.after(self.lines);
        let run = || Run { first_face: 0, name: self.name.clone(), material: self.material.clone() };
        self.strokes.add(stroke, before, run, place.key()).ok_or_else(|| {
            let message = "this point or line refers to a vertex that the file does not have";
            FormatError::malformed(message, place.in_file(self.source.name))
        })
    }

    fn faces_up_to(&mut self, end: usize, next: &mut usize, block: &Block) -> Result<(), FormatError> {
        let first = std::mem::replace(next, end);
        if first == end {
            return Ok(());
        }
        if !self.in_run {
            self.begin_run()?;
        }
        let start = if first == 0 { 0 } else { block.ends[first - 1] };
        let ends = &block.ends[first..end];
        self.indexed.smooth(self.smoothing);
        let corners = &block.corners[start as usize..block.ends[end - 1] as usize];
        self.indexed.faces.append(corners, ends.iter().map(|end| end - start));
        block.places[first..end]
            .iter()
            .for_each(|place| self.indexed.places.push(place.after(self.lines).key()));
        Ok(())
    }

    fn begin_run(&mut self) -> Result<(), FormatError> {
        self.in_run = true;
        let first_face = self.indexed.faces.len();
        let run = Run { first_face, name: self.name.clone(), material: self.material.clone() };
        let same = |last: &Run| last.name == run.name && last.material_name() == run.material_name();
        if self.indexed.runs.last().is_some_and(same) {
            return Ok(());
        }
        let text = run.name.len() + run.material.as_ref().map_or(0, |(name, _)| name.len());
        self.reading.budget.take::<(Run, Object, Mesh)>(1, self.source.name)?;
        self.reading.budget.take::<u8>(2 * text, self.source.name)?;
        self.indexed.runs.push(run);
        Ok(())
    }

    /// `mtllib NAME…`: tries a name with spaces as a whole first.
    fn libraries(&mut self, line: String, at: &Span) -> Result<(), FormatError> {
        let folder = self.source.folder;
        let whole = String::from_utf8_lossy(unquoted(line.as_bytes())).into_owned();
        let names = match self.reading.locator.locate(folder, &whole, at) {
            Ok(_) => vec![whole],
            Err(_) => split_names(&line),
        };
        for name in names {
            let located = self.reading.locator.locate(folder, &name, at);
            let loaded = located.and_then(|path| Ok((self.reading.load_text(&path)?, path)));
            let (bytes, path) = match loaded {
                Ok(loaded) => loaded,
                Err(error @ FormatError::TooLarge { .. }) => return Err(error),
                Err(error) => {
                    self.sink.scene.warn(
                        format!("a material library is missing: {}", error.without_place()),
                        at.clone(),
                    );
                    continue;
                }
            };
            let shown = std::path::Path::new(&**self.source.name).with_file_name(&name).display().to_string();
            let library = Source { bytes: &bytes, name: &shown.into(), folder: path.parent() };
            read_library(self.reading, &library, &mut self.sink.scene, &mut self.materials)?;
            self.reading.release(bytes);
        }
        Ok(())
    }

    fn finish(self) -> Result<SceneBuilder, FormatError> {
        let Obj { reading, source, mut sink, mut materials, mut indexed, mut strokes, .. } = self;
        if let Some(fault) = indexed.first_fault.take_if(|_| indexed.faces.is_empty() && strokes.is_empty()) {
            return Err(fault);
        }
        if indexed.positions.is_empty() {
            let message = "the file has no faces and no vertices: is this an OBJ file?";
            return Err(FormatError::malformed(message, whole_file(source.name)));
        }
        if indexed.faces.is_empty() && strokes.is_empty() {
            // A file of vertices only is a point cloud.
            reading.budget.take::<u32>(indexed.positions.len(), source.name)?;
            strokes.add_all(indexed.positions.len(), source.stem());
        }
        // Only now is the greatest number of the whole file known.
        decode(&mut indexed.colours, Stored::Numbers);
        let place = |key: u64| TextPosition::of_key(key).in_file(source.name);
        strokes.into_objects(reading, source, &place, &indexed, &mut materials, &mut sink)?;
        if !indexed.faces.is_empty() {
            assemble(reading, source, &place, indexed, materials, &mut sink)?;
        }
        Ok(sink.finish())
    }
}

/// An error moved down by a number of lines.
fn moved_down(error: FormatError, lines: u32) -> FormatError {
    match error {
        FormatError::Malformed { message, mut at } => {
            at.line = at.line.saturating_add(lines);
            FormatError::Malformed { message, at }
        }
        error => error,
    }
}

/// Splits names at spaces; a backslash or quotes keep a space in a name, and `#` begins a comment.
fn split_names(line: &str) -> Vec<String> {
    let mut names = vec![String::new()];
    let mut letters = line.chars().peekable();
    let mut quote = None;
    while let Some(letter) = letters.next() {
        let last = names.len() - 1;
        match letter {
            c if quote == Some(c) => quote = None,
            c if quote.is_some() => names[last].push(c),
            '"' | '\'' if names[last].is_empty() => quote = Some(letter),
            '#' if names[last].is_empty() => break,
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

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_import::ReadOptions;
    use std::sync::Arc;

    #[test]
    fn names_with_escaped_blanks() {
        assert_eq!(split_names(r"a.mtl b\ c.mtl  d\e.mtl"), ["a.mtl", "b c.mtl", r"d\e.mtl"]);
        assert_eq!(split_names(r#""a b.mtl" 'c.mtl' it's.mtl # both"#), ["a b.mtl", "c.mtl", "it's.mtl"]);
    }

    /// Describes everything that was read, or the error, as text.
    fn read_with(text: &str, size: usize) -> String {
        let options = ReadOptions::default();
        let mut reading = Reading::new(&options, None);
        let name: Arc<str> = "f.obj".into();
        let source = Source { bytes: text.as_bytes(), name: &name, folder: None };
        match read_in_blocks(&mut reading, &source, &mut text.as_bytes(), size) {
            Ok(scene) => format!("{:?} {:?} {:?}", scene.objects, scene.materials, scene.warnings),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn block_boundaries_change_nothing() {
        let head = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\r\nv 1 1 0 1 .5 .2\rv 0 1 \\\n 0\nv 2 2 2\nvt 0 0\nvt 1 1\nvn 0 0 1\n\n";
        let faces = "f 1 2 3\ns 1\nf -5 -4 -3 -2\ng a b\nf 1/1/1 -4/-1/-1 3//1\nf 1 2\nusemtl x\n  f 4/2 3/9 9\ng c\nv 9 9 nan\n";
        let middle = "f 6 1 2\nl 1 2\nv 3 3 3\nv 4 4 4\nv 5 5 5\nf -1 -2 -9\n";
        for end in
            ["", "f -1 -2 -10\n", "f 1 2 3 # ok\nf -1 -2/x\n", "v 1 2\n", "f 1 2 99\n", "v 1 2", "\u{1}\u{2}"]
        {
            let text = format!("{head}{faces}{middle}{end}");
            let whole = read_with(&text, 1 << 20);
            for size in [1, 2, 3, 5, 8, 13, 40, 100] {
                assert_eq!(read_with(&text, size), whole, "{size} {end:?}");
            }
        }
    }
}
