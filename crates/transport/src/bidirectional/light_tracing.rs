//! Light tracing: a subpath from a light, each of whose vertices is connected with the camera; from the camera, only what emits
//! light is seen. [Arvo 1986]

use super::PATHS;
use super::connect::to_camera;
use super::light_paths::{LightPaths, light_vertices};
use super::queued_sample::QueuedSample;
use crate::camera_rays::CameraRays;
use crate::failures::SamplePlace;
use crate::media::Media;
use crate::sample_queue::{SampleQueue, SampleSink};
use crate::task::Task;
use crate::techniques::TechniqueCounts;
use bilux_accel::Hit;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Ray, Surface, Tracer};

/// A sample of light tracing. There is no other technique, so nothing is weighted.
#[derive(Clone, Copy)]
pub(crate) struct LightTracing {
    pub(crate) roulette_depth: u32,
}

/// The techniques that its light subpaths prepare for.
const TECHNIQUES: TechniqueCounts = TechniqueCounts::BOTH_ENDS;

impl LightTracing {
    /// Light that the camera sees directly.
    pub(crate) fn emitted(ray: &Ray, task: &mut Task) -> Rgb {
        let media = Media::at_start(task.tracer, ray);
        let first = task.tracer.closest(ray);
        emitted_by(first, media, ray, task.tracer)
    }

    /// Follows one light subpath. `add_splat` receives the points of the film, and the light there.
    pub(crate) fn trace(&self, time: f32, task: &mut Task, mut add_splat: impl FnMut(Vec2, Rgb)) {
        for vertex in light_vertices(task, time, self.roulette_depth, &TECHNIQUES) {
            task.sample.enter_light_vertex(vertex.depth);
            if let Some((film, connection)) = to_camera(task, &vertex, &TECHNIQUES)
                && let Some(found) = connection.trace(task.tracer)
            {
                add_splat(film, found.light);
            }
        }
    }
}

/// The light that arrives from the first surface along a camera ray, which starts in these media, or from infinity.
fn emitted_by(first: Option<Surface>, mut media: Media, ray: &Ray, tracer: &mut Tracer) -> Rgb {
    match first.and_then(|surface| media.closest_from(tracer, ray, surface)) {
        Some((surface, passed)) => passed * tracer.scene.emission(&surface, -Vec3::from(ray.direction)),
        None => tracer.scene.background(ray.direction.into(), 0),
    }
}

/// Samples of light tracing.
pub(crate) struct LightTracingSamples {
    light_tracing: LightTracing,
    light_paths: LightPaths,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
}

impl LightTracingSamples {
    pub(crate) fn new(light_tracing: LightTracing) -> LightTracingSamples {
        let (light_paths, rays, hits) = (LightPaths::default(), Vec::new(), Vec::new());
        LightTracingSamples { light_tracing, light_paths, rays, hits }
    }
}

impl SampleQueue for LightTracingSamples {
    fn take<'a>(
        &mut self,
        rays: &CameraRays<'a>,
        tracer: &mut Tracer<'a>,
        places: &[SamplePlace],
        sink: &mut SampleSink,
    ) -> bool {
        for places in places.chunks(PATHS) {
            if sink.is_cancelled() {
                return false;
            }
            let mut samples = QueuedSample::all(rays, places, sink);
            let (context, roulette_depth) = (&rays.context, self.light_tracing.roulette_depth);
            self.light_paths.trace(&mut samples, context, tracer, roulette_depth, &TECHNIQUES);
            self.light_paths.connect_to_camera(
                &mut samples,
                context,
                tracer,
                &TECHNIQUES,
                |i, film, _, found| {
                    sink.splats(places[i]).add(film, found.light);
                },
            );
            self.rays.clear();
            self.rays.extend(samples.iter().filter(|sample| sample.is_wanted).map(|sample| sample.ray));
            self.hits.clear();
            self.hits.resize(self.rays.len(), None);
            tracer.hits(&self.rays, &mut self.hits);
            let mut hits = self.hits.iter();
            for (&place, sample) in places.iter().zip(&samples) {
                let hit = sample.is_wanted.then(|| hits.next()).flatten();
                let light = hit.map_or(Rgb::BLACK, |hit| {
                    let first = hit.map(|hit| tracer.surface(&sample.ray, &hit));
                    let media = Media::at_start(tracer, &sample.ray);
                    emitted_by(first, media, &sample.ray, tracer)
                });
                sink.add(place, light);
            }
        }
        true
    }
}
