//! The files of a job: the scene, what it names, and what options name, copied to where every node can read them.

use crate::commands::shared::sandbox_paths::folder_of;
use anyhow::{Context, bail};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The files, by their names in the job's folder, with `/` between folders.
pub(super) struct Files {
    sources: BTreeMap<String, PathBuf>,
}

impl Files {
    /// Finds a name for every file: its path from the scene's folder, so that the scene's own references hold. A file that
    /// an option names may lie elsewhere.
    ///
    /// # Errors
    /// If a file that the scene names lies elsewhere, or if two files would have the same name.
    pub(super) fn of<'a>(
        scene: &'a Path,
        named: impl Iterator<Item = &'a Path>,
        given: &[&Path],
    ) -> anyhow::Result<Files> {
        let base = full(folder_of(scene))?;
        let mut files = Files { sources: BTreeMap::new() };
        for file in named.chain([scene]) {
            let full = full(file)?;
            let Ok(within) = full.strip_prefix(&base) else {
                bail!(
                    "{}: the scene names this file, which is not in its folder, so nodes would not find it: move it \
                     there",
                    file.display()
                );
            };
            files.add(within, full.clone())?;
        }
        for file in given {
            let full = full(file)?;
            let name = full.strip_prefix(&base).map_or(full.file_name().map(Path::new), Some);
            files.add(name.unwrap_or(file), full.clone())?;
        }
        Ok(files)
    }

    fn add(&mut self, name: &Path, source: PathBuf) -> anyhow::Result<()> {
        let parts: Vec<_> = name.iter().map(|part| part.to_string_lossy()).collect();
        let name = parts.join("/");
        if self.sources.get(&name).is_some_and(|other| *other != source) {
            bail!("{}: another file of the job is called '{name}' too: rename one of them", source.display());
        }
        self.sources.insert(name, source);
        Ok(())
    }

    /// The name of a file in the job's folder.
    ///
    /// # Errors
    /// If it is none of the job's files.
    pub(super) fn name_of(&self, file: &Path) -> anyhow::Result<String> {
        let full = full(file)?;
        let found = self.sources.iter().find(|(_, source)| **source == full);
        Ok(found.with_context(|| format!("{}: it is not part of the job", file.display()))?.0.clone())
    }

    /// Copies all files into a folder, and returns the number of their bytes.
    ///
    /// # Errors
    /// If one cannot be read or written.
    pub(super) fn copy_to(&self, folder: &Path) -> anyhow::Result<u64> {
        let mut bytes = 0;
        for (name, source) in &self.sources {
            let copy = folder.join(name);
            let copied = fs::create_dir_all(folder_of(&copy)).and_then(|()| fs::copy(source, &copy));
            bytes +=
                copied.with_context(|| format!("cannot copy {} to {}", source.display(), copy.display()))?;
        }
        Ok(bytes)
    }
}

fn full(path: &Path) -> anyhow::Result<PathBuf> {
    path.canonicalize().with_context(|| format!("{}: cannot open it", path.display()))
}
