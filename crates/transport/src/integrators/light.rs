//! `light`: light tracing. Paths begin at the lights, and each of their vertices is connected with the camera.
//! [Arvo 1986] What is visible only in mirrors or through glass is not found, and no other technique adds it: this
//! integrator exists to show what light subpaths are good for, and as one of `bdpt`'s techniques.

use super::{IntegratorEntry, LightSubpaths, PixelIntegrator};
use crate::bidirectional::{LightTracing, LightTracingSamples};
use crate::photons::Photons;
use crate::sampling::sample_queue::SampleQueue;
use crate::sampling::splats::Splats;
use crate::sampling::task::{Context, Task};
use bilux_math::Rgb;
use bilux_math::registry::Entry;
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
    build: |reader| Ok(Box::new(LightTracing { roulette_depth: reader.integer("roulette_depth") as u32 })),
};

impl PixelIntegrator for LightTracing {
    /// Only the directly visible lights.
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        LightTracing::emitted(ray, task)
    }

    /// No light subpath begins in a medium.
    fn sees_glow(&self) -> bool {
        false
    }

    fn light_subpaths(&self) -> Option<&dyn LightSubpaths> {
        Some(self)
    }

    fn queue<'a>(
        &self,
        _context: &Context<'a>,
        _photons: Option<&'a Photons>,
    ) -> Option<Box<dyn SampleQueue + 'a>> {
        Some(Box::new(LightTracingSamples::new(*self)))
    }
}

impl LightSubpaths for LightTracing {
    fn sample(
        &self,
        ray: &Ray,
        is_wanted: bool,
        _photons: Option<&Photons>,
        task: &mut Task,
        splats: &mut Splats,
    ) -> Rgb {
        let emitted = if is_wanted { self.radiance(ray, task) } else { Rgb::BLACK };
        self.trace(ray.time, task, |film, light| splats.add(film, light));
        emitted
    }
}
