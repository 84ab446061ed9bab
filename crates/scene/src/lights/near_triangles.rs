//! The triangles of an emissive mesh of many, or their pieces, as a point of the scene chooses among them: by a tree of lights, each triangle a
//! light. A mesh may be all lamps of a city.

use super::{DirectionCone, LightExtent, LightTree};
use bilux_math::{Aabb, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Up to this many triangles are chosen by area alone: a lamp of so few is small, and a tree takes longer.
const FEW: usize = 64;

/// A mesh of more is chosen by area alone: a random number has no bits left for more.
const MOST: usize = 1 << 20;

/// A choice among the triangles of a mesh that does not move, or among their pieces.
pub(super) struct NearTriangles {
    tree: LightTree,
    /// The area of each, in m².
    areas: Vec<f32>,
}

impl NearTriangles {
    /// Whether there are enough triangles for a tree, and not too many.
    pub(super) fn is_for(count: usize) -> bool {
        (FEW + 1..=MOST).contains(&count)
    }

    /// A choice among pieces by their corners and normals, in world space, and their power in any unit.
    pub(super) fn new(
        pieces: impl Iterator<Item = ([Vec3; 3], Vec3, f32)>,
        both_sides: bool,
    ) -> NearTriangles {
        let area = |[a, b, c]: [Vec3; 3]| {
            let area = 0.5 * (b - a).cross(c - a).length();
            if area.is_finite() { area } else { 0.0 }
        };
        let extent = |corners: [Vec3; 3], normal: Vec3| LightExtent {
            bounds: Aabb::of_points(corners),
            facing: if normal == Vec3::ZERO { DirectionCone::ALL } else { DirectionCone::of(normal) },
            spread: FRAC_PI_2,
            both_sides,
        };
        let light = |(corners, normal, power): ([Vec3; 3], Vec3, f32)| {
            (area(corners), (extent(corners, normal), power.max(f32::MIN_POSITIVE)))
        };
        let (areas, lights): (Vec<f32>, Vec<(LightExtent, f32)>) = pieces.map(light).unzip();
        NearTriangles { tree: LightTree::new(&lights), areas }
    }

    /// A triangle for a point, the rest of the random number, and the density of points on the triangle over area; `None` where none shines.
    #[inline]
    pub(super) fn choose(&self, from: Vec3, u: f32) -> Option<(usize, f32, f32)> {
        self.tree.sample_with_rest(from, u).map(|found| self.with_density(found))
    }

    /// [`NearTriangles::choose`] for each point with its number: faster than one by one.
    pub(super) fn choose_each(
        &self,
        points: impl Iterator<Item = (Vec3, f32)>,
        mut chosen: impl FnMut(usize, Option<(usize, f32, f32)>),
    ) {
        self.tree.sample_each(points, |i, found| chosen(i, found.map(|found| self.with_density(found))));
    }

    #[inline]
    fn with_density(&self, (triangle, probability, rest): (usize, f32, f32)) -> (usize, f32, f32) {
        (triangle, rest, probability / self.areas[triangle])
    }

    /// The density over area with which [`NearTriangles::choose`] leads to points of a triangle.
    #[inline]
    pub(super) fn pdf_area(&self, from: Vec3, triangle: usize) -> f32 {
        self.tree.probability(from, triangle) / self.areas[triangle]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lights::{Light, LightTriangle, MeshLight, Sides, SurfaceEmission};
    use bilux_accel::Primitive;
    use bilux_math::hash::{hash_words, unit_f32};
    use bilux_math::motion::Motion;
    use bilux_math::{Rgb, Transform, Vec2};

    fn u(i: u64, k: u64) -> f32 {
        unit_f32(hash_words([i, k]) as u32)
    }

    /// 2,000 small triangles in a slab of 20 × 1 × 20 metres, some of them without area.
    fn scattered() -> Vec<LightTriangle> {
        let triangle = |i: u64| {
            let a = Vec3::new(20.0 * u(i, 0), u(i, 1), 20.0 * u(i, 2));
            let side = |k: u64| Vec3::new(u(i, k), u(i, k + 1), u(i, k + 2)) - Vec3::splat(0.5);
            let size = if i.is_multiple_of(50) { 0.0 } else { 0.1 };
            let corners = [a, a + side(3) * size, a + side(6) * size];
            let normal = (corners[1] - a).cross(corners[2] - a).normalize_or_zero();
            LightTriangle { corners, normal, pdf_area: 0.0 }
        };
        (0..2000).map(triangle).collect()
    }

    /// The choice among triangles of the same radiance.
    fn near(triangles: &[LightTriangle], both_sides: bool) -> NearTriangles {
        let area = |[a, b, c]: [Vec3; 3]| 0.5 * (b - a).cross(c - a).length();
        let piece = |t: &LightTriangle| (t.corners, t.normal, area(t.corners));
        NearTriangles::new(triangles.iter().map(piece), both_sides)
    }

    #[test]
    fn near_triangles_are_chosen_as_often_as_they_say_and_with_less_noise_than_by_area() {
        let triangles = scattered();
        for (from, both_sides) in [(Vec3::new(7.0, -0.5, 9.0), true), (Vec3::new(3.0, 4.0, 18.0), false)] {
            let near = near(&triangles, both_sides);
            let uniform = 1.0 / near.areas.iter().sum::<f32>();
            let irradiance = |i: usize| {
                let LightTriangle { corners: [a, ..], normal, .. } = triangles[i];
                let cos = normal.dot((from - a).normalize());
                let cos = if both_sides { cos.abs() } else { cos.max(0.0) };
                f64::from(near.areas[i] * cos / from.distance_squared(a))
            };
            let mut chosen = vec![0; triangles.len()];
            let count = 400_000;
            let (mut sum, mut squares, mut uniform_squares) = (0.0, 0.0, 0.0);
            for i in 0..count {
                let Some((triangle, rest, pdf_area)) = near.choose(from, u(i, 99)) else { continue };
                assert!((0.0..=1.0).contains(&rest));
                if near.areas[triangle] == 0.0 {
                    continue;
                }
                let again = near.pdf_area(from, triangle);
                assert!((pdf_area / again - 1.0).abs() < 1e-4, "{pdf_area} {again}");
                chosen[triangle] += 1;
                let found = irradiance(triangle) / f64::from(pdf_area * near.areas[triangle]);
                sum += found / count as f64;
                squares += found * found / count as f64;
            }
            let all: f64 = (0..triangles.len()).map(irradiance).sum();
            for i in 0..triangles.len() {
                let probability = f64::from(uniform * near.areas[i]);
                if probability > 0.0 {
                    uniform_squares += irradiance(i) * irradiance(i) / probability;
                }
            }
            assert!((sum / all - 1.0).abs() < 0.01, "{sum} {all}");
            assert!(2.0 * squares < uniform_squares, "{squares} {uniform_squares}");
            let most = (0..triangles.len()).max_by_key(|&i| chosen[i]).unwrap();
            let wanted = f64::from(near.pdf_area(from, most) * near.areas[most]) * count as f64;
            assert!(
                (f64::from(chosen[most]) - wanted).abs() < 5.0 * wanted.sqrt(),
                "{} {wanted}",
                chosen[most]
            );
        }
    }

    /// A file may have vertices that are nowhere. Bounds that reach there would hide their neighbours in the tree.
    #[test]
    fn a_vertex_that_is_nowhere_leaves_the_other_triangles_their_light() {
        let mut triangles: Vec<[Vec3; 3]> = scattered().iter().map(|triangle| triangle.corners).collect();
        triangles[7][1] = Vec3::new(f32::INFINITY, 0.0, 0.0);
        let from = Vec3::new(7.0, -0.5, 9.0);
        let seen = |[a, b, c]: &[Vec3; 3]| {
            let area_times_normal = 0.5 * (*b - *a).cross(*c - *a);
            let to = *a - from;
            f64::from(area_times_normal.dot(to.normalize()).abs() / to.length_squared())
        };
        let wanted: f64 = triangles.iter().map(seen).filter(|seen| seen.is_finite()).sum();
        let emitted = SurfaceEmission { radiance: Rgb::WHITE, picture: None, sides: Sides::Both };
        let rest = Motion::still(Transform::IDENTITY);
        let light = MeshLight::new(triangles, false, Primitive::NONE, rest, emitted, None).unwrap();
        let sample = |i| light.sample_li(from, 0.0, Vec2::new(u(i, 0), u(i, 1)));
        let count = 2_000_000;
        let sum: f64 =
            (0..count).filter_map(sample).map(|sample| 1.0 / f64::from(sample.pdf_solid_angle)).sum();
        let found = sum / f64::from(count as u32);
        assert!((found / wanted - 1.0).abs() < 0.02, "{found} {wanted}");
    }
}
