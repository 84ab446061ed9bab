//! Many camera subpaths at a time, event by event, so that rays are traced in batches. What happens to one of them is told by
//! [`CameraSubpath`].

use super::connect::Connection;
use super::light_paths::LightPaths;
use super::queued_sample::QueuedSample;
use super::{CameraSubpath, Vertex, Walk};
use crate::sampler::PixelSampler;
use crate::shadow_rays::ShadowRays;
use crate::task::Task;
use crate::techniques::{Contribution, Step, Tally, Technique};
use bilux_accel::Hit;
use bilux_scene::Ray;

/// A queue of camera subpaths: the memory that it works in.
#[derive(Default)]
pub(crate) struct CameraQueue<const N: usize = 1> {
    /// The current vertices.
    vertices: Vec<Vertex<N>>,
    /// The sample of each, and the random numbers that follow.
    samples: Vec<(u32, PixelSampler)>,
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
    samples: &'b [QueuedSample],
    walks: Vec<Walk<'b, N>>,
    tallies: &'b mut [T],
}

/// What a connection brings if its shadow ray hits nothing.
struct Unoccluded<const N: usize> {
    sample: u32,
    technique: Technique,
    found: Contribution<N>,
}

impl<const N: usize> CameraQueue<N> {
    /// Follows the subpath of each sample that is wanted, as [`CameraSubpath::follow`] does. What it finds goes to the tally
    /// with its index.
    pub(crate) fn follow<S: CameraSubpath<N>, T: Tally<N>>(
        &mut self,
        events: &S,
        samples: &[QueuedSample],
        light_paths: &LightPaths<N>,
        task: &mut Task,
        tallies: &mut [T],
    ) {
        let walks = samples.iter().map(|sample| events.leave_camera(&sample.ray)).collect();
        self.active.clear();
        self.active.extend((0..samples.len() as u32).filter(|&i| samples[i as usize].is_wanted));
        let mut subpaths = Subpaths { events, samples, walks, tallies };
        while !self.active.is_empty() {
            self.arrive(&mut subpaths, task);
            self.connect(&mut subpaths, light_paths, task);
            self.scatter(&mut subpaths, task);
        }
    }

    /// Takes every subpath to its next vertex, or out of the scene.
    fn arrive<S: CameraSubpath<N>, T: Tally<N>>(&mut self, paths: &mut Subpaths<N, S, T>, task: &mut Task) {
        let Subpaths { events, samples, walks, tallies } = paths;
        self.rays.clear();
        self.rays.extend(self.active.iter().map(|&i| walks[i as usize].ray));
        self.hits.clear();
        self.hits.resize(self.rays.len(), None);
        task.tracer.hits(&self.rays, &mut self.hits);
        self.vertices.clear();
        self.samples.clear();
        for (&index, hit) in self.active.iter().zip(&self.hits) {
            let i = index as usize;
            let (walk, tally) = (&mut walks[i], &mut tallies[i]);
            tally.spend(Step::Camera, 1);
            samples[i].enter(task);
            let surface = hit.map(|hit| task.tracer.surface(&walk.ray, &hit));
            let before = self.vertices.len();
            self.vertices.extend(surface.and_then(|surface| walk.vertex_at(surface, task)));
            let Some(z) = self.vertices.get_mut(before) else {
                events.escape(walk, task, tally);
                continue;
            };
            if events.arrive(walk, z, task, tally) {
                self.samples.push((index, task.sampler.clone()));
            } else {
                self.vertices.truncate(before);
            }
        }
    }

    /// Connects every vertex with lights and with its light subpath.
    fn connect<S: CameraSubpath<N>, T: Tally<N>>(
        &mut self,
        paths: &mut Subpaths<N, S, T>,
        light_paths: &LightPaths<N>,
        task: &mut Task,
    ) {
        let Subpaths { events, samples, tallies, .. } = paths;
        self.shadow_rays.iter_mut().for_each(ShadowRays::clear);
        let is_clear = task.scene().has_clear_media();
        for (z, (sample, sampler)) in self.vertices.iter().zip(&mut self.samples) {
            task.wavelength = samples[*sample as usize].wavelength;
            task.sampler = sampler.clone();
            let light_path = light_paths.of(*sample as usize);
            events.connect(z, light_path, task, |_, step, connection| {
                tallies[*sample as usize].spend(step, 1);
                let Some(connection) = connection else { return };
                let Connection { technique, found, .. } = connection;
                let is_between_subpaths = matches!(technique, Technique::Connected { s: 2.., .. });
                let unoccluded = Unoccluded { sample: *sample, technique, found };
                connection.list(
                    &mut self.shadow_rays[usize::from(is_between_subpaths)],
                    is_clear,
                    unoccluded,
                );
            });
            *sampler = task.sampler.clone();
        }
        for shadow_rays in &mut self.shadow_rays {
            shadow_rays.trace(task, |Unoccluded { sample, technique, found }, passed| {
                tallies[*sample as usize].add_sample(*technique, &found.passed(passed));
            });
        }
    }

    /// Merges every vertex with photons, and sends its subpath on.
    fn scatter<S: CameraSubpath<N>, T: Tally<N>>(&mut self, paths: &mut Subpaths<N, S, T>, task: &mut Task) {
        let Subpaths { events, samples, walks, tallies } = paths;
        self.next.clear();
        for (z, (index, sampler)) in self.vertices.iter().zip(&self.samples) {
            let i = *index as usize;
            task.wavelength = samples[i].wavelength;
            task.sampler = sampler.clone();
            events.merge(z, task, &mut tallies[i]);
            if events.scatter(&mut walks[i], z, task) {
                self.next.push(*index);
            }
        }
        std::mem::swap(&mut self.active, &mut self.next);
    }
}
