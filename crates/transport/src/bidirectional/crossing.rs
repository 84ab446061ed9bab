//! Merging of rays of camera subpaths with the photon beams that they cross in media.

use super::vertex::count;
use crate::media::equiangular::{self, Approach, Departure};
use crate::photons::beam::{Beam, Crossing, medium_of};
use crate::photons::beams::PhotonBeams;
use crate::sampling::task::Task;
use crate::techniques::{Contribution, Technique, TechniqueCounts};
use bilux_math::Vec3;
use bilux_scene::Ray;
use bilux_scene::media::mean;

/// Merges a beam of a camera subpath with all photon beams that it crosses, and visits the light that each of them brings. `ray` is
/// the one that the beam is a part of.
pub(crate) fn crossed<const N: usize>(
    task: &Task,
    beams: &PhotonBeams<N>,
    z: &Beam<N>,
    ray: &Ray,
    techniques: &TechniqueCounts<N>,
    mut visit: impl FnMut(Technique, &Contribution<N>),
) {
    let scene = task.context.scene;
    let Some((medium, is_inside)) = medium_of(scene, z.object) else { return };
    let (eye, channel) = (&z.subpath, usize::from(z.subpath.channel));
    let sigma_t = medium.sigma_t();
    let is_equiangular = equiangular::is_used_inside(scene, &medium, is_inside);
    let often = techniques.crossings(sigma_t, eye.channel);
    let per_events = 1.0 / (sigma_t[channel] * sigma_t[channel]);
    let camera = (eye.depth == 0).then_some((task.context.camera, ray));
    beams.crossing(&z.line, |y, [along_z, along_y]| {
        let light = &y.subpath;
        let events = eye.events.joined(light.events).and(is_inside);
        let is_one = y.object == z.object && light.channel == eye.channel;
        let is_left = light.start.is_some() && is_equiangular && !techniques.direct;
        if !is_one || is_left || !events.are_within(task.context.max_depth) {
            return;
        }
        let [wo, wi] = [-z.line.direction, -y.line.direction];
        let pdf = medium.phase.eval(wo, wi);
        let from_camera = z.at(scene, &medium, along_z, camera, techniques);
        let mut from_light = y.at(scene, &medium, along_y, None, techniques);
        if let (Some(start), true) = (light.start, is_equiangular && !eye.leaves_medium) {
            let Crossing { distance, by_walk, .. } = from_camera;
            let ray = Departure {
                origin: Vec3::from(ray.origin),
                direction: z.line.direction,
                leaves_medium: false,
            };
            let approach = Approach { ray, t: distance, by_walk };
            let also = from_light.partial.connected * approach.ratio(scene, start.light);
            from_light.partial.connected = from_light.partial.connected + also;
        }
        let [row_z, row_y] = [eye, light].map(|subpath| subpath.events.and(is_inside).in_row);
        let others = from_camera.partial.before_crossing(pdf, row_z, events.in_row)
            + from_light.partial.before_crossing(pdf, row_y, events.in_row);
        let brought = from_camera.beta * from_light.beta * medium.sigma_s * (pdf * per_events);
        let brought = task.sample.seen(brought, eye.is_split || light.is_split);
        let brought = brought / mean(from_camera.odds * from_light.odds * sigma_t / sigma_t[channel]);
        let technique = Technique::Merged { s: count(light.depth), t: count(eye.depth) };
        let (own, origin) = (often * wo.cross(wi).length(), light.origin);
        visit(technique, &Contribution { own, others, origin, ..Contribution::only(brought) });
    });
}
