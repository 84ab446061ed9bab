//! From the index of a sample to its camera ray, and to the task of its integrator.

use crate::bidirectional::SampleQueue;
use crate::emission::{Emission, Guide};
use crate::interval::replicate;
use crate::light_choice::LightChoice;
use crate::photons::Photons;
use crate::pixel_integrator::{CameraSpread, PixelIntegrator};
use crate::sampler::{PixelSampler, regular_pattern};
use crate::settings::{Reach, RenderSettings};
use crate::task::Task;
use bilux_math::{Vec2, warp};
use bilux_scene::cameras::Pinhole;
use bilux_scene::{Camera, CameraSample, Ray, Scene, Tracer, Wavelength};
use std::sync::Arc;

/// Turns the index of a sample into a camera ray and the task for it.
pub(crate) struct CameraRays<'a> {
    pub(crate) scene: &'a Scene,
    camera: &'a dyn Camera,
    pub(crate) integrator: &'a dyn PixelIntegrator,
    pub(crate) settings: &'a RenderSettings,
    lights: LightChoice,
    pub(crate) emission: Emission,
    has_lens: bool,
    reach: Reach,
    /// Camera subpaths are merged with light subpaths of the same iteration.
    merges: bool,
    pub(crate) photons: Option<&'a Photons>,
}

impl<'a> CameraRays<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        camera: &'a dyn Camera,
        integrator: &'a dyn PixelIntegrator,
        settings: &'a RenderSettings,
    ) -> CameraRays<'a> {
        let (lights, has_lens) = (LightChoice::new(scene), camera.has_lens());
        let guide = integrator.light_subpaths().and_then(|subpaths| subpaths.guide());
        let emission = Emission::new(scene, guide);
        let merges = integrator.merging().is_some();
        let reach = settings.reach();
        CameraRays {
            scene,
            camera,
            integrator,
            settings,
            lights,
            emission,
            has_lens,
            reach,
            merges,
            photons: None,
        }
    }

    /// The same for subpaths that are merged, whatever the integrator does.
    pub(crate) fn merging(self) -> CameraRays<'a> {
        CameraRays { merges: true, ..self }
    }

    /// The same with light subpaths that are aimed by a guide.
    pub(crate) fn guided(self, guide: Option<Arc<Guide>>) -> CameraRays<'a> {
        CameraRays { emission: Emission::new(self.scene, guide), ..self }
    }

    /// The same where [`crate::techniques::Contribution::origin`] is the index of a light. It changes no sample.
    pub(crate) fn by_light(mut self) -> CameraRays<'a> {
        self.emission.names_lights = true;
        self
    }

    /// Takes many of the integrator's samples at a time, if it can.
    pub(crate) fn queue(&self) -> Option<Box<dyn SampleQueue + 'a>> {
        self.integrator.queue(self.photons)
    }

    /// The camera ray of a sample, and the task for its integrator.
    #[inline]
    pub(crate) fn sample<'t>(
        &'t self,
        tracer: &'t mut Tracer<'a>,
        x: u32,
        y: u32,
        index: u32,
    ) -> (Ray, Task<'t, 'a>) {
        let mut task = self.task(tracer, x, y, index);
        let camera_sample = self.camera_sample(&mut task.sampler, x, y, index);
        (self.scene.from_camera(self.camera.ray(&camera_sample)), task)
    }

    /// The ray of a pixel's [labels](crate::labels): through the centre of the pixel and of the lens, when the shutter opens.
    pub(crate) fn of_labels(&self, x: u32, y: u32) -> Ray {
        let place = Vec2::splat(self.settings.pixel_anchor.offset());
        let [opens, _] = self.scene.shutter();
        let sample =
            CameraSample { film: on_film(self.settings, x, y, place), lens: Vec2::ZERO, time: opens };
        self.scene.for_labels(self.camera.ray(&sample))
    }

    /// The time of a sample, and the task for its light subpath alone: streams of random numbers do not depend on what was drawn
    /// before them.
    #[inline]
    pub(crate) fn light_sample<'t>(
        &'t self,
        tracer: &'t mut Tracer<'a>,
        x: u32,
        y: u32,
        index: u32,
    ) -> (f32, Task<'t, 'a>) {
        let mut task = self.task(tracer, x, y, index);
        let [opens, closes] = self.scene.shutter();
        let time = match opens == closes {
            true => opens,
            false => self.camera_sample(&mut task.sampler, x, y, index).time,
        };
        (time, task)
    }

    /// The task of a sample that has drawn nothing yet.
    #[inline]
    fn task<'t>(&'t self, tracer: &'t mut Tracer<'a>, x: u32, y: u32, index: u32) -> Task<'t, 'a> {
        let (seed, number) = match self.settings.interval {
            true => replicate(self.settings.seed, index),
            false => (self.settings.seed, index),
        };
        let sampler = PixelSampler::new(seed, x, y, number);
        let wavelength =
            if self.scene.disperses() { self.wavelength(seed, &sampler, number) } else { Wavelength::D };
        Task {
            tracer,
            sampler,
            wavelength,
            max_depth: self.settings.max_depth,
            camera: self.camera,
            reach: self.reach,
            lights: &self.lights,
            emission: &self.emission,
            photons: self.photons,
            vertices: 0,
            events: None,
            found: None,
        }
    }

    /// The rays as those of a pinhole, if there is nothing else to them: neither a lens, nor motion, nor wavelengths, nor a
    /// regular pattern.
    pub(crate) fn of_pinhole(&self) -> Option<PinholeRays<'a>> {
        let [opens, closes] = self.scene.shutter();
        let is_plain = self.integrator.camera_spread() == CameraSpread::FULL
            && opens == closes
            && !self.scene.disperses()
            && !self.settings.interval;
        let pinhole = self.camera.pinhole().filter(|_| is_plain)?;
        Some(PinholeRays { pinhole, settings: self.settings, time: opens })
    }

    /// The wavelength of a sample: dispersion sends its paths where light of this wavelength goes. Subpaths that are
    /// merged must have the same one, so then all samples of an iteration share it.
    #[cold]
    fn wavelength(&self, seed: u64, sampler: &PixelSampler, number: u32) -> Wavelength {
        const STREAM: u64 = 0x7761_7665;
        const NO_PIXEL: u32 = u32::MAX;
        let of_all = || PixelSampler::new(seed, NO_PIXEL, NO_PIXEL, number);
        let mut sampler = if self.merges { of_all() } else { sampler.clone() };
        sampler.enter(STREAM);
        Wavelength::sample(sampler.next_1d())
    }

    /// The position on film and lens, and the time. Where the integrator gives an extent of zero, the sample takes the
    /// pixel's regular pattern, the centre of the lens, and the middle of the shutter interval.
    fn camera_sample(&self, sampler: &mut PixelSampler, x: u32, y: u32, index: u32) -> CameraSample {
        let (spread, settings) = (self.integrator.camera_spread(), self.settings);
        let u_pixel = sampler.next_2d();
        let offset = match spread.pixel {
            0.0 => settings.filter.sample(regular_pattern(index)),
            extent => settings.filter.sample(u_pixel) * extent,
        };
        let anchor = settings.pixel_anchor.offset();
        let lens = match spread.lens {
            0.0 => Vec2::ZERO,
            _ if !self.has_lens => {
                sampler.skip(1);
                Vec2::ZERO
            }
            extent => warp::sample_disc(sampler.next_2d()) * extent,
        };
        let [opens, closes] = self.scene.shutter();
        let middle = opens + (closes - opens) * 0.5;
        let time = match spread.shutter {
            0.0 => middle,
            _ if opens == closes => middle,
            extent => middle + (closes - opens) * (sampler.next_1d() - 0.5) * extent,
        };
        let film = on_film(settings, x, y, offset + Vec2::splat(anchor));
        CameraSample { film, lens, time: time.clamp(opens.min(closes), opens.max(closes)) }
    }
}

/// The point of the film (0..=1 on both axes) at a place in a pixel.
#[inline]
fn on_film(settings: &RenderSettings, x: u32, y: u32, place: Vec2) -> Vec2 {
    Vec2::new((x as f32 + place.x) / settings.width as f32, (y as f32 + place.y) / settings.height as f32)
}

/// The rays of a pinhole.
pub(crate) struct PinholeRays<'a> {
    pub(crate) pinhole: Pinhole,
    settings: &'a RenderSettings,
    /// When the shutter opens and closes.
    pub(crate) time: f32,
}

impl PinholeRays<'_> {
    /// The dimension of the random numbers that choose the place in a pixel: the first that is drawn.
    pub(crate) const DIMENSION: u32 = 1;

    /// The random numbers of a sample.
    #[inline]
    pub(crate) fn sampler(&self, x: u32, y: u32, index: u32) -> PixelSampler {
        PixelSampler::new(self.settings.seed, x, y, index)
    }

    /// The point of the film that random numbers choose in a pixel.
    #[inline]
    pub(crate) fn film(&self, x: u32, y: u32, u: Vec2) -> Vec2 {
        let offset = self.settings.filter.sample(u);
        on_film(self.settings, x, y, offset + Vec2::splat(self.settings.pixel_anchor.offset()))
    }
}
