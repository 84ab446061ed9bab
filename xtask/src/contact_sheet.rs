//! `cargo xtask contact-sheet [MODELS [OUT]]`: our pictures of models next to the screenshots that come with them.

use crate::process::{cargo, root, run as run_process, target_folder};
use anyhow::{Result, bail};
use std::path::PathBuf;

/// Renders every model and puts the pictures on one sheet; further arguments are passed to the example that does it.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let is_folder = |argument: &&String| !argument.starts_with("--");
    let given: Vec<&String> = arguments.iter().take_while(is_folder).collect();
    let models = given.first().map_or_else(|| root().join("../shared/scenes/gltf"), PathBuf::from);
    if !models.is_dir() {
        bail!("there is no folder {}: name one of models, each with its screenshot", models.display());
    }
    let out = given.get(1).map_or_else(|| target_folder().join("contact-sheet"), PathBuf::from);
    let example =
        ["run", "--locked", "--release", "--package", "bilux-validation", "--example", "contact_sheet", "--"];
    let mut command = cargo(&example);
    run_process(command.arg(models).arg(out).args(&arguments[given.len()..]))
}
