//! If Mitsuba 3's Python package is installed, it renders the same boxes for comparison: `witness/cornell.py`; and the scenes of others,
//! if a folder of them is named: `witness/scenes.py`. The boxes take more than ten minutes and say little about a change, so they
//! run in the long form of the suites, and if they are named: `cargo test -p bilux-cli --test suite witness`.
//! `witness/smallvcm.py`, which no test starts, compares means and errors with SmallVCM.
//!
//! `BILUX_MITSUBA=FOLDER cargo test -p bilux-cli --test suite scenes_of_mitsuba -- --nocapture` prints a table of them, and
//! `BILUX_RADIANCE=FOLDER cargo test -p bilux-cli --test suite scenes_of_radiance -- --nocapture` one of scenes of Radiance, if the Python
//! package `pyradiance` is installed: `witness/radiance.py`.
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

/// Whether the witness was asked for, and is there; if not, says how to have it.
fn is_wanted() -> bool {
    // `cargo xtask test` names every test.
    let is_whole = std::env::var_os("BILUX_WHOLE").is_some();
    let is_named = std::env::args().skip(1).any(|word| word.contains("witness") || word.contains("mitsuba"));
    if std::env::var_os("BILUX_LONG").is_none() && (is_whole || !is_named) {
        eprintln!(
            "skipped: Mitsuba is asked with `--long` and by `cargo test -p bilux-cli --test suite witness`"
        );
        return false;
    }
    has_mitsuba()
}

/// Whether Mitsuba is there; if not, says how to install it.
fn has_mitsuba() -> bool {
    let found = python().args(["-c", "import mitsuba, numpy"]).output();
    let found = found.is_ok_and(|output| output.status.success());
    if !found {
        eprintln!(
            "skipped: `pip install mitsuba numpy`, and name the interpreter in $BILUX_PYTHON if need be"
        );
    }
    found
}

#[test]
fn scenes_of_mitsuba_are_as_bright_as_there() {
    let Some(folder) = std::env::var_os("BILUX_MITSUBA") else {
        eprintln!("skipped: BILUX_MITSUBA does not name a folder of scenes");
        return;
    };
    if has_mitsuba() {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/suite/witness/scenes.py");
        let status = python().args([script, env!("CARGO_BIN_EXE_bilux")]).arg(folder).status();
        assert!(status.unwrap().success());
    }
}

#[test]
fn scenes_of_radiance_are_as_bright_as_there() {
    let Some(folder) = std::env::var_os("BILUX_RADIANCE") else {
        eprintln!("skipped: BILUX_RADIANCE does not name a folder of scenes");
        return;
    };
    let found = python().args(["-c", "import pyradiance, numpy"]).output();
    if !found.is_ok_and(|output| output.status.success()) {
        eprintln!(
            "skipped: `pip install pyradiance numpy`, and name the interpreter in $BILUX_PYTHON if need be"
        );
        return;
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/suite/witness/radiance.py");
    let status = python().args([script, env!("CARGO_BIN_EXE_bilux")]).arg(folder).status();
    assert!(status.unwrap().success());
}

#[test]
fn mitsuba_renders_the_same_cornell_boxes() {
    if !is_wanted() {
        return;
    }
    assert!(agrees(&["--spp", "64", "--integrators", "path,bdpt,vcm"]));
    assert!(!agrees(&["--spp", "64", "--integrators", "path", "--brighten", "1.05"]), "a bug of 5% passes");
}

#[test]
fn mitsuba_renders_what_is_written_for_it() {
    if !is_wanted() {
        return;
    }
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/suite/witness/written.py");
    let agrees = |options: &[&str]| {
        let status = python().args([script, env!("CARGO_BIN_EXE_bilux")]).args(options).status();
        status.unwrap().success()
    };
    assert!(agrees(&[]));
    assert!(!agrees(&["--brighten", "1.05"]), "a bug of 5% passes");
}
