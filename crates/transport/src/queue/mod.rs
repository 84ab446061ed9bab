//! Many paths at a time. A queue advances all of its paths by one event, then by the next: their rays are traced in
//! batches, and what surfaces and lights have in common is computed in vector loops. An integrator says what happens to
//! *one* path ([`Path::interact`]); the queue decides which paths come next, in which order. It gives the same light as
//! following one path after the other, bit for bit. See docs/adr/0011-one-path-or-waves.md.

mod camera;
mod diffuse;
mod escapes;
mod general;
mod lanes;
mod light_samples;
mod next_rays;
mod opaque;
mod paths;
mod smooth;
mod triangles;
mod vertices;

use crate::camera_rays::CameraRays;
use crate::integrators::path::{Path, Walk};
use crate::media::Media;
use crate::task::Task;
use bilux_accel::Hit;
use bilux_math::Rgb;
use bilux_scene::{Ray, Shading, Tracer, Wavelength};
use diffuse::Diffuse;
use escapes::Escapes;
use general::General;
use opaque::Opaque;
use paths::{Paths, QueuedPath};
use smooth::Smooth;
use std::any::Any;
use vertices::Vertices;

/// The number of paths in a queue. Their state fits into the second cache.
const PATHS: usize = 1024;

/// A queue of paths, and the memory that it works in.
#[derive(Default)]
pub(crate) struct PathQueue {
    state: Paths,
    /// Indices of the paths that go on.
    active: Vec<u32>,
    /// Indices of the paths that have ended: others take their places.
    free: Vec<u32>,
    /// Whether each path goes on after the current event.
    goes_on: Vec<bool>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    escapes: Escapes,
    vertices: Box<Vertices>,
    diffuse: Box<Diffuse>,
    smooth: Box<Smooth>,
    opaque: Box<Opaque>,
    general: General,
}

impl PathQueue {
    /// The integrator whose paths can be followed in a queue.
    pub(crate) fn integrator<'a>(rays: &CameraRays<'a>) -> Option<&'a Path> {
        (rays.integrator as &dyn Any).downcast_ref::<Path>().filter(|path| path.is_mis())
    }

    /// Takes samples: a pixel's column and row, and the sample's index. `add` receives the light of each, as they end.
    ///
    /// As paths end, others begin, so that the queue is never less than half full until the last of them. False when it
    /// was cancelled on the way.
    pub(crate) fn take<'a>(
        &mut self,
        path: &Path,
        rays: &CameraRays<'a>,
        tracer: &mut Tracer<'a>,
        samples: &[(u32, u32, u32)],
        is_cancelled: impl Fn() -> bool,
        mut add: impl FnMut((u32, u32, u32), Rgb),
    ) -> bool {
        let Some(&(x, y, index)) = samples.first() else { return true };
        // Its tools serve all paths; each path has its own random numbers and wavelength.
        let (_, mut task) = rays.sample(tracer, x, y, index);
        self.state.paths.clear();
        self.active.clear();
        self.free.clear();
        let mut waiting = samples;
        loop {
            if self.active.len() <= PATHS / 2 && !waiting.is_empty() {
                if is_cancelled() {
                    return false;
                }
                let (now, later) = waiting.split_at(waiting.len().min(PATHS - self.active.len()));
                self.begin(rays, now, &mut task);
                waiting = later;
            }
            if self.active.is_empty() {
                return true;
            }
            self.advance(path, &mut task);
            self.goes_on.clear();
            self.goes_on.resize(self.state.paths.len(), false);
            for &index in &self.active {
                self.goes_on[index as usize] = true;
            }
            // Those that were active before.
            for &index in self.state.next.iter().filter(|&&index| !self.goes_on[index as usize]) {
                let one = &self.state.paths[index as usize];
                add(one.sample, one.walk.light);
                self.free.push(index);
            }
        }
    }

    /// Begins the paths of some samples.
    fn begin<'a>(&mut self, rays: &CameraRays<'a>, samples: &[(u32, u32, u32)], task: &mut Task<'_, 'a>) {
        let mut begin = |tracer: &mut Tracer, sample, ray: Ray, sampler, wavelength| {
            let walk = Walk::new(&ray, Media::at_start(tracer, &ray));
            let (direct, beta) = (Rgb::BLACK, Rgb::WHITE);
            let path = QueuedPath { walk, sampler, wavelength, direct, beta, sample };
            match self.free.pop() {
                Some(index) => {
                    self.state.paths[index as usize] = path;
                    self.active.push(index);
                }
                None => {
                    self.active.push(self.state.paths.len() as u32);
                    self.state.paths.push(path);
                }
            }
        };
        if let Some(rays) = rays.of_pinhole() {
            camera::camera_rays(&rays, task.scene(), samples, |sample, sampler, ray| {
                begin(task.tracer, sample, ray, sampler, Wavelength::D);
            });
            return;
        }
        for &(x, y, index) in samples {
            let (sampler, wavelength, ray) = {
                let (ray, task) = rays.sample(task.tracer, x, y, index);
                (task.sampler, task.wavelength, ray)
            };
            begin(task.tracer, (x, y, index), ray, sampler, wavelength);
        }
    }

    /// Advances every path to its next surface, and past it.
    fn advance(&mut self, path: &Path, task: &mut Task) {
        let paths = &self.state.paths;
        self.rays.clear();
        self.rays.extend(self.active.iter().map(|&i| paths[i as usize].walk.ray));
        self.hits.clear();
        self.hits.resize(self.rays.len(), None);
        task.tracer.hits(&self.rays, &mut self.hits);
        self.state.clear_lists();
        let is_clear = task.scene().has_clear_media();
        for (&index, hit) in self.active.iter().zip(&self.hits) {
            let Some(hit) = hit else {
                self.state.escaped.push(index);
                continue;
            };
            let object = task.scene().geometry().object_of(hit);
            match task.scene().shading(object) {
                Shading::Lambertian => self.state.diffuse_hits.push((index, object, *hit)),
                Shading::OpaqueBase => self.state.opaque_hits.push((index, *hit)),
                Shading::Smooth if is_clear => self.state.smooth_hits.push((index, object, *hit)),
                Shading::Smooth | Shading::General => self.state.general_hits.push((index, *hit)),
            }
        }
        self.state.end_escaped(&mut self.escapes, path, task);
        self.state.shade_diffuse((&mut self.vertices, &mut self.diffuse), path, task);
        self.state.shade_smooth((&mut self.vertices, &mut self.smooth), path, task);
        self.state.shade_opaque((&mut self.vertices, &mut self.opaque), path, task);
        self.state.shade_general((&mut self.vertices, &mut self.general), path, task);
        self.state.add_direct_light(task);
        std::mem::swap(&mut self.active, &mut self.state.next);
    }
}
