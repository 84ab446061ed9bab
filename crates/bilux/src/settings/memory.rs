//! The memory that a picture takes.

use super::Settings;
use crate::limits::memory::Memory;
use bilux_scene::SceneBuilder;

/// Bytes per pixel, with its sums, its layers, and what measuring the noise and denoising take; measured up to 180.
const PIXEL: u64 = 200;

impl Memory {
    /// The memory for a picture of a scene with these settings.
    pub fn of(scene: &SceneBuilder, settings: &Settings) -> Memory {
        let picture = u64::from(settings.width) * u64::from(settings.height) * PIXEL;
        Memory { picture, ..Memory::of_scene(scene) }
    }
}
