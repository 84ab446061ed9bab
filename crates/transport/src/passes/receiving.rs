//! Light that points receive, and how certain that is: each is measured on its own, without a film.

use crate::film::error::{FilmError, RenderError};
use crate::film::failures::SamplePlace;
use crate::film::interval::{Estimate, REPLICATES, quantile};
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::task::Task;
use crate::schedule::progress::Progress;
use crate::schedule::settings::{RenderSettings, threads};
use bilux_math::Rgb;
use bilux_math::parallel::{for_each, install};
use bilux_scene::cameras::SensorPoints;
use bilux_scene::{Scene, Tracer};
use std::f64::consts::PI;
use std::ops::Range;
use std::time::Instant;

/// The samples after which it is first asked whether they are enough.
const FIRST: u32 = 64;

/// Light that points receive.
#[derive(Clone, Debug, PartialEq)]
pub struct Received {
    /// Irradiance of each point in W/m²: red, green, blue and luminance.
    pub points: Vec<[Estimate; 4]>,
    /// Samples that each point got.
    pub samples: u32,
    /// Half-width of the intervals in standard errors.
    pub quantile: f64,
}

/// The sums of a point.
#[derive(Clone, Debug, Default)]
struct Sums {
    /// Of each replicate: red, green, blue and luminance.
    replicates: [[f64; 4]; REPLICATES as usize],
    /// A sample was infinite or NaN.
    is_bad: bool,
}

/// Measures points with all samples of the settings, or until their noise level or time limit is reached. `None` when it was
/// cancelled before the first samples were complete.
///
/// # Errors
/// When the integrator does not measure, or there is not enough memory.
pub fn received(
    scene: &Scene,
    points: &SensorPoints,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    progress: &dyn Progress,
) -> Result<Option<Received>, RenderError> {
    settings.check()?;
    let settings = &RenderSettings { interval: true, ..settings.clone() };
    let pool = threads(settings)?;
    let plan = install(&pool, || integrator.plan(scene, points, &settings.for_planning()));
    let integrator = plan.as_ref().map_or(integrator, |plan| &*plan.integrator);
    if !integrator.receives() {
        return Err(RenderError::Receives);
    }
    let (count, begun) = (points.points().len(), Instant::now());
    let mut sums: Vec<Sums> = Vec::new();
    sums.try_reserve_exact(count).map_err(|_| FilmError::NoRoom { pixels: count as u64 })?;
    sums.resize(count, Sums::default());
    let eye = integrator.camera_rays(scene, points, settings);
    let ends = settings.stop.noise.is_some() || settings.stop.time_limit.is_some();
    let all = settings.samples.len() as u32;
    progress.begin(count as u64 * u64::from(all));
    let (mut taken, mut next) = (0, if ends { FIRST.min(all) } else { all });
    let mut kept = None;
    loop {
        let samples = taken..next;
        let of_point = |(i, sums): (usize, &mut Sums)| {
            sums.add(integrator, &eye, points.pixel(i), samples.clone(), progress);
        };
        install(&pool, || for_each(sums.iter_mut().enumerate(), of_point));
        if progress.is_cancelled() {
            return Ok(kept);
        }
        taken = next;
        let found = Received::of(&sums, taken);
        let is_late = settings.stop.time_limit.is_some_and(|limit| begun.elapsed() * 2 > limit);
        if taken == all
            || is_late
            || settings.stop.noise.is_some_and(|noise| found.noise() <= f64::from(noise))
        {
            return Ok(Some(found));
        }
        kept = Some(found);
        next = taken.saturating_mul(2).min(all);
    }
}

impl Sums {
    fn add(
        &mut self,
        integrator: &dyn PixelIntegrator,
        eye: &CameraRays,
        [x, y]: [u32; 2],
        samples: Range<u32>,
        progress: &dyn Progress,
    ) {
        let mut tracer = Tracer::new(eye.context.scene, false);
        let count = samples.len() as u64;
        for sample in samples {
            if sample % FIRST == 0 && progress.is_cancelled() {
                return;
            }
            let (ray, mut state) = eye.sample(SamplePlace { x, y, sample });
            let mut task = Task { context: &eye.context, tracer: &mut tracer, sample: &mut state };
            let light = integrator.radiance(&ray, &mut task);
            self.is_bad |= !light.is_finite();
            let light = if light.is_finite() { light } else { Rgb::BLACK };
            let all = [light.r, light.g, light.b, light.luminance()];
            let own = &mut self.replicates[(sample % REPLICATES) as usize];
            own.iter_mut().zip(all).for_each(|(sum, light)| *sum += f64::from(light));
        }
        progress.advance(count, tracer.counters.rays);
    }

    /// The mean and its interval after so many samples; infinitely wide after one, and where a sample was bad.
    fn estimates(&self, samples: u32, quantile: f64) -> [Estimate; 4] {
        let counts =
            |replicate: u32| f64::from(samples / REPLICATES + u32::from(samples % REPLICATES > replicate));
        let freedom = samples.min(REPLICATES).saturating_sub(1);
        [0, 1, 2, 3].map(|channel| {
            let replicates = || (0..REPLICATES).map(|i| (self.replicates[i as usize][channel], counts(i)));
            let mean = replicates().map(|(sum, _)| sum).sum::<f64>() / f64::from(samples);
            let off = |(sum, count): (f64, f64)| {
                if count > 0.0 { count * (sum / count - mean) * (sum / count - mean) } else { 0.0 }
            };
            let squares = replicates().map(off).sum::<f64>();
            let error = (squares / (f64::from(freedom) * f64::from(samples))).sqrt();
            let is_known = freedom > 0 && !self.is_bad;
            let half_width = if is_known { error * quantile * PI } else { f64::INFINITY };
            Estimate { mean: mean * PI, half_width }
        })
    }
}

impl Received {
    fn of(sums: &[Sums], samples: u32) -> Received {
        let quantile = quantile(samples.min(REPLICATES).saturating_sub(1));
        let points = sums.iter().map(|sums| sums.estimates(samples, quantile)).collect();
        Received { points, samples, quantile }
    }

    /// The standard error of luminances as a fraction of the luminances, on average over the points.
    fn noise(&self) -> f64 {
        let sum = |of: fn(&Estimate) -> f64| self.points.iter().map(|[.., light]| of(light)).sum::<f64>();
        let (error, light) = (sum(|light| light.half_width) / self.quantile, sum(|light| light.mean));
        if light > 0.0 { error / light } else { 0.0 }
    }
}
