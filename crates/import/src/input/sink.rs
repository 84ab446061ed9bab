//! Output of a reader: a scene, and what is odd about the file.

use crate::input::diagnostics::Diagnostics;
use bilux_scene::SceneBuilder;

/// The scene so far, and the diagnostics so far.
#[derive(Default)]
pub struct Sink {
    pub scene: SceneBuilder,
    pub diagnostics: Diagnostics,
}

impl Sink {
    /// For files that say nothing of what surrounds their objects, nor of how bright the picture is.
    pub fn for_bare_files() -> Sink {
        let scene = SceneBuilder {
            environment_unspecified: true,
            exposure_unspecified: true,
            ..SceneBuilder::default()
        };
        Sink { scene, diagnostics: Diagnostics::default() }
    }

    /// The scene with a warning or a note for each diagnostic.
    pub fn finish(self) -> SceneBuilder {
        let Sink { mut scene, diagnostics } = self;
        diagnostics.into_warnings(&mut scene);
        scene
    }
}
