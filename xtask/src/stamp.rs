//! Inputs with which a check has passed, so that it need not run again before something of them changes.

use crate::process::target_folder;
use anyhow::{Context, Result};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// The inputs of a check, as a hash, and where that of the last success is kept.
pub(crate) struct Stamp {
    path: PathBuf,
    hash: String,
}

impl Stamp {
    /// The stamp of a check by its name; its inputs are files and folders.
    pub(crate) fn new(name: &str, inputs: &[PathBuf]) -> Result<Stamp> {
        let mut hasher = Sha256::new();
        inputs.iter().try_for_each(|input| add(input, &mut hasher))?;
        let mut hash = String::new();
        hasher.finalize().iter().try_for_each(|byte| write!(hash, "{byte:02x}"))?;
        Ok(Stamp { path: target_folder().join("stamps").join(name), hash })
    }

    /// Whether the check has passed with these inputs.
    pub(crate) fn is_fresh(&self) -> bool {
        fs::read_to_string(&self.path).is_ok_and(|hash| hash == self.hash)
    }

    /// Remembers that it has.
    pub(crate) fn write(&self) -> Result<()> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
        fs::write(&self.path, &self.hash).with_context(|| format!("cannot write {}", self.path.display()))
    }
}

/// Adds the names and the bytes of files; what Python has compiled is none of them.
fn add(path: &Path, hasher: &mut Sha256) -> Result<()> {
    if path.ends_with("__pycache__") {
        return Ok(());
    }
    let what = || format!("cannot read {}", path.display());
    hasher.update(path.as_os_str().as_encoded_bytes());
    if path.is_dir() {
        let entries = fs::read_dir(path).with_context(what)?;
        let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
        paths.sort();
        return paths.iter().try_for_each(|path| add(path, hasher));
    }
    let bytes = fs::read(path).with_context(what)?;
    hasher.update(bytes.len().to_le_bytes());
    hasher.update(bytes);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_makes_a_stamp_old() {
        let folder = target_folder().join("tmp").join(format!("stamp-{}", std::process::id()));
        fs::create_dir_all(folder.join("sub/__pycache__")).unwrap();
        fs::write(folder.join("sub/a"), "1").unwrap();
        let name = format!("test-{}", std::process::id());
        let stamp = || Stamp::new(&name, std::slice::from_ref(&folder)).unwrap();
        assert!(!stamp().is_fresh());
        stamp().write().unwrap();
        fs::write(folder.join("sub/__pycache__/a"), "1").unwrap();
        assert!(stamp().is_fresh());
        fs::write(folder.join("sub/a"), "2").unwrap();
        assert!(!stamp().is_fresh());
        stamp().write().unwrap();
        fs::rename(folder.join("sub/a"), folder.join("sub/b")).unwrap();
        assert!(!stamp().is_fresh());
        fs::remove_file(&stamp().path).unwrap();
        fs::remove_dir_all(&folder).unwrap();
        assert!(Stamp::new(&name, &[folder]).is_err());
    }
}
