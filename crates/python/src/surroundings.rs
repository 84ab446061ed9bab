//! `Scene.surround`: what lights a scene from all around.

use crate::errors::exception;
use bilux::formats::ReadOptions;
use bilux::scene::{SceneBuilder, Warning};
use pyo3::prelude::*;
use std::path::Path;

/// Surrounds a scene with what a name or a picture says; returns what is wrong with the picture.
pub(crate) fn surround(
    scene: &mut SceneBuilder,
    around: &Path,
    layer: Option<String>,
) -> PyResult<Vec<Warning>> {
    let options = ReadOptions { allow_outside: true, picture_layer: layer, ..ReadOptions::default() };
    let before = scene.warnings.len();
    bilux::presets::surround(scene, around, &options).map_err(exception)?;
    Ok(scene.warnings[before..].to_vec())
}
