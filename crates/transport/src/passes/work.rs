//! Cost of each pixel: the rays that its samples trace, what these ask of the accelerator, and the vertices of its paths.
//!
//! The samples of the picture are taken once more, one at a time, as [`crate::replay()`] takes them. Work is counted and
//! not clocked: seconds would depend on the machine and its load, and so would the bytes of the picture. Rays and vertices
//! are the same whichever accelerator answers; nodes and primitive tests are what it is compared by.

use crate::film::error::{FilmError, RenderError};
use crate::film::failures::SamplePlace;
use crate::film::window::{TILE, Window};
use crate::film::{scale_exponent, zeroed};
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::passes::photon_tracing::iterations;
use crate::photons::Photons;
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::splats::Splats;
use crate::sampling::task::Task;
use crate::schedule::progress::Progress;
use crate::schedule::settings::{RenderSettings, threads};
use bilux_math::parallel::{for_each, install};
use bilux_scene::{Camera, Scene, Tracer};
use std::ops::Range;

/// The mean work of a sample of each pixel; planes of the window in rows, the top row first.
///
/// A sample's light subpath counts in the pixel of the sample, wherever its light arrives. Photons are of no pixel, and not
/// counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Work {
    /// The pixels that they cover.
    pub window: Window,
    /// Rays, shadow rays included.
    pub rays: Vec<f32>,
    /// Surfaces that its paths reach: from the camera, and from the light where the integrator traces paths from there.
    pub path_length: Vec<f32>,
    /// Nodes of the accelerator that the rays visit; 0 unless they were asked for.
    pub nodes: Vec<f32>,
    /// Primitives that the rays are tested with; 0 unless they were asked for.
    pub tests: Vec<f32>,
}

/// Sums over the samples of one pixel: rays, vertices, nodes and primitive tests.
type Sums = [u64; 4];

/// Counts the work of the requested samples; that of the accelerator only `with_accel`, since counting it takes time. `None`
/// when it was cancelled.
///
/// # Errors
/// As [`crate::render()`].
pub fn work(
    scene: &Scene,
    camera: &dyn Camera,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    with_accel: bool,
    progress: &dyn Progress,
) -> Result<Option<Work>, RenderError> {
    settings.check()?;
    let pool = threads(settings)?;
    let plan = install(&pool, || integrator.plan(scene, camera, &settings.for_planning()));
    let integrator = plan.as_ref().map_or(integrator, |plan| &*plan.integrator);
    let (window, whole) = (settings.window(), Window::whole(settings.width, settings.height));
    progress.begin(window.pixels() as u64 * settings.samples.len() as u64);
    let empty = |tile: Window| Ok((tile, zeroed::<Sums>(tile.pixels())?));
    let mut tiles = window.tiles(TILE).into_iter().map(empty).collect::<Result<Vec<_>, FilmError>>()?;
    for samples in iterations(integrator, &settings.samples) {
        let mut eye = integrator.camera_rays(scene, camera, settings);
        let of_whole = whole.tiles(TILE);
        let photons =
            install(&pool, || Photons::of_iteration(integrator, &eye, &of_whole, samples.start, None, None));
        eye.photons = photons.as_ref().map(|(photons, _)| photons);
        let each = |(tile, sums): &mut (Window, Vec<Sums>)| {
            count(integrator, &eye, tile, sums, &samples, with_accel, progress);
        };
        install(&pool, || for_each(&mut tiles, each));
    }
    if progress.is_cancelled() { Ok(None) } else { Work::of(window, tiles, settings.samples.len()).map(Some) }
}

/// Adds the work of a tile's samples.
fn count(
    integrator: &dyn PixelIntegrator,
    eye: &CameraRays,
    tile: &Window,
    sums: &mut [Sums],
    samples: &Range<u32>,
    with_accel: bool,
    progress: &dyn Progress,
) {
    let mut tracer = Tracer::new(eye.context.scene, with_accel);
    let mut splats = Splats::new(eye.settings, *tile, scale_exponent(eye.context.scene));
    for (i, sums) in sums.iter_mut().enumerate() {
        if progress.is_cancelled() {
            return;
        }
        let ((x, y), before) = (tile.position(i), tracer.counters);
        for sample in samples.clone() {
            let (ray, mut state) = eye.sample(SamplePlace { x, y, sample });
            let mut task = Task { context: &eye.context, tracer: &mut tracer, sample: &mut state };
            splats.begin(x, y, sample);
            integrator.sample(&ray, true, eye.photons, &mut task, &mut splats);
            splats.deposits.clear();
            sums[1] += u64::from(state.vertices);
        }
        let now = tracer.counters;
        sums[0] += now.rays - before.rays;
        sums[2] += now.nodes - before.nodes;
        sums[3] += now.triangles - before.triangles;
    }
    progress.advance(tile.pixels() as u64 * samples.len() as u64, tracer.counters.rays);
}

impl Work {
    fn of(window: Window, tiles: Vec<(Window, Vec<Sums>)>, samples: usize) -> Result<Work, RenderError> {
        let plane = || zeroed::<f32>(window.pixels());
        let mut planes = [plane()?, plane()?, plane()?, plane()?];
        for (tile, sums) in tiles {
            for (i, sums) in sums.iter().enumerate() {
                let (x, y) = tile.position(i);
                let Some(at) = window.index(x, y) else { continue };
                let mean = |sum: u64| (sum as f64 / samples.max(1) as f64) as f32;
                planes.iter_mut().zip(sums).for_each(|(plane, sum)| plane[at] = mean(*sum));
            }
        }
        let [rays, path_length, nodes, tests] = planes;
        Ok(Work { window, rays, path_length, nodes, tests })
    }
}
