//! Emissive triangle meshes. Not in the table: objects with an emissive material become mesh lights.

use super::cumulative::{Cumulative, CumulativePart};
use super::light_triangle::{LightTriangle, TriangleSample, barycentric, blend, clearance};
use super::{
    ClassicLighting, DirectionCone, EmissionSample, Light, LightExtent, LightSample, LightTracing, Sides,
};
use crate::classic::ClassicLight;
use crate::corners::transform_with_error;
use crate::mesh::Mesh;
use crate::surface::{Surface, gamma};
use crate::texture::{ColourMap, NumberMap, UvPair};
use bilux_accel::Primitive;
use bilux_math::motion::Motion;
use bilux_math::{Aabb, Frame, Rgb, Vec2, Vec3, warp};
use std::any::Any;
use std::f32::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// An emissive object, sampled in proportion to the object-space area of its triangles times their brightness.
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
    /// The mean radiance over its area.
    radiance: Rgb,
    picture: Option<Picture>,
    sides: Sides,
    /// The orientation of the front in world space: -1 if mirrored, otherwise 1.
    turn: f32,
    classic: Option<Rgb>,
}

/// The emission of a light across its surface.
pub struct Picture {
    /// Emission by texture coordinates.
    pub map: ColourMap,
    /// The opacity mask, if any. Light sampling scales the emission by it; a ray that hits the light has already passed
    /// the opacity test.
    pub opacity: Option<NumberMap>,
    /// The texture coordinates of each triangle's corners.
    pub uvs: Vec<[UvPair; 3]>,
    /// The mesh, whose vertices may have factors on emission and opacity.
    pub mesh: Arc<Mesh>,
}

impl Picture {
    fn at(&self, triangle: usize, weights: [f32; 3]) -> Rgb {
        let uv = UvPair::between(self.uvs[triangle], weights);
        let opacity = self.opacity.as_ref().map_or(1.0, |opacity| opacity.at(uv));
        let corners = self.mesh.triangles[triangle];
        self.map.at(uv)
            * self.mesh.emission_factor(corners, weights)
            * self.mesh.opacity(opacity, corners, weights)
    }

    /// The mean over a triangle, from the centres of its sixteen sub-triangles.
    fn mean(&self, triangle: usize) -> Rgb {
        let mut sum = Rgb::BLACK;
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            // Every second sub-triangle is upside down.
            let (i, j, third) = if i + j < 4 { (i, j, 1.0 / 3.0) } else { (7 - i - j, j, 2.0 / 3.0) };
            let (u, v) = ((i as f32 + third) / 4.0, (j as f32 + third) / 4.0);
            sum += self.at(triangle, [1.0 - u - v, u, v]);
        }
        sum / 16.0
    }
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

/// The minimum brightness of a triangle, relative to the mean: a few points may miss the bright parts of a triangle.
const MIN_SHARE: f64 = 0.1;

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
        let areas: Vec<f64> = triangles.iter().map(|t| f64::from(area(t))).map(finite_or_zero).collect();
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
        Some(light)
    }

    /// Picks a triangle in proportion to its probability; returns its index, and the rest of the random number.
    #[inline]
    pub fn choose(&self, u: f32) -> (usize, f32) {
        self.choice.sample(u)
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

/// The mean radiance over all triangles, and the unnormalised probability of each.
fn weights_by_brightness(picture: &Picture, areas: &[f64]) -> (Rgb, Vec<f64>) {
    let total: f64 = areas.iter().sum();
    let means: Vec<Rgb> = (0..areas.len()).map(|i| picture.mean(i)).collect();
    let mean: Rgb = means.iter().zip(areas).map(|(mean, area)| *mean * (area / total) as f32).sum();
    let least = MIN_SHARE * f64::from(mean.luminance());
    let weight = |(mean, area): (&Rgb, &f64)| area * (f64::from(mean.luminance()) + least);
    let weights = if least > 0.0 { means.iter().zip(areas).map(weight).collect() } else { areas.to_vec() };
    (mean, weights)
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
        let (triangle, weights) = self.sample_weights(u);
        let sample = TriangleSample::new(from, &self.facet(triangle, time), weights, self.sides);
        (sample.pdf_solid_angle > 0.0).then(|| LightSample {
            wi: sample.wi,
            li: self.radiance(triangle, weights),
            point: Some(sample.point),
            n_light: sample.n_light,
            pdf_solid_angle: sample.pdf_solid_angle,
            clearance: sample.clearance,
        })
    }

    fn li_pdf_solid_angle(&self, from: Vec3, wi: Vec3, hit: Option<&Surface>) -> f32 {
        let Some(hit) = hit else { return 0.0 };
        let pdf = self.pdf_area(from, hit) * from.distance_squared(hit.p) / hit.n_geom.dot(wi).abs();
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    fn pdf_area(&self, _from: Vec3, hit: &Surface) -> f32 {
        let triangle = hit.primitive.index.wrapping_sub(self.first.index) as usize;
        if hit.primitive.instance != self.first.instance || triangle >= self.triangles.len() {
            return 0.0;
        }
        let pdf = self.facet(triangle, hit.time).pdf_area;
        if pdf.is_finite() { pdf } else { 0.0 }
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
        leaves.then(|| self.ray(triangle, weights, time, direction, pdf_area)).flatten()
    }

    fn unaimed_pdf(&self, _bounds: &Aabb, pdf_direct: f32, _direction: Vec3, _cos: f32) -> f32 {
        pdf_direct
    }

    fn emission_pdf(&self, _bounds: &Aabb, pdf_direct: f32, _direction: Vec3, cos: f32) -> f32 {
        pdf_direct * (warp::cosine_hemisphere_pdf_solid_angle(cos) / self.sides.count())
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
