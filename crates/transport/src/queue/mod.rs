//! Many paths at a time. A queue advances all of its paths by one event, then by the next: their rays are traced in
//! batches, and what surfaces and lights have in common is computed in
//! vector loops. An integrator says what happens to *one*
//! path ([`Path::interact`]); the queue decides which paths come next, in which order. It gives the same light as
//! following one path after the other, bit for bit. See docs/adr/0011-one-path-or-waves.md.

mod camera;
mod diffuse;
mod general;
mod lanes;
mod light_samples;
mod vertices;

use crate::camera_rays::CameraRays;
use crate::integrators::path::{Path, Walk};
use crate::media::Media;
use crate::sampler::PixelSampler;
use crate::shadow_rays::ShadowRays;
use crate::task::Task;
use bilux_accel::Hit;
use bilux_math::Rgb;
use bilux_scene::{Ray, Tracer, Wavelength};
use diffuse::Diffuse;
use general::General;
use vertices::Vertices;

/// The number of paths in a queue. Their state fits into the second cache.
pub(crate) const PATHS: usize = 1024;

/// A path in the queue.
struct QueuedPath {
    walk: Walk,
    sampler: PixelSampler,
    wavelength: Wavelength,
    /// Light that connections of its current vertex bring, and the throughput there, as the colour channels see it.
    direct: Rgb,
    beta: Rgb,
}

impl QueuedPath {
    /// Starts an event: no connection has brought anything yet.
    #[inline]
    fn begin_event(&mut self, task: &mut Task) {
        task.wavelength = self.wavelength;
        (self.direct, self.beta) = (Rgb::BLACK, task.seen(self.walk.beta, self.walk.is_split));
    }

    /// The end of a path that leaves the scene.
    fn escape(&mut self, path: &Path, task: &mut Task) {
        task.wavelength = self.wavelength;
        path.escape(&mut self.walk, task);
    }
}

/// What the connection of a path's vertex with a light brings if its shadow ray hits nothing.
#[derive(Clone, Copy)]
struct Unoccluded {
    /// Index of the path.
    path: u32,
    light: Rgb,
}

/// Connections with lights. Rays towards the same light are next to each other, since these are traced fastest.
#[derive(Default)]
struct Connections {
    lists: [ShadowRays<Unoccluded>; LISTS],
}

/// A light has a list of its own if it is one of few.
const LISTS: usize = 4;

impl Connections {
    fn clear(&mut self) {
        self.lists.iter_mut().for_each(ShadowRays::clear);
    }

    /// The list of a light. Connections of one vertex come in the order of the lights.
    #[inline]
    fn with(&mut self, light: usize) -> &mut ShadowRays<Unoccluded> {
        &mut self.lists[light.min(LISTS - 1)]
    }
}

/// A queue of paths, and the memory that it works in.
#[derive(Default)]
pub(crate) struct PathQueue {
    paths: Vec<QueuedPath>,
    /// Indices of the paths that go on.
    active: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    connections: Connections,
    vertices: Box<Vertices>,
    diffuse: Box<Diffuse>,
    /// Path, object, hit.
    diffuse_hits: Vec<(u32, u32, Hit)>,
    general: General,
    general_hits: Vec<(u32, Hit)>,
    next: Vec<u32>,
    /// Paths that connect to lights at this event.
    shaded: Vec<u32>,
}

impl PathQueue {
    /// The integrator whose paths can be followed in a queue.
    pub(crate) fn integrator<'a>(rays: &CameraRays<'a>) -> Option<&'a Path> {
        rays.integrator.as_path().filter(|path| path.is_mis())
    }

    /// Takes samples, at most [`PATHS`] of them: a pixel's column and row, and the sample's index. `add` receives the
    /// light of each, in the same order.
    pub(crate) fn take<'a>(
        &mut self,
        path: &Path,
        rays: &CameraRays<'a>,
        tracer: &mut Tracer<'a>,
        samples: &[(u32, u32, u32)],
        mut add: impl FnMut((u32, u32, u32), Rgb),
    ) {
        self.paths.clear();
        let mut begin = |tracer: &mut Tracer<'a>, ray: Ray, sampler, wavelength| {
            let walk = Walk::new(&ray, Media::at_start(tracer, &ray));
            self.paths.push(QueuedPath { walk, sampler, wavelength, direct: Rgb::BLACK, beta: Rgb::WHITE });
        };
        match rays.of_pinhole() {
            Some(rays) => camera::camera_rays(&rays, tracer.scene, samples, |sampler, ray| {
                begin(tracer, ray, sampler, Wavelength::D);
            }),
            None => {
                for &(x, y, index) in samples {
                    let (ray, task) = rays.sample(tracer, x, y, index);
                    let (sampler, wavelength) = (task.sampler, task.wavelength);
                    begin(tracer, ray, sampler, wavelength);
                }
            }
        }
        let Some(&(x, y, index)) = samples.first() else { return };
        // Its tools serve all paths; each path has its own random numbers and wavelength.
        let (_, mut task) = rays.sample(tracer, x, y, index);
        self.active.clear();
        self.active.extend(0..samples.len() as u32);
        while !self.active.is_empty() {
            self.advance(path, &mut task);
        }
        for (sample, path) in samples.iter().zip(&self.paths) {
            add(*sample, path.walk.light);
        }
    }

    /// Advances every path to its next surface, and past it.
    fn advance(&mut self, path: &Path, task: &mut Task) {
        let paths = &self.paths;
        self.rays.clear();
        self.rays.extend(self.active.iter().map(|&i| paths[i as usize].walk.ray));
        self.hits.clear();
        self.hits.resize(self.rays.len(), None);
        task.tracer.hits(&self.rays, &mut self.hits);
        self.next.clear();
        self.connections.clear();
        self.diffuse_hits.clear();
        self.general_hits.clear();
        self.shaded.clear();
        for (&index, hit) in self.active.iter().zip(&self.hits) {
            let one = &mut self.paths[index as usize];
            let Some(hit) = hit else {
                one.escape(path, task);
                continue;
            };
            let object = task.scene().geometry().object_of(hit);
            if task.scene().is_lambertian(object) {
                self.diffuse_hits.push((index, object, *hit));
            } else {
                self.general_hits.push((index, *hit));
            }
        }
        self.shade_diffuse(path, task);
        self.shade_general(path, task);
        self.add_direct_light(task);
        std::mem::swap(&mut self.active, &mut self.next);
    }

    /// Traces the shadow rays, and adds the light of connections that nothing blocks. The light of a vertex is summed
    /// before it is weighted by the throughput, as in a single path.
    fn add_direct_light(&mut self, task: &mut Task) {
        for list in &mut self.connections.lists {
            list.trace(task, |brought, passed| {
                self.paths[brought.path as usize].direct += brought.light * passed;
            });
        }
        for &index in &self.shaded {
            let one = &mut self.paths[index as usize];
            one.walk.light += one.beta * one.direct;
        }
    }
}
