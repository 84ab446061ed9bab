//! Converts files to a scene.

use super::compose::Composer;
use super::files::{Files, Text};
use super::finish::finish;
use super::kinds::{self, Kind};
use super::lexer::Lexer;
use super::place::Place;
use super::rif::{self, Variable, is_rif, variables};
use super::statement::parse;
use super::views;
use super::world::World;
use bilux_import::FormatError;
use bilux_import::bytes::float::parse_f64;
use bilux_import::bytes::text::{name_of, whole_file};
use bilux_import::input::reading::{Reading, Source};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{SceneBuilder, Span};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// True for a text that begins with a statement or a variable.
pub(super) fn sniff(bytes: &[u8]) -> bool {
    let bytes = &bytes[..bytes.len().min(65536)];
    let file = Arc::from("");
    let mut lexer = Lexer::new(&file, bytes);
    match lexer.peek() {
        None => return false,
        Some(b'!') => {
            let (line, _) = lexer.line();
            let programs: [&[u8]; 4] = [b"xform ", b"genbox ", b"gensky ", b"gendaylit "];
            return programs.iter().any(|program| line[1..].trim_ascii_start().starts_with(program));
        }
        Some(_) => {}
    }
    let [_, kind, _] = [(); 3].map(|()| lexer.word().map_or(&b""[..], |word| word.text));
    match kinds::named(kind) {
        Some(row) => row.kind == Kind::Alias || has_arguments(&mut lexer),
        None => is_rif_of_scene(&file, bytes),
    }
}

/// True where three lists follow, each after the number of its entries: of any words, of integers, and of numbers. The object `sphere`
/// of an OBJ file has its vertices there. A file that goes on beyond what is looked at is taken at its word.
fn has_arguments(lexer: &mut Lexer) -> bool {
    let mut all = 0;
    for are_numbers in [false, true, true] {
        // A comment may stand before a number.
        lexer.peek();
        let Some(word) = lexer.word() else { return false };
        let count = std::str::from_utf8(word.text).ok().and_then(|text| text.parse::<u32>().ok());
        let Some(count) = count else { return false };
        all += u64::from(count);
        for _ in 0..count {
            match lexer.word() {
                Some(word) if are_numbers && parse_f64(word.text).is_none() => return false,
                Some(_) => {}
                None => return true,
            }
        }
    }
    all > 0
}

/// True for a list of variables that names a scene.
fn is_rif_of_scene(file: &Arc<str>, bytes: &[u8]) -> bool {
    is_rif(bytes)
        && variables(file, bytes).iter().any(|variable| variable.is("scene") || variable.is("octree"))
}

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let root = source.folder.map(Path::to_owned);
    let own = source.folder.zip(Path::new(&**source.name).file_name());
    let own = own.and_then(|(folder, file)| std::fs::canonicalize(folder.join(file)).ok());
    let files = Files::new(own, root.clone());
    let mut composer = Composer { world: World::new(reading), files };
    let cameras = if is_rif(source.bytes) {
        composer.rif(&variables(source.name, source.bytes), root.as_deref(), &whole_file(source.name))?
    } else {
        let statements = parse(source.name, source.bytes, &mut composer.world.reading.budget)?;
        composer.run(&Text::new(statements, root.clone()), &Place::default())?;
        composer.cameras_beside(source, root.as_deref())
    };
    finish(composer.world, cameras, source.name)
}

impl Composer<'_, '_> {
    /// Adds the files of a scene, and gives its views.
    fn rif(
        &mut self,
        variables: &[Variable],
        root: Option<&Path>,
        whole: &Span,
    ) -> Result<Vec<CameraSpec>, FormatError> {
        let mut is_empty = true;
        for kind in rif::FILES {
            for variable in variables.iter().filter(|variable| variable.is(kind)) {
                for name in &variable.words {
                    is_empty = false;
                    self.file(&Rc::from(&**name), root, &variable.at, &Place::default())?;
                }
            }
        }
        if is_empty {
            let message = "it names no files of a scene: add 'scene=' and a file; octrees are not read";
            return Err(FormatError::malformed(message, whole.clone()));
        }
        Ok(self.views(variables, root))
    }

    fn views(&mut self, variables: &[Variable], root: Option<&Path>) -> Vec<CameraSpec> {
        let views = variables.iter().filter(|variable| variable.is(rif::VIEW));
        let mut cameras = Vec::new();
        for Variable { words, at, .. } in views {
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            let (name, options) = match words.split_first() {
                Some((name, options)) if !name.starts_with('-') => (*name, options),
                _ => ("", &words[..]),
            };
            let from_file = match options {
                ["-vf", file, ..] => self.view_file(root, file, at),
                _ => Some(Vec::new()),
            };
            let options = if let ["-vf", _, rest @ ..] = options { rest } else { options };
            // What comes after the file counts last.
            let Some(all) = from_file else { continue };
            let all: Vec<&str> = all.iter().map(String::as_str).chain(options.iter().copied()).collect();
            cameras.extend(views::camera(&all, name, at, &mut self.world));
        }
        cameras
    }

    /// The options of a file of views; `None`, with a warning, if there are none.
    fn view_file(&mut self, root: Option<&Path>, file: &str, at: &Span) -> Option<Vec<String>> {
        let text = self.text(root, file, at);
        let found = text.as_deref().and_then(views::last_of);
        if found.is_none() {
            let what = format!("the view file '{file}' cannot be read, or has no view");
            self.world.diagnostics.note(&what, || at.clone());
        }
        found.map(|(_, line)| line.split_whitespace().map(str::to_owned).collect())
    }

    /// Views from the files that are called as the scene is: `.vf`, or else `.rif`.
    fn cameras_beside(&mut self, source: &Source, root: Option<&Path>) -> Vec<CameraSpec> {
        let named = |extension: &str| {
            let file = Path::new(&**source.name).file_name().map(PathBuf::from).unwrap_or_default();
            file.with_extension(extension).display().to_string()
        };
        let at = whole_file(source.name);
        let shown = |file: &str| Path::new(&*at.file).with_file_name(file).display().to_string();
        let view = named("vf");
        if let Some(text) = self.text_beside(root, &view, &at) {
            return views::of_file(&text, &shown(&view), &mut self.world).into_iter().collect();
        }
        let list = named("rif");
        match self.text_beside(root, &list, &at) {
            Some(text) => self.views(&variables(&shown(&list).into(), text.as_bytes()), root),
            None => Vec::new(),
        }
    }

    /// The text of a file in the folder of the scene, if there is one of just this name.
    fn text_beside(&mut self, root: Option<&Path>, file: &str, at: &Span) -> Option<String> {
        if root?.join(file).is_file() { self.text(root, file, at) } else { None }
    }

    /// The text of a file, if it can be read.
    fn text(&mut self, root: Option<&Path>, file: &str, at: &Span) -> Option<String> {
        let reading = &mut *self.world.reading;
        let path = reading.locator.locate(root, file, at).ok()?;
        let bytes = reading.load_text(&path).ok()?;
        let text = name_of(&bytes);
        reading.release(bytes);
        Some(text)
    }
}
