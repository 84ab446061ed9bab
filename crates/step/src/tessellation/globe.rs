//! Faces of spheres, which have no poles that are worse than other points: they are projected from a point outside of the face.

use super::corner::{Corner, area, contain};
use super::fill::{Filled, fill};
use crate::curves::Accuracy;
use bilux_math::transcendental::{atan2_f64, sin_cos_f64, sin_f64, tan_f64};
use bilux_math::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Least distance of an inner point from the boundary, in steps.
const MARGIN: f64 = 0.4;

/// The most steps from pole to pole.
const MOST: f64 = 64.0;

/// The points of the boundary next to which a centre of projection is tried.
const TRIED: usize = 64;

/// A stereographic projection of the unit sphere, which keeps angles.
#[derive(Clone, Copy)]
struct Projection {
    /// The point that it projects from.
    from: DVec3,
    x: DVec3,
    y: DVec3,
}

impl Projection {
    /// The sphere is seen from outside, so that counter-clockwise remains so.
    fn new(from: DVec3) -> Projection {
        let x = from.any_orthonormal_vector();
        Projection { from, x, y: x.cross(from) }
    }

    fn project(&self, q: DVec3) -> DVec2 {
        DVec2::new(q.dot(self.x), q.dot(self.y)) / (1.0 - q.dot(self.from))
    }

    fn back(&self, at: DVec2) -> DVec3 {
        let s = at.length_squared();
        let along = (s - 1.0) / (s + 1.0);
        let q = self.from * along + (self.x * at.x + self.y * at.y) * (1.0 - along);
        q.normalize_or(-self.from)
    }
}

/// A sphere with the lines around a face, which lies on the left of them.
pub(super) struct Globe<'a> {
    pub(super) centre: DVec3,
    pub(super) radius: f64,
    pub(super) lines: &'a [Vec<DVec3>],
}

impl Globe<'_> {
    fn direction(&self, p: DVec3) -> DVec3 {
        (p - self.centre).normalize_or(DVec3::Z)
    }

    /// The triangles of the face. Their normals are the directions from the centre.
    pub(super) fn filled(&self, accuracy: Accuracy) -> Option<Filled> {
        let projection = self.projection()?;
        let corner = |&p: &DVec3| Corner { at: projection.project(self.direction(p)), point: p };
        let loops: Vec<Vec<Corner>> =
            self.lines.iter().map(|line| line.iter().map(corner).collect()).collect();
        let inner = self.inner(projection, &loops, accuracy);
        let place = |at: DVec2| self.centre + projection.back(at) * self.radius;
        fill(&loops, inner, DVec2::ONE, place)
    }

    /// From the point outside of the face that is farthest from its boundary, as far as it is known.
    fn projection(&self) -> Option<Projection> {
        let boundary: Vec<DVec3> = self.lines.iter().flatten().map(|&p| self.direction(p)).collect();
        let mut candidates: Vec<DVec3> = Vec::new();
        for x in -1..=1 {
            for y in -1..=1 {
                for z in -1..=1 {
                    candidates.extend(DVec3::new(f64::from(x), f64::from(y), f64::from(z)).try_normalize());
                }
            }
        }
        for line in self.lines.iter().take(TRIED) {
            let step = line.len().div_ceil((TRIED / self.lines.len()).max(1));
            for i in (0..line.len()).step_by(step) {
                let (a, b) = (self.direction(line[i]), self.direction(line[(i + 1) % line.len()]));
                let middle = (a + b).normalize_or(a);
                let right = (b - a).cross(middle).normalize_or_zero();
                // Next to the boundary, and across a small or a large remainder.
                for way in [0.1, 0.5, 1.5] {
                    candidates.push((middle + right * way * a.distance(b).max(1e-3)).normalize_or(middle));
                }
            }
        }
        let distance =
            |c: &DVec3| boundary.iter().map(|q| q.distance_squared(*c)).fold(f64::INFINITY, f64::min);
        let mut all: Vec<(f64, DVec3)> = candidates.iter().map(|c| (distance(c), *c)).collect();
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let outside = all.iter().find(|(d, c)| *d > 1e-12 && self.is_outside(*c));
        outside.or(all.first()).map(|(_, c)| Projection::new(*c))
    }

    /// True if a point is not on the face: seen from it, the largest line goes counter-clockwise around the face.
    fn is_outside(&self, from: DVec3) -> bool {
        let projection = Projection::new(from);
        let corner = |&p: &DVec3| Corner { at: projection.project(self.direction(p)), point: p };
        let areas = self.lines.iter().map(|line| area(&line.iter().map(corner).collect::<Vec<_>>()));
        areas.max_by(|a, b| a.abs().total_cmp(&b.abs())).is_some_and(|largest| largest > 0.0)
    }

    /// Rings of points around the middle of the projection.
    fn inner(&self, projection: Projection, loops: &[Vec<Corner>], accuracy: Accuracy) -> Vec<Corner> {
        let chord = (8.0 * accuracy.distance / self.radius).sqrt();
        let step = chord.min(accuracy.angle).max(PI / MOST);
        let reach = loops.iter().flatten().map(|corner| corner.at.length()).fold(0.0, f64::max);
        let last = 2.0 * atan2_f64(reach, 1.0);
        let boundary: Vec<DVec3> =
            loops.iter().flatten().map(|corner| self.direction(corner.point)).collect();
        let mut found = Vec::new();
        for ring in 0..=(last / step) as usize {
            let polar = ring as f64 * step;
            let count = ((TAU * sin_f64(polar) / step).ceil() as usize).max(1);
            for i in 0..count {
                let (sin, cos) = sin_cos_f64(TAU * i as f64 / count as f64);
                let at = DVec2::new(cos, sin) * tan_f64(0.5 * polar);
                let q = projection.back(at);
                let near = MARGIN * step;
                let is_free = boundary.iter().all(|b| b.distance_squared(q) > near * near);
                if is_free && contain(loops.iter().map(|line| &line[..]), at) {
                    found.push(Corner { at, point: self.centre + q * self.radius });
                }
            }
        }
        found
    }
}
