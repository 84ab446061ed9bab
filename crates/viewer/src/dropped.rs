//! Files that people drop into the page. They lie in a temporary folder, which goes when they are not shown any more.

use bilux::formats::format_named;
use std::fs::File;
use std::io::{self, Write};
use std::path::PathBuf;
use tempfile::TempDir;
use tokio::sync::oneshot;

/// The maximum length of a file, in bytes.
pub(crate) const LARGEST: u64 = 512 << 20;

/// The maximum length of a name.
const LONGEST_NAME: usize = 100;

/// A file that is kept.
#[derive(Debug)]
pub(crate) struct Kept {
    folder: TempDir,
    /// The name of the file.
    pub(crate) name: String,
}

impl Kept {
    /// Path of the file.
    pub(crate) fn path(&self) -> PathBuf {
        self.folder.path().join(&self.name)
    }
}

/// A file that is to be opened.
pub(crate) struct Dropped {
    /// The file.
    pub(crate) file: Kept,
    /// The channel on which it is said whether that worked.
    pub(crate) to: oneshot::Sender<Result<(), String>>,
}

/// A file that comes in, piece by piece.
pub(crate) struct Incoming {
    kept: Kept,
    to: File,
    length: u64,
}

impl Incoming {
    /// A file with the name that a browser says.
    ///
    /// # Errors
    /// If it is no scene by its name, or the system has no temporary folder.
    pub(crate) fn named(name: &str) -> Result<Incoming, String> {
        let name = plain(name)?;
        let failed = |error: io::Error| format!("{name} cannot be kept: {error}");
        let folder = tempfile::Builder::new().prefix("bilux-").tempdir().map_err(failed)?;
        let to = File::create_new(folder.path().join(&name)).map_err(failed)?;
        Ok(Incoming { kept: Kept { folder, name }, to, length: 0 })
    }

    /// Adds a piece.
    ///
    /// # Errors
    /// If the file is too large, or the disk is full.
    pub(crate) fn add(&mut self, bytes: &[u8]) -> Result<(), String> {
        let name = &self.kept.name;
        self.length += bytes.len() as u64;
        if self.length > LARGEST {
            let most = LARGEST >> 20;
            return Err(format!("{name} is larger than {most} MiB: open it with `bilux serve` instead"));
        }
        self.to.write_all(bytes).map_err(|error| format!("{name} cannot be kept: {error}"))
    }

    /// The whole file.
    pub(crate) fn whole(self) -> Kept {
        self.kept
    }
}

/// A name without folders and without anything that a file system could take for something else; its extension is that
/// of a scene.
fn plain(name: &str) -> Result<String, String> {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let name: String = last.chars().map(|c| if is_plain(c) { c } else { '-' }).collect();
    let name = name.trim_start_matches('.');
    let reads = |extension: &str| format_named(extension).is_some_and(|row| row.reads());
    match name.rsplit_once('.') {
        Some((stem, extension)) if !stem.is_empty() && reads(extension) && name.len() <= LONGEST_NAME => {
            Ok(name.to_owned())
        }
        _ => Err(format!("'{name}' is no scene by its name: drop a file such as model.glb in")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_their_folder_and_are_those_of_scenes() {
        for (name, kept) in [
            ("model.glb", "model.glb"),
            ("../../etc/pot.obj", "pot.obj"),
            ("C:\\models\\my pot.STL", "my-pot.STL"),
            ("..\u{0}.ply", "-.ply"),
        ] {
            assert_eq!(plain(name).as_deref(), Ok(kept));
        }
        for name in
            ["", ".glb", "..", "passwd", "run.sh", "picture.png", "a/", &format!("{}.glb", "x".repeat(101))]
        {
            assert!(plain(name).is_err(), "{name}");
        }
    }

    #[test]
    fn a_file_goes_with_its_folder() {
        let mut incoming = Incoming::named("a.obj").unwrap();
        incoming.add(b"v 0 0").unwrap();
        incoming.add(b" 0").unwrap();
        let kept = incoming.whole();
        let path = kept.path();
        assert_eq!(std::fs::read(&path).unwrap(), b"v 0 0 0");
        drop(kept);
        assert!(!path.exists() && !path.parent().unwrap().exists());
        let mut incoming = Incoming::named("a.obj").unwrap();
        incoming.length = LARGEST;
        assert!(incoming.add(b"x").unwrap_err().contains("larger than"));
    }
}
