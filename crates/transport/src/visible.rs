//! What the camera sees first, for compositors: where its surfaces are, how they move over the picture, and how much of
//! each pixel each object covers.
//!
//! Positions, texture coordinates and motion are [labels](crate::labels). Coverage is counted in camera rays of the picture's
//! first samples. Mirrors and glass are surfaces like any other. The object that bounds fog or smoke covers what its inside hides of
//! what lies behind, and that covers the rest: the shares of a pixel add up to its alpha.

use crate::camera_rays::CameraRays;
use crate::error::{FilmError, RenderError};
use crate::failures::SamplePlace;
use crate::film::zeroed;
use crate::labels::labels;
use crate::media::Media;
use crate::pixel_integrator::PixelIntegrator;
use crate::progress::Progress;
use crate::settings::{RenderSettings, threads};
use crate::sight::Sight;
use crate::window::{TILE, Window};
use bilux_accel::Hit;
use bilux_math::{Vec2, Vec3};
use bilux_scene::media::mean;
use bilux_scene::{Camera, Ray, Scene, Surface, Tracer};
use rayon::prelude::*;

/// The camera rays of each pixel: at least this many, even where the picture has fewer samples, since coverage is
/// counted in them.
pub const MIN_SAMPLES: u32 = 16;
/// And at most this many.
pub const MAX_SAMPLES: u32 = 128;
/// The number of ids that a pixel can have; those that cover less of it are left out.
pub const RANKS: usize = 6;

/// What is wanted.
#[derive(Clone, Default)]
pub struct Wanted<'a> {
    /// [`Visible::position`].
    pub position: bool,
    /// [`Visible::uv`].
    pub uv: bool,
    /// [`Visible::motion`], to this moment.
    pub motion: Option<Moment<'a>>,
    /// For each [`Visible::mattes`], the ids of the scene's objects and spheres; 0 for none.
    pub ids: Vec<Vec<u32>>,
}

/// The scene at another time.
#[derive(Clone, Copy)]
pub struct Moment<'a> {
    /// The scene, of the same meshes.
    pub scene: &'a Scene,
    /// Its camera.
    pub camera: &'a dyn Camera,
    /// The time, in seconds.
    pub time: f32,
}

/// What is seen; planes of the window in rows, the top row first, and empty if they were not asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Visible {
    /// The point that the ray through the pixel's centre hits, in world space, in metres; 0 where nothing is visible.
    pub position: Vec<Vec3>,
    /// Its texture coordinates.
    pub uv: Vec<Vec2>,
    /// How far it moves over the picture until the other moment, in pixels: to the right, and upwards.
    pub motion: Vec<Vec2>,
    /// The ids of each pixel, those that cover most of it first, with the fractions that they cover, 0..=1.
    pub mattes: Vec<Vec<Ranks>>,
}

/// Ids and the fractions of a pixel that they cover.
pub type Ranks = [(u32, f32); RANKS];

/// Looks at each pixel; `None` when it was cancelled. `samples` is the number of samples that the picture has.
///
/// # Errors
/// When the size or the crop is invalid, or there is not enough memory or no threads.
pub fn visible(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    wanted: &Wanted,
    samples: u32,
    progress: &dyn Progress,
) -> Result<Option<Visible>, RenderError> {
    settings.check()?;
    let least = if integrator.is_random() { MIN_SAMPLES } else { 1 };
    let look = Look {
        eye: integrator.camera_rays(scene, camera, settings),
        camera,
        wanted,
        samples: samples.clamp(least, MAX_SAMPLES),
        has_interfaces: scene.has_interfaces(),
    };
    let window = settings.window();
    let of_tile = |tile: Window| (!progress.is_cancelled()).then(|| look.tile(tile));
    let tiles: Option<Vec<Vec<Seen>>> =
        threads(settings)?.install(|| window.tiles(TILE).into_par_iter().map(of_tile).collect());
    let Some(tiles) = tiles else { return Ok(None) };
    Ok(Some(look.assembled(window, tiles)?))
}

/// Everything that stays the same while the pixels are looked at.
struct Look<'a> {
    eye: CameraRays<'a>,
    camera: &'a dyn Camera,
    wanted: &'a Wanted<'a>,
    samples: u32,
    has_interfaces: bool,
}

/// A pixel.
#[derive(Clone, Default)]
struct Seen {
    first: Option<(Surface, Vec2)>,
    mattes: Vec<Ranks>,
}

impl<'a> Look<'a> {
    fn tile(&self, tile: Window) -> Vec<Seen> {
        let mut tracer = Tracer::new(self.eye.context.scene, false);
        let mut counts = vec![Vec::new(); self.wanted.ids.len()];
        let mut seen = vec![Seen::default(); tile.pixels()];
        if self.wanted.position || self.wanted.uv || self.wanted.motion.is_some() {
            for (seen, label) in seen.iter_mut().zip(labels(&self.eye, &tile, &mut tracer)) {
                seen.first = label.map(|label| (label.surface, self.motion(&label.hit, &label.surface)));
            }
        }
        if !counts.is_empty() {
            for (i, seen) in seen.iter_mut().enumerate() {
                seen.mattes = self.mattes(tile.position(i), &mut tracer, &mut counts);
            }
        }
        seen
    }

    /// The mattes of a pixel, counted in its samples. `counts` is memory for its ids.
    fn mattes(
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
            for (counts, ids) in counts.iter_mut().zip(&self.wanted.ids) {
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

    /// How far the point moves over the picture, in pixels.
    fn motion(&self, hit: &Hit, surface: &Surface) -> Vec2 {
        let Some(next) = &self.wanted.motion else { return Vec2::ZERO };
        let opens = self.eye.context.scene.shutter()[0];
        let here = self.eye.context.scene.geometry();
        let [from, to] = here.moved(hit, surface.p, next.scene.geometry(), [opens, next.time]);
        let from = self.camera.project(from, opens);
        let Some((from, to)) = from.zip(next.camera.project(to, next.time)) else { return Vec2::ZERO };
        let settings = self.eye.settings;
        (to - from) * Vec2::new(settings.width as f32, -(settings.height as f32))
    }

    fn assembled(&self, window: Window, tiles: Vec<Vec<Seen>>) -> Result<Visible, FilmError> {
        let wants = |wanted: bool| if wanted { window.pixels() } else { 0 };
        let mut all = Visible {
            position: zeroed(wants(self.wanted.position))?,
            uv: zeroed(wants(self.wanted.uv))?,
            motion: zeroed(wants(self.wanted.motion.is_some()))?,
            mattes: Vec::new(),
        };
        for _ in &self.wanted.ids {
            all.mattes.push(zeroed(window.pixels())?);
        }
        for (tile, pixels) in window.tiles(TILE).into_iter().zip(tiles) {
            for (i, seen) in pixels.into_iter().enumerate() {
                let (x, y) = tile.position(i);
                let Some(at) = window.index(x, y) else { continue };
                if let Some((surface, motion)) = seen.first {
                    put(&mut all.position, at, surface.p);
                    put(&mut all.uv, at, surface.uv);
                    put(&mut all.motion, at, motion);
                }
                all.mattes.iter_mut().zip(seen.mattes).for_each(|(matte, ranks)| put(matte, at, ranks));
            }
        }
        Ok(all)
    }
}

/// Sets a value, if the plane was asked for.
fn put<T>(plane: &mut [T], at: usize, value: T) {
    if let Some(place) = plane.get_mut(at) {
        *place = value;
    }
}

/// The share of a sample that each object covers, among fog and smoke, given what its ray hits first.
fn covered(tracer: &mut Tracer, ray: &Ray, hit: &Hit, add: &mut impl FnMut(u32, f32)) {
    let first = tracer.surface(ray, hit);
    let mut media = Media::at_start(tracer, ray);
    let sight = Sight::along(tracer, &mut media, ray, Some(first), &mut *add);
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
