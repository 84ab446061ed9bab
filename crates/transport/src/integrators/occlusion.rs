//! `occlusion`: the unoccluded fraction of the hemisphere at each point, whatever its material and the scene's lights:
//! the quickest way to see the shape of a bare model. [Zhukov 1998]

use super::{IntegratorEntry, PixelIntegrator};
use crate::media::Media;
use crate::sampling::task::Task;
use crate::walk::through::Through;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::{Frame, Rgb, Vec3, warp};
use bilux_scene::Ray;

pub(super) const ENTRY: IntegratorEntry = IntegratorEntry {
    entry: Entry {
        name: "occlusion",
        summary: "ambient occlusion: the unoccluded fraction of the hemisphere at each point, without materials and \
                  lights",
        source: "Zhukov 1998",
        parameters: &[Parameter {
            name: "distance",
            summary: "maximum distance of an occluder; 0 for no limit",
            unit: "m",
            kind: ParameterKind::Number { min: 0.0, max: 1e9 },
            default: "0",
        }],
    },
    covers: "",
    classic: true,
    default_spp: 16,
    build: |reader| {
        let distance = reader.number("distance");
        Ok(Box::new(Occlusion { distance: if distance > 0.0 { distance } else { f32::INFINITY } }))
    },
};

struct Occlusion {
    distance: f32,
}

impl PixelIntegrator for Occlusion {
    /// 1 where a cosine-distributed direction is unoccluded, 0 where it is occluded; 1 where the ray leaves the scene.
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        // Boundaries of media are not surfaces.
        let mut media = Media::at_start(task.tracer, ray);
        let first = task.tracer.closest(ray);
        let Some(surface) = first.and_then(|first| media.closest_from(task.tracer, ray, first, 0).0) else {
            task.sample.note(0, || "leaves the scene".to_owned());
            return Rgb::WHITE;
        };
        task.sample.vertices += 1;
        let faces_eye = surface.n_shade.dot(Vec3::from(ray.direction)) < 0.0;
        let normal = if faces_eye { surface.n_shade } else { -surface.n_shade };
        let wi = Frame::from_normal(normal)
            .to_world(warp::sample_cosine_hemisphere(task.sample.sampler.next_2d()));
        let probe = Ray { t_max: self.distance, ..surface.spawn(wi) };
        let media = media.beyond(task.context.scene, &surface, -Vec3::from(ray.direction), wi);
        let through = Through { media, distance: None, panes: 0, seed: 0 };
        let open = through.visible(task.tracer, &probe, Vec3::ZERO).is_some();
        task.sample.note(0, || {
            format!("at {} the direction {wi} is {}", surface.p, if open { "open" } else { "closed" })
        });
        if open { Rgb::WHITE } else { Rgb::BLACK }
    }
}
