//! Merging of a vertex of a camera subpath with the photons around it.

use super::vertex::{Vertex, count, kept_share};
use crate::media::interaction::{Interaction, MediumPoint};
use crate::photons::Photons;
use crate::sampling::task::Task;
use crate::techniques::{Contribution, Technique};
use bilux_math::hash::{mix64, unit_f32};
use bilux_scene::media::mean;
use bilux_scene::{Bsdf, Surface, TransportMode};

/// Merges a camera vertex with all photons around it, and visits the light that each of them brings. True if it has
/// looked for any.
pub(crate) fn merged<const N: usize>(
    task: &Task,
    photons: &Photons<N>,
    z: &Vertex<N>,
    visit: impl FnMut(Technique, &Contribution<N>),
) -> bool {
    match &z.at {
        Interaction::Surface(surface, bsdf) => {
            on_surface(task, photons, z, (surface, bsdf), visit);
            true
        }
        Interaction::Medium(point) => in_medium(task, photons, z, point, visit),
    }
}

/// Merges a camera vertex on a surface.
#[inline]
fn on_surface<const N: usize>(
    task: &Task,
    photons: &Photons<N>,
    z: &Vertex<N>,
    (surface, bsdf): (&Surface, &Bsdf),
    mut visit: impl FnMut(Technique, &Contribution<N>),
) {
    let facing = bsdf.facing(z.wo, TransportMode::Radiance);
    photons.around(surface.p, |position, y, walk| {
        // Densities are those of one channel.
        if walk.is_some_and(|walk| walk.channel != task.sample.channel) {
            return;
        }
        // Merge only on the same surface, not with the other side of a sheet or around a corner.
        let counted = z.events().counted + position.counted();
        if counted > task.context.max_depth || surface.n_geom.dot(y.n_geom) < 0.5 {
            return;
        }
        let Some((scattered, pdf, back)) = facing.eval_and_pdfs(y.wo) else { return };
        // Photons arrive per area of the surface that they fell on, and grazing ones are rare; `eval` contains the
        // cosine to the shading normal. With the normal at `z`, a grazing photon from around a bend could have any
        // brightness.
        let cos = y.n_geom.dot(y.wo).abs();
        let others = y.connected + y.d_vc * pdf + z.partial.before(back);
        let light =
            task.sample.seen(z.beta * scattered * y.beta * (1.0 / cos), z.is_split() || position.is_split());
        let light = walk.map_or(light, |walk| light / mean(z.odds * walk.odds));
        let technique = Technique::Merged { s: count(position.depth()), t: z.count() };
        let own = photons.techniques().eta;
        visit(technique, &Contribution { own, others, origin: position.origin, ..Contribution::only(light) });
    });
}

/// Merges a camera vertex in a dense medium with the photons in a ball; true if it has looked for any. A light subpath comes
/// to a point as often as it has an event there, so throughputs of both have scattered there, and one has to take that back.
/// [Křivánek 2014, estimator P-P3D]
///
/// Of long walks, few points are merged, and count for more, as light subpaths keep few.
fn in_medium<const N: usize>(
    task: &Task,
    photons: &Photons<N>,
    z: &Vertex<N>,
    point: &MediumPoint,
    mut visit: impl FnMut(Technique, &Contribution<N>),
) -> bool {
    let Some(ball) = z.ball else { return false };
    let (share, scene) = (kept_share(z.events.in_row), task.context.scene);
    if share < 1.0 && unit_f32(mix64(task.sample.seed()) as u32) >= share {
        return false;
    }
    let Some((object, sigma_s)) = z.media.scattering(scene) else { return false };
    let inside = z.media.part_inside(scene, point.p, ball);
    // How often a photon there is found is known; weights count whole balls.
    let share = share * inside.volume / ball.volume;
    let once = sigma_s.map(|sigma| if sigma > 0.0 { 1.0 / (sigma * share) } else { 0.0 });
    let own = photons.techniques().points * ball.volume;
    photons.points().around(point.p, inside.radius, |_, position, y| {
        let events = z.events.merged(y.events, point.is_inside);
        let is_one = y.object == object && y.walk.channel == task.sample.channel;
        if !is_one || !events.are_within(task.context.max_depth) {
            return;
        }
        let pdf = point.phase.eval(z.wo, y.wo);
        let mut from_light = y.partial;
        if let (Some(light), Some(approach)) = (y.straight_from, z.approach) {
            let also = from_light.connected * approach.ratio(scene, light as usize);
            from_light.connected = from_light.connected + also;
        }
        let others = z.partial.before_crossing(pdf, z.events.in_row, events.in_row)
            + from_light.before_crossing(pdf, y.events.in_row, events.in_row);
        let light = task.sample.seen(z.beta * y.beta * once * pdf, z.is_split() || position.is_split());
        let light = light / mean(z.odds * y.walk.odds);
        let technique = Technique::Merged { s: count(position.depth()), t: z.count() };
        visit(technique, &Contribution { own, others, origin: position.origin, ..Contribution::only(light) });
    });
    true
}
