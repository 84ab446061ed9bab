//! Wrong inputs and command lines, each with the complete answer: `command_lines.txt` and `files.txt` hold what is
//! printed for every row of the tables next to them. Each answer must say what is wrong, where, and what to do about
//! it, and must read well aloud.
//!
//! After an intended change, `BILUX_WRITE_MESSAGES=1 cargo test -p bilux-cli --test suite wrong_inputs` rewrites the texts;
//! read what has changed before you commit it.

mod command_lines;
mod files;

use assert_cmd::Command;
use std::fmt::Write;
use std::path::Path;
use tempfile::TempDir;

/// One wrong input or command line.
struct Case {
    /// The fault, in a few words.
    name: &'static str,
    /// Files that the case needs besides `triangle.obj`, which is always there.
    files: &'static [(&'static str, &'static [u8])],
    /// The bytes on standard input.
    input: &'static [u8],
    /// The command line without `bilux`, its words separated by spaces.
    command: &'static str,
    /// The expected exit status.
    status: i32,
}

impl Case {
    /// A case without files of its own.
    const fn command(name: &'static str, status: i32, command: &'static str) -> Case {
        Case { name, files: &[], input: b"", command, status }
    }

    /// A case with files of its own, which the command uses.
    const fn file(
        name: &'static str,
        status: i32,
        files: &'static [(&'static str, &'static [u8])],
        command: &'static str,
    ) -> Case {
        Case { name, files, input: b"", command, status }
    }

    /// Runs the case in a folder of its own and returns its section of the text.
    fn run(&self) -> String {
        let folder = TempDir::new().unwrap();
        let path = folder.path();
        std::fs::write(path.join("triangle.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        for (name, bytes) in self.files {
            let file = path.join(name);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, bytes).unwrap();
        }
        let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
        command.current_dir(path).env("NO_COLOR", "1").env("OIDN_LIB", "nowhere").write_stdin(self.input);
        let output = command.args(self.command.split_whitespace()).output().unwrap();
        let said = String::from_utf8(output.stderr).expect("messages are text");
        let said = said.replace(&path.canonicalize().unwrap().display().to_string(), "FOLDER");
        let said = said.replace(&path.display().to_string(), "FOLDER");
        self.check(path, output.status.code(), &said, &output.stdout);
        format!("## {}\n$ bilux {}\n{}\n", self.name, self.command, said.trim_end())
    }

    /// Checks what must hold for every answer.
    fn check(&self, folder: &Path, status: Option<i32>, said: &str, result: &[u8]) {
        let name = self.name;
        assert_eq!(status, Some(self.status), "{name}: {said}");
        assert!(!said.is_empty(), "{name}: nothing is said");
        assert!(self.status == 0 || said.contains("error: "), "{name}: {said}");
        assert!(self.status == 0 || !folder.join("out.png").exists(), "{name}: a picture is written");
        assert!(self.status == 0 || result.is_empty(), "{name}: an error prints a result");
        for raw in RAW {
            assert!(!said.contains(raw), "{name}: '{raw}' means nothing to a user, in: {said}");
        }
    }
}

/// Texts that no message may contain: values as Rust prints them, and NaN.
const RAW: &[&str] =
    &["Some(", "Err(", "None,", "Utf8Error", "os error", "panicked", " { ", "::", "NaN", "\u{1b}", "\\u{"];

/// Compares a table with the text next to it.
fn check_table(cases: &[Case], text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/wrong_inputs").join(text);
    let mut now = String::new();
    for case in cases {
        assert_eq!(cases.iter().filter(|other| other.name == case.name).count(), 1, "twice: {}", case.name);
        writeln!(now, "{}", case.run()).unwrap();
    }
    if std::env::var_os("BILUX_WRITE_MESSAGES").is_some() {
        std::fs::write(&path, &now).unwrap();
        return;
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    let sections = |text: &str| -> Vec<String> { text.split("\n## ").map(str::to_owned).collect() };
    for section in sections(&now) {
        let title = section.lines().next().unwrap_or_default().trim_start_matches("## ").to_owned();
        assert!(
            sections(&kept).iter().any(|other| other.trim() == section.trim()),
            "{text} says otherwise of '{title}'; now it is:\n{section}"
        );
    }
    assert_eq!(sections(&kept).len(), sections(&now).len(), "{text} has cases that are not in the table");
}

#[test]
fn wrong_command_lines_give_the_recorded_messages() {
    check_table(command_lines::CASES, "command_lines.txt");
}

#[test]
fn wrong_files_give_the_recorded_messages() {
    check_table(files::CASES, "files.txt");
}
