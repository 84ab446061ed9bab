//! Light tracing: a subpath from a light, each of whose vertices is connected with the camera; from the camera, only what emits
//! light is seen. [Arvo 1986]

use super::BatchQueue;
use super::connect::{places_on_film, to_camera};
use super::light_paths::{LightPaths, light_vertices};
use super::queued_sample::QueuedSample;
use crate::media::Media;
use crate::sampling::task::{Context, Task};
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
        emitted_by(first, media, (ray, task.sample.seed()), task.tracer)
    }

    /// Follows one light subpath. `add_splat` receives the points of the film, and the light there.
    pub(crate) fn trace(&self, time: f32, task: &mut Task, mut add_splat: impl FnMut(Vec2, Rgb)) {
        for vertex in light_vertices(task, time, self.roulette_depth, &TECHNIQUES, |_| {}) {
            task.sample.enter_light_vertex(vertex.depth);
            if let Some((film, connection)) = to_camera(task, &vertex, &TECHNIQUES)
                && let Some((_, found)) = connection.trace(task.tracer)
            {
                for film in places_on_film(task.context, film) {
                    add_splat(film, found.light);
                }
            }
        }
    }
}

/// The light that arrives from the first surface along a camera ray, which starts in these media, or from infinity.
fn emitted_by(
    first: Option<Surface>,
    mut media: Media,
    (ray, seed): (&Ray, u64),
    tracer: &mut Tracer,
) -> Rgb {
    let arrived = first.map(|surface| media.closest_from(tracer, ray, surface, seed));
    let (surface, passed) = arrived.unwrap_or((None, Rgb::WHITE));
    let light = match surface {
        Some(surface) => tracer.scene.emission(&surface, -Vec3::from(ray.direction)),
        None => tracer.scene.background(ray.direction.into(), 0),
    };
    passed * light
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

impl BatchQueue for LightTracingSamples {
    fn take_batch<'a>(
        &mut self,
        samples: &mut [QueuedSample],
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
        add_splat: &mut dyn FnMut(usize, Vec2, Rgb),
    ) -> Vec<Rgb> {
        self.light_paths.trace(samples, context, tracer, self.light_tracing.roulette_depth, &TECHNIQUES);
        self.light_paths.connect_to_camera(samples, context, tracer, &TECHNIQUES, |i, film, _, found| {
            add_splat(i, film, found.light);
        });
        self.rays.clear();
        self.rays.extend(samples.iter().filter(|sample| sample.is_wanted).map(|sample| sample.ray));
        self.hits.clear();
        self.hits.resize(self.rays.len(), None);
        tracer.hits(&self.rays, &mut self.hits);
        let mut hits = self.hits.iter();
        let light = |sample: &QueuedSample| {
            let Some(hit) = sample.is_wanted.then(|| hits.next()).flatten() else { return Rgb::BLACK };
            let first = hit.map(|hit| tracer.surface(&sample.ray, &hit));
            let media = Media::at_start(tracer, &sample.ray);
            emitted_by(first, media, (&sample.ray, sample.state.seed()), tracer)
        };
        samples.iter().map(light).collect()
    }
}
