//! Many paths at a time. A queue advances all of its paths by one event, then by the next: their rays are traced in
//! batches, and what surfaces and lights have in common is computed in vector loops. An integrator says what happens to
//! *one* path ([`PathTracing::interact`]); the queue decides which paths come next, in which order. It gives the same light as
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

use crate::film::failures::SamplePlace;
use crate::media::Media;
use crate::path_tracing::{Path, PathTracing};
use crate::sampling::camera_rays::CameraRays;
use crate::sampling::sample_queue::{SampleQueue, SampleSink};
use crate::sampling::task::{Context, SampleState};
use bilux_accel::Hit;
use bilux_math::Rgb;
use bilux_scene::{Ray, Scene, Shading, Tracer, Wavelength};
pub(crate) use camera::camera_rays;
use diffuse::Diffuse;
use escapes::Escapes;
use general::General;
use opaque::Opaque;
use paths::{Paths, QueuedPath};
use smooth::Smooth;
use vertices::Vertices;

/// The number of paths in a queue. Their state fits into the second cache.
const PATHS: usize = 1024;

/// A queue of paths, and the memory that it works in.
pub(crate) struct PathQueue {
    tracing: PathTracing,
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
    /// True for scenes whose paths it follows: paths in columns do not stop between surfaces.
    pub(crate) fn takes(scene: &Scene) -> bool {
        !scene.scatters()
    }

    pub(crate) fn new(tracing: PathTracing) -> PathQueue {
        PathQueue {
            tracing,
            state: Paths::default(),
            active: Vec::new(),
            free: Vec::new(),
            goes_on: Vec::new(),
            rays: Vec::new(),
            hits: Vec::new(),
            escapes: Escapes::default(),
            vertices: Box::default(),
            diffuse: Box::default(),
            smooth: Box::default(),
            opaque: Box::default(),
            general: General::default(),
        }
    }
}

impl SampleQueue for PathQueue {
    /// As paths end, others begin, so that the queue is never less than half full until the last of them.
    fn take<'a>(
        &mut self,
        rays: &CameraRays<'a>,
        tracer: &mut Tracer<'a>,
        places: &[SamplePlace],
        sink: &mut SampleSink,
    ) -> bool {
        self.state.paths.clear();
        self.active.clear();
        self.free.clear();
        let mut waiting = places;
        loop {
            if self.active.len() <= PATHS / 2 && !waiting.is_empty() {
                if sink.is_cancelled() {
                    return false;
                }
                let (now, later) = waiting.split_at(waiting.len().min(PATHS - self.active.len()));
                self.begin(rays, now, tracer, sink);
                waiting = later;
            }
            if self.active.is_empty() {
                return true;
            }
            self.advance(&rays.context, tracer);
            self.goes_on.clear();
            self.goes_on.resize(self.state.paths.len(), false);
            for &index in &self.active {
                self.goes_on[index as usize] = true;
            }
            // Those that were active before.
            for &index in self.state.next.iter().filter(|&&index| !self.goes_on[index as usize]) {
                let one = &self.state.paths[index as usize];
                sink.add(one.place, one.path.light);
                self.free.push(index);
            }
        }
    }
}

impl PathQueue {
    /// Begins the paths of some samples.
    fn begin<'a>(
        &mut self,
        rays: &CameraRays<'a>,
        places: &[SamplePlace],
        tracer: &mut Tracer<'a>,
        sink: &mut SampleSink,
    ) {
        let mut begin = |place, ray: Ray, state| {
            let path = Path::new(&ray, Media::at_start(tracer, &ray));
            let (direct, beta) = (Rgb::BLACK, Rgb::WHITE);
            let queued = QueuedPath { path, state, direct, beta, place };
            match self.free.pop() {
                Some(index) => {
                    self.state.paths[index as usize] = queued;
                    self.active.push(index);
                }
                None => {
                    self.active.push(self.state.paths.len() as u32);
                    self.state.paths.push(queued);
                }
            }
        };
        if let Some(pinhole) = rays.of_pinhole() {
            camera_rays(&pinhole, rays.context.scene, places, |place, sampler, ray| {
                begin(place, ray, SampleState::new(sampler, Wavelength::D));
            });
            return;
        }
        for &place in places {
            let (ray, state) = rays.sample(place);
            match ray.is_nowhere() {
                true => sink.add(place, Rgb::BLACK),
                false => begin(place, ray, state),
            }
        }
    }

    /// Advances every path to its next surface, and past it.
    fn advance<'a>(&mut self, context: &Context<'a>, tracer: &mut Tracer<'a>) {
        let (tracing, paths) = (&self.tracing, &self.state.paths);
        self.rays.clear();
        self.rays.extend(self.active.iter().map(|&i| paths[i as usize].path.walk.ray));
        self.hits.clear();
        self.hits.resize(self.rays.len(), None);
        tracer.hits(&self.rays, &mut self.hits);
        self.state.clear_lists();
        let scene = context.scene;
        let is_clear = scene.has_clear_media();
        for (&index, hit) in self.active.iter().zip(&self.hits) {
            let Some(hit) = hit else {
                self.state.escaped.push(index);
                continue;
            };
            let object = scene.geometry().object_of(hit);
            match scene.shading(object) {
                Shading::Lambertian => self.state.diffuse_hits.push((index, object, *hit)),
                Shading::OpaqueBase => self.state.opaque_hits.push((index, *hit)),
                Shading::Smooth if is_clear => self.state.smooth_hits.push((index, object, *hit)),
                Shading::Smooth | Shading::General => self.state.general_hits.push((index, *hit)),
            }
        }
        let v = &mut self.vertices;
        self.state.end_escaped(&mut self.escapes, tracing, context);
        self.state.shade_diffuse(v, &mut self.diffuse, tracing, context, tracer);
        self.state.shade_smooth(v, &mut self.smooth, tracing, context);
        self.state.shade_opaque(v, &mut self.opaque, tracing, context, tracer);
        self.state.shade_general(v, &mut self.general, tracing, context, tracer);
        self.state.add_direct_light(tracer);
        std::mem::swap(&mut self.active, &mut self.state.next);
    }
}
