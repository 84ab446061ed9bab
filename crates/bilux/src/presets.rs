//! How bare files are seen: presets that the user asks for, and the studio for files that bring no camera or light.

use bilux_scene::SceneBuilder;
pub use bilux_scene::presets::{Ground, PRESETS, PresetEntry, Studio, apply};

/// A copy of the scene in which a missing camera and missing light are made up for, and what is asked of the studio is
/// there.
pub fn completed(scene: &SceneBuilder, studio: &Studio) -> SceneBuilder {
    let mut scene = scene.clone();
    bilux_scene::presets::complete(&mut scene, studio);
    scene
}
