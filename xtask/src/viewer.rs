//! `cargo xtask viewer`: drives `bilux serve` in a browser that is installed, and takes screenshots.

use crate::process::{cargo, root, run as run_process, target_folder};
use crate::python::{Environment, python};
use anyhow::{Context, Result};
use std::fs;
use std::process::Command;

/// Packages that drive browsers, of which they download none themselves, and that check that everybody can use the page.
const DRIVERS: &[&str] = &["playwright", "axe-playwright-python"];

/// The names of Chromium on various systems.
const BROWSERS: &[&str] = &["chromium", "chromium-browser", "google-chrome", "chrome"];

/// Tests the page. Skips that, and says so, where there is no Chromium or no Python.
pub(crate) fn run(_: &[String]) -> Result<()> {
    let Some(browser) = browser() else {
        println!("SKIPPED: the viewer is not tested in a browser: install Chromium");
        return Ok(());
    };
    let environment = match python().and_then(|python| Environment::new(&python, "viewer", DRIVERS, &[])) {
        Ok(environment) => environment,
        Err(error) => {
            println!("SKIPPED: the viewer is not tested in a browser: {error:#}");
            return Ok(());
        }
    };
    run_process(&mut cargo(&["build", "--quiet", "--locked", "--release", "-p", "bilux-cli"]))?;
    let folder = target_folder().join("viewer");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let mut test = environment.python();
    test.arg(root().join("crates/viewer/tests/browser.py"));
    run_process(test.arg(target_folder().join("release/bilux")).arg(browser).arg(&folder))
}

/// The path of an installed Chromium.
fn browser() -> Option<String> {
    let folders = std::env::var_os("PATH")?;
    let folders: Vec<_> = std::env::split_paths(&folders).collect();
    let found = BROWSERS.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let found = found.into_iter().find(|path| path.is_file())?;
    let answers = Command::new(&found).arg("--version").output().is_ok_and(|said| said.status.success());
    answers.then(|| found.to_string_lossy().into_owned())
}
