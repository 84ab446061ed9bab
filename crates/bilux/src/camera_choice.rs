//! Which of a scene's cameras takes the picture.

use crate::Error;
use bilux_scene::{Camera, Scene, SceneError, Span};
use std::sync::Arc;

/// A camera by its name, or by its number from 0.
pub(crate) fn choose_camera(scene: &Scene, wanted: &str, at: &Span) -> Result<Arc<dyn Camera>, Error> {
    let cameras = scene.cameras();
    let by_name = cameras.iter().find(|(name, _)| name == wanted);
    let by_number = wanted.parse().ok().and_then(|i: usize| cameras.get(i));
    if let Some((_, camera)) = by_name.or(by_number) {
        return Ok(camera.clone());
    }
    let names: Vec<&str> = cameras.iter().map(|(name, _)| name.as_str()).filter(|n| !n.is_empty()).collect();
    if names.is_empty() || wanted.parse::<usize>().is_ok() {
        let message = format!(
            "there is no camera '{wanted}': this scene has {}, counted from 0{}",
            cameras.len(),
            if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) }
        );
        return Err(SceneError::invalid(message, at).into());
    }
    Err(SceneError::unknown("camera", wanted, names, at).into())
}
