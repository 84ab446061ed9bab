//! `bdpt`: bidirectional path tracing. Each sample traces a subpath from the camera and one from a light; every vertex
//! of one is connected with every vertex of the other, with the camera and with a light, and each technique is weighted
//! against all others. [Veach 1997, 10; Lafortune 1993]

use super::{IntegratorEntry, PixelIntegrator};
use crate::bidirectional::{
    Contribution, Lanes, Partial, Photons, Step, Tally, Technique, TechniqueCounts, Vertex, Walk, count,
    emitted, from_infinity, light_vertices, merged, show_to_camera, to_light, to_vertex,
};
use crate::splats::Splats;
use crate::strategies::Layers;
use crate::task::Task;
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec2};
use bilux_scene::{Ray, TransportMode};

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "bdpt",
        summary: "bidirectional path tracing: subpaths from the camera and from the lights, connected in every possible way",
        source: "Veach 1997",
        parameters: &[super::ROULETTE_DEPTH],
    },
    covers: "L(D|G|S)*E",
    classic: false,
    default_spp: 64,
    build: |reader| Ok(Box::new(Bdpt { roulette_depth: reader.integer("roulette_depth") as u32 })),
};

struct Bdpt {
    roulette_depth: u32,
}

impl PixelIntegrator for Bdpt {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        of_camera_path(ray, task, &TechniqueCounts::BOTH_ENDS, self.roulette_depth)
    }

    fn splats(&self) -> bool {
        true
    }

    fn roulette_depth(&self) -> u32 {
        self.roulette_depth
    }

    fn sample(&self, ray: &Ray, is_wanted: bool, task: &mut Task, splats: &mut Splats) -> Rgb {
        let mut sum = Sum { here: Rgb::BLACK, splats };
        BothEnds::new(&TechniqueCounts::BOTH_ENDS, self.roulette_depth)
            .sample(ray, is_wanted, task, &mut sum);
        sum.here
    }

    fn has_strategies(&self) -> bool {
        true
    }

    fn sample_strategies(&self, ray: &Ray, is_wanted: bool, task: &mut Task, layers: &mut Layers) {
        BothEnds::new(&TechniqueCounts::BOTH_ENDS, self.roulette_depth).sample(ray, is_wanted, task, layers);
    }
}

/// One subpath from each end, and all that they find.
pub(super) struct BothEnds<'a, const N: usize = 1> {
    techniques: &'a TechniqueCounts<N>,
    photons: Option<&'a Photons<N>>,
    /// Its own light subpath is connected with the camera; false where those of the photons replace it.
    shows: bool,
    roulette_depth: u32,
}

impl<'a, const N: usize> BothEnds<'a, N> {
    /// Without merging.
    pub(super) fn new(techniques: &'a TechniqueCounts<N>, roulette_depth: u32) -> BothEnds<'a, N> {
        BothEnds { techniques, photons: None, shows: techniques.splats != Lanes::ZERO, roulette_depth }
    }

    /// With photons that camera subpaths are merged with.
    pub(super) fn merging(photons: &'a Photons<N>, shows: bool, roulette_depth: u32) -> BothEnds<'a, N> {
        BothEnds { techniques: photons.techniques(), photons: Some(photons), shows, roulette_depth }
    }

    /// Traces both subpaths; the one from the camera only where it `is_wanted`.
    pub(super) fn sample(&self, ray: &Ray, is_wanted: bool, task: &mut Task, tally: &mut impl Tally<N>) {
        let (shows, joins) = (self.shows, self.techniques.joins != Lanes::ZERO);
        let light_path = if !shows && !joins {
            Vec::new()
        } else {
            let rays = task.tracer.counters.rays;
            let vertices = light_vertices(task, ray.time, self.roulette_depth, self.techniques);
            tally.spend(Step::Light, (task.tracer.counters.rays - rays) as usize);
            vertices
        };
        if shows {
            show_to_camera(task, &light_path, self.techniques, tally);
        }
        if is_wanted {
            let joined = if joins { &light_path[..] } else { &[] };
            self.camera_path(ray, joined, task, tally);
        }
    }

    fn camera_path(&self, ray: &Ray, light_path: &[Vertex<N>], task: &mut Task, tally: &mut impl Tally<N>) {
        let mut walk =
            Walk::new(TransportMode::Radiance, *ray, Rgb::WHITE, Partial::START, false, self.techniques);
        loop {
            tally.spend(Step::Camera, 1);
            let Some(mut z) = walk.next_vertex(task) else {
                let technique = Technique::Joined { s: 0, t: count(walk.depth) };
                from_infinity(task, &walk, |hit| {
                    tally.add_sample(technique, &hit.by(walk.seen(task), &walk.partial))
                });
                return;
            };
            if z.depth == 0 {
                let density = task.camera.density(&walk.ray, z.surface.t);
                z.partial = Partial::of_camera(density * z.surface.n_geom.dot(z.wo).abs(), self.techniques);
                walk.partial = z.partial;
            }
            // s = 0: the subpath has hit a light by itself.
            if let Some(hit) = emitted(task, &z.surface, z.wo) {
                let seen = || Contribution::only(walk.seen(task) * hit.radiance);
                let technique = Technique::Joined { s: 0, t: z.count() };
                tally.add_sample(
                    technique,
                    &if z.depth == 0 { seen() } else { hit.by(walk.seen(task), &z.partial) },
                );
            }
            if z.depth >= task.max_depth {
                return;
            }
            task.sampler.enter(u64::from(z.depth) + 1);
            self.lights(&z, task, tally);
            if !z.bsdf.is_delta() {
                self.joins(&z, light_path, task, tally);
                if let Some(photons) = self.photons {
                    tally.spend(Step::Lookup, 1);
                    merged(task, photons, &z, |technique, found| tally.add_sample(technique, found));
                }
            }
            if !walk.scatter(&z, self.roulette_depth, task) {
                return;
            }
        }
    }

    /// s = 1: a point on a light is sampled.
    fn lights(&self, z: &Vertex<N>, task: &mut Task, tally: &mut impl Tally<N>) {
        let lights = task.lights;
        let u = task.sampler.next_1d();
        for index in lights.sample(u) {
            let u = task.sampler.next_2d();
            if z.bsdf.is_delta() {
                continue;
            }
            tally.spend(Step::Picked, 1);
            if let Some(found) = to_light(task, z, index, u, self.techniques) {
                tally.add_sample(Technique::Joined { s: 1, t: z.count() }, &found);
            }
        }
    }

    /// s, t > 1: the vertex is connected with every vertex of the light subpath.
    fn joins(&self, z: &Vertex<N>, light_path: &[Vertex<N>], task: &mut Task, tally: &mut impl Tally<N>) {
        let max_depth = task.max_depth;
        for y in light_path.iter().filter(|y| z.depth + y.depth + 2 <= max_depth) {
            tally.spend(Step::Joined, 1);
            if let Some(found) = to_vertex(task, z, y, self.techniques) {
                tally.add_sample(Technique::Joined { s: y.count(), t: z.count() }, &found);
            }
        }
    }
}

/// What a camera subpath finds without a light subpath, weighted as if there were some.
pub(super) fn of_camera_path(
    ray: &Ray,
    task: &mut Task,
    techniques: &TechniqueCounts,
    roulette_depth: u32,
) -> Rgb {
    /// Sums the light of the pixel itself.
    struct PixelSum(Rgb);
    impl Tally<1> for PixelSum {
        fn add_sample(&mut self, _technique: Technique, found: &Contribution) {
            self.0 += found.weighted();
        }
        fn add_splat(&mut self, _film: Vec2, _technique: Technique, _found: &Contribution) {}
    }
    let mut sum = PixelSum(Rgb::BLACK);
    BothEnds::new(techniques, roulette_depth).camera_path(ray, &[], task, &mut sum);
    sum.0
}

/// Sums weighted contributions.
pub(super) struct Sum<'a, 's> {
    pub(super) here: Rgb,
    pub(super) splats: &'a mut Splats<'s>,
}

impl Tally<1> for Sum<'_, '_> {
    fn add_sample(&mut self, _technique: Technique, found: &Contribution) {
        self.here += found.weighted();
    }
    fn add_splat(&mut self, film: Vec2, _technique: Technique, found: &Contribution) {
        self.splats.add(film, found.weighted());
    }
}
