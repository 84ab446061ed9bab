//! Features of the surfaces that the camera sees, whatever their lighting, on average over a pixel: albedo, normal and depth. Denoisers
//! use these features to distinguish edges and textures from noise.
//!
//! They take a pass of their own over the film. Albedo, and the normals and depths that guide denoisers, are means over the
//! camera rays of the picture's first samples. At smooth mirrors and glass a ray goes on, along the more likely of
//! reflection and refraction, to the surface that is visible there, so that reflected and refracted images have their
//! edges too; depth is that of the first surface. What is exact, and of one surface, are [labels](mod@crate::labels). Each
//! pixel is summed on its own, in the order of its samples: the bytes are the same for any number of threads, any crop
//! and any range of samples.
//!
//! Fog, smoke and murky insides are part of albedo, mean depth, mean normal and coverage by the share of the light that they
//! scatter or stop; what they let pass is the share of what lies behind. These shares are expected values, without the noise of a walk
//! that ends somewhere.

use crate::film::error::{FilmError, RenderError};
use crate::film::failures::SamplePlace;
use crate::film::window::{TILE, Tile, Tiling, Window, finest_complete};
use crate::film::zeroed;
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::labels::visible_normal;
use crate::media::Media;
use crate::media::camera_segment::CameraSegment;
use crate::queue;
use crate::sampling::camera_rays::CameraRays;
use crate::schedule::progress::Progress;
use crate::schedule::settings::{RenderSettings, threads};
use bilux_math::parallel::{for_each, install};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_pictures::Picture;
use bilux_scene::{Camera, ClassicMaterial, Ray, Scene, Surface, Tracer, TransportMode, Wavelength};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Camera rays per pixel, even where the picture has fewer samples: they show denoisers which mixture of surfaces an
/// edge pixel contains. An integrator without random numbers takes no more of them than the picture has samples.
pub const FEATURE_SAMPLES: u32 = 8;

/// Maximum number of smooth surfaces that a ray is followed through.
const MAX_SMOOTH: u32 = 12;

/// Planes of a window of the film, in rows, the top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Features {
    /// The pixels that they cover.
    pub window: Window,
    /// The fraction of light that surfaces and media scatter, 0..=1; for lights, fire and the background their emission, at most 1.
    pub albedo: Vec<Rgb>,
    /// The mean of the samples' shading normals: shorter than 1 where normals differ, and in fog, which has none.
    pub mean_normal: Vec<Vec3>,
    /// The mean depth of what the samples see, of surfaces and media; infinite where there is nothing.
    pub mean_depth: Vec<f32>,
    /// The share of each pixel that fog, smoke, and surfaces with a murky inside show, 0..=1; empty where no medium scatters. Their light
    /// has no sharp edges, however noisy it is.
    pub haze: Vec<f32>,
    /// The fraction of the pixel that is covered, 0..=1, as [`coverage`] says.
    pub coverage: Vec<f32>,
}

/// Sums over the samples of one pixel.
#[derive(Clone, Copy, Default)]
struct Sums {
    albedo: Rgb,
    normal: Vec3,
    depth: f32,
    /// The sum of the weights of the depths.
    seen: f32,
    covered: f32,
    haze: f32,
}

/// Evaluates the first [`FEATURE_SAMPLES`] samples of each pixel, and no more than fit into `time` if that is given: those that the first does
/// not reach in twice that time get the features of a pixel beside them. `None` when it was cancelled.
///
/// # Errors
/// When the size or the crop is invalid, or there is not enough memory or no threads.
pub fn features(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    time: Option<Duration>,
    progress: &dyn Progress,
) -> Result<Option<Features>, RenderError> {
    settings.check()?;
    let (window, begun) = (settings.window(), Instant::now());
    let eye = integrator.camera_rays(scene, camera, settings);
    let empty = |tile: Tile| Ok((tile, zeroed::<Sums>(tile.pixels())?));
    let tiling = if time.is_some() { Tiling::Spread(TILE) } else { Tiling::Squares(TILE) };
    let mut tiles = window.divided(tiling).into_iter().map(empty).collect::<Result<Vec<_>, FilmError>>()?;
    let coarsest = tiles.first().map_or(1, |(tile, _)| tile.step);
    let least = tiles.iter().filter(|(tile, _)| tile.step == coarsest).count();
    let pool = threads(settings)?;
    let samples = if integrator.is_random() { FEATURE_SAMPLES } else { settings.spp.min(FEATURE_SAMPLES) };
    let mut done = 0;
    while done < samples {
        // The first sample is worth more than others: it guides what completes a picture that time ends within its own first one.
        let is_over = || time.is_some_and(|time| begun.elapsed() > 2 * time);
        let is_late = |i: usize| done == 0 && i >= least && is_over();
        let left_out = Mutex::new(tiles.len());
        let each = |(i, (tile, sums)): (usize, &mut (Tile, Vec<Sums>))| {
            if is_late(i) {
                let mut first = left_out.lock().unwrap_or_else(PoisonError::into_inner);
                *first = i.min(*first);
            } else if !progress.is_cancelled() {
                look(&eye, tile, sums, done);
            }
        };
        install(&pool, || for_each(tiles.iter_mut().enumerate(), each));
        done += 1;
        if progress.is_cancelled() {
            return Ok(None);
        }
        let left_out = left_out.into_inner().unwrap_or_else(PoisonError::into_inner);
        if left_out < tiles.len() {
            let is_done: Vec<bool> = (0..tiles.len()).map(|i| i < left_out).collect();
            take_from_lattice(&mut tiles, &is_done, window)?;
            break;
        }
        if time.is_some_and(|time| begun.elapsed() * (done + 1) > time * done) {
            break;
        }
    }
    let has_haze = scene.scatters() || scene.has_interfaces();
    Features::of(window, tiles, done, has_haze).map(Some)
}

/// Gives the pixels that are not looked at the sums of the point before them, to the left and above, of the finest complete lattice.
fn take_from_lattice(
    tiles: &mut [(Tile, Vec<Sums>)],
    done: &[bool],
    window: Window,
) -> Result<(), FilmError> {
    let all: Vec<Tile> = tiles.iter().map(|(tile, _)| *tile).collect();
    let Some(spacing) = finest_complete(&all, done) else { return Ok(()) };
    let mut known = zeroed::<Sums>(window.pixels())?;
    for ((tile, sums), _) in tiles.iter().zip(done).filter(|(_, is_done)| **is_done) {
        for ((x, y), sum) in tile.positions().zip(sums) {
            window.index(x, y).into_iter().for_each(|i| known[i] = *sum);
        }
    }
    for ((tile, sums), _) in tiles.iter_mut().zip(done).filter(|(_, is_done)| !**is_done) {
        for ((x, y), sum) in tile.positions().zip(sums) {
            let [x, y] = [x, y].map(|at| at / spacing * spacing);
            *sum = window.index(x, y).map_or(*sum, |i| known[i]);
        }
    }
    Ok(())
}

/// The fraction of each pixel that is covered, 0..=1, in rows of the film's window, the top row first: the mean over its first
/// samples, of which one whose camera ray ends at a surface counts as 1, and one that passes only fog, smoke or fire as what these stop of
/// the light behind, the mean over the channels.
///
/// # Errors
/// As [`features`].
pub fn coverage(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    samples: u32,
) -> Result<Vec<f32>, RenderError> {
    settings.check()?;
    let window = settings.window();
    let eye = integrator.camera_rays(scene, camera, settings);
    let has_interfaces = scene.has_interfaces();
    let mut coverage = zeroed::<f32>(window.pixels())?;
    let of_row = |(row, coverage): (usize, &mut [f32])| {
        let mut tracer = Tracer::new(eye.context.scene, false);
        for (column, coverage) in coverage.iter_mut().enumerate() {
            let (x, y) = (window.x + column as u32, window.y + row as u32);
            let of_sample = |sample: u32| {
                let (ray, _) = eye.sample(SamplePlace { x, y, sample });
                match tracer.closest(&ray) {
                    None => 0.0,
                    Some(_) if !has_interfaces => 1.0,
                    first => {
                        let mut media = Media::at_start(&mut tracer, &ray);
                        CameraSegment::along(&mut tracer, &mut media, &ray, first, |_, _| {}).coverage()
                    }
                }
            };
            *coverage = (0..samples).map(of_sample).sum::<f32>() / samples.max(1) as f32;
        }
    };
    let rows = coverage.chunks_mut(window.width as usize).enumerate();
    install(&threads(settings)?, || for_each(rows, of_row));
    Ok(coverage)
}

/// The camera rays of samples; those of a pinhole many at a time.
fn camera_rays(eye: &CameraRays, places: &[SamplePlace]) -> Vec<Ray> {
    let Some(pinhole) = eye.of_pinhole() else {
        return places.iter().map(|place| eye.sample(*place).0).collect();
    };
    let mut rays = Vec::with_capacity(places.len());
    queue::camera_rays(&pinhole, eye.context.scene, places, |_, _, ray| rays.push(ray));
    rays
}

/// Adds one sample to each pixel of a tile.
fn look(eye: &CameraRays, tile: &Tile, sums: &mut [Sums], sample: u32) {
    let mut tracer = Tracer::new(eye.context.scene, false);
    let place = |(x, y): (u32, u32)| SamplePlace { x, y, sample };
    let places: Vec<SamplePlace> = tile.positions().map(place).collect();
    let rays = camera_rays(eye, &places);
    let mut hits = vec![None; rays.len()];
    tracer.hits(&rays, &mut hits);
    for ((sum, ray), hit) in sums.iter_mut().zip(&rays).zip(hits) {
        let surface = hit.map(|hit| tracer.surface(ray, &hit));
        sum.add(&mut tracer, ray, surface);
    }
}

impl Sums {
    /// Adds a sample, given its camera ray and the first surface along it.
    fn add(&mut self, tracer: &mut Tracer, ray: &Ray, mut surface: Option<Surface>) {
        let scene = tracer.scene;
        let mut media = Media::at_start(tracer, ray);
        let (mut ray, mut beta) = (*ray, Rgb::WHITE);
        // The share of the sample that the ray still sees, and the normal of the surface that it came through.
        let (mut share, mut boundary) = (1.0, Vec3::ZERO);
        // How much denser radiance is where the ray is: what scatters in there sends all of it out again.
        let mut denser = 1.0;
        for event in 0..=MAX_SMOOTH {
            let direction = Vec3::from(ray.direction);
            if event > 0 {
                surface = tracer.closest(&ray);
            }
            let sight = CameraSegment::along(tracer, &mut media, &ray, surface, |_, _| {});
            if event == 0 {
                self.add_first(&sight);
            }
            let [air, inside] = sight.shares();
            self.albedo += beta * sight.albedo * denser;
            // Fog has no normal. What shines out of milk has that of its surface.
            self.normal += boundary * (share * inside);
            self.haze += share * (air + inside);
            (beta, share) = (beta * sight.transmittance, share * (1.0 - air - inside));
            let Some(surface) = sight.surface else {
                self.albedo += beta * scene.background(direction, event).clamp(0.0, 1.0);
                return;
            };
            let classic = scene.material(&surface).classic(&surface);
            // Where there is a diffuse lobe, not all lobes are smooth.
            let may_be_smooth = event < MAX_SMOOTH && classic.kd.is_black();
            let smooth =
                may_be_smooth.then(|| media.bsdf(scene, &surface, &Wavelength::D)).and_then(|bsdf| {
                    let only_way = || bsdf.sample(-direction, 0.5, Vec2::splat(0.5), TransportMode::Radiance);
                    bsdf.is_delta().then(only_way).flatten()
                });
            let normal = visible_normal(&surface, direction);
            let Some(next) = smooth else {
                self.albedo += beta * albedo(&classic, scene.emission(&surface, -direction));
                self.normal += normal * share;
                let is_murky =
                    scene.scatters() && scene.material(&surface).medium().is_some_and(|m| m.scatters());
                self.haze += if is_murky { share } else { 0.0 };
                return;
            };
            beta *= next.weight.clamp(0.0, 1.0);
            denser *= next.eta * next.eta;
            media = media.beyond(scene, &surface, -direction, next.wi);
            (ray, boundary) = (surface.spawn(next.wi), normal);
        }
    }

    /// Adds what the camera itself sees.
    fn add_first(&mut self, sight: &CameraSegment) {
        let [depth, weight] = sight.depth();
        self.depth += depth * weight;
        self.seen += weight;
        self.covered += sight.coverage();
    }
}

/// The albedo of a surface by the colours of its material, or its emission where that is larger.
fn albedo(classic: &ClassicMaterial, glows: Rgb) -> Rgb {
    let channel = |c: usize| (classic.kd[c] + classic.ks[c].max(classic.kt[c])).max(glows[c]);
    Rgb::from_array([0, 1, 2].map(channel)).clamp(0.0, 1.0)
}

impl Features {
    fn of(
        window: Window,
        tiles: Vec<(Tile, Vec<Sums>)>,
        samples: u32,
        has_haze: bool,
    ) -> Result<Features, RenderError> {
        let (pixels, share) = (window.pixels(), 1.0 / samples as f32);
        let mut all = Features {
            window,
            albedo: zeroed(pixels)?,
            mean_normal: zeroed(pixels)?,
            mean_depth: zeroed(pixels)?,
            haze: zeroed(if has_haze { pixels } else { 0 })?,
            coverage: zeroed(pixels)?,
        };
        for (tile, sums) in tiles {
            for ((x, y), sum) in tile.positions().zip(&sums) {
                let Some(at) = window.index(x, y) else { continue };
                (all.albedo[at], all.mean_normal[at]) = (sum.albedo * share, sum.normal * share);
                all.mean_depth[at] = if sum.seen > 0.0 { sum.depth / sum.seen } else { f32::INFINITY };
                all.coverage[at] = sum.covered * share;
                if has_haze {
                    all.haze[at] = (sum.haze * share).min(1.0);
                }
            }
        }
        Ok(all)
    }

    /// Adds the wanted ones of the layers `albedo` and `guides` to a picture of the window.
    ///
    /// # Errors
    /// When the picture has a different size, or already has such layers.
    pub fn push_layers(&self, picture: &mut Picture, wanted: impl Fn(&str) -> bool) -> Result<(), FilmError> {
        if wanted("albedo") {
            picture.push_rgb("albedo", &self.albedo)?;
        }
        if wanted("guides") {
            self.push_guides(picture)?;
        }
        Ok(())
    }

    /// Adds what guides denoisers: albedo, normal, depth, and haze where there may be some, each the mean of a pixel's samples. In a picture with an alpha channel
    /// the mean is that of the samples that hit something.
    ///
    /// # Errors
    /// When the picture has a different size, or already has such layers.
    pub fn push_guides(&self, picture: &mut Picture) -> Result<(), FilmError> {
        let is_cut_out = picture.channel("A").is_some();
        let (albedo, normal) = self.guides(is_cut_out, 0..self.albedo.len());
        picture.push_rgb("guides", &albedo)?;
        for (axis, name) in ["guides.X", "guides.Y", "guides.Z"].into_iter().enumerate() {
            picture.push_channel(name, normal.iter().map(|n| n[axis]).collect())?;
        }
        picture.push_channel("guides.depth", self.mean_depth.clone())?;
        match self.haze(is_cut_out, 0..self.albedo.len()) {
            Some(haze) => Ok(picture.push_channel("guides.haze", haze)?),
            None => Ok(()),
        }
    }

    /// The haze of some pixels, if there may be some; if the picture `is_cut_out`, as a fraction of what is there.
    pub fn haze(&self, is_cut_out: bool, pixels: Range<usize>) -> Option<Vec<f32>> {
        let haze = self.haze.get(pixels.clone()).filter(|_| !self.haze.is_empty())?;
        let parts = haze.iter().zip(&self.coverage[pixels]);
        Some(
            parts
                .map(|(haze, all)| if is_cut_out && *all > 0.0 { (haze / all).min(1.0) } else { *haze })
                .collect(),
        )
    }

    /// The mean albedo and normal of some pixels; if the picture `is_cut_out` of its background, those of the samples that hit
    /// something.
    pub fn guides(&self, is_cut_out: bool, pixels: Range<usize>) -> (Vec<Rgb>, Vec<[f32; 3]>) {
        let factor =
            |i: usize| if is_cut_out && self.coverage[i] > 0.0 { 1.0 / self.coverage[i] } else { 1.0 };
        let albedo = pixels.clone().map(|i| self.albedo[i] * factor(i));
        (albedo.collect(), pixels.map(|i| (self.mean_normal[i] * factor(i)).to_array()).collect())
    }
}
