//! The lights of a scene.

use crate::lights::Light;
use bilux_math::Rgb;
use std::sync::Arc;

/// A light of the scene.
#[derive(Clone)]
pub struct SceneLight {
    /// The user's name for it; may be empty.
    pub name: String,
    /// The layer of light that it belongs to; may be empty.
    pub group: String,
    /// The light.
    pub light: Arc<dyn Light>,
    /// Colour of the light in `cast`, `whitted` and `cook`.
    pub classic_colour: Rgb,
    /// Whether it lights next to nothing of what is visible ([`SceneBuilder::has_faint_emitters`](crate::SceneBuilder::has_faint_emitters)).
    pub is_faint: bool,
}

impl SceneLight {
    pub(crate) fn new(name: &str, light: Arc<dyn Light>) -> SceneLight {
        let [name, group] = [name, name].map(str::to_owned);
        SceneLight { name, group, light, classic_colour: Rgb::BLACK, is_faint: false }
    }
}
