//! The files of a scene, each read once.

use super::statement::{Statement, parse};
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_scene::Span;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Longer chains of files are refused, since each level uses some of the stack.
const MAX_CHAIN: usize = 32;

/// Bytes that count as held for a statement that stands somewhere once more, and for a command: a bound on how often that is.
const VISIT: u64 = 256;
const COMMAND: u64 = 1 << 15;

/// The files that are read.
pub(super) struct Files {
    known: HashMap<PathBuf, Rc<Text>>,
    /// Files by the folder and the name in it.
    named: HashMap<(Option<PathBuf>, Rc<str>), Rc<Text>>,
    /// The chain of files from the first to the current one.
    open: Vec<PathBuf>,
    /// The folder of the first file.
    root: Option<PathBuf>,
    /// Bytes that count as held for all visits.
    visited: u64,
}

/// The statements of a file, or of a program.
#[derive(Debug)]
pub(super) struct Text {
    pub(super) statements: Vec<Statement>,
    /// The folder that the names in it are relative to.
    pub(super) folder: Option<PathBuf>,
    path: Option<PathBuf>,
}

impl Text {
    /// Of the first file, or of what a program writes.
    pub(super) fn new(statements: Vec<Statement>, folder: Option<PathBuf>) -> Text {
        Text { statements, folder, path: None }
    }
}

impl Files {
    /// With the first file, by its full path if it has one.
    pub(super) fn new(first: Option<PathBuf>, root: Option<PathBuf>) -> Files {
        let open = vec![first.unwrap_or_default()];
        Files { known: HashMap::new(), named: HashMap::new(), open, root, visited: 0 }
    }

    /// A file that one in this folder names: relative to that folder, or else to that of the scene, where the programs would run.
    pub(super) fn find(
        &mut self,
        name: &Rc<str>,
        folder: Option<&Path>,
        at: &Span,
        reading: &mut Reading,
    ) -> Result<Rc<Text>, FormatError> {
        let key = (folder.map(Path::to_owned), name.clone());
        if let Some(known) = self.named.get(&key) {
            return Ok(known.clone());
        }
        let text = self.read(name, folder, at, reading)?;
        reading.budget.take_bytes(4 * (size_of_val(&key) + name.len()) as u64, &at.file)?;
        self.named.insert(key, text.clone());
        Ok(text)
    }

    fn read(
        &mut self,
        name: &str,
        folder: Option<&Path>,
        at: &Span,
        reading: &mut Reading,
    ) -> Result<Rc<Text>, FormatError> {
        let found = match reading.locator.locate(folder, name, at) {
            Err(FormatError::MissingFile { .. }) if folder != self.root.as_deref() => {
                reading.locator.locate(self.root.as_deref(), name, at)
            }
            found => found,
        };
        let path = found?;
        if let Some(known) = self.known.get(&path) {
            return Ok(known.clone());
        }
        let bytes = reading.load_text(&path)?;
        let shown = Path::new(&*at.file).with_file_name(name).display().to_string();
        let statements = parse(&shown.into(), &bytes, &mut reading.budget)?;
        reading.release(bytes);
        let folder = path.parent().map(Path::to_owned);
        let text = Rc::new(Text { statements, folder, path: Some(path.clone()) });
        self.known.insert(path, text.clone());
        Ok(text)
    }

    /// Begins a text, until [`Files::leave`].
    pub(super) fn enter(&mut self, text: &Text, at: &Span) -> Result<(), FormatError> {
        let path = text.path.clone().unwrap_or_default();
        if text.path.is_some() && self.open.contains(&path) {
            let message =
                format!("'{}' names itself, directly or through other files: remove it here", path.display());
            return Err(FormatError::malformed(message, at.clone()));
        }
        if self.open.len() > MAX_CHAIN {
            let message = format!("files are named more than {MAX_CHAIN} levels deep");
            return Err(FormatError::malformed(message, at.clone()));
        }
        self.open.push(path);
        Ok(())
    }

    pub(super) fn leave(&mut self) {
        self.open.pop();
    }

    /// Counts so many statements in one of their places. Arrays of arrays multiply.
    pub(super) fn visit(&mut self, count: u64, at: &Span, reading: &Reading) -> Result<(), FormatError> {
        self.charge(count.saturating_mul(VISIT), at, reading)
    }

    /// Counts a command in one of its places.
    pub(super) fn visit_command(&mut self, at: &Span, reading: &Reading) -> Result<(), FormatError> {
        self.charge(COMMAND, at, reading)
    }

    fn charge(&mut self, bytes: u64, at: &Span, reading: &Reading) -> Result<(), FormatError> {
        self.visited = self.visited.saturating_add(bytes);
        if self.visited > reading.options.max_memory {
            let message = "files and arrays multiply so much that reading would not end: remove some";
            return Err(FormatError::malformed(message, at.clone()));
        }
        Ok(())
    }
}
