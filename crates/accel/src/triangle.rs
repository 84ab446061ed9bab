//! The one triangle test that all structures share.
//!
//! The test is that of Woop, Benthin and Wald: shear space so that the ray becomes the z axis, then find on which
//! side of it the three edges lie [Woop 2013]. Two changes make it exact enough to prune by:
//!
//! - Signs are first computed in f32 without fused operations. Rounding is monotone, so a strictly positive or
//!   negative result has the true sign; only zeros (and overflows) are undecided.
//! - Whatever those signs do not reject is evaluated in f64, where a product of two f32 is exact. All signs are then
//!   true, and `t`, `u`, `v` have a relative error of about 2⁻⁵⁰ before they are rounded.
//!
//! # The lemma behind pruning
//! Let `far` be the maximum distance, on any axis, from the ray's origin to a vertex. If the test accepts a triangle
//! at `t`, then the point `origin + t · direction` lies within `16 · 2⁻²⁴ · far` of some point of that triangle, on
//! every axis. So a structure that enlarges its boxes, or moves its planes, by [`PreparedRay::pad`] never skips a
//! triangle that the test would accept. The proof, which sums the roundings of the shear, is in
//! `docs/adr/0002-one-answer.md`.
//!
//! Two triangles that share an edge see the same sheared vertices, and hence opposite signs there: no ray passes
//! between them.

use crate::ray::{Culling, Hit, Query, Ray};
use bilux_math::Aabb;

/// A ray with the values that the triangle test needs, computed once.
#[derive(Clone, Copy, Debug)]
pub struct PreparedRay {
    /// The ray itself.
    pub ray: Ray,
    /// Which axes of space are x, y and z of sheared space; z is the dominant axis of the direction.
    pub(crate) axes: [usize; 3],
    /// The shear of x and y along z.
    pub(crate) shear: [f32; 2],
}

/// An accepted triangle, whatever its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance along the ray.
    pub t: f32,
    /// Barycentric weight of the second vertex.
    pub u: f32,
    /// Barycentric weight of the third vertex.
    pub v: f32,
    /// True when the ray comes from the side from which the vertices run clockwise.
    pub back: bool,
}

impl PreparedRay {
    /// Prepares a ray; `None` when it can hit nothing (see [`Ray`]).
    #[inline]
    pub fn new(ray: &Ray) -> Option<PreparedRay> {
        let finite = ray.origin.iter().chain(&ray.direction).all(|c| c.is_finite());
        let [dx, dy, dz] = ray.direction.map(f32::abs);
        if !finite || dx.max(dy).max(dz) == 0.0 || ray.t_min.is_nan() || ray.t_max.is_nan() {
            return None;
        }
        let kz = if dz >= dx && dz >= dy {
            2
        } else if dy >= dx {
            1
        } else {
            0
        };
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        let d = ray.direction;
        Some(PreparedRay { ray: *ray, axes: [kx, ky, kz], shear: [d[kx] / d[kz], d[ky] / d[kz]] })
    }

    /// Distance by which every box and plane must be moved outwards so that nothing which the triangle test would accept
    /// is skipped; `bounds` holds all vertices in question. See the lemma above.
    #[inline]
    pub fn pad(&self, bounds: &Aabb) -> f32 {
        let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
        let far = (0..3).fold(0f32, |far, axis| {
            let o = self.ray.origin[axis];
            far.max((low[axis] - o).abs()).max((high[axis] - o).abs())
        });
        far * PAD + f32::MIN_POSITIVE
    }

    /// Intersects the infinite line of the ray with a triangle and ignores the ray's ends; `None` where the line
    /// misses, and for triangles that the ray sees edge-on or without area.
    #[inline(always)]
    pub fn cross(&self, triangle: &[[f32; 3]; 3]) -> Option<Crossing> {
        let [ax, ay, az] = self.shear(&triangle[0]);
        let [bx, by, bz] = self.shear(&triangle[1]);
        let [cx, cy, cz] = self.shear(&triangle[2]);
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        self.cross_exactly([ax, ay, az], [bx, by, bz], [cx, cy, cz])
    }

    /// A vertex relative to the ray: x and y sheared, z not yet divided by the direction.
    #[inline(always)]
    fn shear(&self, vertex: &[f32; 3]) -> [f32; 3] {
        let ([kx, ky, kz], [shear_x, shear_y]) = (self.axes, self.shear);
        let o = &self.ray.origin;
        let z = vertex[kz] - o[kz];
        [(vertex[kx] - o[kx]) - shear_x * z, (vertex[ky] - o[ky]) - shear_y * z, z]
    }

    #[inline]
    fn cross_exactly(&self, a: [f32; 3], b: [f32; 3], c: [f32; 3]) -> Option<Crossing> {
        let [ax, ay, az] = a.map(f64::from);
        let [bx, by, bz] = b.map(f64::from);
        let [cx, cy, cz] = c.map(f64::from);
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        // Written so that a NaN determinant is rejected too.
        if !(det.abs() > 0.0 && det.is_finite()) {
            return None;
        }
        let dz = f64::from(self.ray.direction[self.axes[2]]);
        let t = (u * az + v * bz + w * cz) / (det * dz);
        Some(Crossing {
            t: without_sign_of_zero(t),
            u: without_sign_of_zero(v / det),
            v: without_sign_of_zero(w / det),
            back: (det < 0.0) != (dz < 0.0),
        })
    }
}

/// A number in single precision, where a zero is positive: adding zero changes no other number.
#[inline(always)]
fn without_sign_of_zero(x: f64) -> f32 {
    x as f32 + 0.0
}

/// 16 units of f32 rounding: twice what the proof requires.
pub(crate) const PAD: f32 = 16.0 / 16_777_216.0;

/// The nearest hit so far.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    /// Hits beyond this no longer count. Prune with `entry > t`, never `>=`: ties go to the lowest primitive.
    pub t: f32,
    hit: Option<Hit>,
}

impl Nearest {
    /// No hit yet.
    #[inline]
    pub fn new(ray: &Ray) -> Nearest {
        Nearest { t: ray.t_max, hit: None }
    }

    /// Tests a triangle and keeps its hit if it is nearer, or equally near with a lower index.
    #[inline(always)]
    pub fn test(&mut self, ray: &PreparedRay, query: &Query, triangle: &[[f32; 3]; 3], primitive: u32) {
        if let Some(crossing) = ray.cross(triangle) {
            self.offer(ray, query, crossing, primitive);
        }
    }

    /// Applies the rules of [`Nearest::test`] to a crossing that is already known.
    #[inline]
    pub fn offer(&mut self, ray: &PreparedRay, query: &Query, crossing: Crossing, primitive: u32) {
        let Some(found) = counts(ray, query, &crossing, primitive, self.t) else { return };
        let wins = match self.hit {
            Some(hit) => found.t < hit.t || primitive < hit.primitive,
            None => true,
        };
        if wins && query.accepts(&found) {
            (self.t, self.hit) = (found.t, Some(found));
        }
    }

    /// The hit, if there is one.
    #[inline]
    pub fn hit(self) -> Option<Hit> {
        self.hit
    }
}

/// True when a ray hits a triangle anywhere between its ends.
#[inline(always)]
pub fn hits(ray: &PreparedRay, query: &Query, triangle: &[[f32; 3]; 3], primitive: u32) -> bool {
    ray.cross(triangle)
        .and_then(|crossing| counts(ray, query, &crossing, primitive, ray.ray.t_max))
        .is_some_and(|hit| query.accepts(&hit))
}

/// The hit, if a crossing is between the ray's ends, and on a side that counts. The filter is not evaluated.
#[inline(always)]
fn counts(ray: &PreparedRay, query: &Query, crossing: &Crossing, primitive: u32, t_max: f32) -> Option<Hit> {
    let Crossing { t, u, v, back } = *crossing;
    let counts = t >= ray.ray.t_min
        && t <= t_max
        && primitive != ray.ray.exclude.index
        && !(back && query.culling == Culling::Back);
    counts.then_some(Hit { t, u, v, primitive, instance: 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    fn cross(origin: [f32; 3], direction: [f32; 3]) -> Option<Crossing> {
        PreparedRay::new(&Ray::new(origin, direction))?.cross(&TRIANGLE)
    }

    #[test]
    fn front_is_where_the_vertices_run_counter_clockwise() {
        assert!(!cross([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]).unwrap().back);
        assert!(cross([0.25, 0.25, -1.0], [0.0, 0.0, 1.0]).unwrap().back);
    }

    #[test]
    fn weights_belong_to_the_second_and_third_vertex() {
        let crossing = cross([0.5, 0.125, 2.0], [0.0, 0.0, -4.0]).unwrap();
        assert_eq!((crossing.t, crossing.u, crossing.v), (0.5, 0.5, 0.125));
    }

    #[test]
    fn vertices_and_edges_are_hit() {
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0)] {
            assert!(cross([x, y, 1.0], [0.0, 0.0, -1.0]).is_some(), "({x}, {y})");
        }
        assert!(cross([0.5, 0.500_001, 1.0], [0.0, 0.0, -1.0]).is_none());
    }

    #[test]
    fn invalid_rays_hit_nothing() {
        assert!(cross([f32::NAN, 0.0, 1.0], [0.0, 0.0, -1.0]).is_none());
        assert!(cross([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]).is_none());
        assert!(cross([0.0, 0.0, 1.0], [0.0, f32::INFINITY, -1.0]).is_none());
    }
}
