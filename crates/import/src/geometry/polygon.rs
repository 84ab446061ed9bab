//! Triangulates polygons.

use crate::geometry::normals::newell;
use bilux_math::{DVec2, DVec3, Vec3};
use earcut::Earcut;

/// Triangulates polygons, reusing its buffers.
#[derive(Default)]
pub struct Triangulator {
    points: Vec<Vec3>,
    flat: Vec<DVec2>,
    earcut: Earcut<f64>,
    ears: Vec<u32>,
}

/// Triangulating a concave polygon takes quadratic time at worst; one with more corners is treated as convex.
const MAX_EARS: usize = 4096;

impl Triangulator {
    /// Emits triples of corners, from 0, that cover a polygon with the same winding.
    ///
    /// `None` if the polygon is concave and has too many corners.
    pub fn triangulate(
        &mut self,
        points: impl Iterator<Item = Vec3>,
        mut triangle: impl FnMut([u32; 3]),
    ) -> Option<()> {
        self.points.clear();
        self.points.extend(points);
        let count = self.points.len() as u32;
        let mut fan = |first: u32| {
            (2..count).for_each(|i| triangle([first, i - 1 + first, i + first].map(|c| c % count)))
        };
        if count <= 3 || !self.flatten() || self.is_convex() {
            fan(0);
            return Some(());
        }
        if count == 4 {
            // The two triangles of a concave quadrilateral share its reflex corner.
            fan((0..4).find(|&i| self.turns_right(i as usize)).unwrap_or(0));
            return Some(());
        }
        if count as usize > MAX_EARS {
            fan(0);
            return None;
        }
        if !self.cut_ears() {
            fan(0);
        }
        for ear in self.ears.chunks_exact(3) {
            let [a, b, c] = [ear[0], ear[1], ear[2]].map(|i| self.flat[i as usize]);
            let turned = (b - a).perp_dot(c - a) < 0.0;
            triangle(if turned { [ear[0], ear[2], ear[1]] } else { [ear[0], ear[1], ear[2]] });
        }
        Some(())
    }

    /// Clips ears; returns false, without triangles, if the outline intersects itself so that ears would miss a
    /// part.
    fn cut_ears(&mut self) -> bool {
        self.ears.clear();
        self.earcut.earcut(self.flat.iter().map(|p| p.to_array()), &[], &mut self.ears);
        let doubled = |a: usize, b: usize, c: usize| {
            (self.flat[b] - self.flat[a]).perp_dot(self.flat[c] - self.flat[a])
        };
        let cut: f64 = self
            .ears
            .chunks_exact(3)
            .map(|e| doubled(e[0] as usize, e[1] as usize, e[2] as usize).abs())
            .sum();
        let whole: f64 = (2..self.flat.len()).map(|i| doubled(0, i - 1, i)).sum();
        let covers = (cut - whole).abs() <= 1e-6 * whole;
        if !covers {
            self.ears.clear();
        }
        covers
    }

    /// Projects the polygon along its normal, so that it is counter-clockwise; false if it has no normal.
    fn flatten(&mut self) -> bool {
        let normal = newell(self.points.iter().copied());
        if !(normal.is_finite() && normal != DVec3::ZERO) {
            return false;
        }
        let first = self.points[0].as_dvec3();
        let size = normal.abs();
        let view = |p: DVec3| match () {
            () if size.x >= size.y && size.x >= size.z => DVec2::new(p.y, p.z * normal.x.signum()),
            () if size.y >= size.z => DVec2::new(p.z, p.x * normal.y.signum()),
            () => DVec2::new(p.x, p.y * normal.z.signum()),
        };
        self.flat.clear();
        self.flat.extend(self.points.iter().map(|p| view(p.as_dvec3() - first)));
        true
    }

    /// True if the outline turns right at a corner.
    fn turns_right(&self, corner: usize) -> bool {
        let n = self.flat.len();
        let [before, at, after] = [corner + n - 1, corner, corner + 1].map(|i| self.flat[i % n]);
        (at - before).perp_dot(after - at) < 0.0
    }

    /// True if the polygon turns left at every corner and winds around only once.
    fn is_convex(&self) -> bool {
        let n = self.flat.len();
        let at = |i: usize| self.flat[i % n];
        let turns_left = (0..n).all(|i| !self.turns_right(i));
        // A pentagram also turns left everywhere, but rises and falls more than once.
        let rises = |i: usize| at(i + 1).y > at(i).y || (at(i + 1).y == at(i).y && at(i + 1).x > at(i).x);
        let changes = (0..n).filter(|&i| rises(i) != rises(i + 1)).count();
        turns_left && changes <= 2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cut(points: &[Vec3]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        Triangulator::default().triangulate(points.iter().copied(), |t| triangles.push(t)).unwrap();
        triangles
    }

    fn area(points: &[Vec3], triangles: &[[u32; 3]]) -> DVec3 {
        triangles.iter().map(|t| newell(t.iter().map(|&i| points[i as usize]))).sum()
    }

    #[test]
    fn concave_polygons_are_covered_once_in_every_plane() {
        // An L shape, which a fan around its first corner would leave.
        let ell = [[1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [0.0, 0.0], [2.0, 0.0], [2.0, 1.0]];
        let planes: [fn([f32; 2]) -> Vec3; 6] = [
            |[a, b]| Vec3::new(a, b, 5.0),
            |[a, b]| Vec3::new(b, a, 5.0),
            |[a, b]| Vec3::new(a, -7.0, b),
            |[a, b]| Vec3::new(b, 3.0, a),
            |[a, b]| Vec3::new(9.0, a, b),
            |[a, b]| Vec3::new(-9.0, b, a),
        ];
        for place in planes {
            let points = ell.map(place);
            let triangles = cut(&points);
            let whole = newell(points.iter().copied());
            assert_eq!(triangles.len(), 4);
            assert!((area(&points, &triangles) - whole).length() < 1e-6);
            let with_it = |t: &[u32; 3]| newell(t.iter().map(|&i| points[i as usize])).dot(whole) > 0.0;
            assert!(triangles.iter().all(with_it), "{triangles:?}");
        }
    }

    #[test]
    fn a_concave_quadrilateral_is_split_at_its_reflex_corner() {
        let dart = [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        for turn in 0..4 {
            let mut points = dart;
            points.rotate_left(turn);
            let triangles = cut(&points);
            let positive = |t: &[u32; 3]| newell(t.iter().map(|&i| points[i as usize])).z > 0.0;
            assert!(triangles.len() == 2 && triangles.iter().all(positive), "{triangles:?}");
        }
    }

    #[test]
    fn degenerate_polygons_are_fans() {
        assert_eq!(cut(&[Vec3::ZERO; 5]).len(), 3);
        assert_eq!(cut(&[Vec3::NAN; 4]).len(), 2);
        assert_eq!(cut(&[Vec3::X, Vec3::Y]), Vec::<[u32; 3]>::new());
    }

    proptest! {
        #[test]
        fn any_polygon_gives_triangles_of_its_corners(points in prop::collection::vec(prop::array::uniform3(-3f32..3.0), 3..40)) {
            let points: Vec<Vec3> = points.into_iter().map(Vec3::from).collect();
            let triangles = cut(&points);
            prop_assert!(!triangles.is_empty() && triangles.len() <= points.len() - 2);
            prop_assert!(triangles.iter().flatten().all(|&i| (i as usize) < points.len()));
        }
    }
}
