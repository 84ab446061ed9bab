//! `sppm`: stochastic progressive photon mapping. Light subpaths store photons; camera subpaths continue through
//! mirrors and glass to the first surface that is not specular, and gather the photons around it. The radius shrinks
//! from iteration to iteration. [Hachisuka 2009; Knaus 2011]

use super::{IntegratorEntry, PixelIntegrator, merging};
use crate::bidirectional::{Partial, Walk, emitted, from_infinity, merged};
use crate::photons::Merging;
use crate::task::Task;
use crate::techniques::{Contribution, Lanes, TechniqueCounts};
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use bilux_scene::{Ray, TransportMode};

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "sppm",
        summary: "stochastic progressive photon mapping: photons from the lights, gathered around camera vertices",
        source: "Hachisuka 2009",
        parameters: &[super::ROULETTE_DEPTH, merging::radius(1e-6), merging::ALPHA, merging::LIGHT_PATHS],
    },
    covers: "L(D|G|S)*E",
    classic: false,
    default_spp: 64,
    build: |reader| {
        Ok(Box::new(Sppm {
            roulette_depth: reader.integer("roulette_depth") as u32,
            merging: merging::read(reader, TechniqueCounts::CAMERA),
        }))
    },
};

struct Sppm {
    roulette_depth: u32,
    merging: Merging,
}

impl PixelIntegrator for Sppm {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        let mut walk = Walk::new(
            TransportMode::Radiance,
            *ray,
            Rgb::WHITE,
            Partial::START,
            false,
            &TechniqueCounts::CAMERA,
        );
        let mut sum = Rgb::BLACK;
        loop {
            let Some(z) = walk.next_vertex(task) else {
                // Lights that are visible, in mirrors too; photons bring the light that they give to other surfaces.
                from_infinity(task, &walk, |hit| sum += walk.seen(task) * hit.radiance);
                return sum;
            };
            if let Some(hit) = emitted(task, &z.surface, z.wo) {
                sum += walk.seen(task) * hit.radiance;
            }
            if z.depth >= task.max_depth {
                return sum;
            }
            if let Some(photons) = task.photons
                && !z.bsdf.is_delta()
            {
                // There is no other technique.
                merged(task, photons, &z, |_, found| {
                    sum += Contribution { others: Lanes::ZERO, ..*found }.weighted()
                });
            }
            task.sampler.enter(u64::from(z.depth) + 1);
            // Beyond an event that is not a delta event, photons have counted everything.
            if !walk.scatter(&z, self.roulette_depth, task) || !walk.specular {
                return sum;
            }
        }
    }

    fn merging(&self) -> Option<&Merging> {
        Some(&self.merging)
    }

    fn roulette_depth(&self) -> u32 {
        self.roulette_depth
    }
}
