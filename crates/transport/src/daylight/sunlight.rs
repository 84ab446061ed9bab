//! Sunlight that reaches points straight: the sun is a point, so that its shadows are exact. Panes of glass let their part of it
//! through. \[IES LM-83-12]

use crate::film::error::{FilmError, RenderError};
use crate::media::Media;
use crate::path_tracing::sheet::paper;
use crate::schedule::progress::Progress;
use crate::schedule::settings::{RenderSettings, threads};
use bilux_math::parallel::{for_each, install};
use bilux_math::{Rgb, Vec3};
use bilux_scene::bsdf::BsdfSample;
use bilux_scene::cameras::{SensorPoint, SensorPoints};
use bilux_scene::{Ray, Scene, Surface, Tracer, Wavelength};

/// Panes and boundaries of media that light passes at most on its way.
const MOST: u32 = 64;

/// The cosine of the sun's angular radius, 0.2665 degrees: what panes turn light by less than that is still seen in the same
/// direction.
const SAME: f32 = 1.0 - 1.08e-5;

/// Irradiance of each point from a sun in each direction, over that of a surface which faces the sun, in front of everything. One
/// row of directions after the other. `None` when it was cancelled.
///
/// # Errors
/// When there is not enough memory.
pub fn sunlight(
    scene: &Scene,
    points: &SensorPoints,
    directions: &[Vec3],
    settings: &RenderSettings,
    progress: &dyn Progress,
) -> Result<Option<Vec<f32>>, RenderError> {
    settings.check()?;
    let count = points.points().len();
    let mut table: Vec<f32> = Vec::new();
    let room = count.checked_mul(directions.len()).filter(|room| table.try_reserve_exact(*room).is_ok());
    table.resize(room.ok_or(FilmError::NoRoom { pixels: count as u64 })?, 0.0);
    progress.begin(table.len() as u64);
    let of_point = |(point, row): (&SensorPoint, &mut [f32])| {
        if progress.is_cancelled() {
            return;
        }
        let mut tracer = Tracer::new(scene, false);
        let straight = Straight::from(&mut tracer, point);
        for (part, towards) in row.iter_mut().zip(directions) {
            let direction = towards.normalize_or_zero();
            let cos = direction.dot(point.normal);
            if cos > 0.0 {
                *part = cos * straight.passed(&mut tracer, direction).luminance();
            }
        }
        progress.advance(directions.len() as u64, tracer.counters.rays);
    };
    let pool = threads(settings)?;
    let rows = points.points().iter().zip(table.chunks_exact_mut(directions.len().max(1)));
    install(&pool, || for_each(rows, of_point));
    Ok((!progress.is_cancelled()).then_some(table))
}

/// Straight ways out of the scene, from a point.
pub(super) struct Straight {
    from: Surface,
    media: Media,
}

impl Straight {
    pub(super) fn from(tracer: &mut Tracer, point: &SensorPoint) -> Straight {
        let time = tracer.scene.shutter()[0];
        let ray = Ray { time, ..Ray::new(point.p.to_array(), point.normal.to_array()) };
        Straight { media: Media::at_start(tracer, &ray), from: paper(&ray, point.normal) }
    }

    /// True if directions are the same but for what panes turn light by.
    pub(super) fn is_same(&self, a: Vec3, b: Vec3) -> bool {
        a.normalize_or_zero().dot(b.normalize_or_zero()) > SAME
    }

    /// The fraction of light that comes from infinity, against this unit direction, and reaches the point: through smooth panes
    /// whose faces are parallel, and media. Black if anything else is in the way.
    pub(super) fn passed(&self, tracer: &mut Tracer, direction: Vec3) -> Rgb {
        let (scene, mut media, mut passed) = (tracer.scene, self.media, Rgb::WHITE);
        let mut ray = self.from.spawn(direction);
        for _ in 0..MOST {
            let Some(first) = tracer.closest(&ray) else { return self.seen(passed, &ray, direction) };
            let (surface, transmitted) = media.closest_from(tracer, &ray, first, 0);
            passed *= transmitted;
            let Some(surface) = surface else { return self.seen(passed, &ray, direction) };
            let wo = -Vec3::from(ray.direction);
            let mut through: Option<BsdfSample> = None;
            media.bsdf(scene, &surface, &Wavelength::D).each_smooth(wo, |sample| {
                if sample.transmits {
                    through = Some(sample);
                }
            });
            let Some(through) = through else { return Rgb::BLACK };
            passed *= through.weight;
            media = media.beyond(scene, &surface, wo, through.wi);
            ray = surface.spawn(through.wi);
        }
        Rgb::BLACK
    }

    /// Fraction of light that is left where a ray leaves the scene, if it is still in the direction from which the light comes.
    fn seen(&self, passed: Rgb, ray: &Ray, direction: Vec3) -> Rgb {
        if self.is_same(Vec3::from(ray.direction), direction) { passed } else { Rgb::BLACK }
    }
}
