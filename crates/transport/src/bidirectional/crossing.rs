//! How rays of camera subpaths are merged with the photon beams that they cross in media.

use super::subpath::count;
use crate::beam::{Beam, medium_of};
use crate::photon_beams::PhotonBeams;
use crate::task::Task;
use crate::techniques::{Contribution, PerSet, Technique, TechniqueCounts};
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
    let sigma_t = medium.sigma_t();
    let sigma = sigma_t[usize::from(z.channel)];
    let here = 1.0 / (sigma * sigma);
    let eye = (z.depth == 0).then_some((task.context.camera, ray));
    beams.crossing(&z.line, |y, [along_z, along_y]| {
        let events = z.events.joined(y.events).and(is_inside);
        if y.object != z.object || y.channel != z.channel || !events.are_within(task.context.max_depth) {
            return;
        }
        let [wo, wi] = [-z.line.direction, -y.line.direction];
        let pdf = medium.phase.eval(wo, wi);
        let mut from_camera = z.at(scene, &medium, along_z, eye, techniques);
        if y.start.is_some() && !techniques.direct {
            from_camera.partial.splatted = PerSet::ZERO;
        }
        let from_light = y.at(scene, &medium, along_y, None, techniques);
        let row = if is_inside { events.in_row } else { 0 };
        let rows = [z, y].map(|beam| if is_inside { beam.events.in_row + 1 } else { 0 });
        let others = from_camera.partial.before_crossing(pdf, rows[0], row)
            + from_light.partial.before_crossing(pdf, rows[1], row);
        let light = from_camera.beta * from_light.beta * medium.sigma_s * (pdf * here);
        let light = task.sample.seen(light, z.is_split || y.is_split);
        let light = light / mean(from_camera.odds * from_light.odds * sigma_t / sigma);
        let own = techniques.beams * (wo.cross(wi).length() * here);
        let technique = Technique::Merged { s: count(y.depth), t: count(z.depth) };
        visit(technique, &Contribution { own, others, origin: y.origin, ..Contribution::only(light) });
    });
}
