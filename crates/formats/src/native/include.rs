//! Collects a file and the files that it includes.

use super::document::{BYTES_PER_BYTE, Item, Table, TomlValue, parse};
use bilux_import::FormatError;
use bilux_import::input::reading::{Reading, Source};
use bilux_scene::Span;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A parsed file.
pub(super) struct Part {
    pub(super) root: Table,
    pub(super) folder: Option<PathBuf>,
}

/// The parts of a scene: included files before those that include them, each file once.
pub(super) fn gather(reading: &mut Reading, source: &Source) -> Result<Vec<Part>, FormatError> {
    let mut gathering = Gathering { reading, parts: Vec::new(), seen: HashSet::new(), open: Vec::new() };
    gathering.add(source.bytes, source.name, source.folder)?;
    Ok(gathering.parts)
}

struct Gathering<'o, 'r> {
    reading: &'r mut Reading<'o>,
    parts: Vec<Part>,
    seen: HashSet<PathBuf>,
    /// The chain of includes, from the first file to the current one.
    open: Vec<PathBuf>,
}

/// Longer chains of includes are refused, since each level uses some of the stack.
const MAX_CHAIN: usize = 32;

impl Gathering<'_, '_> {
    fn add(&mut self, bytes: &[u8], name: &Arc<str>, folder: Option<&Path>) -> Result<(), FormatError> {
        self.reading.budget.take_bytes(bytes.len() as u64 * BYTES_PER_BYTE, name)?;
        let root = parse(bytes, name)?;
        let own = folder.zip(Path::new(&**name).file_name());
        let own = own.and_then(|(folder, file)| std::fs::canonicalize(folder.join(file)).ok());
        self.open.push(own.unwrap_or_default());
        if let Some(list) = root.find("include") {
            for item in list.list("include", "a list of files, as in include = [\"lights.toml\"]")? {
                self.include(item.text("include")?, &item.at, name, folder)?;
            }
        }
        self.open.pop();
        self.parts.push(Part { root, folder: folder.map(Path::to_owned) });
        Ok(())
    }

    fn include(
        &mut self,
        file: &str,
        at: &Span,
        from: &Arc<str>,
        folder: Option<&Path>,
    ) -> Result<(), FormatError> {
        let path = self.reading.locator.locate(folder, file, at)?;
        if self.open.contains(&path) {
            let message =
                format!("'{file}' includes itself, directly or through other files: remove it here");
            return Err(FormatError::malformed(message, at.clone()));
        }
        if self.open.len() >= MAX_CHAIN {
            let message = format!("files are included more than {MAX_CHAIN} levels deep");
            return Err(FormatError::malformed(message, at.clone()));
        }
        if !self.seen.insert(path.clone()) {
            return Ok(());
        }
        if is_of_another_format(file) {
            self.parts.push(Part { root: as_model(file, at), folder: folder.map(Path::to_owned) });
            return Ok(());
        }
        let bytes = self.reading.load_text(&path)?;
        let shown = Path::new(&**from).with_file_name(file).display().to_string();
        self.add(&bytes, &shown.into(), path.parent())?;
        self.reading.release(bytes);
        Ok(())
    }
}

fn is_of_another_format(file: &str) -> bool {
    let extension = Path::new(file).extension().map(|extension| extension.to_string_lossy().into_owned());
    extension
        .and_then(|extension| crate::format_named(&extension))
        .is_some_and(|row| row.entry.name != "toml")
}

/// Wraps a scene of another format as the only model of a part, with its lights and cameras.
fn as_model(file: &str, at: &Span) -> Table {
    let entry = |key: &str, node: TomlValue| (key.to_owned(), at.clone(), Item { node, at: at.clone() });
    let list = |nodes: Vec<TomlValue>| {
        TomlValue::List(nodes.into_iter().map(|node| Item { node, at: at.clone() }).collect())
    };
    let text = |text: &str| TomlValue::Text(text.to_owned());
    let with = list(vec![text("lights"), text("cameras")]);
    let model = Table { entries: vec![entry("file", text(file)), entry("with", with)], at: at.clone() };
    Table { entries: vec![entry("model", list(vec![TomlValue::Table(model)]))], at: at.clone() }
}
