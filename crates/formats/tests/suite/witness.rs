//! Other programs as witnesses: files below a folder, and what a script of a witness says of them.

use crate::shared_files::files;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Every file below a folder with one of these extensions, sorted.
pub(crate) fn files_below(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    files(folder, &mut found);
    let is_one = |ending: &OsStr| extensions.iter().any(|known| ending.eq_ignore_ascii_case(known));
    found.retain(|path| path.extension().is_some_and(is_one));
    found.sort();
    found
}

/// Output of a script beside this file, run by a Python with the names of files, one per line.
pub(crate) fn said(script: &str, files: &[PathBuf], python: &OsStr) -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite").join(script);
    let mut child = Command::new(python)
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let list: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    child.stdin.take().unwrap().write_all(list.join("\n").as_bytes()).unwrap();
    String::from_utf8_lossy(&child.wait_with_output().unwrap().stdout).into_owned()
}
