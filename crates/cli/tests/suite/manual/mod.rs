//! Every command of the manual works: those in blocks of `sh` and `console`, and whole commands within the text.
//!
//! The commands of a page run in order, in a folder of their own that contains `scenes/`. `bilux` is the program that was
//! built with the tests, behind a script ([`bilux.sh`](bilux.sh)) that lowers sizes, samples and limits of time, so that
//! all pages take less than a minute; `cargo run --release --` is the same. What cannot run here, for want of a network, a
//! scheduler or time, says so in a comment on its page ([`page`]), and the test lists it.
#![cfg(unix)]

mod page;

use page::{Action, steps};
use std::fs;
use std::io::Write;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use tempfile::TempDir;

/// Pages about their day: what a command was then is not promised to last.
const RECORDS: &[&str] = &["docs/adr/", "CHANGELOG.md"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Outcome of a page's commands.
#[derive(Default)]
struct Outcome {
    run: usize,
    skipped: Vec<String>,
    failures: Vec<String>,
}

/// A folder with the stand-ins for `bilux` and `cargo`.
fn stand_ins() -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, script) in [("bilux", include_str!("bilux.sh")), ("cargo", include_str!("cargo.sh"))] {
        let path = folder.path().join(name);
        fs::write(&path, script).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    }
    folder
}

/// Does what a page says.
fn follow(name: &str, markdown: &str, stand_ins: &Path) -> Outcome {
    let folder = TempDir::new().unwrap();
    symlink(root().join("scenes"), folder.path().join("scenes")).unwrap();
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", stand_ins.display());
    let mut outcome = Outcome::default();
    for step in steps(markdown) {
        let place = format!("{name}:{}", step.line);
        match step.action {
            Action::Write { name, text } => fs::write(folder.path().join(name), text).unwrap(),
            Action::Skip { script, reason } => {
                outcome.skipped.push(format!("{place}: {reason}: {}", script.trim().replace('\n', "; ")));
            }
            Action::Run { script, status } => {
                let mut command = Command::new("sh");
                command.args(["-euc", &script]).current_dir(folder.path());
                command.env("PATH", &path).env("BILUX", env!("CARGO_BIN_EXE_bilux"));
                let output = command.output().unwrap();
                outcome.run += 1;
                if output.status.code() != Some(status) {
                    let said = String::from_utf8_lossy(&output.stderr);
                    outcome.failures.push(format!("{place}: {} of\n{script}{said}", output.status));
                }
            }
        }
    }
    outcome
}

/// The pages of the manual, from the root of the repository.
fn pages() -> Vec<String> {
    let summary = fs::read_to_string(root().join("docs/SUMMARY.md")).unwrap();
    let links = summary.lines().filter_map(|line| line.split_once("](")?.1.strip_suffix(')'));
    let paths = links.map(|link| link.strip_prefix("../").map_or(format!("docs/{link}"), str::to_owned));
    paths.filter(|path| !RECORDS.iter().any(|records| path.starts_with(records))).collect()
}

#[test]
fn every_command_of_the_manual_works() {
    let stand_ins = stand_ins();
    let pages = Mutex::new(pages());
    let all = Mutex::new(Outcome::default());
    let work = || {
        while let Some(name) = { pages.lock().unwrap().pop() } {
            let markdown = fs::read_to_string(root().join(&name)).unwrap();
            let outcome = follow(&name, &markdown, stand_ins.path());
            let mut all = all.lock().unwrap();
            all.run += outcome.run;
            all.skipped.extend(outcome.skipped);
            all.failures.extend(outcome.failures);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let Outcome { run, skipped, failures } = all.into_inner().unwrap();
    // Written so that it is seen when the test passes, too.
    let mut report = format!("the manual: {run} blocks and commands run, {} skipped\n", skipped.len());
    report.extend(skipped.iter().map(|line| format!("SKIPPED: {line}\n")));
    std::io::stderr().write_all(report.as_bytes()).unwrap();
    assert!(run > 60, "only {run} commands were found");
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}

#[test]
fn planted_mistakes_are_noticed() {
    let stand_ins = stand_ins();
    let mistakes = [
        "```sh\nbilux generate teapot -o pot.obj\nbilux rendr pot.obj -o pot.png\n```\n",
        "```sh\nbilux generate teapot -o pot.obj\nbilux info pott.obj\nbilux info pot.obj\n```\n",
        "```sh\nbilux generate teapot -o pot.obj\nbilux render pot.obj -o pot.png --ground shadw\n```\n",
        "As in `bilux list integrator --json`.\n",
        "<!-- test: fails with 1 -->\n```sh\nbilux list integrators\n```\n",
        "<!-- test: save as s.toml -->\n```toml\n[[light]]\nkind = \"rekt\"\n```\n```sh\nbilux info s.toml\n```\n",
    ];
    for mistake in mistakes {
        let outcome = follow("page", mistake, stand_ins.path());
        assert_eq!(outcome.failures.len(), 1, "{mistake}");
    }
    let right = mistakes[0].replace("rendr", "render");
    assert!(follow("page", &right, stand_ins.path()).failures.is_empty());
}
