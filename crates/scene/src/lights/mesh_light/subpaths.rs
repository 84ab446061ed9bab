//! The light subpaths that begin at emissive meshes: on pieces as often as they are bright.

use super::{MeshLight, finite};
use crate::geometry::corners::transform_with_error;
use crate::lights::light_triangle::{LightTriangle, blend};
use crate::lights::{EmissionSample, LightTracing, Sides};
use crate::surface::{Surface, gamma};
use bilux_accel::Primitive;
use bilux_math::{Aabb, Frame, Vec2, Vec3, warp};

impl MeshLight {
    /// A point of a triangle and the bound on its error, both as for a hit there.
    fn point_with_error(&self, triangle: usize, weights: [f32; 3], time: f32) -> (Vec3, Vec3) {
        let own = &self.triangles[triangle];
        let (p, error) = (blend(own, weights), blend(&own.map(Vec3::abs), weights) * gamma(7));
        let to_world = self.motion.at(time);
        if to_world.is_identity() { (p, error) } else { transform_with_error(&to_world, p, error) }
    }

    /// A ray from a point of a piece, given by its weights in the triangle, emitted with density `pdf_emission`; `None` if that is zero.
    fn ray(
        &self,
        piece: usize,
        weights: [f32; 3],
        time: f32,
        direction: Vec3,
        pdf_emission: f32,
    ) -> Option<EmissionSample> {
        let LightTriangle { normal, pdf_area, .. } = self.facet(piece, time);
        let triangle = self.pieces.triangle(piece);
        let (p, p_error) = self.point_with_error(triangle, weights, time);
        (pdf_emission.is_finite() && pdf_emission > 0.0).then(|| EmissionSample {
            p,
            p_error,
            n_light: if normal.dot(direction) < 0.0 { -normal } else { normal },
            direction,
            le: self.radiance(triangle, weights),
            pdf_emission,
            pdf_direct: pdf_area,
            primitive: Primitive { index: self.first.index + triangle as u32, ..self.first },
        })
    }
}

impl LightTracing for MeshLight {
    fn direct_pdf(&self, sample: &EmissionSample, from: Vec3) -> f32 {
        if self.near.is_none() {
            return sample.pdf_direct;
        }
        // Its triangles do not move.
        let piece = self.piece_at(sample.primitive, sample.p, 0.0);
        piece.map_or(0.0, |piece| self.pdf_area_of(from, 0.0, piece))
    }

    fn pdf_start(&self, pdf_direct: f32, hit: &Surface) -> f32 {
        if self.near.is_none() {
            return pdf_direct;
        }
        let piece = self.piece_at(hit.primitive, hit.p, hit.time);
        finite(piece.map_or(0.0, |piece| self.facet(piece, hit.time).pdf_area))
    }

    fn sample_le(
        &self,
        bounds: &Aabb,
        time: f32,
        u_point: Vec2,
        u_direction: Vec2,
    ) -> Option<EmissionSample> {
        let (piece, weights) = self.sample_weights(u_point);
        let LightTriangle { normal, pdf_area, .. } = self.facet(piece, time);
        let (n_light, u) = match self.sides {
            Sides::Front => (normal, u_direction),
            // Each side takes half of the random numbers.
            Sides::Both if u_direction.x < 0.5 => (normal, Vec2::new(2.0 * u_direction.x, u_direction.y)),
            Sides::Both => (-normal, Vec2::new(2.0 * u_direction.x - 1.0, u_direction.y)),
        };
        let direction = Frame::from_normal(n_light).to_world(warp::sample_cosine_hemisphere(u)).normalize();
        let pdf_emission = self.emission_pdf(bounds, pdf_area, direction, n_light.dot(direction).abs());
        self.ray(piece, weights, time, direction, pdf_emission)
    }

    fn sample_le_aimed(&self, _: &Aabb, time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        let (piece, weights) = self.sample_weights(u);
        let (LightTriangle { normal, pdf_area, .. }, direction) =
            (self.facet(piece, time), warp::square_to_sphere(aim).normalize());
        let leaves = self.sides == Sides::Both || normal.dot(direction) > 0.0;
        leaves.then(|| self.ray(piece, weights, time, direction, pdf_area)).flatten()
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, pdf_start: f32, _direction: Vec3, _cos: f32) -> f32 {
        pdf_start
    }

    fn emission_pdf(&self, _bounds: &Aabb, pdf_start: f32, _direction: Vec3, cos: f32) -> f32 {
        pdf_start * (warp::cosine_hemisphere_pdf_solid_angle(cos) / self.sides.count())
    }

    fn is_infinite(&self) -> bool {
        false
    }
}
