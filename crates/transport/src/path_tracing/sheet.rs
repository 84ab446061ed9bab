//! White matt paper that is not there: on it begin the paths of a camera that measures the light that arrives
//! ([`Camera::receives`](bilux_scene::Camera::receives)). What such paper reflects is the irradiance over π.

use super::{Path, PathTracing, Vertex};
use crate::media::Media;
use crate::media::interaction::{Interaction, NO_OBJECT};
use crate::sampling::task::Task;
use crate::walk::Walk;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::bsdf::{Lambert, Lobe};
use bilux_scene::surface::gamma;
use bilux_scene::{Bsdf, Primitive, Ray, Surface};

impl PathTracing {
    /// Follows one path from the paper where a ray begins, which faces along the ray. Returns the light that the paper reflects.
    pub(crate) fn receive(&self, ray: &Ray, task: &mut Task) -> Rgb {
        let normal = Vec3::from(ray.direction);
        let at = Interaction::Surface(paper(ray, normal), white(normal));
        let seen_from = Ray { direction: (-normal).to_array(), ..*ray };
        let mut path = Path::new(&seen_from, Media::at_start(task.tracer, ray));
        task.sample.reach(|| at.place(normal));
        task.sample.sampler.enter(1);
        let panes = path.walk.panes(task.context, false);
        let Walk { media, odds, .. } = path.walk;
        let from = Vertex { at: &at, wo: normal, media: &media, odds, approach: None, panes };
        let seen = path.walk.seen(task.sample);
        path.light = seen * self.direct(task, &from, (0, seen));
        if let Some(record) = task.sample.record.as_deref_mut() {
            record.straight = record.found.as_ref().map_or(0, Vec::len);
        }
        match self.scatter(&mut path, &at, None, task) {
            true => {
                if let Some(record) = task.sample.record.as_deref_mut() {
                    record.first = Some(Vec3::from(path.walk.ray.direction));
                }
                self.follow(path, task)
            }
            false => path.light,
        }
    }
}

fn white(normal: Vec3) -> Bsdf {
    Bsdf::of(normal, normal, Lobe::Lambert(Lambert { albedo: Rgb::WHITE }))
}

/// The paper where a ray begins.
pub(crate) fn paper(ray: &Ray, normal: Vec3) -> Surface {
    let p = Vec3::from(ray.origin);
    Surface {
        t: 0.0,
        p,
        // A point that is meant to lie on a surface was rounded when it was computed.
        p_error: Vec3::splat(gamma(16) * p.abs().max_element()),
        n_geom: normal,
        n_shade: normal,
        n_smooth: normal,
        tangent: Vec3::ZERO,
        handedness: 1.0,
        uv: Vec2::ZERO,
        uv2: Vec2::ZERO,
        uv_width: [Vec2::ZERO; 2],
        vertex_kd: None,
        vertex_ks: None,
        primitive: Primitive::NONE,
        object: NO_OBJECT,
        time: ray.time,
    }
}
