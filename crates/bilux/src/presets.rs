//! How bare files are seen: presets that the user asks for, and the studio for files that bring no camera or light.

use bilux_scene::SceneBuilder;
pub use bilux_scene::presets::{PRESETS, PresetEntry, apply};

/// A copy of the scene in which a missing camera and missing light are made up for.
pub fn completed(scene: &SceneBuilder) -> SceneBuilder {
    let mut scene = scene.clone();
    bilux_scene::presets::complete(&mut scene);
    scene
}
