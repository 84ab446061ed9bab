//! Test scenes for the integrators: built-in scenes, and the user's own files.

use super::options::Options;
use super::reference::{Reference, ReferenceOptions, make_reference};
use super::scenes::{chosen_scenes, generated};
use crate::ProgressFn;
use bilux::Error;
use bilux::gallery::GENERATORS;
use bilux::scene::SceneBuilder;
use std::path::Path;

/// A scene to measure on, and its expected picture.
pub(super) struct TestScene {
    pub(super) name: String,
    pub(super) summary: String,
    pub(super) scene: SceneBuilder,
    pub(super) reference: Reference,
}

/// All scenes that were asked for. The references of files are made here.
pub(super) fn test_scenes(options: &Options, progress: ProgressFn) -> Result<Vec<TestScene>, Error> {
    let shipped = if options.scenes.is_empty() && !options.files.is_empty() {
        Vec::new()
    } else {
        chosen_scenes(&options.scenes)?
    };
    let mut test_scenes =
        shipped.iter().map(|(name, bytes)| of_ours(name, bytes)).collect::<Result<Vec<_>, _>>()?;
    for file in &options.files {
        test_scenes.push(of_the_user(file, options, progress)?);
    }
    Ok(test_scenes)
}

fn of_ours(name: &str, bytes: &[u8]) -> Result<TestScene, Error> {
    let entry = GENERATORS.iter().find(|row| row.entry.name == name);
    Ok(TestScene {
        name: name.to_owned(),
        summary: entry.map_or("", |row| row.entry.summary).to_owned(),
        scene: generated(name)?,
        reference: Reference::read(bytes)?,
    })
}

fn of_the_user(file: &Path, options: &Options, progress: ProgressFn) -> Result<TestScene, Error> {
    let scene = bilux::load(file, &options.read)?;
    let making = ReferenceOptions {
        folder: Default::default(),
        scenes: Vec::new(),
        seconds: options.reference_seconds,
        threads: options.threads,
    };
    let (made, p) = make_reference(&file.display().to_string(), &scene, &making, progress)?;
    let summary = match p {
        // The pictures are averaged all the same; the user must know that the errors below are uncertain.
        Some(p) => format!("the two integrators of the reference disagree (least p {p:.1e})"),
        None => "a file".to_owned(),
    };
    Ok(TestScene { name: file.display().to_string(), summary, scene, reference: made })
}
