//! The input of the rules: every text file that belongs to the repository, and the workspace's packages.

use super::rust_text::RustText;
use crate::process::root;
use crate::workspace::{Package, packages};
use anyhow::{Context, Result};
use std::fs;
use std::path::Path;

/// Files longer than this are data, not text for people.
const LONGEST_TEXT: u64 = 1 << 20;

/// The repository, in memory, so that tests can plant whatever they like.
#[derive(Default)]
pub(crate) struct Repository {
    pub(crate) files: Vec<TextFile>,
    pub(crate) packages: Vec<Package>,
}

/// One file.
pub(crate) struct TextFile {
    /// The path from the root of the repository, with `/` between folders.
    pub(crate) path: String,
    pub(crate) text: String,
    /// Code and comments separated, if it is Rust.
    pub(crate) rust: Option<RustText>,
}

impl TextFile {
    pub(crate) fn new(path: &str, text: &str) -> TextFile {
        let rust = path.ends_with(".rs").then(|| RustText::new(text));
        TextFile { path: path.to_owned(), text: text.to_owned(), rust }
    }

    /// Whether the whole file is tests.
    pub(crate) fn is_test(&self) -> bool {
        self.path.ends_with("/tests.rs") || self.path.split('/').any(|part| part == "tests")
    }

    /// Number of lines before the file's tests.
    pub(crate) fn lines_before_tests(&self) -> usize {
        let lines = || self.text.lines();
        lines().position(|line| line == "#[cfg(test)]").unwrap_or_else(|| lines().count())
    }
}

impl Repository {
    /// Reads what is on disk, except what `.gitignore` names.
    pub(crate) fn read() -> Result<Repository> {
        let root = root();
        let ignored = fs::read_to_string(root.join(".gitignore")).unwrap_or_default();
        let mut files = Vec::new();
        walk(&root, "", &ignored, &mut files)?;
        Ok(Repository { files, packages: packages()? })
    }

    /// The file at a path.
    pub(crate) fn file(&self, path: &str) -> Option<&TextFile> {
        self.files.iter().find(|file| file.path == path)
    }

    /// Every Rust file.
    pub(crate) fn rust(&self) -> impl Iterator<Item = (&TextFile, &RustText)> {
        self.files.iter().filter_map(|file| Some((file, file.rust.as_ref()?)))
    }

    #[cfg(test)]
    pub(crate) fn planted(files: &[(&str, &str)]) -> Repository {
        let files = files.iter().map(|(path, text)| TextFile::new(path, text)).collect();
        Repository { files, packages: Vec::new() }
    }
}

fn walk(root: &Path, folder: &str, ignored: &str, files: &mut Vec<TextFile>) -> Result<()> {
    let listing = fs::read_dir(root.join(folder)).with_context(|| format!("cannot list '{folder}'"))?;
    let mut entries: Vec<_> = listing.collect::<Result<_, _>>()?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let Ok(name) = entry.file_name().into_string() else { continue };
        let path = if folder.is_empty() { name.clone() } else { format!("{folder}/{name}") };
        let hidden = name.starts_with('.') && ![".ci", ".cargo"].contains(&name.as_str());
        if hidden || is_ignored(&path, ignored) {
            continue;
        }
        let kind = entry.file_type()?;
        if kind.is_dir() {
            walk(root, &path, ignored, files)?;
        } else if kind.is_file() && entry.metadata()?.len() <= LONGEST_TEXT {
            let bytes = fs::read(entry.path()).with_context(|| format!("cannot read '{path}'"))?;
            files.extend(String::from_utf8(bytes).ok().map(|text| TextFile::new(&path, &text)));
        }
    }
    Ok(())
}

/// Supports as much of `.gitignore` as ours uses: `/path` from the root, `*ending` anywhere.
fn is_ignored(path: &str, ignored: &str) -> bool {
    ignored.lines().any(|pattern| match (pattern.strip_prefix('/'), pattern.strip_prefix('*')) {
        (Some(anchored), _) => path == anchored.trim_end_matches('/'),
        (_, Some(ending)) => path.ends_with(ending),
        _ => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ignored_paths_are_left_out() {
        let ignored = "/target\n/fuzz/target\n*.profraw\n";
        assert!(is_ignored("target", ignored) && is_ignored("fuzz/target", ignored));
        assert!(is_ignored("crates/a/x.profraw", ignored));
        assert!(!is_ignored("crates/target", ignored) && !is_ignored("targets", ignored));
    }
}
