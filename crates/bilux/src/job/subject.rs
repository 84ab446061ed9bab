//! Subject of a job.

use crate::settings::{Settings, shutter_of};
use bilux_scene::{AccelChoice, Camera, Scene, SceneBuilder};
use bilux_transport::ShadowCatcher;
use bilux_transport::integrators::PixelIntegrator;
use std::sync::Arc;

/// Subject of a job: a scene, as a camera sees it, by the light that an integrator finds.
#[derive(Clone)]
pub(crate) struct Subject {
    pub(crate) scene: Arc<Scene>,
    pub(crate) camera: Arc<dyn Camera>,
    pub(crate) integrator: Arc<dyn PixelIntegrator>,
    /// The description from which the scene was built. The fingerprint is computed from it, which takes long if textures
    /// are large.
    pub(crate) source: Arc<SceneBuilder>,
    pub(crate) accel: AccelChoice,
    /// The ground of which only the shadow is in the picture.
    pub(crate) catcher: Option<ShadowCatcher>,
    /// The next frame, if its meshes have another pose.
    pub(crate) next_pose: Option<Arc<Subject>>,
    /// The previous one, likewise.
    pub(crate) previous_pose: Option<Arc<Subject>>,
}

impl Subject {
    /// The subject at the time that the settings show. Static objects are not rebuilt.
    pub(crate) fn at_time_of(&self, settings: &Settings) -> Subject {
        let scene = self.scene.at(&self.accel, shutter_of(settings));
        Subject { scene: Arc::new(scene), ..self.clone() }
    }
}
