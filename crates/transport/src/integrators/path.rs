//! `path`: path tracing from the camera. [Kajiya 1986]

use super::{IntegratorEntry, PixelIntegrator};
use crate::path_tracing::{PathTracing, Sampling};
use crate::photons::Photons;
use crate::queue::PathQueue;
use crate::sampling::sample_queue::SampleQueue;
use crate::sampling::task::{Context, Task};
use bilux_math::Rgb;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_scene::Ray;

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "path",
        summary: "path tracing with next-event estimation: unbiased",
        source: "Kajiya 1986",
        parameters: &[
            Parameter {
                name: "sampling",
                summary: "how direct light is sampled: by the lights and the BSDF with multiple importance sampling \
                          (mis), by the lights only, or by the BSDF only (scattering)",
                unit: "",
                kind: ParameterKind::Choice(&["mis", "lights", "scattering"]),
                default: "mis",
            },
            super::ROULETTE_DEPTH,
        ],
    },
    covers: "L(D|G|S)*E",
    classic: false,
    default_spp: 64,
    build: |reader| {
        let sampling = match reader.text("sampling").as_str() {
            "lights" => Sampling::Lights,
            "scattering" => Sampling::Scattering,
            _ => Sampling::Mis,
        };
        Ok(Box::new(PathTracing { sampling, roulette_depth: reader.integer("roulette_depth") as u32 }))
    },
};

impl PixelIntegrator for PathTracing {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        match task.context.camera.receives() {
            true => self.receive(ray, task),
            false => self.trace(ray, task),
        }
    }

    fn receives(&self) -> bool {
        true
    }

    fn reports_light(&self) -> bool {
        true
    }

    fn queue<'a>(
        &self,
        context: &Context<'a>,
        _photons: Option<&'a Photons>,
    ) -> Option<Box<dyn SampleQueue + 'a>> {
        let has_queue = self.is_mis() && PathQueue::takes(context.scene) && !context.camera.receives();
        has_queue.then(|| Box::new(PathQueue::new(*self)) as _)
    }
}
