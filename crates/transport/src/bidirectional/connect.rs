//! Connections of subpaths: with the camera, with a point on a light, or with each other.

use super::vertex::Vertex;
use crate::film::limits::MAX_CONNECTED_ROW;
use crate::light::emission::light_number;
use crate::media::Passage;
use crate::media::interaction::Interaction;
use crate::sampling::task::{Context, Task};
use crate::techniques::{Contribution, PerSet, Technique, TechniqueCounts, power_factor};
use crate::walk::segment::Segment;
use crate::walk::through::Through;
use bilux_math::{Rgb, Vec2, Vec3, warp};
use bilux_scene::{Ray, Tracer, TransportMode};

/// A connection, before it is known what lies between its ends.
pub(crate) struct Connection<const N: usize = 1> {
    pub(crate) join: Join<N>,
    pub(crate) segment: Segment,
}

/// Join of the two ends of a connection, if nothing blocks it.
pub(crate) struct Join<const N: usize = 1> {
    /// If no panes are on the way.
    pub(crate) technique: Technique,
    /// Contribution, but for other techniques and what absorbs on the way.
    found: Contribution<N>,
    /// Frequency of other techniques that come back along the segment to its start and find the path, if no medium is on the way.
    back: PerSet<N>,
    end: End<N>,
    /// Frequency of the other techniques that do not depend on what lies along the segment.
    alike: PerSet<N>,
    /// Whether each end is a point of a medium.
    in_medium: [bool; 2],
    /// The odds of both subpaths together.
    odds: Rgb,
}

/// Other techniques that go on along the segment to its end, if no medium is on the way.
enum End<const N: usize> {
    /// They find the path so often.
    Vertex(PerSet<N>),
    /// The camera subpath hits the light by chance.
    Light {
        by_chance: f32,
        /// [`Join::back`], if panes are on the way.
        back_beyond_panes: PerSet<N>,
    },
}

impl<const N: usize> Connection<N> {
    /// By which technique it contributes what; `None` where something blocks it.
    #[inline]
    pub(crate) fn trace(&self, tracer: &mut Tracer) -> Option<(Technique, Contribution<N>)> {
        Some(self.join.along(&self.segment.passage(tracer)?))
    }
}

impl<const N: usize> Join<N> {
    /// This join of an equiangular point and a point on its light, where there are `ratio` such points for each event of a walk.
    pub(super) fn equiangular(self, ratio: f32) -> Join<N> {
        Join { found: Contribution { own: PerSet::ONE * ratio, ..self.found }, alike: PerSet::ONE, ..self }
    }

    /// By which technique it contributes what along this. Each pane is one more vertex on the side of the light.
    #[inline]
    pub(crate) fn along(&self, passage: &Passage) -> (Technique, Contribution<N>) {
        let [leaves_medium, ends_in_medium] = self.in_medium;
        let on_by = passage.arriving((!ends_in_medium).then_some(1.0));
        let together = self.found.own.0[0] + self.alike.0[0];
        let (on, power_factor, back) = match self.end {
            End::Vertex(on) => (on * on_by, 1.0, self.back),
            End::Light { by_chance, back_beyond_panes } => {
                let by_chance = by_chance * on_by;
                let back = if passage.panes > 0 { back_beyond_panes } else { self.back };
                (PerSet::ONE * by_chance, power_factor(by_chance / together), back)
            }
        };
        let technique = match self.technique {
            Technique::Connected { s, t } => Technique::Connected { s: s + passage.panes, t },
            merged => merged,
        };
        let found = Contribution {
            light: self.found.light * passage.share(self.odds),
            others: on + back * passage.returning(leaves_medium) + self.alike,
            power_factor,
            ..self.found
        };
        (technique, found)
    }
}

/// Connects a vertex of a light subpath with the camera (t = 1): the position on the film or where pixels reach beyond its
/// edge, and the light there as an integral over the whole film.
pub(crate) fn to_camera<const N: usize>(
    task: &mut Task,
    y: &Vertex<N>,
    techniques: &TechniqueCounts<N>,
) -> Option<(Vec2, Connection<N>)> {
    let u_lens = task.sample.sampler.next_2d();
    let lens = if task.context.camera.has_lens() { warp::sample_disc(u_lens) } else { Vec2::ZERO };
    let seen = task.context.camera.connect(y.at.p(), lens, y.at.time())?;
    let exposure = task.context.exposure;
    if !task.context.splat_bounds.contains(seen.film) || !exposure.exposes(seen.film, y.at.time()) {
        return None;
    }
    let density = seen.density * exposure.density(y.at.time());
    let scattered = y.at.eval(y.wo, seen.wi, TransportMode::Importance);
    let hides = |surface| task.context.scene.camera_sees_through(surface, seen.wi);
    if scattered.is_black() || y.at.surface().is_some_and(hides) {
        return None;
    }
    let media = y.media_towards(task.context.scene, seen.wi);
    let ray = task.context.scene.to_camera(y.at.spawn_to(seen.p));
    let arriving = density * y.at.cos(seen.wi).unwrap_or(1.0);
    let back = y.at.pdf_solid_angle(seen.wi, y.wo, TransportMode::Radiance);
    let others = y.partial.others(arriving, back, y.at.sine(y.wo, seen.wi, techniques));
    let light = task.sample.seen(y.beta * scattered * density, y.is_split());
    let join = Join {
        technique: Technique::Connected { s: y.count(), t: 1 },
        found: Contribution { own: techniques.splats, origin: y.origin, ..Contribution::only(light) },
        back: others,
        end: End::Vertex(PerSet::ZERO),
        alike: y.lit_from(task.context.scene, seen.p) * arriving,
        in_medium: [y.at.is_in_medium(), false],
        odds: y.odds,
    };
    let distance = Some(seen.p.distance(y.at.p()));
    let segment = Segment {
        ray,
        n: Vec3::ZERO,
        through: Through { media, distance, panes: 0, seed: task.sample.seed() },
    };
    Some((seen.film, Connection { join, segment }))
}

/// A point of the film, and where else beside it pixels see the same: light that arrives there arrives everywhere.
pub(crate) fn places_on_film(context: &Context, film: Vec2) -> impl Iterator<Item = Vec2> {
    let bounds = context.splat_bounds;
    let beside = context.camera.repeats(film).into_iter().flatten();
    std::iter::once(film).chain(beside.filter(move |film| bounds.contains(*film)))
}

/// Connects a camera vertex with a point sampled on a light (s = 1), which was chosen with this probability.
pub(crate) fn to_light<const N: usize>(
    task: &mut Task,
    z: &Vertex<N>,
    (index, probability): (usize, f32),
    u: Vec2,
    techniques: &TechniqueCounts<N>,
) -> Option<Connection<N>> {
    let scene = task.context.scene;
    let light = &scene.lights()[index].light;
    if probability == 0.0 {
        return None;
    }
    let sample = light.sample_li(z.at.p(), z.at.time(), u)?;
    let (scattered, pdf) = z.at.eval_and_pdf(z.wo, sample.wi, TransportMode::Radiance);
    if scattered.is_black() {
        return None;
    }
    let distance = sample.point.map(|point| point.distance(z.at.p()));
    let media = z.media_towards(scene, sample.wi);
    let cos_light = sample.cos();
    // A delta light has one certain point: its density over solid angle grows with the distance alone.
    let area_to_angle = distance.map_or(1.0, |distance| distance * distance / cos_light);
    let pdf_direct = if light.is_delta() { area_to_angle } else { sample.pdf_solid_angle };
    let pdf_start = sample.pdf_start.unwrap_or(pdf_direct / area_to_angle);
    let pdf_emission = task.context.emission.pdf(scene, index, z.at.p(), pdf_start, -sample.wi, cos_light);
    let by_chance = if light.is_delta() { 0.0 } else { pdf / (pdf_direct * probability) };
    let cos = z.at.cos(sample.wi).unwrap_or(1.0);
    let arriving = pdf_emission * cos / (pdf_direct * probability * cos_light);
    let back = z.at.pdf_solid_angle(sample.wi, z.wo, TransportMode::Importance);
    let sine = z.at.sine(z.wo, sample.wi, techniques);
    let from_light = z.partial.others_of_direct(arriving, back, sine, z.at.direct_light(techniques));
    let panes = z.panes(task.context);
    // Light that comes through panes is not direct.
    let back_beyond_panes = if panes > 0 { z.partial.others(arriving, back, sine) } else { PerSet::ZERO };
    let light = z.beta * scattered * sample.li / (sample.pdf_solid_angle * probability);
    let light = task.sample.seen(light, z.is_split());
    let join = Join {
        technique: Technique::Connected { s: 1, t: z.count() },
        found: Contribution { origin: light_number(index), ..Contribution::only(light) },
        back: from_light,
        end: End::Light { by_chance, back_beyond_panes },
        alike: z.approach.map_or(PerSet::ZERO, |approach| PerSet::ONE * approach.ratio(scene, index)),
        in_medium: [z.at.is_in_medium(), false],
        odds: z.odds,
    };
    let ray = z.at.spawn_to_light(&sample);
    let through = Through { media, distance, panes, seed: task.sample.seed() };
    Some(Connection { join, segment: Segment { ray, n: sample.n_light, through } })
}

/// Connects a camera vertex and a light vertex (s, t > 1); not two points of a medium between which walks have many events.
pub(crate) fn to_vertex<const N: usize>(
    task: &mut Task,
    z: &Vertex<N>,
    y: &Vertex<N>,
    techniques: &TechniqueCounts<N>,
) -> Option<Connection<N>> {
    let in_medium = [z.at.is_in_medium(), y.at.is_in_medium()];
    let is_inside = z.at.is_inside() && y.at.is_inside();
    if is_inside && z.events().joined(y.events()).in_row > MAX_CONNECTED_ROW {
        return None;
    }
    let is_hidden = |from: &Vertex<N>, p| from.at.is_in_medium() && from.media.hide(task.context.scene, p);
    if is_hidden(z, y.at.p()) || is_hidden(y, z.at.p()) {
        return None;
    }
    let between = y.at.p() - z.at.p();
    let distance2 = between.length_squared();
    let direction = between.try_normalize()?;
    let (f_z, pdf_z) = z.at.eval_and_pdf(z.wo, direction, TransportMode::Radiance);
    if f_z.is_black() {
        return None;
    }
    let (f_y, pdf_y) = y.at.eval_and_pdf(y.wo, -direction, TransportMode::Importance);
    if f_y.is_black() {
        return None;
    }
    let media = z.media_towards(task.context.scene, direction);
    let normal = |surface| task.context.scene.normal_towards(surface, -direction);
    let n = y.at.surface().map_or(Vec3::ZERO, normal);
    let cos = |vertex: &Vertex<N>| vertex.at.cos(direction).unwrap_or(1.0);
    let back = [
        z.at.pdf_solid_angle(direction, z.wo, TransportMode::Importance),
        y.at.pdf_solid_angle(-direction, y.wo, TransportMode::Radiance),
    ];
    let sine = |vertex: &Vertex<N>| vertex.at.sine(vertex.wo, direction, techniques);
    let from_camera = y.partial.others(pdf_z * cos(y) / distance2, back[1], sine(y));
    let from_light = z.partial.others(pdf_y * cos(z) / distance2, back[0], sine(z));
    let light = task.sample.seen(z.beta * f_z * f_y * y.beta / distance2, z.is_split() || y.is_split());
    let join = Join {
        technique: Technique::Connected { s: y.count(), t: z.count() },
        found: Contribution { own: techniques.connections, origin: y.origin, ..Contribution::only(light) },
        back: from_light,
        end: End::Vertex(from_camera),
        alike: if z.at.is_in_medium() {
            PerSet::ZERO
        } else {
            y.lit_from(task.context.scene, z.at.p()) * (pdf_z / distance2)
        },
        in_medium,
        odds: z.odds * y.odds,
    };
    let through = Through { media, distance: Some(distance2.sqrt()), panes: 0, seed: task.sample.seed() };
    let segment = Segment { ray: spawn_between(&z.at, &y.at), n, through };
    Some(Connection { join, segment })
}

/// A ray from one vertex to another that ends just before the second, if that is on a surface.
fn spawn_between(z: &Interaction, y: &Interaction) -> Ray {
    let ray = z.spawn_to(y.p());
    let Some(surface) = y.surface() else { return ray };
    let direction = Vec3::from(ray.direction);
    let length = direction.length();
    let cos = surface.n_geom.dot(direction).abs() / length;
    let error = surface.n_geom.abs().dot(surface.p_error)
        + f32::EPSILON * (length + z.p().abs().max_element() + y.p().abs().max_element());
    // A ray hits the second surface within the position error there, over the cosine.
    let clearance = (8.0 * error / (cos * length)).min(0.5);
    Ray { t_max: 1.0 - clearance, ..ray }
}
