//! The shadow that a model casts on an invisible ground, as alpha: black with this alpha, composited over the ground as
//! it would be without the model, gives the ground with its shadow.
//!
//! Only direct light counts: alpha is the fraction of it that the model blocks. Where the model casts no shadow, alpha
//! is exactly 0, without noise. Smoke blocks what it stops, for the camera and for the light.

use crate::film::error::{FilmError, RenderError};
use crate::film::failures::SamplePlace;
use crate::film::zeroed;
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::light::choice::LightChoice;
use crate::media::Media;
use crate::media::camera_segment::CameraSegment;
use crate::sampling::sampler::PixelSampler;
use crate::schedule::settings::{RenderSettings, threads};
use bilux_math::parallel::{for_each, install};
use bilux_math::{Rgb, Vec3};
use bilux_pictures::PictureError;
use bilux_pictures::denoise::{Denoiser, Layer, Noisy, Source};
use bilux_scene::media::mean;
use bilux_scene::{Camera, LightSample, Ray, Scene, Surface, Tracer};
use std::ops::Range;
use std::time::Duration;

/// Minimum number of points on lights that are sampled for each pixel, and the minimum where the result is denoised.
const MIN_SAMPLES: u32 = 128;
const MIN_SAMPLES_DENOISED: u32 = 32;
/// The expected time for one sample of a shadow that is denoised, on one thread.
const TIME_PER_SAMPLE: Duration = Duration::from_nanos(150);
/// A stream of random numbers apart from those of the picture's paths.
const STREAM: u64 = 0x7368_6164;
/// Maximum number of glass surfaces that light passes straight through.
const MAX_PANES: usize = 32;

/// The expected time for the alpha of so many pixels, where it is denoised.
pub fn shadow_alpha_time(pixels: usize, threads: usize) -> Duration {
    TIME_PER_SAMPLE * MIN_SAMPLES_DENOISED * (pixels / threads.max(1)) as u32
}

/// The surface that catches the shadow, and the objects that cast it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadowCatcher {
    /// The object index of the ground, which is invisible to camera rays.
    pub ground: u32,
    /// The first `objects` objects come from the file or the studio; the emissive surfaces of lights follow, and cast
    /// no shadow.
    pub objects: u32,
}

/// Sums over the samples of one pixel.
#[derive(Clone, Copy, Default)]
struct Sums {
    /// Camera rays that see the model, and that see the ground: one that does through smoke counts for both, in parts.
    model: f64,
    ground: f64,
    /// Light on the ground with the model and without it.
    with: f64,
    without: f64,
    /// Sum of the squares of the samples of `without`.
    squares: f64,
}

/// The alpha of each pixel: 1 where the model is visible, and on the ground the fraction of light that the model
/// blocks. Then, for each pixel, the fraction of it that shows the model, 0..=1.
///
/// Pixels are in rows of the film's window, the top row first. `samples` is the picture's number of samples per pixel.
/// With a denoiser, the shadow takes fewer samples and is denoised; the model's outline stays as it is.
///
/// # Errors
/// As [`crate::features()`].
pub fn shadow_alpha(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    samples: u32,
    catcher: ShadowCatcher,
    denoiser: Option<&dyn Denoiser>,
) -> Result<[Vec<f32>; 2], RenderError> {
    settings.check()?;
    let window = settings.window();
    let (eye, lights) = (integrator.camera_rays(scene, camera, settings), shadowed_lights(scene, catcher));
    let mut pixels = zeroed::<Sums>(window.pixels())?;
    let least = if denoiser.is_some() { MIN_SAMPLES_DENOISED } else { MIN_SAMPLES };
    let tries = least.div_ceil(samples.max(1));
    let of_row = |(row, pixels): (usize, &mut [Sums])| {
        let mut tracer = Tracer::new(eye.context.scene, false);
        for (column, sums) in pixels.iter_mut().enumerate() {
            let (x, y) = (window.x + column as u32, window.y + row as u32);
            for sample in 0..samples {
                let (ray, _) = eye.sample(SamplePlace { x, y, sample });
                let mut sampler = PixelSampler::new(settings.seed, x, y, sample);
                sampler.enter(STREAM);
                sums.add(&mut tracer, &ray, &lights, catcher, &mut sampler, tries);
            }
        }
    };
    let width = window.width as usize;
    install(&threads(settings)?, || for_each(pixels.chunks_mut(width).enumerate(), of_row));
    let smooth = match denoiser {
        Some(denoiser) => denoiser.denoise(&Shadow { width, pixels: &pixels }).map_err(FilmError::from)?,
        None => Vec::new(),
    };
    let blocked = |i: usize| smooth.get(i).map_or_else(|| pixels[i].blocked(), |smooth| f64::from(smooth.r));
    let alpha = pixels.iter().enumerate().map(|(i, sums)| sums.alpha(blocked(i), samples));
    let model = pixels.iter().map(|sums| sums.model as f32 / samples.max(1) as f32);
    Ok([alpha.collect(), model.collect()])
}

/// The blocked fraction of the light as a picture to denoise. Pixels that show only the model have another depth, so that
/// they do not mix with the ground.
struct Shadow<'a> {
    width: usize,
    pixels: &'a [Sums],
}

impl Source for Shadow<'_> {
    fn size(&self) -> (usize, usize) {
        (self.width, self.pixels.len() / self.width)
    }

    fn rows(&self, rows: Range<usize>) -> Result<Noisy, PictureError> {
        let pixels = &self.pixels[rows.start * self.width..rows.end * self.width];
        let grey = |of: fn(&Sums) -> f64| pixels.iter().map(|sums| Rgb::grey(of(sums) as f32)).collect();
        let depth = |sums: &Sums| if sums.ground > 0.0 { 1.0 } else { f32::INFINITY };
        Ok(Noisy {
            width: self.width,
            height: rows.len(),
            layers: vec![Layer { colour: grey(Sums::blocked), variance: Some(grey(Sums::variance)) }],
            coverage: None,
            albedo: None,
            normal: None,
            depth: Some(pixels.iter().map(depth).collect()),
            haze: None,
        })
    }
}

/// Indices of the lights that remain without the model, as far as their probability is above 0.
fn shadowed_lights(scene: &Scene, catcher: ShadowCatcher) -> Vec<usize> {
    let of_model: Vec<usize> =
        (0..catcher.objects).filter_map(|object| scene.light_index_of(object)).collect();
    let choice = LightChoice::new(scene);
    (0..scene.lights().len())
        .filter(|i| !of_model.contains(i) && choice.probability(*i, None) > 0.0)
        .collect()
}

impl Sums {
    fn add(
        &mut self,
        tracer: &mut Tracer,
        ray: &Ray,
        lights: &[usize],
        catcher: ShadowCatcher,
        sampler: &mut PixelSampler,
        tries: u32,
    ) {
        let hidden = hidden(tracer, ray, catcher);
        self.model += hidden;
        if hidden >= 1.0 {
            return;
        }
        let Some(ground) = beyond_smoke(tracer, &Ray { mask: u32::MAX, ..*ray })
            .filter(|surface| surface.object == catcher.ground)
        else {
            return;
        };
        self.ground += 1.0 - hidden;
        let n =
            if ground.n_geom.dot(Vec3::from(ray.direction)) > 0.0 { -ground.n_geom } else { ground.n_geom };
        for _ in 0..tries {
            // Chooses one light uniformly: a studio has few.
            let picked = (sampler.next_1d() * lights.len() as f32) as usize;
            let u = sampler.next_2d();
            let Some(&light) = lights.get(picked.min(lights.len().saturating_sub(1))) else { return };
            let light = &tracer.scene.lights()[light].light;
            let Some(sample) = light.sample_li(ground.p, ground.time, u) else { continue };
            let cos = n.dot(sample.wi);
            let weight = f64::from(sample.li.luminance() * cos / sample.pdf_solid_angle);
            if cos > 0.0
                && weight.is_finite()
                && let Some(passed) = passed(tracer, &ground, &sample, catcher)
            {
                self.with += weight * f64::from(passed);
                self.without += weight;
                self.squares += weight * weight;
            }
        }
    }

    /// The fraction of the light on the ground that the model blocks.
    fn blocked(&self) -> f64 {
        if self.without > 0.0 { 1.0 - self.with / self.without } else { 0.0 }
    }

    /// Four times the upper bound of the variance of this fraction, which is reached in half shadow. An estimate from the
    /// same few samples would be low wherever they happen to agree, and so would keep the noise.
    fn variance(&self) -> f64 {
        if self.without > 0.0 { self.squares / (self.without * self.without) } else { 0.0 }
    }

    fn alpha(&self, blocked: f64, samples: u32) -> f32 {
        let sum = self.model + self.ground * blocked;
        (sum / f64::from(samples.max(1))).clamp(0.0, 1.0) as f32
    }
}

/// Fraction of what is behind the model that the model hides from the camera, 0..=1.
fn hidden(tracer: &mut Tracer, ray: &Ray, catcher: ShadowCatcher) -> f64 {
    let of_model = |surface: &Surface| surface.object < catcher.objects;
    let first = tracer.closest(ray).filter(of_model);
    if first.is_none() || !tracer.scene.has_interfaces() {
        return if first.is_some() { 1.0 } else { 0.0 };
    }
    let mut media = Media::at_start(tracer, ray);
    let sight = CameraSegment::along(tracer, &mut media, ray, first, |_, _| {});
    if sight.surface.as_ref().is_some_and(of_model) {
        1.0
    } else {
        f64::from(1.0 - mean(sight.transmittance))
    }
}

/// The first surface along a ray that is not only the boundary of smoke.
fn beyond_smoke(tracer: &mut Tracer, ray: &Ray) -> Option<Surface> {
    let mut ray = *ray;
    loop {
        let surface = tracer.closest(&ray)?;
        if !tracer.scene.material(&surface).is_interface() {
            return Some(surface);
        }
        ray = Ray { t_min: surface.t.next_up(), exclude: surface.primitive, ..ray };
    }
}

/// The fraction of the light along a ray that smoke lets through, whatever else is there.
fn through_smoke(tracer: &mut Tracer, ray: &Ray) -> f32 {
    let (scene, direction) = (tracer.scene, Vec3::from(ray.direction));
    if !scene.has_interfaces() {
        return 1.0;
    }
    let (length, unit) = (direction.length(), direction.normalize());
    let mut ray =
        Ray { direction: unit.to_array(), t_min: ray.t_min * length, t_max: ray.t_max * length, ..*ray };
    let (mut media, mut left) = (Media::at_start(tracer, &ray), 1.0);
    for _ in 0..MAX_PANES {
        let (first, mut stopped) = (tracer.closest(&ray), 0.0);
        let sight = CameraSegment::along(tracer, &mut media, &ray, first, |object, part| {
            stopped += if scene.material_of(object).is_interface() { part } else { 0.0 };
        });
        left *= 1.0 - stopped;
        let Some(surface) = sight.surface else { break };
        media = media.beyond(scene, &surface, -unit, unit);
        ray = Ray { t_max: ray.t_max - surface.t, mask: ray.mask, ..surface.spawn(unit) };
    }
    left
}

/// The fraction of a light that the model lets through to the ground; `None` where another light is in the way, with or
/// without the model.
fn passed(
    tracer: &mut Tracer,
    ground: &Surface,
    sample: &LightSample,
    catcher: ShadowCatcher,
) -> Option<f32> {
    let mut ray = ground.spawn_to_light(sample);
    let (direction, mut left) = (Vec3::from(ray.direction), 1.0);
    let smoke = through_smoke(tracer, &ray);
    for _ in 0..MAX_PANES {
        let Some(surface) = tracer.closest(&ray) else { return Some(left * smoke) };
        if surface.object >= catcher.objects {
            return None;
        }
        let material = tracer.scene.material(&surface).classic(&surface);
        if material.thin || surface.n_geom.dot(direction) < 0.0 {
            // Each body counts once: where the light enters it.
            left *= material.kt.luminance();
        }
        if material.kt.is_black() {
            return Some(0.0);
        }
        ray = Ray { t_min: surface.t.next_up(), exclude: surface.primitive, ..ray };
    }
    Some(0.0)
}
