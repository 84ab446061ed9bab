//! What an integrator has to answer; the integrators are in [`crate::integrators`].

use crate::bidirectional::{BothEnds, BothEndsSamples, SampleQueue};
use crate::emission::Guide;
use crate::layers::Layers;
use crate::photons::{Merging, Photons};
use crate::plan::Choice;
use crate::settings::RenderSettings;
use crate::splats::{Splats, Sum};
use crate::task::Task;
use bilux_math::Rgb;
use bilux_scene::{Camera, Counters, Ray, Scene};
use std::any::Any;
use std::sync::Arc;

/// Estimates the light along camera rays; [`crate::render()`] handles pixels, tiles and threads.
pub trait PixelIntegrator: Any + Send + Sync {
    /// Radiance (in the classic modes: intensity) that arrives along a camera ray, as far as the integrator finds it
    /// from the camera.
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb;

    /// True when it also traces light subpaths, which may contribute anywhere on the film.
    fn splats(&self) -> bool {
        false
    }

    /// How it merges camera subpaths with light subpaths. Each sample of all pixels is then an iteration, which begins
    /// with the light subpaths of all pixels ([`Task::photons`]).
    fn merging(&self) -> Option<&Merging> {
        None
    }

    /// The guide that aims its light subpaths, if there is one.
    fn guide(&self) -> Option<Arc<Guide>> {
        None
    }

    /// When Russian roulette begins on the light subpaths of an iteration.
    fn roulette_depth(&self) -> u32 {
        0
    }

    /// The integrator that renders in its place, if this one chooses: by scene, camera and the film's settings,
    /// whatever samples and pixels are requested.
    fn plan(&self, _scene: &Scene, _camera: &dyn Camera, _film: &RenderSettings) -> Option<Plan> {
        None
    }

    /// Takes a sample of a pixel: [`PixelIntegrator::radiance`] where it `is_wanted` (pixels outside the crop trace
    /// only their light subpaths), and all splats.
    fn sample(&self, ray: &Ray, is_wanted: bool, task: &mut Task, splats: &mut Splats) -> Rgb {
        match self.both_ends(task.photons) {
            Some(both_ends) => {
                let mut sum = Sum { here: Rgb::BLACK, splats };
                both_ends.sample(ray, is_wanted, task, &mut sum);
                sum.here
            }
            None if is_wanted => self.radiance(ray, task),
            None => Rgb::BLACK,
        }
    }

    /// True when it has techniques that can be rendered separately ([`crate::strategies()`]).
    fn has_strategies(&self) -> bool {
        self.both_ends(None).is_some()
    }

    /// The same sample as [`PixelIntegrator::sample`], technique by technique.
    fn sample_strategies(&self, ray: &Ray, is_wanted: bool, task: &mut Task, layers: &mut Layers) {
        if let Some(both_ends) = self.both_ends(task.photons) {
            both_ends.showing().sample(ray, is_wanted, task, layers);
        }
    }

    /// The subpaths from both ends that its samples consist of, if they do.
    #[doc(hidden)]
    fn both_ends<'a>(&self, _photons: Option<&'a Photons>) -> Option<BothEnds<'a>> {
        None
    }

    /// Takes many of its samples at a time, each as [`PixelIntegrator::sample`] does; `None` where they are taken one by one.
    #[doc(hidden)]
    fn queue<'a>(&self, photons: Option<&'a Photons>) -> Option<Box<dyn SampleQueue + 'a>> {
        Some(Box::new(BothEndsSamples::new(self.both_ends(photons)?)))
    }

    /// True when its samples can be taken in independent replicates ([`RenderSettings::interval`]).
    fn is_random(&self) -> bool {
        self.camera_spread().pixel > 0.0
    }

    /// How far samples spread over pixel, lens and shutter.
    fn camera_spread(&self) -> CameraSpread {
        CameraSpread::FULL
    }
}

/// How far samples spread, each 0..=1 of what filter, aperture and shutter allow. With 0, pixels are sampled in a
/// regular pattern that begins at the centre, and lens and shutter in their middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraSpread {
    /// Over the pixel's filter.
    pub pixel: f32,
    /// Over the lens.
    pub lens: f32,
    /// Over the time that the shutter is open.
    pub shutter: f32,
}

impl CameraSpread {
    /// Full spread.
    pub const FULL: CameraSpread = CameraSpread { pixel: 1.0, lens: 1.0, shutter: 1.0 };
    /// No spread.
    pub const NONE: CameraSpread = CameraSpread { pixel: 0.0, lens: 0.0, shutter: 0.0 };
}

/// A choice among sets of techniques.
pub struct Plan {
    /// The integrator that renders the picture.
    pub integrator: Box<dyn PixelIntegrator>,
    /// The choice.
    pub choice: Choice,
    /// The work of the rays that led to it.
    pub counters: Counters,
}
