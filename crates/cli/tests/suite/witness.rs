//! If Mitsuba 3's Python package is installed, it renders the same boxes for comparison: `witness/cornell.py`.
#![allow(clippy::print_stderr, reason = "a test that skips says so")]

use std::process::Command;

/// `python3`, or the interpreter that `$BILUX_PYTHON` names.
fn python() -> Command {
    Command::new(std::env::var_os("BILUX_PYTHON").unwrap_or_else(|| "python3".into()))
}

fn agrees(options: &[&str]) -> bool {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/suite/witness/cornell.py");
    let status = python().args([script, env!("CARGO_BIN_EXE_bilux"), "--seeds", "6"]).args(options).status();
    status.unwrap().success()
}

#[test]
fn mitsuba_renders_the_same_cornell_boxes() {
    let found = python().args(["-c", "import mitsuba, numpy"]).output();
    if !found.is_ok_and(|output| output.status.success()) {
        eprintln!(
            "skipped: `pip install mitsuba numpy`, and name the interpreter in $BILUX_PYTHON if need be"
        );
        return;
    }
    assert!(agrees(&["--spp", "64", "--integrators", "path,bdpt,vcm"]));
    assert!(!agrees(&["--spp", "64", "--integrators", "path", "--brighten", "1.05"]), "a bug of 5% passes");
}
