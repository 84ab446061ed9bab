//! `whitted`: the paper's ray tracer. Equation 2 with mirror reflection, refraction, Fresnel and shadows.

use super::{CameraSpread, IntegratorEntry, PixelIntegrator};
use crate::classic::{self, CUTOFF, FRESNEL, RayTree, SHADOW_RULE, SHADOWS, SPECULAR};
use crate::sampling::task::Task;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use bilux_scene::Ray;

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "whitted",
        summary: "Whitted ray tracing: Equation 2 with recursive reflection, refraction and shadows",
        source: "Whitted 1980",
        parameters: &[SPECULAR, FRESNEL, SHADOW_RULE, SHADOWS, CUTOFF],
    },
    covers: "L(D|G)?S*E",
    classic: true,
    default_spp: 4,
    build: |reader| Ok(Box::new(Whitted { tree: classic::ray_tree(reader) })),
};

struct Whitted {
    tree: RayTree,
}

impl PixelIntegrator for Whitted {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        self.tree.intensity(task, ray)
    }

    fn camera_spread(&self) -> CameraSpread {
        CameraSpread::NONE
    }
}
