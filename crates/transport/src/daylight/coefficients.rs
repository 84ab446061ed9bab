//! Daylight coefficients: how much each point receives of the light of each patch of the sky. [Tregenza 1983]
//!
//! The light of a day or a year is then a product: of these coefficients with the luminances of the patches, hour by hour.

use super::SkyPatches;
use super::sunlight::Straight;
use crate::film::error::{FilmError, RenderError};
use crate::film::failures::SamplePlace;
use crate::film::interval::REPLICATES;
use crate::integrators::pixel_integrator::PixelIntegrator;
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::task::{FoundLight, Record, Task};
use crate::schedule::progress::Progress;
use crate::schedule::settings::{RenderSettings, threads};
use bilux_math::Rgb;
use bilux_math::parallel::{for_each, install};
use bilux_scene::cameras::{SensorPoint, SensorPoints};
use bilux_scene::{Scene, Tracer};
use std::f64::consts::PI;

/// The coefficient of a point and a patch, in sr: its illuminance in lx where the patch has a luminance of 1 cd/m²; and its
/// standard error, which is infinite after fewer samples than there are independent sequences of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PartOfSky {
    /// The coefficient.
    pub mean: f32,
    /// Standard error of the coefficient.
    pub error: f32,
}

/// The coefficients of points, one row after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct DaylightCoefficients {
    /// Of all light.
    pub all: Vec<PartOfSky>,
    /// Of what does not come straight from the patch: see [`sunlight`](super::sunlight()).
    pub reflected: Vec<PartOfSky>,
}

/// Edges of a path from the light to the point, and on from the paper there.
const STRAIGHT: u32 = 2;

/// Light that a point has received, by patches.
struct Sums {
    /// Of each replicate, patch by patch: all light, and what does not come straight.
    replicates: Vec<[f64; 2]>,
}

/// The coefficients of each point, patch by patch. The scene's infinite lights are sampled as they are, so they should shine from
/// everywhere; other lights do not count. `None` when it was cancelled.
///
/// # Errors
/// When the integrator does not report what it receives, or there is not enough memory.
pub fn daylight_coefficients(
    scene: &Scene,
    points: &SensorPoints,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    patches: &SkyPatches,
    progress: &dyn Progress,
) -> Result<Option<DaylightCoefficients>, RenderError> {
    settings.check()?;
    if !integrator.receives() || !integrator.reports_light() {
        return Err(RenderError::Receives);
    }
    let settings = &RenderSettings { interval: true, ..settings.clone() };
    let all = points.points().len();
    let mut table: Vec<[PartOfSky; 2]> = Vec::new();
    let room = all.checked_mul(patches.count()).filter(|room| table.try_reserve_exact(*room).is_ok());
    table.resize(room.ok_or(FilmError::NoRoom { pixels: all as u64 })?, Default::default());
    let pool = threads(settings)?;
    progress.begin(all as u64 * settings.samples.len() as u64);
    let eye = integrator.camera_rays(scene, points, settings);
    let of_point = |(i, row): (usize, &mut [[PartOfSky; 2]])| {
        if !progress.is_cancelled() {
            let mut sums = Sums { replicates: vec![[0.0; 2]; patches.count() * REPLICATES as usize] };
            sums.add(integrator, &eye, (points.points()[i], points.pixel(i)), patches, progress);
            sums.estimates(settings.samples.len() as u32, row);
        }
    };
    install(&pool, || for_each(table.chunks_exact_mut(patches.count()).enumerate(), of_point));
    let column = |part: usize| table.iter().map(|parts| parts[part]).collect();
    let found = || DaylightCoefficients { all: column(0), reflected: column(1) };
    Ok((!progress.is_cancelled()).then(found))
}

impl Sums {
    /// Adds the samples of a point.
    fn add(
        &mut self,
        integrator: &dyn PixelIntegrator,
        eye: &CameraRays,
        (point, [x, y]): (SensorPoint, [u32; 2]),
        patches: &SkyPatches,
        progress: &dyn Progress,
    ) {
        let mut tracer = Tracer::new(eye.context.scene, false);
        let straight = Straight::from(&mut tracer, &point);
        let mut memory = Vec::new();
        for sample in eye.settings.samples.clone() {
            let (ray, mut state) = eye.sample(SamplePlace { x, y, sample });
            let found = Some(std::mem::take(&mut memory));
            state.record = Some(Box::new(Record { found, ..Record::default() }));
            let mut task = Task { context: &eye.context, tracer: &mut tracer, sample: &mut state };
            integrator.radiance(&ray, &mut task);
            let record = state.record.map(|record| *record).unwrap_or_default();
            let Record { first, straight: sampled, found, .. } = record;
            memory = found.unwrap_or_default();
            let own = &mut self.replicates[(sample % REPLICATES) as usize * patches.count()..];
            for (number, light) in memory.drain(..).enumerate() {
                let part = f64::from(part_of_sky(eye.context.scene, &light));
                if part.is_finite() {
                    // Where it left the point in the direction from which it came, nothing has turned it.
                    let comes_straight = number < sampled
                        || light.edges <= STRAIGHT
                        || first.is_some_and(|first| straight.is_same(first, light.towards))
                            && straight.passed(&mut tracer, light.towards) != Rgb::BLACK;
                    let [all, reflected] = &mut own[patches.number(light.towards)];
                    *all += part;
                    *reflected += if comes_straight { 0.0 } else { part };
                }
            }
        }
        progress.advance(eye.settings.samples.len() as u64, tracer.counters.rays);
    }

    /// The means after so many samples, and their errors.
    fn estimates(&self, samples: u32, row: &mut [[PartOfSky; 2]]) {
        let patches = row.len();
        let count =
            |replicate: u32| f64::from(samples / REPLICATES + u32::from(samples % REPLICATES > replicate));
        for (patch, parts) in row.iter_mut().enumerate() {
            *parts = [0, 1].map(|part| {
                let sums = || {
                    (0..REPLICATES).map(|i| (self.replicates[i as usize * patches + patch][part], count(i)))
                };
                let mean = sums().map(|(sum, _)| sum).sum::<f64>() / f64::from(samples);
                let squares: f64 = sums()
                    .filter(|(_, count)| *count > 0.0)
                    .map(|(sum, count)| count * (sum / count - mean) * (sum / count - mean))
                    .sum();
                let freedom = f64::from(REPLICATES - 1) * f64::from(samples);
                let error = if samples < REPLICATES { f64::INFINITY } else { (squares / freedom).sqrt() };
                PartOfSky { mean: (mean * PI) as f32, error: (error * PI) as f32 }
            });
        }
    }
}

/// Light of a patch of radiance 1 that a sample has found.
fn part_of_sky(scene: &Scene, found: &FoundLight) -> f32 {
    let towards = found.towards.normalize_or_zero();
    let shining = found.light.map_or(Rgb::BLACK, |index| scene.lights()[index].light.le(towards));
    found.radiance.luminance() / shining.luminance()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two samples of each independent sequence, whose means are 0, 1, 2 …: their mean has the standard deviation of them over the root
    /// of their number.
    #[test]
    fn errors_are_those_of_the_mean_of_the_sequences() {
        let replicates = (0..REPLICATES).map(|i| [2.0 * f64::from(i), 0.0]).collect();
        let mut row = [[PartOfSky::default(); 2]];
        Sums { replicates }.estimates(2 * REPLICATES, &mut row);
        let n = f64::from(REPLICATES);
        let deviation = (n * (n + 1.0) / 12.0).sqrt();
        let [all, reflected] = row[0];
        assert!((f64::from(all.mean) / (PI * (n - 1.0) / 2.0) - 1.0).abs() < 1e-6, "{all:?}");
        assert!((f64::from(all.error) / (PI * deviation / n.sqrt()) - 1.0).abs() < 1e-6, "{all:?}");
        assert_eq!(reflected, PartOfSky { mean: 0.0, error: 0.0 });
    }

    /// Of eleven samples the first three sequences have two: where all are alike, there is no error.
    #[test]
    fn sequences_may_have_different_numbers_of_samples() {
        let alike = (0..REPLICATES).map(|i| if i < 3 { [4.0, 1.0] } else { [2.0, 0.5] }).collect();
        let mut row = [[PartOfSky::default(); 2]];
        Sums { replicates: alike }.estimates(REPLICATES + 3, &mut row);
        for (found, wanted) in row[0].iter().zip([2.0 * PI, 0.5 * PI]) {
            assert!((f64::from(found.mean) / wanted - 1.0).abs() < 1e-6 && found.error < 1e-6, "{row:?}");
        }
    }
}
