//! `cast`: Equation 1 at the first surface that a camera ray hits. No reflection, no refraction.

use super::{CameraSpread, IntegratorEntry, PixelIntegrator};
use crate::classic::{LocalRules, SPECULAR, ShadowRule, Shadows, specular};
use crate::sampling::task::Task;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Rgb, Vec3};
use bilux_scene::Ray;

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "cast",
        summary: "ray casting: the Phong model (Equation 1) at the first hit",
        source: "Appel 1968",
        parameters: &[
            Parameter {
                name: "shadows",
                summary: "cast shadow rays",
                unit: "",
                kind: ParameterKind::Bool,
                default: "true",
            },
            SPECULAR,
            Parameter {
                name: "viewer",
                summary: "the viewer of the highlight: at the eye (local) or infinitely far away (infinite)",
                unit: "",
                kind: ParameterKind::Choice(&["local", "infinite"]),
                default: "local",
            },
        ],
    },
    covers: "L(D|G)?E",
    classic: true,
    default_spp: 4,
    build: |reader| {
        Ok(Box::new(Cast {
            rules: LocalRules {
                specular: specular(reader),
                shadows: if reader.bool("shadows") { Shadows::Opaque } else { Shadows::Off },
                rule: ShadowRule::PerLight,
                light_extent: 0.0,
            },
            infinite_viewer: reader.text("viewer") == "infinite",
        }))
    },
};

struct Cast {
    rules: LocalRules,
    infinite_viewer: bool,
}

impl PixelIntegrator for Cast {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        let direction = Vec3::from(ray.direction);
        let Some(surface) = task.tracer.closest(ray) else {
            task.sample.note(0, || "leaves the scene".to_owned());
            return task.context.scene.background(direction, 0);
        };
        task.sample.vertices += 1;
        task.sample.note(0, || format!("hits object {} at {}", surface.object, surface.p));
        let material = task.context.scene.material(&surface);
        let emission = task.context.scene.emission(&surface, -direction);
        if !emission.is_black() {
            return emission.clamp(0.0, 1.0);
        }
        if task.context.max_depth == 0 {
            return Rgb::BLACK;
        }
        let eye = if self.infinite_viewer { -task.context.camera.forward(ray.time) } else { -direction };
        let classic = material.classic(&surface);
        let local = self.rules.illuminate(task, &surface, &classic, eye, 0.0);
        (local.ambient + local.diffuse + classic.ks * local.highlight).clamp(0.0, 1.0)
    }

    fn camera_spread(&self) -> CameraSpread {
        CameraSpread::NONE
    }
}
