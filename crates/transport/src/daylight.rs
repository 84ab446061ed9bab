//! Daylight coefficients: how much each point receives of the light of each patch of the sky. [Tregenza 1983]
//!
//! The light of a day or a year is then a product: of these coefficients with the luminances of the patches, hour by hour.

use crate::camera_rays::CameraRays;
use crate::error::{FilmError, RenderError};
use crate::failures::SamplePlace;
use crate::pixel_integrator::PixelIntegrator;
use crate::progress::Progress;
use crate::settings::{RenderSettings, threads};
use crate::task::{FoundLight, Record, Task};
use bilux_math::parallel::{for_each, install};
use bilux_math::transcendental::turns_of_point;
use bilux_math::{Rgb, Vec3};
use bilux_scene::cameras::SensorPoints;
use bilux_scene::{Scene, Tracer};
use std::f32::consts::PI;

/// A sky in rows of patches, from the horizon to the zenith, and the ground. Up is +y, north is -z, east is +x.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyPatches {
    rows: Vec<SkyRow>,
    count: usize,
}

/// A row of patches.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SkyRow {
    /// The sine of the elevation of its lower edge.
    height: f32,
    /// The number of its first patch.
    first: usize,
    patches: usize,
}

impl SkyPatches {
    /// From the sine of the elevation at which each row begins, the lowest first, and the number of its patches. The middle of
    /// the first patch of a row is in the north, that of the second to the east of it.
    pub fn new(rows: impl IntoIterator<Item = (f32, usize)>) -> SkyPatches {
        // The ground is number 0.
        let mut first = 1;
        let row = |(height, patches): (f32, usize)| {
            let row = SkyRow { height, first, patches: patches.max(1) };
            first += row.patches;
            row
        };
        let rows = rows.into_iter().map(row).collect();
        SkyPatches { rows, count: first }
    }

    /// The number of patches, with the ground.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The number of the patch in a direction, which need not be of unit length: 0 for the ground.
    pub fn number(&self, direction: Vec3) -> usize {
        let Some(d) = direction.try_normalize().filter(|d| d.y >= 0.0) else { return 0 };
        let Some(row) = self.rows.iter().rev().find(|row| d.y >= row.height) else { return 0 };
        let turns = turns_of_point(-d.z, d.x);
        let place = (turns * row.patches as f32 + 0.5).floor() as i64;
        row.first + place.rem_euclid(row.patches as i64) as usize
    }
}

/// The coefficients of each point, patch by patch, in sr: its illuminance in lx where the patch has a luminance of 1 cd/m². The
/// scene's infinite lights are sampled as they are, so they should shine from everywhere; other lights do not count. `None` when
/// it was cancelled.
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
) -> Result<Option<Vec<f32>>, RenderError> {
    settings.check()?;
    if !integrator.receives() || !integrator.reports_light() {
        return Err(RenderError::Receives);
    }
    let all = points.points().len();
    let mut table: Vec<f32> = Vec::new();
    let room = all.checked_mul(patches.count()).filter(|room| table.try_reserve_exact(*room).is_ok());
    table.resize(room.ok_or(FilmError::NoRoom { pixels: all as u64 })?, 0.0);
    let pool = threads(settings)?;
    progress.begin(all as u64 * settings.samples.len() as u64);
    let eye = integrator.camera_rays(scene, points, settings);
    let of_point = |(i, row): (usize, &mut [f32])| {
        if !progress.is_cancelled() {
            add_point(integrator, &eye, points.pixel(i), patches, row, progress);
        }
    };
    install(&pool, || for_each(table.chunks_exact_mut(patches.count()).enumerate(), of_point));
    if progress.is_cancelled() { Ok(None) } else { Ok(Some(table)) }
}

/// Adds the samples of a point to its row.
fn add_point(
    integrator: &dyn PixelIntegrator,
    eye: &CameraRays,
    [x, y]: [u32; 2],
    patches: &SkyPatches,
    row: &mut [f32],
    progress: &dyn Progress,
) {
    let mut tracer = Tracer::new(eye.context.scene, false);
    let samples = &eye.settings.samples;
    let share = PI / samples.len() as f32;
    let mut memory = Vec::new();
    for sample in samples.clone() {
        let (ray, mut state) = eye.sample(SamplePlace { x, y, sample });
        let found = Some(std::mem::take(&mut memory));
        state.record = Some(Box::new(Record { found, ..Record::default() }));
        let mut task = Task { context: &eye.context, tracer: &mut tracer, sample: &mut state };
        integrator.radiance(&ray, &mut task);
        memory = state.record.and_then(|record| record.found).unwrap_or_default();
        for FoundLight { light, towards, radiance, .. } in memory.drain(..) {
            let shining = light.map_or(Rgb::BLACK, |index| {
                eye.context.scene.lights()[index].light.le(towards.normalize_or_zero())
            });
            let part = radiance.luminance() / shining.luminance();
            if part.is_finite() {
                row[patches.number(towards)] += part * share;
            }
        }
    }
    progress.advance(samples.len() as u64, tracer.counters.rays);
}
