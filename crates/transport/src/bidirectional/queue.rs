//! Many samples at a time: the light subpaths of all of them, then the camera subpaths, event by event, so that rays are
//! traced in batches. What happens to one pair of subpaths is told by [`BothEnds`].

use super::connect::Connection;
use super::light_paths::LightPaths;
use super::queued_sample::QueuedSample;
use super::{BothEnds, Vertex, Walk};
use crate::sampler::PixelSampler;
use crate::shadow_rays::ShadowRays;
use crate::task::Task;
use crate::techniques::{Contribution, Tally, Technique};
use bilux_accel::Hit;
use bilux_math::Vec2;
use bilux_scene::Ray;

/// The number of samples in a queue: the vertices of their light subpaths fit into the second cache.
pub(crate) const PATHS: usize = 256;

/// A queue of samples, and the memory that it works in.
#[derive(Default)]
pub(crate) struct BothEndsQueue<const N: usize = 1> {
    light_paths: LightPaths<N>,
    /// The current vertices of camera subpaths.
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

/// The camera subpaths of all samples, and what they find.
struct CameraPaths<'b, const N: usize, T> {
    both_ends: &'b BothEnds<'b, N>,
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

impl<const N: usize> BothEndsQueue<N> {
    /// Takes samples. What each finds goes to the tally with its index, except for splats: these go to `add_splat`, in
    /// the order of the samples.
    pub(crate) fn take<T: Tally<N>>(
        &mut self,
        both_ends: &BothEnds<N>,
        samples: &[QueuedSample],
        task: &mut Task,
        tallies: &mut [T],
        add_splat: impl FnMut(usize, Vec2, Technique, &Contribution<N>),
    ) {
        let techniques = &both_ends.techniques;
        if both_ends.shows || both_ends.joins() {
            self.light_paths.trace(samples, task, both_ends.roulette_depth, techniques);
        } else {
            self.light_paths.clear(samples.len());
        }
        if both_ends.shows {
            self.light_paths.show_to_camera(samples, task, techniques, add_splat);
        }
        let walks = samples.iter().map(|sample| both_ends.leave_camera(&sample.ray)).collect();
        self.active.clear();
        self.active.extend((0..samples.len() as u32).filter(|&i| samples[i as usize].is_wanted));
        let mut camera_paths = CameraPaths { both_ends, samples, walks, tallies };
        while !self.active.is_empty() {
            self.arrive(&mut camera_paths, task);
            self.connect(&mut camera_paths, task);
            self.scatter(&mut camera_paths, task);
        }
    }

    /// Takes every camera subpath to its next vertex, or out of the scene.
    fn arrive<T: Tally<N>>(&mut self, paths: &mut CameraPaths<N, T>, task: &mut Task) {
        let CameraPaths { both_ends, samples, walks, tallies } = paths;
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
            samples[i].enter(task);
            let surface = hit.map(|hit| task.tracer.surface(&walk.ray, &hit));
            let before = self.vertices.len();
            self.vertices.extend(surface.and_then(|surface| walk.vertex_at(surface, task)));
            let Some(z) = self.vertices.get_mut(before) else {
                both_ends.escape(walk, task, tally);
                continue;
            };
            if both_ends.arrive(walk, z, task, tally) {
                self.samples.push((index, task.sampler.clone()));
            } else {
                self.vertices.truncate(before);
            }
        }
    }

    /// Connects every vertex with lights and with its light subpath.
    fn connect<T: Tally<N>>(&mut self, paths: &mut CameraPaths<N, T>, task: &mut Task) {
        let CameraPaths { both_ends, samples, tallies, .. } = paths;
        self.shadow_rays.iter_mut().for_each(ShadowRays::clear);
        let is_clear = task.scene().has_clear_media();
        for (z, (sample, sampler)) in self.vertices.iter().zip(&mut self.samples) {
            task.wavelength = samples[*sample as usize].wavelength;
            task.sampler = sampler.clone();
            let light_path = self.light_paths.of(*sample as usize);
            both_ends.connect(z, light_path, task, |_, _, connection| {
                let Some(connection) = connection else { return };
                let Connection { technique, found, .. } = connection;
                let is_join = matches!(technique, Technique::Joined { s: 2.., .. });
                let unoccluded = Unoccluded { sample: *sample, technique, found };
                connection.list(&mut self.shadow_rays[usize::from(is_join)], is_clear, unoccluded);
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
    fn scatter<T: Tally<N>>(&mut self, paths: &mut CameraPaths<N, T>, task: &mut Task) {
        let CameraPaths { both_ends, samples, walks, tallies } = paths;
        self.next.clear();
        for (z, (index, sampler)) in self.vertices.iter().zip(&self.samples) {
            let i = *index as usize;
            task.wavelength = samples[i].wavelength;
            task.sampler = sampler.clone();
            both_ends.merge(z, task, &mut tallies[i]);
            if walks[i].scatter(z, both_ends.roulette_depth, task) {
                self.next.push(*index);
            }
        }
        std::mem::swap(&mut self.active, &mut self.next);
    }
}
