//! Emissive triangle meshes. Not in the table: objects with an emissive material become mesh lights.

mod subpaths;

use super::cumulative::{Cumulative, CumulativePart};
use super::light_triangle::{LightTriangle, TriangleSample, barycentric, blend, clearance};
use super::near_triangles::NearTriangles;
use super::picture::{Picture, pieces_by_brightness};
use super::pieces::{Piece, Pieces};
use super::{ClassicLighting, DirectionCone, Light, LightExtent, LightSample, Receiver, Sides};
use crate::classic::ClassicLight;
use crate::surface::Surface;
use bilux_accel::Primitive;
use bilux_math::motion::Motion;
use bilux_math::{Aabb, Rgb, Transform, Vec2, Vec3};
use std::any::Any;
use std::f32::consts::{FRAC_PI_2, PI};

/// An emissive object, sampled in proportion to the object-space area of its triangles times their brightness; where there are many,
/// points of the scene choose among them by where they are.
///
/// Where a picture is uneven within triangles, they are cut into pieces, which are chosen like triangles. Points are uniform within each piece.
pub struct MeshLight {
    triangles: Vec<[Vec3; 3]>,
    pieces: Pieces,
    /// Among all pieces, wherever the receiver is.
    choice: Cumulative,
    /// The object's first triangle, as in a hit.
    first: Primitive,
    /// Centroid of the area, in object space.
    middle: Vec3,
    /// Half the root of its area in world space, when its motion begins.
    reach: f32,
    motion: Motion,
    /// The triangles in world space, each with the density of its first piece; empty when they move.
    static_triangles: Vec<LightTriangle>,
    /// Choice among the pieces by where the receiver is, if they are many.
    near: Option<NearTriangles>,
    /// The mean radiance over its area.
    radiance: Rgb,
    picture: Option<Picture>,
    sides: Sides,
    /// The orientation of the front in world space: -1 if mirrored, otherwise 1.
    turn: f32,
    classic: Option<Rgb>,
}

/// Emission of a surface.
pub struct SurfaceEmission {
    /// Everywhere, if there is no picture.
    pub radiance: Rgb,
    /// Emission where it varies.
    pub picture: Option<Picture>,
    /// From which sides.
    pub sides: Sides,
}

/// A piece of a triangle that a point has chosen.
pub struct ChosenPiece {
    number: usize,
    /// The triangle of the mesh.
    pub triangle: usize,
    /// The part of it.
    pub piece: Piece,
    /// The rest of the random number, from 0 to 1.
    pub rest: f32,
    /// The triangle in world space, with the density of points on the piece.
    pub facet: LightTriangle,
}

impl MeshLight {
    /// A light from an object's object-space triangles; `None` when they have no area.
    ///
    /// `first` is the first of them, as in a hit. `mirrored` says whether the transform to world space reverses the
    /// winding.
    pub fn new(
        triangles: Vec<[Vec3; 3]>,
        mirrored: bool,
        first: Primitive,
        motion: Motion,
        SurfaceEmission { radiance, picture, sides }: SurfaceEmission,
        classic: Option<Rgb>,
    ) -> Option<MeshLight> {
        let to_world = motion.at(0.0);
        let is_finite = || triangles.iter().flatten().all(|p| to_world.point(*p).is_finite());
        let may_be_many = picture.is_some() || NearTriangles::is_for(triangles.len());
        let may_have_near = may_be_many && motion.is_still() && is_finite();
        // Then points are as dense in world space, whatever the scale along each axis.
        let to_world = if may_have_near { to_world } else { Transform::IDENTITY };
        let area_of = |t: &[Vec3; 3]| f64::from(area(&t.map(|p| to_world.point(p))));
        let areas: Vec<f64> = triangles.iter().map(area_of).map(finite_or_zero).collect();
        let total: f64 = areas.iter().sum();
        if total <= 0.0 {
            return None;
        }
        let (pieces, radiance, weights) = match &picture {
            None => (Pieces::WHOLE, radiance, areas.clone()),
            Some(picture) => pieces_by_brightness(picture, &areas),
        };
        let choice = Cumulative::new(&weights);
        let weighted = |(t, a): (&[Vec3; 3], &f64)| (t[0] + t[1] + t[2]) * (a / (3.0 * total)) as f32;
        let middle = triangles.iter().zip(&areas).filter(|(_, a)| **a > 0.0).map(weighted).sum();
        let static_triangles = Vec::new();
        let turn = if mirrored { -1.0 } else { 1.0 };
        let mut light = MeshLight {
            triangles,
            pieces,
            choice,
            first,
            middle,
            reach: 0.0,
            motion,
            static_triangles,
            near: None,
            radiance,
            picture,
            sides,
            turn,
            classic,
        };
        light.reach = 0.5 * light.world_area(0.0).sqrt();
        if light.motion.is_still() {
            light.static_triangles =
                (0..light.triangles.len()).map(|i| light.facet(i * pieces.of_each(), 0.0)).collect();
        }
        if may_have_near && NearTriangles::is_for(weights.len()) {
            let piece_of = |(i, weight): (usize, &f64)| {
                let LightTriangle { corners, normal, .. } = light.static_triangles[pieces.triangle(i)];
                (pieces.piece(i).corners(&corners), normal, *weight as f32)
            };
            let all = weights.iter().enumerate().map(piece_of);
            light.near = Some(NearTriangles::new(all, sides == Sides::Both));
        }
        Some(light)
    }

    /// Picks a piece of a triangle for a point. `None` where none shines.
    #[inline]
    pub fn choose(&self, from: Vec3, time: f32, u: f32) -> Option<ChosenPiece> {
        let Some(near) = &self.near else {
            let (number, rest) = self.choice.sample(u);
            return Some(self.chosen(number, rest, self.facet(number, time)));
        };
        near.choose(from, u).map(|found| self.nearby(found))
    }

    /// [`MeshLight::choose`] for each receiver, by the first of its numbers: faster than one by one.
    pub fn choose_each(
        &self,
        receivers: impl Iterator<Item = Receiver>,
        mut chosen: impl FnMut(usize, Option<ChosenPiece>),
    ) {
        let Some(near) = &self.near else {
            receivers.enumerate().for_each(|(i, r)| chosen(i, self.choose(r.p, r.time, r.u.x)));
            return;
        };
        near.choose_each(receivers.map(|r| (r.p, r.u.x)), |i, found| {
            chosen(i, found.map(|found| self.nearby(found)));
        });
    }

    /// A piece that was chosen by where the receiver is. These do not move.
    #[inline]
    fn nearby(&self, (number, rest, pdf_area): (usize, f32, f32)) -> ChosenPiece {
        self.chosen(number, rest, LightTriangle { pdf_area, ..self.facet(number, 0.0) })
    }

    #[inline]
    fn chosen(&self, number: usize, rest: f32, facet: LightTriangle) -> ChosenPiece {
        let (triangle, piece) = (self.pieces.triangle(number), self.pieces.piece(number));
        ChosenPiece { number, triangle, piece, rest, facet }
    }

    /// A point of the piece that `from` has chosen, by another number.
    #[inline]
    fn sample_chosen(&self, from: Vec3, chosen: &ChosenPiece, u: f32, time: f32) -> Option<LightSample> {
        let weights = chosen.piece.weights(barycentric(Vec2::new(chosen.rest, u)));
        let sample = TriangleSample::new(from, &chosen.facet, weights, self.sides);
        (sample.pdf_solid_angle > 0.0).then(|| LightSample {
            wi: sample.wi,
            li: self.radiance(chosen.triangle, weights),
            point: Some(sample.point),
            n_light: sample.n_light,
            pdf_solid_angle: sample.pdf_solid_angle,
            clearance: sample.clearance,
            pdf_start: self.near.is_some().then(|| self.facet(chosen.number, time).pdf_area),
        })
    }

    /// The density over area with which a point samples points of a piece.
    #[inline]
    fn pdf_area_of(&self, from: Vec3, time: f32, piece: usize) -> f32 {
        let near = self.near.as_ref().map(|near| near.pdf_area(from, piece));
        finite(near.unwrap_or_else(|| self.facet(piece, time).pdf_area))
    }

    /// The piece of one of its triangles in which a point lies at a time; `None` if the triangle is not one of its.
    #[inline]
    fn piece_at(&self, primitive: Primitive, p: Vec3, time: f32) -> Option<usize> {
        let triangle = primitive.index.wrapping_sub(self.first.index) as usize;
        if primitive.instance != self.first.instance || triangle >= self.triangles.len() {
            return None;
        }
        if self.pieces.of_each() == 1 {
            return Some(triangle);
        }
        let [a, b, c] = self.corners(triangle, time);
        let (second, third) = (b - a, c - a);
        let across = second.cross(third);
        let weights = Vec2::new((p - a).cross(third).dot(across), second.cross(p - a).dot(across));
        Some(self.pieces.at(triangle, weights / across.length_squared()))
    }

    /// Triangles with the random numbers that pick each, in their order, if they are few, do not move and emit
    /// evenly.
    pub fn few_even_triangles(&self) -> Option<impl Iterator<Item = (LightTriangle, CumulativePart)>> {
        let is_even = self.picture.is_none() && !self.static_triangles.is_empty();
        let parts = self.choice.few().filter(|_| is_even)?;
        Some(self.static_triangles.iter().copied().zip(parts))
    }

    /// The sides that emit.
    #[inline]
    pub fn sides(&self) -> Sides {
        self.sides
    }

    /// The emitted radiance at a point of a triangle, given by its barycentric weights.
    #[inline]
    pub fn radiance(&self, triangle: usize, weights: [f32; 3]) -> Rgb {
        self.picture.as_ref().map_or(self.radiance, |picture| picture.at(triangle, weights))
    }

    /// In world space.
    #[inline]
    fn corners(&self, triangle: usize, time: f32) -> [Vec3; 3] {
        if let Some(stored) = self.static_triangles.get(triangle) {
            return stored.corners;
        }
        let to_world = self.motion.at(time);
        self.triangles[triangle].map(|p| to_world.point(p))
    }

    /// The triangle of a piece in world space at a time, with the density of points on the piece.
    #[inline]
    fn facet(&self, piece: usize, time: f32) -> LightTriangle {
        let of_each = self.pieces.of_each();
        if let (1, Some(stored)) = (of_each, self.static_triangles.get(piece)) {
            return *stored;
        }
        let corners @ [a, b, c] = self.corners(self.pieces.triangle(piece), time);
        let normal = (b - a).cross(c - a);
        let pdf_area = self.choice.probability(piece) / (0.5 * normal.length() / of_each as f32);
        LightTriangle { corners, normal: normal.normalize_or_zero() * self.turn, pdf_area }
    }

    /// Picks a piece, and barycentric coordinates in its triangle, uniform over the piece.
    fn sample_weights(&self, u: Vec2) -> (usize, [f32; 3]) {
        let (number, rest) = self.choice.sample(u.x);
        (number, self.pieces.piece(number).weights(barycentric(Vec2::new(rest, u.y))))
    }

    /// Samples a point; returns it, and its triangle.
    fn sample_point(&self, time: f32, u: Vec2) -> (Vec3, LightTriangle) {
        let (number, weights) = self.sample_weights(u);
        let facet = self.facet(number, time);
        (blend(&facet.corners, weights), facet)
    }

    fn middle(&self, time: f32) -> Vec3 {
        self.motion.at(time).point(self.middle)
    }

    fn world_area(&self, time: f32) -> f32 {
        (0..self.triangles.len()).map(|i| area(&self.corners(i, time))).sum()
    }
}

fn area(t: &[Vec3; 3]) -> f32 {
    (t[1] - t[0]).cross(t[2] - t[0]).length() * 0.5
}

/// 0 where a triangle has no area.
fn finite(pdf: f32) -> f32 {
    if pdf.is_finite() { pdf } else { 0.0 }
}

fn finite_or_zero(x: f64) -> f64 {
    if x.is_finite() { x } else { 0.0 }
}

impl dyn Light {
    /// The mesh light that this one is: integrators that sample many points at once sample its triangles themselves.
    #[doc(hidden)]
    pub fn as_mesh(&self) -> Option<&MeshLight> {
        (self as &dyn Any).downcast_ref()
    }
}

impl Light for MeshLight {
    fn sample_li(&self, from: Vec3, time: f32, u: Vec2) -> Option<LightSample> {
        self.sample_chosen(from, &self.choose(from, time, u.x)?, u.y, time)
    }

    fn sample_li_each(&self, receivers: &[Receiver], samples: &mut Vec<Option<LightSample>>) {
        samples.clear();
        samples.resize(receivers.len(), None);
        self.choose_each(receivers.iter().copied(), |i, chosen| {
            let Receiver { p, time, u } = receivers[i];
            samples[i] = chosen.and_then(|chosen| self.sample_chosen(p, &chosen, u.y, time));
        });
    }

    fn li_pdf_solid_angle(&self, from: Vec3, wi: Vec3, hit: Option<&Surface>) -> f32 {
        let Some(hit) = hit else { return 0.0 };
        let pdf = self.pdf_area(from, hit) * from.distance_squared(hit.p) / hit.n_geom.dot(wi).abs();
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    fn pdf_area(&self, from: Vec3, hit: &Surface) -> f32 {
        let piece = self.piece_at(hit.primitive, hit.p, hit.time);
        piece.map_or(0.0, |piece| self.pdf_area_of(from, hit.time, piece))
    }

    fn emits_towards(&self, hit: &Surface, wo: Vec3) -> bool {
        let piece = || hit.primitive.index.wrapping_sub(self.first.index) as usize * self.pieces.of_each();
        self.sides == Sides::Both || self.facet(piece(), hit.time).normal.dot(wo) > 0.0
    }

    fn middle_and_reach(&self) -> Option<(Vec3, f32)> {
        Some((self.middle(0.0), self.reach))
    }

    fn extent(&self, shutter: [f32; 2]) -> Option<LightExtent> {
        let own = Aabb::of_points(self.triangles.iter().flatten().copied());
        let bounds = self.motion.bounds_over(&own, shutter);
        let both_sides = self.sides == Sides::Both;
        // A side that shines back is as good as one that faces the other way.
        let axis = self.static_triangles.iter().map(|t| t.normal).find(|normal| *normal != Vec3::ZERO);
        let forth = |normal: Vec3| match axis {
            Some(axis) if both_sides && normal.dot(axis) < 0.0 => -normal,
            _ => normal,
        };
        let normals = self.static_triangles.iter().map(|t| forth(t.normal)).filter(|n| *n != Vec3::ZERO);
        let facing = normals.map(DirectionCone::of).reduce(DirectionCone::union);
        let facing = facing.unwrap_or(DirectionCone::ALL);
        Some(LightExtent { bounds, facing, spread: FRAC_PI_2, both_sides })
    }

    fn is_delta(&self) -> bool {
        false
    }

    fn power(&self, _bounds: &Aabb) -> f32 {
        self.radiance.luminance() * self.world_area(0.0) * PI * self.sides.count()
    }
}

impl ClassicLighting for MeshLight {
    fn classic(&self, from: Vec3, time: f32, u: Vec2, extent: f32) -> Option<ClassicLight> {
        let middle = self.middle(time);
        let (point, LightTriangle { corners, normal, .. }) = self.sample_point(time, u);
        let position = middle + (point - middle) * extent;
        let wi = (position - from).try_normalize()?;
        let cos = normal.dot(wi);
        if self.sides == Sides::Front && cos >= 0.0 {
            return None;
        }
        let clearance = clearance(from, position, &corners, cos.abs());
        Some(ClassicLight { wi, position: Some(position), strength: 1.0, clearance })
    }

    fn classic_colour(&self, bounds: &Aabb) -> Rgb {
        let intensity = self.radiance * self.world_area(0.0);
        self.classic.unwrap_or_else(|| super::classic_colour_of(intensity, self.middle(0.0), bounds))
    }
}
