//! `light`: light tracing. Paths begin at the lights, and each of their vertices is connected with the camera.
//! [Arvo 1986] What is visible only in mirrors or through glass is not found, and no other technique adds it: this
//! integrator exists to show what light subpaths are good for, and as one of `bdpt`'s techniques.

use super::{IntegratorEntry, PixelIntegrator};
use crate::bidirectional::{light_vertices, to_camera};
use crate::media::Media;
use crate::splats::Splats;
use crate::task::Task;
use crate::techniques::TechniqueCounts;
use bilux_math::registry::Entry;
use bilux_math::{Rgb, Vec3};
use bilux_scene::Ray;

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "light",
        summary: "light tracing: paths from the lights, each vertex connected to the camera; mirrors and glass stay \
                  black",
        source: "Arvo 1986",
        parameters: &[super::ROULETTE_DEPTH],
    },
    covers: "L(D|G|S)*(D|G)E|LE",
    classic: false,
    default_spp: 64,
    build: |reader| Ok(Box::new(Light { roulette_depth: reader.integer("roulette_depth") as u32 })),
};

struct Light {
    roulette_depth: u32,
}

impl PixelIntegrator for Light {
    /// Only the directly visible lights.
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        let mut media = Media::at_start(task.tracer, ray);
        match media.closest(task.tracer, ray) {
            Some((surface, passed)) => passed * task.scene().emission(&surface, -Vec3::from(ray.direction)),
            None => task.scene().background(ray.direction.into(), 0),
        }
    }

    fn splats(&self) -> bool {
        true
    }

    fn sample(&self, ray: &Ray, is_wanted: bool, task: &mut Task, splats: &mut Splats) -> Rgb {
        let emitted = if is_wanted { self.radiance(ray, task) } else { Rgb::BLACK };
        for vertex in light_vertices(task, ray.time, self.roulette_depth, &TechniqueCounts::BOTH_ENDS) {
            task.enter_light_vertex(vertex.depth);
            if let Some((film, connection)) = to_camera(task, &vertex, &TechniqueCounts::BOTH_ENDS)
                && let Some(found) = connection.trace(task)
            {
                // There is no other technique.
                splats.add(film, found.light);
            }
        }
        emitted
    }
}
