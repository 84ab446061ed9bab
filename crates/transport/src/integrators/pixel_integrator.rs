//! Traits of integrators; the integrators are in [`crate::integrators`].

use crate::bidirectional::{BothEnds, BothEndsSamples};
use crate::light::choice::LightChoice;
use crate::light::emission::Guide;
use crate::photons::{Merging, Photons};
use crate::sampling::camera_rays::{CameraRays, CameraSpread};
use crate::sampling::sample_queue::SampleQueue;
use crate::sampling::splats::{Splats, Sum};
use crate::sampling::task::{Context, Task};
use crate::schedule::plan::Choice;
use crate::schedule::settings::RenderSettings;
use bilux_math::Rgb;
use bilux_scene::{Camera, Counters, Ray, Scene};
use std::sync::Arc;

/// Estimates the light along camera rays; [`crate::render()`] handles pixels, tiles and threads.
///
/// What an integrator may do beyond that is asked of it by role: [`LightSubpaths`] of those that trace paths from the lights,
/// [`Chooser`] of those that let another one render.
pub trait PixelIntegrator: Send + Sync + 'static {
    /// Radiance (in the classic modes: intensity) that arrives along a camera ray, as far as the integrator finds it
    /// from the camera.
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb;

    /// Spread of samples over pixel, lens and shutter.
    fn camera_spread(&self) -> CameraSpread {
        CameraSpread::FULL
    }

    /// True if it follows light that the media of a scene scatter.
    fn follows_media(&self, _scene: &Scene) -> bool {
        true
    }

    /// True if it finds light that media emit.
    fn sees_glow(&self) -> bool {
        true
    }

    /// True if it finds what a camera [receives](Camera::receives).
    fn receives(&self) -> bool {
        false
    }

    /// True if it reports each piece of light that a path finds (`Task::find`), so that light can be divided into parts.
    fn reports_light(&self) -> bool {
        false
    }

    /// Subpaths from the lights, if it traces any.
    fn light_subpaths(&self) -> Option<&dyn LightSubpaths> {
        None
    }

    /// Chooser of another integrator, if it is one.
    fn chooser(&self) -> Option<&dyn Chooser> {
        None
    }

    /// Takes many of its samples at a time, each as if on its own; `None` where they are taken one by one.
    #[doc(hidden)]
    fn queue<'a>(
        &self,
        _context: &Context<'a>,
        photons: Option<&'a Photons>,
    ) -> Option<Box<dyn SampleQueue + 'a>> {
        Some(Box::new(BothEndsSamples::new(self.light_subpaths()?.both_ends(photons)?)))
    }
}

/// An integrator that also traces subpaths from the lights: one for each sample, or for photons.
pub trait LightSubpaths: PixelIntegrator {
    /// True when each sample has a light subpath of its own, which may contribute anywhere on the film.
    fn splats(&self) -> bool {
        true
    }

    /// Takes a sample of a pixel: [`PixelIntegrator::radiance`] where it `is_wanted` (pixels outside the crop trace
    /// only their light subpaths), and all splats.
    fn sample(
        &self,
        ray: &Ray,
        is_wanted: bool,
        photons: Option<&Photons>,
        task: &mut Task,
        splats: &mut Splats,
    ) -> Rgb {
        match self.both_ends(photons) {
            Some(both_ends) => {
                let mut sum = Sum { here: Rgb::BLACK, splats };
                both_ends.sample(ray, is_wanted, task, &mut sum);
                sum.here
            }
            None if is_wanted => self.radiance(ray, task),
            None => Rgb::BLACK,
        }
    }

    /// The pair of subpaths that each sample consists of, if its techniques can be rendered separately
    /// ([`crate::strategies()`]).
    #[doc(hidden)]
    fn both_ends<'a>(&self, _photons: Option<&'a Photons>) -> Option<BothEnds<'a>> {
        None
    }

    /// Merging of camera subpaths with photons, if there is any. Each sample of all pixels is then an iteration, which begins
    /// with the photons' light subpaths.
    fn merging(&self) -> Option<&Merging> {
        None
    }

    /// The guide that aims the light subpaths, if there is one.
    fn guide(&self) -> Option<Arc<Guide>> {
        None
    }
}

/// An integrator that chooses the one that renders in its place.
pub trait Chooser {
    /// Chooses by scene, camera and the film's settings, whatever samples and pixels are requested.
    fn plan(&self, scene: &Scene, camera: &dyn Camera, film: &RenderSettings) -> Plan;
}

/// Methods that follow from the roles of an integrator.
impl dyn PixelIntegrator {
    /// True when its samples can be taken in independent replicates ([`RenderSettings::interval`]).
    pub fn is_random(&self) -> bool {
        self.camera_spread().pixel > 0.0
    }

    /// Takes a sample of a pixel: from the camera where it `is_wanted`, and all splats.
    pub fn sample(
        &self,
        ray: &Ray,
        is_wanted: bool,
        photons: Option<&Photons>,
        task: &mut Task,
        splats: &mut Splats,
    ) -> Rgb {
        // Where the film sees nothing, only light subpaths are left.
        let is_wanted = is_wanted && !ray.is_nowhere();
        match self.light_subpaths() {
            Some(subpaths) => subpaths.sample(ray, is_wanted, photons, task, splats),
            None if is_wanted => self.radiance(ray, task),
            None => Rgb::BLACK,
        }
    }

    /// [`LightSubpaths::splats`].
    pub fn splats(&self) -> bool {
        self.light_subpaths().is_some_and(LightSubpaths::splats)
    }

    /// [`LightSubpaths::merging`].
    pub fn merging(&self) -> Option<&Merging> {
        self.light_subpaths()?.merging()
    }

    /// True when it has techniques that can be rendered separately ([`crate::strategies()`]).
    pub fn has_strategies(&self) -> bool {
        self.light_subpaths().is_some_and(|subpaths| subpaths.both_ends(None).is_some())
    }

    /// The camera rays of its samples.
    pub(crate) fn camera_rays<'a>(
        &self,
        scene: &'a Scene,
        camera: &'a dyn Camera,
        settings: &'a RenderSettings,
    ) -> CameraRays<'a> {
        let lights = Arc::new(LightChoice::new(scene));
        let rays = CameraRays::new(scene, camera, settings, self.camera_spread(), lights);
        let rays = rays.guided(self.light_subpaths().and_then(|subpaths| subpaths.guide()));
        if self.merging().is_some() { rays.merging() } else { rays }
    }

    /// Plan that it chooses for a picture, if it chooses.
    pub(crate) fn plan(&self, scene: &Scene, camera: &dyn Camera, film: &RenderSettings) -> Option<Plan> {
        Some(self.chooser()?.plan(scene, camera, film))
    }
}

/// A choice among sets of techniques.
pub struct Plan {
    /// The integrator that renders the picture.
    pub integrator: Box<dyn PixelIntegrator>,
    /// The choice.
    pub choice: Choice,
    /// The work of the rays that led to it.
    pub counters: Counters,
    /// Whether a limit of time ended the pilot before all of its samples.
    pub is_hurried: bool,
}
