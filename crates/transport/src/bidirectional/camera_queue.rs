//! Many camera subpaths at a time, event by event, so that rays are traced in batches. What happens to one of them is told by
//! [`CameraSubpath`].

use super::connect::{Connection, Join};
use super::light_paths::LightPaths;
use super::queued_sample::QueuedSample;
use super::{CameraSubpath, Subpath, Vertex};
use crate::sampling::task::{Context, Task};
use crate::techniques::{Step, Tally, Technique};
use crate::walk::shadow_rays::ShadowRays;
use bilux_accel::Hit;
use bilux_scene::{Ray, Tracer};

/// A queue of camera subpaths: the memory that it works in.
#[derive(Default)]
pub(crate) struct CameraQueue<const N: usize = 1> {
    /// The current vertices.
    vertices: Vec<Vertex<N>>,
    /// The sample of each.
    samples: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    active: Vec<u32>,
    next: Vec<u32>,
    /// Connections with lights, and with light subpaths. Rays towards the same light are traced fastest.
    shadow_rays: [ShadowRays<Unoccluded<N>>; 2],
}

/// The subpaths of all samples, and what they find.
struct Subpaths<'b, const N: usize, S, T> {
    events: &'b S,
    samples: &'b mut [QueuedSample],
    subpaths: Vec<Subpath<'b, N>>,
    tallies: &'b mut [T],
}

/// Connection of a sample, for the case that its shadow ray hits nothing.
struct Unoccluded<const N: usize> {
    sample: u32,
    join: Join<N>,
}

impl<const N: usize> CameraQueue<N> {
    /// Follows the subpath of each sample that is wanted, as [`CameraSubpath::follow`] does. What it finds goes to the tally
    /// with its index.
    pub(crate) fn follow<'a, S: CameraSubpath<N>, T: Tally<N>>(
        &mut self,
        events: &S,
        samples: &mut [QueuedSample],
        light_paths: &LightPaths<N>,
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
        tallies: &mut [T],
    ) {
        let subpaths = samples.iter().map(|sample| events.leave_camera(&sample.ray)).collect();
        self.active.clear();
        self.active.extend((0..samples.len() as u32).filter(|&i| samples[i as usize].is_wanted));
        let mut subpaths = Subpaths { events, samples, subpaths, tallies };
        while !self.active.is_empty() {
            self.arrive(&mut subpaths, context, tracer);
            self.connect(&mut subpaths, light_paths, context, &mut *tracer);
            self.scatter(&mut subpaths, context, tracer);
        }
    }

    /// Takes every subpath to its next vertex, or out of the scene.
    fn arrive<'a, S: CameraSubpath<N>, T: Tally<N>>(
        &mut self,
        paths: &mut Subpaths<N, S, T>,
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
    ) {
        let Subpaths { events, samples, subpaths, tallies } = paths;
        self.rays.clear();
        self.rays.extend(self.active.iter().map(|&i| {
            let i = i as usize;
            subpaths[i].ray(context.scene, &mut samples[i].state)
        }));
        self.hits.clear();
        self.hits.resize(self.rays.len(), None);
        tracer.hits(&self.rays, &mut self.hits);
        self.vertices.clear();
        self.samples.clear();
        for (&index, hit) in self.active.iter().zip(&self.hits) {
            let i = index as usize;
            let (subpath, tally) = (&mut subpaths[i], &mut tallies[i]);
            tally.spend(Step::Camera, 1);
            let surface = hit.map(|hit| tracer.surface(&subpath.walk.ray, &hit));
            let mut task = Task { context, tracer: &mut *tracer, sample: &mut samples[i].state };
            let before = self.vertices.len();
            self.vertices.extend(subpath.vertex_before(surface, &mut task));
            events.cross(subpath, &task, tally);
            events.equiangular(subpath, &mut task, tally);
            let Some(z) = self.vertices.get_mut(before) else {
                events.escape(subpath, &task, tally);
                continue;
            };
            if events.arrive(subpath, z, &mut task, tally) {
                self.samples.push(index);
            } else {
                self.vertices.truncate(before);
            }
        }
    }

    /// Connects every vertex with lights and with its light subpath.
    fn connect<'a, S: CameraSubpath<N>, T: Tally<N>>(
        &mut self,
        paths: &mut Subpaths<N, S, T>,
        light_paths: &LightPaths<N>,
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
    ) {
        let Subpaths { events, samples, tallies, .. } = paths;
        self.shadow_rays.iter_mut().for_each(ShadowRays::clear);
        let is_plain = context.scene.has_plain_shadows();
        for (z, sample) in self.vertices.iter().zip(&self.samples) {
            let state = &mut samples[*sample as usize].state;
            let mut task = Task { context, tracer: &mut *tracer, sample: state };
            let light_path = light_paths.of(*sample as usize);
            events.connect(z, light_path, &mut task, |_, step, connection| {
                tallies[*sample as usize].spend(step, 1);
                let Some(connection) = connection else { return };
                let Connection { join, segment } = connection;
                let is_between_subpaths = matches!(join.technique, Technique::Connected { s: 2.., .. });
                let unoccluded = Unoccluded { sample: *sample, join };
                let shadow_rays = &mut self.shadow_rays[usize::from(is_between_subpaths)];
                segment.list(shadow_rays, context.scene, is_plain, unoccluded);
            });
        }
        for shadow_rays in &mut self.shadow_rays {
            shadow_rays.trace(tracer, |Unoccluded { sample, join }, passage| {
                let (technique, found) = join.along(passage);
                tallies[*sample as usize].add_sample(technique, &found);
            });
        }
    }

    /// Merges every vertex with photons, and sends its subpath on.
    fn scatter<'a, S: CameraSubpath<N>, T: Tally<N>>(
        &mut self,
        paths: &mut Subpaths<N, S, T>,
        context: &Context<'a>,
        tracer: &mut Tracer<'a>,
    ) {
        let Subpaths { events, samples, subpaths, tallies } = paths;
        self.next.clear();
        for (z, index) in self.vertices.iter().zip(&self.samples) {
            let i = *index as usize;
            let mut task = Task { context, tracer: &mut *tracer, sample: &mut samples[i].state };
            events.merge(z, &task, &mut tallies[i]);
            if events.scatter(&mut subpaths[i], z, &mut task) {
                self.next.push(*index);
            }
        }
        std::mem::swap(&mut self.active, &mut self.next);
    }
}
