//! Emissive triangle meshes. Not in the table: objects with an emissive material become mesh lights.

use super::cumulative::{Cumulative, CumulativePart};
use super::light_triangle::{LightTriangle, TriangleSample, barycentric, blend, clearance};
use super::near_triangles::NearTriangles;
use super::picture::{Picture, weights_by_brightness};
use super::{
    ClassicLighting, DirectionCone, EmissionSample, Light, LightExtent, LightSample, LightTracing, Receiver,
    Sides,
};
use crate::classic::ClassicLight;
use crate::corners::transform_with_error;
use crate::surface::{Surface, gamma};
use bilux_accel::Primitive;
use bilux_math::motion::Motion;
use bilux_math::{Aabb, Frame, Rgb, Transform, Vec2, Vec3, warp};
use std::any::Any;
use std::f32::consts::{FRAC_PI_2, PI};

/// An emissive object, sampled in proportion to the object-space area of its triangles times their brightness; where there are many,
/// points of the scene choose among them by where they are.
///
/// Points are uniform within each triangle.
pub struct MeshLight {
    triangles: Vec<[Vec3; 3]>,
    choice: Cumulative,
    /// The object's first triangle, as in a hit.
    first: Primitive,
    /// Centroid of the area, in object space.
    middle: Vec3,
    /// Half the root of its area in world space, when its motion begins.
    reach: f32,
    motion: Motion,
    /// The triangles in world space; empty when they move.
    static_triangles: Vec<LightTriangle>,
    /// How points choose among these, if they are many and equally bright.
    near: Option<NearTriangles>,
    /// The mean radiance over its area.
    radiance: Rgb,
    picture: Option<Picture>,
    sides: Sides,
    /// The orientation of the front in world space: -1 if mirrored, otherwise 1.
    turn: f32,
    classic: Option<Rgb>,
}

/// What a surface emits.
pub struct SurfaceEmission {
    /// Everywhere, if there is no picture.
    pub radiance: Rgb,
    /// What it is where it varies.
    pub picture: Option<Picture>,
    /// From which sides.
    pub sides: Sides,
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
        let is_even = picture.is_none() && motion.is_still();
        let has_near = is_even && NearTriangles::is_for(triangles.len()) && is_finite();
        // Then points are uniform in world space, whatever the scale along each axis.
        let to_world = if has_near { to_world } else { Transform::IDENTITY };
        let area_of = |t: &[Vec3; 3]| f64::from(area(&t.map(|p| to_world.point(p))));
        let areas: Vec<f64> = triangles.iter().map(area_of).map(finite_or_zero).collect();
        let total: f64 = areas.iter().sum();
        if total <= 0.0 {
            return None;
        }
        let (radiance, weights) = match &picture {
            None => (radiance, areas.clone()),
            Some(picture) => weights_by_brightness(picture, &areas),
        };
        let choice = Cumulative::new(&weights);
        let weighted = |(t, a): (&[Vec3; 3], &f64)| (t[0] + t[1] + t[2]) * (a / (3.0 * total)) as f32;
        let middle = triangles.iter().zip(&areas).filter(|(_, a)| **a > 0.0).map(weighted).sum();
        let static_triangles = Vec::new();
        let turn = if mirrored { -1.0 } else { 1.0 };
        let mut light = MeshLight {
            triangles,
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
            light.static_triangles = (0..light.triangles.len()).map(|i| light.facet(i, 0.0)).collect();
        }
        if has_near {
            light.near = Some(NearTriangles::new(&light.static_triangles, sides == Sides::Both));
        }
        Some(light)
    }

    /// Picks a triangle for a point; returns its index, the rest of the random number, and the triangle with the density of its points.
    /// `None` where none shines.
    #[inline]
    pub fn choose(&self, from: Vec3, time: f32, u: f32) -> Option<(usize, f32, LightTriangle)> {
        let Some(near) = &self.near else {
            let (triangle, rest) = self.choice.sample(u);
            return Some((triangle, rest, self.facet(triangle, time)));
        };
        near.choose(from, u).map(|chosen| self.nearby(chosen, time))
    }

    /// [`MeshLight::choose`] for each receiver, by the first of its numbers: faster than one by one.
    pub fn choose_each(
        &self,
        receivers: impl Iterator<Item = Receiver>,
        mut chosen: impl FnMut(usize, Option<(usize, f32, LightTriangle)>),
    ) {
        let Some(near) = &self.near else {
            receivers.enumerate().for_each(|(i, r)| chosen(i, self.choose(r.p, r.time, r.u.x)));
            return;
        };
        // These triangles do not move.
        near.choose_each(receivers.map(|r| (r.p, r.u.x)), |i, found| {
            chosen(i, found.map(|found| self.nearby(found, 0.0)));
        });
    }

    /// What a point has chosen, with the triangle.
    #[inline]
    fn nearby(
        &self,
        (triangle, rest, pdf_area): (usize, f32, f32),
        time: f32,
    ) -> (usize, f32, LightTriangle) {
        (triangle, rest, LightTriangle { pdf_area, ..self.facet(triangle, time) })
    }

    /// A point of the triangle that `from` has chosen, by what is left of the number that chose it, and another.
    #[inline]
    fn sample_chosen(
        &self,
        from: Vec3,
        u_y: f32,
        (triangle, rest, facet): (usize, f32, LightTriangle),
    ) -> Option<LightSample> {
        let weights = barycentric(Vec2::new(rest, u_y));
        let sample = TriangleSample::new(from, &facet, weights, self.sides);
        (sample.pdf_solid_angle > 0.0).then(|| LightSample {
            wi: sample.wi,
            li: self.radiance(triangle, weights),
            point: Some(sample.point),
            n_light: sample.n_light,
            pdf_solid_angle: sample.pdf_solid_angle,
            clearance: sample.clearance,
        })
    }

    /// The density over area with which a point samples points of a triangle.
    #[inline]
    fn pdf_area_of(&self, from: Vec3, time: f32, triangle: usize) -> f32 {
        let near = self.near.as_ref().map(|near| near.pdf_area(from, triangle));
        let pdf = near.unwrap_or_else(|| self.facet(triangle, time).pdf_area);
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    /// The density over area with which light subpaths begin at a point, where points of the scene sample it with `pdf_direct`.
    #[inline]
    fn start_pdf_area(&self, pdf_direct: f32) -> f32 {
        self.near.as_ref().map_or(pdf_direct, NearTriangles::uniform_pdf_area)
    }

    /// Its triangles with the random numbers that pick each, in their order, if they are few, do not move and emit
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

    fn corners(&self, triangle: usize, time: f32) -> [Vec3; 3] {
        let to_world = self.motion.at(time);
        self.triangles[triangle].map(|p| to_world.point(p))
    }

    /// A triangle in world space at a time.
    #[inline]
    pub fn facet(&self, triangle: usize, time: f32) -> LightTriangle {
        if let Some(stored) = self.static_triangles.get(triangle) {
            return *stored;
        }
        let corners @ [a, b, c] = self.corners(triangle, time);
        let normal = (b - a).cross(c - a);
        let pdf_area = self.choice.probability(triangle) / (0.5 * normal.length());
        LightTriangle { corners, normal: normal.normalize_or_zero() * self.turn, pdf_area }
    }

    /// Picks a triangle, and barycentric coordinates uniform over it.
    fn sample_weights(&self, u: Vec2) -> (usize, [f32; 3]) {
        let (triangle, rest) = self.choice.sample(u.x);
        (triangle, barycentric(Vec2::new(rest, u.y)))
    }

    /// Samples a point; returns it, its triangle and the emitted radiance.
    fn sample_point(&self, time: f32, u: Vec2) -> (Vec3, LightTriangle, Rgb) {
        let (triangle, weights) = self.sample_weights(u);
        let facet = self.facet(triangle, time);
        (blend(&facet.corners, weights), facet, self.radiance(triangle, weights))
    }

    /// A point of a triangle and the bound on its error, both as for a hit there.
    fn point_with_error(&self, triangle: usize, weights: [f32; 3], time: f32) -> (Vec3, Vec3) {
        let own = &self.triangles[triangle];
        let (p, error) = (blend(own, weights), blend(&own.map(Vec3::abs), weights) * gamma(7));
        let to_world = self.motion.at(time);
        if to_world.is_identity() { (p, error) } else { transform_with_error(&to_world, p, error) }
    }

    /// A ray from a point of a triangle, emitted with density `pdf_emission`; `None` if that is zero.
    fn ray(
        &self,
        triangle: usize,
        weights: [f32; 3],
        time: f32,
        direction: Vec3,
        pdf_emission: f32,
    ) -> Option<EmissionSample> {
        let LightTriangle { normal, pdf_area, .. } = self.facet(triangle, time);
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
        self.sample_chosen(from, u.y, self.choose(from, time, u.x)?)
    }

    fn sample_li_each(&self, receivers: &[Receiver], samples: &mut Vec<Option<LightSample>>) {
        samples.clear();
        samples.resize(receivers.len(), None);
        self.choose_each(receivers.iter().copied(), |i, chosen| {
            let Receiver { p, u, .. } = receivers[i];
            samples[i] = chosen.and_then(|chosen| self.sample_chosen(p, u.y, chosen));
        });
    }

    fn li_pdf_solid_angle(&self, from: Vec3, wi: Vec3, hit: Option<&Surface>) -> f32 {
        let Some(hit) = hit else { return 0.0 };
        let pdf = self.pdf_area(from, hit) * from.distance_squared(hit.p) / hit.n_geom.dot(wi).abs();
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    fn pdf_area(&self, from: Vec3, hit: &Surface) -> f32 {
        let triangle = hit.primitive.index.wrapping_sub(self.first.index) as usize;
        if hit.primitive.instance != self.first.instance || triangle >= self.triangles.len() {
            return 0.0;
        }
        self.pdf_area_of(from, hit.time, triangle)
    }

    fn emits_towards(&self, hit: &Surface, wo: Vec3) -> bool {
        let triangle = || hit.primitive.index.wrapping_sub(self.first.index) as usize;
        self.sides == Sides::Both || self.facet(triangle(), hit.time).normal.dot(wo) > 0.0
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

impl LightTracing for MeshLight {
    fn direct_pdf(&self, sample: &EmissionSample, from: Vec3) -> f32 {
        let triangle = sample.primitive.index.wrapping_sub(self.first.index) as usize;
        if self.near.is_some() { self.pdf_area_of(from, 0.0, triangle) } else { sample.pdf_direct }
    }

    fn sample_le(
        &self,
        bounds: &Aabb,
        time: f32,
        u_point: Vec2,
        u_direction: Vec2,
    ) -> Option<EmissionSample> {
        let (triangle, weights) = self.sample_weights(u_point);
        let LightTriangle { normal, pdf_area, .. } = self.facet(triangle, time);
        let (n_light, u) = match self.sides {
            Sides::Front => (normal, u_direction),
            // Each side takes half of the random numbers.
            Sides::Both if u_direction.x < 0.5 => (normal, Vec2::new(2.0 * u_direction.x, u_direction.y)),
            Sides::Both => (-normal, Vec2::new(2.0 * u_direction.x - 1.0, u_direction.y)),
        };
        let direction = Frame::from_normal(n_light).to_world(warp::sample_cosine_hemisphere(u)).normalize();
        let pdf_emission = self.emission_pdf(bounds, pdf_area, direction, n_light.dot(direction).abs());
        self.ray(triangle, weights, time, direction, pdf_emission)
    }

    fn sample_le_aimed(&self, _: &Aabb, time: f32, u: Vec2, aim: Vec2) -> Option<EmissionSample> {
        let (triangle, weights) = self.sample_weights(u);
        let (LightTriangle { normal, pdf_area, .. }, direction) =
            (self.facet(triangle, time), warp::square_to_sphere(aim).normalize());
        let leaves = self.sides == Sides::Both || normal.dot(direction) > 0.0;
        let pdf = self.start_pdf_area(pdf_area);
        leaves.then(|| self.ray(triangle, weights, time, direction, pdf)).flatten()
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, pdf_direct: f32, _direction: Vec3, _cos: f32) -> f32 {
        self.start_pdf_area(pdf_direct)
    }

    fn emission_pdf(&self, _bounds: &Aabb, pdf_direct: f32, _direction: Vec3, cos: f32) -> f32 {
        self.start_pdf_area(pdf_direct) * (warp::cosine_hemisphere_pdf_solid_angle(cos) / self.sides.count())
    }

    fn is_infinite(&self) -> bool {
        false
    }
}

impl ClassicLighting for MeshLight {
    fn classic(&self, from: Vec3, time: f32, u: Vec2, extent: f32) -> Option<ClassicLight> {
        let middle = self.middle(time);
        let (point, LightTriangle { corners, normal, .. }, _) = self.sample_point(time, u);
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
