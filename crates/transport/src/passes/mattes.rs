//! Mattes for compositors: how much of each pixel each object covers.
//!
//! Coverage is counted in camera rays of the picture's first samples. Mirrors and glass are surfaces like any other. The object
//! that bounds fog or smoke covers what its inside hides of what lies behind, and that covers the rest: the shares of a pixel add
//! up to its alpha.

use crate::film::error::RenderError;
use crate::film::failures::SamplePlace;
use crate::film::window::{TILE, Window};
use crate::film::zeroed;
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::media::Media;
use crate::media::camera_segment::CameraSegment;
use crate::sampling::camera_rays::CameraRays;
use crate::schedule::progress::Progress;
use crate::schedule::settings::{RenderSettings, threads};
use bilux_accel::Hit;
use bilux_math::parallel::{install, map};
use bilux_scene::media::mean;
use bilux_scene::{Camera, Ray, Scene, Tracer};

/// The camera rays of each pixel: at least this many, even where the picture has fewer samples, since coverage is
/// counted in them.
pub const MIN_SAMPLES: u32 = 16;
/// And at most this many.
pub const MAX_SAMPLES: u32 = 128;
/// The number of ids that a pixel can have; those that cover less of it are left out.
pub const RANKS: usize = 6;

/// Ids and the fractions of a pixel that they cover.
pub type Ranks = [(u32, f32); RANKS];

/// The ids of each pixel, those that cover most of it first, with the fractions that they cover, 0..=1: planes of the window in
/// rows, the top row first, one for each list of ids. A list has the ids of the scene's objects and spheres, 0 for none.
/// `samples` is the number of samples that the picture has. `None` when it was cancelled.
///
/// # Errors
/// When the size or the crop is invalid, or there is not enough memory or no threads.
pub fn mattes(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    ids: &[Vec<u32>],
    samples: u32,
    progress: &dyn Progress,
) -> Result<Option<Vec<Vec<Ranks>>>, RenderError> {
    settings.check()?;
    let least = if integrator.is_random() { MIN_SAMPLES } else { 1 };
    let look = Look {
        eye: integrator.camera_rays(scene, camera, settings),
        ids,
        samples: samples.clamp(least, MAX_SAMPLES),
        has_interfaces: scene.has_interfaces(),
    };
    let window = settings.window();
    let of_tile = |tile: Window| (!progress.is_cancelled()).then(|| look.tile(tile));
    let tiles = install(&threads(settings)?, || map(window.tiles(TILE), of_tile));
    let Some(tiles) = tiles.into_iter().collect::<Option<Vec<Vec<Vec<Ranks>>>>>() else { return Ok(None) };
    let mut planes = Vec::new();
    for _ in ids {
        planes.push(zeroed::<Ranks>(window.pixels())?);
    }
    for (tile, pixels) in window.tiles(TILE).into_iter().zip(tiles) {
        for (i, ranks) in pixels.into_iter().enumerate() {
            let (x, y) = tile.position(i);
            let Some(at) = window.index(x, y) else { continue };
            planes.iter_mut().zip(ranks).for_each(|(plane, ranks)| plane[at] = ranks);
        }
    }
    Ok(Some(planes))
}

/// Everything that stays the same while the pixels are looked at.
struct Look<'a> {
    eye: CameraRays<'a>,
    ids: &'a [Vec<u32>],
    samples: u32,
    has_interfaces: bool,
}

impl<'a> Look<'a> {
    fn tile(&self, tile: Window) -> Vec<Vec<Ranks>> {
        let mut tracer = Tracer::new(self.eye.context.scene, false);
        let mut counts = vec![Vec::new(); self.ids.len()];
        let pixels = 0..tile.pixels();
        pixels.map(|i| self.pixel(tile.position(i), &mut tracer, &mut counts)).collect()
    }

    /// The mattes of a pixel, counted in its samples. `counts` is memory for its ids.
    fn pixel(
        &self,
        (x, y): (u32, u32),
        tracer: &mut Tracer<'a>,
        counts: &mut [Vec<(u32, f32)>],
    ) -> Vec<Ranks> {
        let rays: Vec<Ray> =
            (0..self.samples).map(|sample| self.eye.sample(SamplePlace { x, y, sample }).0).collect();
        let mut hits = vec![None; rays.len()];
        tracer.hits(&rays, &mut hits);
        counts.iter_mut().for_each(Vec::clear);
        let mut add = |object: u32, share: f32| {
            for (counts, ids) in counts.iter_mut().zip(self.ids) {
                count(counts, ids.get(object as usize).copied().unwrap_or_default(), share);
            }
        };
        for (ray, hit) in rays.iter().zip(&hits).filter_map(|(ray, hit)| Some((ray, hit.as_ref()?))) {
            if self.has_interfaces {
                covered(tracer, ray, hit, &mut add);
            } else {
                add(self.eye.context.scene.geometry().object_of(hit), 1.0);
            }
        }
        counts.iter_mut().map(|counts| ranked(counts, self.samples)).collect()
    }
}

/// The share of a sample that each object covers, among fog and smoke, given what its ray hits first.
fn covered(tracer: &mut Tracer, ray: &Ray, hit: &Hit, add: &mut impl FnMut(u32, f32)) {
    let first = tracer.surface(ray, hit);
    let mut media = Media::at_start(tracer, ray);
    let sight = CameraSegment::along(tracer, &mut media, ray, Some(first), &mut *add);
    if let Some(surface) = sight.surface {
        add(surface.object, mean(sight.transmittance));
    }
}

/// Counts a share of a sample for an id; 0 is none.
fn count(counts: &mut Vec<(u32, f32)>, id: u32, share: f32) {
    match counts.iter_mut().find(|(known, _)| *known == id) {
        _ if id == 0 || share <= 0.0 => {}
        Some((_, count)) => *count += share,
        None => counts.push((id, share)),
    }
}

/// The ids that cover most; those that cover as much by their numbers.
fn ranked(counts: &mut [(u32, f32)], samples: u32) -> Ranks {
    counts.sort_unstable_by(|(a, most), (b, least)| least.total_cmp(most).then(a.cmp(b)));
    let mut ranks = Ranks::default();
    for (rank, &(id, count)) in ranks.iter_mut().zip(counts.iter()) {
        *rank = (id, count / samples as f32);
    }
    ranks
}
