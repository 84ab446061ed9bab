//! `bdpt`: bidirectional path tracing. Each sample traces a subpath from the camera and one from a light; every vertex
//! of one is connected with every vertex of the other, with the camera and with a light, and each technique is weighted
//! against all others by the balance heuristic. [Veach 1997, 10; Lafortune 1993]
//!
//! It deviates from the balance heuristic in one point: of the two techniques by which a camera subpath finds a light on its own, s = 0
//! and s = 1, the joint weight is that of the balance heuristic, but it is divided between them by the power heuristic
//! (`power_factor` in `techniques.rs`). The weights of all techniques still add up to 1. With the balance heuristic alone, the
//! direct light of a panel has 1.6 times the variance.

use super::{IntegratorEntry, LightSubpaths, PixelIntegrator};
use crate::bidirectional::{BothEnds, CameraSubpath};
use crate::photons::Photons;
use crate::sampling::task::Task;
use crate::techniques::{PixelSum, TechniqueCounts};
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use bilux_scene::Ray;

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
        of_camera_path(ray, task, &BothEnds::new(TechniqueCounts::BOTH_ENDS, self.roulette_depth))
    }

    fn light_subpaths(&self) -> Option<&dyn LightSubpaths> {
        Some(self)
    }
}

impl LightSubpaths for Bdpt {
    fn both_ends<'a>(&self, _photons: Option<&'a Photons>) -> Option<BothEnds<'a>> {
        Some(BothEnds::new(TechniqueCounts::BOTH_ENDS, self.roulette_depth))
    }
}

/// Light that a camera subpath finds without a light subpath, weighted as if there were some.
pub(super) fn of_camera_path(ray: &Ray, task: &mut Task, both_ends: &BothEnds) -> Rgb {
    let mut sum = PixelSum::default();
    both_ends.follow(ray, &[], task, &mut sum);
    sum.0
}
