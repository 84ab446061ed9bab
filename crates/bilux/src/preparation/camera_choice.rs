//! Which of a scene's cameras takes the picture.

use crate::Error;
use bilux_scene::error::nearest_name;
use bilux_scene::{Camera, Scene, SceneError, Span};
use std::sync::Arc;

/// Finds a camera by its name, or by its number from 0.
pub(crate) fn choose_camera(scene: &Scene, wanted: &str, at: &Span) -> Result<Arc<dyn Camera>, Error> {
    let cameras = scene.cameras();
    let by_name = cameras.iter().find(|(name, _)| name == wanted);
    let by_number = wanted.parse().ok().and_then(|i: usize| cameras.get(i));
    if let Some((_, camera)) = by_name.or(by_number) {
        return Ok(camera.clone());
    }
    let names: Vec<&str> = cameras.iter().map(|(name, _)| name.as_str()).filter(|n| !n.is_empty()).collect();
    let near = nearest_name(wanted, &names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>());
    if near.is_none() || wanted.parse::<usize>().is_ok() {
        let known = cameras.iter().enumerate().map(|(i, (name, _))| match name.as_str() {
            "" => i.to_string(),
            name => format!("{i} ({name})"),
        });
        let known: Vec<String> = known.collect();
        let message = match known.as_slice() {
            [one] => format!("there is no camera '{wanted}': this scene has only camera {one}"),
            known => {
                format!("there is no camera '{wanted}': this scene has the cameras {}", known.join(", "))
            }
        };
        return Err(SceneError::invalid(message, at).into());
    }
    Err(SceneError::unknown("camera", wanted, names, at).into())
}
