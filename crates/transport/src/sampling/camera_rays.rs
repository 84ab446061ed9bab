//! From the index of a sample to its camera ray, and to its random numbers.

use crate::film::failures::SamplePlace;
use crate::film::interval::replicate;
use crate::light::choice::LightChoice;
use crate::light::emission::{Emission, Guide};
use crate::photons::Photons;
use crate::sampling::sampler::{PixelSampler, regular_pattern};
use crate::sampling::task::{Context, SampleState};
use crate::schedule::settings::RenderSettings;
use bilux_math::{Vec2, warp};
use bilux_scene::cameras::Pinhole;
use bilux_scene::{Camera, CameraSample, Ray, Scene, Wavelength};
use std::sync::Arc;

/// Turns the index of a sample into a camera ray and the state of the sample.
pub struct CameraRays<'a> {
    pub(crate) context: Context<'a>,
    pub(crate) settings: &'a RenderSettings,
    spread: CameraSpread,
    has_lens: bool,
    /// Camera subpaths are merged with light subpaths of the same iteration.
    merges: bool,
    /// Photons of this iteration's light subpaths, where subpaths are merged.
    pub(crate) photons: Option<&'a Photons>,
}

/// Extents over which samples spread, each 0..=1 of what filter, aperture and shutter allow. With 0, pixels are sampled in a
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

impl<'a> CameraRays<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        camera: &'a dyn Camera,
        settings: &'a RenderSettings,
        spread: CameraSpread,
        lights: Arc<LightChoice>,
    ) -> CameraRays<'a> {
        let context = Context {
            scene,
            camera,
            splat_bounds: settings.splat_bounds(),
            exposure: settings.exposure(scene),
            lights,
            emission: Emission::new(scene, None),
            // The paper that receives light is no surface of the scene.
            max_depth: settings.max_depth.saturating_add(u32::from(camera.receives())),
        };
        CameraRays { context, settings, spread, has_lens: camera.has_lens(), merges: false, photons: None }
    }

    /// These rays for subpaths that are merged.
    pub(crate) fn merging(self) -> CameraRays<'a> {
        CameraRays { merges: true, ..self }
    }

    /// These rays with light subpaths that are aimed by a guide.
    pub(crate) fn guided(mut self, guide: Option<Arc<Guide>>) -> CameraRays<'a> {
        self.context.emission = Emission::new(self.context.scene, guide);
        self
    }

    /// These rays where [`crate::techniques::Contribution::origin`] is the index of a light. That changes no sample.
    pub(crate) fn by_light(mut self) -> CameraRays<'a> {
        self.context.emission.names_lights = true;
        self
    }

    /// The camera ray of a sample, and its state.
    #[inline]
    pub(crate) fn sample(&self, place: SamplePlace) -> (Ray, SampleState) {
        let mut state = self.state(place);
        let camera_sample = self.camera_sample(&mut state.sampler, place);
        let Context { scene, camera, .. } = self.context;
        (scene.from_camera(camera.ray(&camera_sample)), state)
    }

    /// The time of a sample, and the state for its light subpath alone: streams of random numbers do not depend on what was
    /// drawn before them.
    #[inline]
    pub(crate) fn light_sample(&self, place: SamplePlace) -> (f32, SampleState) {
        let mut state = self.state(place);
        let [opens, closes] = self.context.scene.shutter();
        let time = match opens == closes {
            true => opens,
            false => self.camera_sample(&mut state.sampler, place).time,
        };
        (time, state)
    }

    /// The state of a sample that has drawn nothing yet.
    #[inline]
    fn state(&self, SamplePlace { x, y, sample }: SamplePlace) -> SampleState {
        let (seed, number) = match self.settings.interval {
            true => replicate(self.settings.seed, sample),
            false => (self.settings.seed, sample),
        };
        let sampler = PixelSampler::new(seed, x, y, number);
        let disperses = self.context.scene.disperses();
        let wavelength = if disperses { self.wavelength(seed, &sampler, number) } else { Wavelength::D };
        let is_coloured = self.context.scene.has_coloured_distances();
        let channel = if is_coloured { channel_of(&sampler, number) } else { 0 };
        SampleState { channel, ..SampleState::new(sampler, wavelength) }
    }

    /// The rays as those of a pinhole, if there is nothing else to them: neither a lens, nor motion, nor wavelengths, nor a
    /// regular pattern.
    pub(crate) fn of_pinhole(&self) -> Option<PinholeRays<'a>> {
        let [opens, closes] = self.context.scene.shutter();
        let is_plain = self.spread == CameraSpread::FULL
            && opens == closes
            && !self.context.scene.disperses()
            && !self.settings.interval;
        let pinhole = self.context.camera.pinhole().filter(|_| is_plain)?;
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
    fn camera_sample(&self, sampler: &mut PixelSampler, place: SamplePlace) -> CameraSample {
        let SamplePlace { x, y, sample } = place;
        let CameraRays { spread, settings, .. } = *self;
        let u_pixel = sampler.next_2d();
        let offset = match spread.pixel {
            0.0 => settings.filter.sample(regular_pattern(sample)),
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
        let [opens, closes] = self.context.exposure.of_first_row();
        let middle = opens + (closes - opens) * 0.5;
        let time = match spread.shutter {
            0.0 => middle,
            _ if opens == closes => middle,
            extent => middle + (closes - opens) * (sampler.next_1d() - 0.5) * extent,
        };
        let film = on_film(settings, x, y, offset + Vec2::splat(anchor));
        let time = time.clamp(opens.min(closes), opens.max(closes)) + self.context.exposure.delay(film);
        CameraSample { film, lens, time }
    }
}

/// The channel of a sample's distances in media: in a pixel all in turn, beginning anywhere.
#[cold]
fn channel_of(sampler: &PixelSampler, number: u32) -> u8 {
    const STREAM: u64 = 0x6368_616e;
    // What is the same for all samples of a pixel.
    let mut first = sampler.first();
    first.enter(STREAM);
    let offset = (first.next_1d() * 3.0) as u32;
    ((offset + number % 3) % 3) as u8
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
    pub(crate) fn sampler(&self, SamplePlace { x, y, sample }: SamplePlace) -> PixelSampler {
        PixelSampler::new(self.settings.seed, x, y, sample)
    }

    /// The point of the film that random numbers choose in a pixel.
    #[inline]
    pub(crate) fn film(&self, x: u32, y: u32, u: Vec2) -> Vec2 {
        let offset = self.settings.filter.sample(u);
        on_film(self.settings, x, y, offset + Vec2::splat(self.settings.pixel_anchor.offset()))
    }
}
