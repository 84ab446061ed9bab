//! A heat map of the work that the accelerator does for the ray of each pixel: nodes that it visits, and triangles that
//! it tests.

use bilux::math::Vec2;
use bilux::math::transcendental::log2;
use bilux::pictures::metrics::ramp;
use bilux::pictures::{ColourSpace, Picture};
use bilux::scene::{CameraSample, Ray, Tracer};
use bilux::{Error, Job};
use std::time::{Duration, Instant};

/// The work at the upper end of the scale, which is logarithmic and the same for all accelerators.
const MOST: f32 = 65_536.0;

/// Time that the heat map may take: a slow accelerator is shown in coarse squares.
const TIME: Duration = Duration::from_millis(300);

/// The sides of the coarsest squares, in pixels.
const COARSEST: usize = 32;

/// The ray through the middle of a place of the film.
pub(super) fn ray(job: &Job, film: Vec2) -> Ray {
    let sample = CameraSample { film, lens: Vec2::ZERO, time: job.settings().time };
    job.scene().from_camera(job.camera().ray(&sample))
}

/// The heat map of a job's picture.
///
/// # Errors
/// If memory is short.
pub(super) fn picture(job: &Job) -> Result<Picture, Error> {
    let settings = job.settings();
    let (width, height) = (settings.width as usize, settings.height as usize);
    let (begun, mut side) = (Instant::now(), COARSEST);
    let mut work = squares(job, [width, height], side);
    // The next finer map has four times the rays.
    while side > 1 && begun.elapsed() * 4 < TIME {
        side /= 2;
        work = squares(job, [width, height], side);
    }
    let across = width.div_ceil(side);
    let colours = (0..width * height).map(|i| {
        let (x, y) = (i % width, i / width);
        ramp(log2(1.0 + work[(y / side) * across + x / side]) / log2(1.0 + MOST))
    });
    let mut picture = Picture::from_rgb(width, height, colours.collect())?;
    picture.colour_space = ColourSpace::Srgb;
    Ok(picture)
}

/// The work for the ray in the middle of each square, row by row.
fn squares(job: &Job, [width, height]: [usize; 2], side: usize) -> Vec<f32> {
    let (across, down) = (width.div_ceil(side), height.div_ceil(side));
    let mut work = vec![0.0; across * down];
    let threads = match job.settings().threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    };
    let rows = down.div_ceil(threads);
    std::thread::scope(|scope| {
        for (part, work) in work.chunks_mut(rows * across).enumerate() {
            scope.spawn(move || {
                let mut tracer = Tracer::new(job.scene(), true);
                for (i, place) in work.iter_mut().enumerate() {
                    let at = [i % across, part * rows + i / across];
                    let middle = |at: usize, side_of_all: usize| {
                        ((at * side) as f32 + 0.5 * side as f32).min(side_of_all as f32 - 0.5)
                            / side_of_all as f32
                    };
                    let before = tracer.counters;
                    tracer.hit(&ray(job, Vec2::new(middle(at[0], width), middle(at[1], height))));
                    let now = tracer.counters;
                    *place = (now.nodes - before.nodes + now.triangles - before.triangles) as f32;
                }
            });
        }
    });
    work
}
