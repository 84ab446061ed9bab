//! `bdpt`: bidirectional path tracing. Each sample grows a path from the camera and one from a light; every vertex of the
//! one is joined with every vertex of the other, with the camera and with a light, and each way of finding a path is
//! weighted against all others. [Veach 1997, 10; Lafortune 1993]

use super::{IntegratorEntry, PixelIntegrator};
use crate::bidirectional::{
    Partial, Photons, Vertex, Walk, emitted, from_infinity, light_vertices, merged, to_camera, to_light,
    to_vertex,
};
use crate::splats::Splats;
use crate::task::Task;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use bilux_scene::{Ray, Reader, TransportMode};

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "bdpt",
        summary: "bidirectional path tracing: paths from the camera and from the lights, joined in every way",
        source: "Veach 1997",
        parameters: &[super::ROULETTE_DEPTH],
    },
    covers: "L(D|G|S)*E",
    classic: false,
    default_spp: 64,
    build: |reader| Ok(Box::new(Bdpt::new(reader))),
};

pub(super) struct Bdpt {
    roulette_depth: u32,
}

impl PixelIntegrator for Bdpt {
    /// Without light paths: what the camera path finds, weighted as if there were some.
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        self.camera_path(ray, &[], task)
    }

    fn splats(&self) -> bool {
        true
    }

    fn roulette_depth(&self) -> u32 {
        self.roulette_depth
    }

    fn sample(&self, ray: &Ray, is_wanted: bool, task: &mut Task, splats: &mut Splats) -> Rgb {
        let light_path = light_vertices(task, ray.time, self.roulette_depth, eta(task));
        for y in &light_path {
            task.enter_light_vertex(y.depth);
            if let Some((film, light, others)) = to_camera(task, y) {
                splats.add(film, light * (1.0 / (1.0 + others)));
            }
        }
        if is_wanted { self.camera_path(ray, &light_path, task) } else { Rgb::BLACK }
    }
}

/// How many light paths a merged vertex counts; 0 where nothing is merged.
fn eta(task: &Task) -> f32 {
    task.photons.map_or(0.0, Photons::eta)
}

impl Bdpt {
    pub(super) fn new(reader: &Reader) -> Bdpt {
        Bdpt { roulette_depth: reader.integer("roulette_depth") as u32 }
    }

    fn camera_path(&self, ray: &Ray, light_path: &[Vertex], task: &mut Task) -> Rgb {
        let mut walk = Walk::new(TransportMode::Radiance, *ray, Rgb::WHITE, Partial::default(), false);
        let mut sum = Rgb::BLACK;
        loop {
            let Some(mut z) = walk.meet(task) else {
                return sum + walk.beta * from_infinity(task, &walk);
            };
            if z.depth == 0 {
                let density = task.camera.density(&walk.ray, z.surface.t);
                z.partial = Partial::of_camera(density * z.surface.n_geom.dot(z.wo).abs(), eta(task));
                walk.partial = z.partial;
            }
            sum += z.beta * self.emission(&z, task);
            if z.depth >= task.max_depth {
                return sum;
            }
            task.sampler.enter(u64::from(z.depth) + 1);
            sum += self.lights(&z, task) + self.connections(&z, light_path, task);
            if let Some(photons) = task.photons
                && !z.bsdf.is_delta()
            {
                sum += merged(task, photons, &z, false);
            }
            if !walk.scatter(&z, self.roulette_depth, task) {
                return sum;
            }
        }
    }

    /// s = 0: the path has met a light by itself.
    fn emission(&self, z: &Vertex, task: &Task) -> Rgb {
        match emitted(task, &z.surface, z.wo) {
            None => Rgb::BLACK,
            Some(found) if z.depth == 0 => found.radiance,
            Some(found) => {
                let others = z.partial.d_vcm * found.pdf_direct + z.partial.d_vc * found.pdf_emission;
                found.radiance * (1.0 / (1.0 + others))
            }
        }
    }

    /// s = 1: a point on a light is sampled.
    fn lights(&self, z: &Vertex, task: &mut Task) -> Rgb {
        let lights = task.lights;
        let u = task.sampler.next_1d();
        let mut sum = Rgb::BLACK;
        for index in lights.sample(u) {
            let u = task.sampler.next_2d();
            if !z.bsdf.is_delta() {
                sum += to_light(task, z, index, u);
            }
        }
        sum
    }

    /// s, t > 1: the path is joined with every vertex of the light path.
    fn connections(&self, z: &Vertex, light_path: &[Vertex], task: &mut Task) -> Rgb {
        if z.bsdf.is_delta() {
            return Rgb::BLACK;
        }
        let max_depth = task.max_depth;
        let short_enough = light_path.iter().filter(|y| z.depth + y.depth + 2 <= max_depth);
        short_enough.fold(Rgb::BLACK, |sum, y| sum + to_vertex(task, z, y))
    }
}
