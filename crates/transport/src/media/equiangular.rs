//! Equiangular points: points of fog on a ray, uniform in the angle under which a light sees the ray. [Kulla 2012]
//!
//! A walk meets fog as often as the fog says, wherever the light is, and light falls as the inverse square of the distance. So a ray of a
//! camera subpath has such a point for each light that is sampled, which is connected with that light as an event of the walk is. Which point of the
//! light is sampled depends on the point of fog alone, so the two ways to this differ in their densities along the ray only, and are weighted by them.
//!
//! Rays that leave a point of a medium have none, for they are the most in thick fog, and gain the least there. Where a lamp shines into a
//! cone, `path` has them on those that meet it: few of its walks have an event in a narrow cone, and nothing else finds what is lit there.
//!
//! The angle goes on to infinity, whatever is behind the ray: the density depends on the ray's start, its direction and the light, which other
//! techniques know too.

use crate::media::interaction::Interaction;
use crate::techniques::PerSet;
use bilux_math::transcendental::{atan, tan};
use bilux_math::{Vec2, Vec3};
use bilux_scene::{Medium, Scene};
use std::f32::consts::FRAC_PI_2;

/// The distribution of one light's points on a ray.
pub(crate) struct Equiangular {
    /// Distance along the ray to where the light is closest, in metres; negative behind its start.
    nearest: f32,
    /// The distance from there to the light, with what the light's own size adds.
    apart: f32,
    /// The angle at the light from the closest point to the start of the ray, and from there to its end.
    begin: f32,
    angle: f32,
    /// The part of the ray in the light's beam, if it has one.
    in_beam: Option<InBeam>,
}

/// The part of a ray in a beam. [The angle there is uniform, too.](Equiangular)
struct InBeam {
    /// Probability of sampling this part, not the whole ray.
    share: f32,
    /// Distances along the ray, in metres.
    ends: [f32; 2],
    /// The angle at the light from the closest point to its begin, and from there to its end.
    begin: f32,
    angle: f32,
}

/// A small part of the distance to the light, without which a ray through a point light would have its points in one place.
const CLOSEST: f32 = 1e-3;

impl Equiangular {
    /// On a ray; `None` for lights that are infinitely far away, and where the ray meets none of a light, or leaves a medium and does
    /// not meet the light's beam.
    #[inline]
    pub(crate) fn new(scene: &Scene, light: usize, ray: &Departure) -> Option<Equiangular> {
        let Departure { origin, direction, leaves_medium } = *ray;
        let light = &scene.lights().get(light)?.light;
        let beam = light.beam();
        if leaves_medium && beam.is_none() {
            return None;
        }
        let (middle, reach) = light.middle_and_reach()?;
        let to_light = middle - origin;
        let nearest = to_light.dot(direction);
        let clearance = CLOSEST * CLOSEST * to_light.length_squared() + reach * reach;
        let apart = ((to_light - direction * nearest).length_squared() + clearance).sqrt();
        let begin = -atan(nearest / apart);
        let mut points = Equiangular { nearest, apart, begin, angle: FRAC_PI_2 - begin, in_beam: None };
        if let Some(beam) = beam {
            points.in_beam =
                beam.along(-to_light, direction).and_then(|ends| points.between(ends, beam.share));
            if points.in_beam.is_none() && (beam.share == 1.0 || leaves_medium) {
                return None;
            }
        }
        (apart > 0.0).then_some(points)
    }

    /// The part between these distances, with so many of the points; `None` where the light sees it under no angle.
    fn between(&self, ends: [f32; 2], share: f32) -> Option<InBeam> {
        let [begin, end] = ends.map(|t| atan((t - self.nearest) / self.apart));
        (end > begin).then_some(InBeam { share, ends, begin, angle: end - begin })
    }

    /// A distance along the ray, in metres, for a random number; it may be far behind everything.
    #[inline]
    pub(crate) fn sample(&self, u: f32) -> f32 {
        let at = |angle: f32| self.nearest + self.apart * tan(angle);
        match &self.in_beam {
            Some(part) if u < part.share => {
                at(part.begin + part.angle * (u / part.share)).clamp(part.ends[0], part.ends[1])
            }
            Some(part) => at(self.begin + self.angle * ((u - part.share) / (1.0 - part.share))).max(0.0),
            None => at(self.begin + self.angle * u).max(0.0),
        }
    }

    /// The density of a distance, per metre.
    #[inline]
    pub(crate) fn density(&self, t: f32) -> f32 {
        let from_nearest = t - self.nearest;
        let square = self.apart * self.apart + from_nearest * from_nearest;
        let Some(part) = &self.in_beam else { return self.apart / (self.angle * square) };
        let is_within = (part.ends[0]..=part.ends[1]).contains(&t);
        let per_angle =
            (1.0 - part.share) / self.angle + if is_within { part.share / part.angle } else { 0.0 };
        per_angle * self.apart / square
    }
}

/// A ray of a camera subpath as it begins: where its points are depends on nothing else.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Departure {
    pub(crate) origin: Vec3,
    /// A unit vector.
    pub(crate) direction: Vec3,
    /// Whether it comes from a point of a medium.
    pub(crate) leaves_medium: bool,
}

/// An equiangular point, and how it is to be connected.
pub(crate) struct EquiangularSample {
    pub(crate) light: usize,
    /// With which it was chosen.
    pub(crate) probability: f32,
    pub(crate) points: Equiangular,
    /// Distance along the ray, in metres.
    pub(crate) distance: f32,
    /// The random point that picks the light's sample.
    pub(crate) u_light: Vec2,
}

/// Approach of a camera subpath's ray to a point of fog.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approach {
    pub(crate) ray: Departure,
    /// The distance, in metres.
    pub(crate) t: f32,
    /// The density per metre with which a walk has an event there.
    pub(crate) by_walk: f32,
}

impl Approach {
    /// To a vertex, from along `wo`; `None` where there are no equiangular points.
    #[inline]
    pub(crate) fn of(at: &Interaction, wo: Vec3, leaves_medium: bool, by_walk: f32) -> Option<Approach> {
        let Interaction::Medium(point) = at else { return None };
        let ray = Departure { origin: point.p + wo * point.t, direction: -wo, leaves_medium };
        point.is_equiangular.then_some(Approach { ray, t: point.t, by_walk })
    }

    /// Number of equiangular points of this light there, for each event of a walk.
    #[inline]
    pub(crate) fn ratio(&self, scene: &Scene, light: usize) -> f32 {
        density(scene, light, &self.ray, self.t) / self.by_walk
    }
}

/// A point of fog that a light subpath has reached straight from its light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lit<const N: usize = 1> {
    pub(crate) light: usize,
    pub(crate) p: Vec3,
    /// Frequency with which connections between the two count, in each set, over the density with which the light subpath goes on
    /// from here.
    pub(crate) connected: PerSet<N>,
}

impl<const N: usize> Lit<N> {
    /// Frequency with which it is the equiangular point of a ray that comes here along this unit vector, from so far away, and is
    /// connected with its light; over the density with which a light subpath arrives where the ray begins.
    #[inline]
    pub(crate) fn picked(&self, scene: &Scene, along: Vec3, distance: f32) -> PerSet<N> {
        let origin = self.p - along * distance;
        let ray = Departure { origin, direction: along, leaves_medium: false };
        self.connected * density(scene, self.light, &ray, distance)
    }
}

/// The density per metre of a light's equiangular points on a ray; 0 for an infinite light.
#[inline]
pub(crate) fn density(scene: &Scene, light: usize, ray: &Departure, t: f32) -> f32 {
    Equiangular::new(scene, light, ray).map_or(0.0, |points| points.density(t))
}

/// Whether rays have such points in a scene: where distances are coloured, their densities are not those of one channel.
#[inline]
pub(crate) fn is_used_in(scene: &Scene) -> bool {
    scene.scatters() && !scene.has_coloured_distances()
}

/// Whether a medium of such a scene has them: fog that is the same everywhere.
#[inline]
pub(crate) fn is_used_inside(scene: &Scene, medium: &Medium, is_inside: bool) -> bool {
    medium.density.is_none() && !is_inside && is_used_in(scene)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_scene::cameras::CameraSpec;
    use bilux_scene::{SceneBuilder, Spec};

    #[test]
    fn points_are_where_their_density_says() {
        let mut builder = SceneBuilder::default();
        for (kind, angle) in [("point", None), ("spot", Some(40.0f32))] {
            let lamp = Spec::new("", kind).with("position", Vec3::new(1.0, 2.0, 0.5));
            builder.lights.push(angle.map_or(lamp.clone(), |angle| lamp.with("angle", angle)));
        }
        builder.cameras = vec![CameraSpec { spec: Spec::new("", "perspective"), keyframes: Vec::new() }];
        let scene = crate::shapes::built(&builder);
        let rays = [(Vec3::ZERO, Vec3::X), (Vec3::new(3.0, 0.0, 0.0), Vec3::X), (Vec3::Z, Vec3::Y)];
        let in_cone = [(Vec3::new(-3.0, 0.1, 0.0), Vec3::X), (Vec3::ZERO, Vec3::new(0.6, 0.8, 0.0))];
        for (light, (origin, direction)) in
            rays.map(|ray| (0, ray)).into_iter().chain(in_cone.map(|ray| (1, ray)))
        {
            let ray = Departure { origin, direction, leaves_medium: light == 1 };
            let points = Equiangular::new(&scene, light, &ray).unwrap();
            // The inverse of the cumulative distribution: its slope is one over the density.
            for i in 1..200 {
                let u = i as f32 / 200.0;
                let [before, at, behind] = [u - 1e-3, u, u + 1e-3].map(|u| points.sample(u));
                let slope = (behind - before) / 2e-3;
                if u < 0.95 {
                    assert!((slope * points.density(at) - 1.0).abs() < 5e-3, "{origin} {direction}: at {u}");
                }
            }
            let first = points.in_beam.as_ref().map_or(0.0, |part| part.ends[0]);
            assert!((points.sample(0.0) - first).abs() < 1e-3);
        }
        // A ray that passes the cone has none, nor has one that leaves a medium and meets no cone.
        let ray = Departure { origin: Vec3::new(-3.0, 3.0, 0.0), direction: Vec3::X, leaves_medium: false };
        assert!(Equiangular::new(&scene, 1, &ray).is_none());
        assert!(Equiangular::new(&scene, 0, &ray).is_some());
        assert!(Equiangular::new(&scene, 0, &Departure { leaves_medium: true, ..ray }).is_none());
    }
}
