//! Planes and convex polygons in f64, for ordering only: they never decide what covers a pixel.

use bilux_math::DVec3;

/// An oriented plane with a unit normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
}

impl Plane {
    /// The plane through a point.
    pub(crate) fn through(point: DVec3, normal: DVec3) -> Plane {
        Plane { normal, offset: normal.dot(point) }
    }

    /// The plane of a triangle, whose front is where the corners run counter-clockwise. For a triangle without area,
    /// some plane through it.
    pub(crate) fn of_triangle(corners: &[DVec3; 3]) -> Plane {
        let [a, b, c] = *corners;
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or_else(|| {
            let longest = [b - a, c - b, a - c]
                .into_iter()
                .max_by(|p, q| p.length_squared().total_cmp(&q.length_squared()));
            match longest.and_then(DVec3::try_normalize) {
                Some(edge) => edge.any_orthonormal_vector(),
                None => DVec3::X,
            }
        });
        Plane::through(a, normal)
    }

    /// Signed distance of a point, positive in front.
    #[inline]
    pub(crate) fn side(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// This plane seen from its other side.
    pub(crate) fn flipped(&self) -> Plane {
        Plane { normal: -self.normal, offset: -self.offset }
    }

    /// Minimum and maximum distance of some points.
    #[inline]
    pub(crate) fn range(&self, points: &[DVec3]) -> (f64, f64) {
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &p| {
            let side = self.side(p);
            (low.min(side), high.max(side))
        })
    }
}

/// The part of a convex polygon at distance `least` or more from a plane.
pub(crate) fn clip(polygon: &[DVec3], plane: &Plane, least: f64) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    let Some(&last) = polygon.last() else { return kept };
    let (mut from, mut from_side) = (last, plane.side(last) - least);
    for &to in polygon {
        let to_side = plane.side(to) - least;
        let (was_behind, is_behind) = (from_side < 0.0, to_side < 0.0);
        if was_behind != is_behind {
            kept.push(from + (to - from) * (from_side / (from_side - to_side)));
        }
        if !is_behind {
            kept.push(to);
        }
        (from, from_side) = (to, to_side);
    }
    kept
}

/// The corners of a triangle, unless it is not finite and hence never hit.
pub(crate) fn corners(triangle: &[[f32; 3]; 3]) -> Option<[DVec3; 3]> {
    let finite = triangle.iter().flatten().all(|c| c.is_finite());
    finite.then(|| triangle.map(|corner| DVec3::from(corner.map(f64::from))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clipping_keeps_what_is_in_front() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        let plane = Plane::through(DVec3::ZERO, DVec3::X);
        let half = clip(&square, &plane, 0.5);
        assert_eq!(half.len(), 4);
        assert_eq!(plane.range(&half), (0.5, 1.0));
        assert_eq!(clip(&square, &plane, -1.0), square);
        assert!(clip(&square, &plane, 2.0).is_empty());
    }

    #[test]
    fn triangles_without_area_have_a_plane_through_them() {
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 3.0];
        let (low, high) = Plane::of_triangle(&line).range(&line);
        assert!(low == 0.0 && high == 0.0);
        assert!(Plane::of_triangle(&[DVec3::ONE; 3]).normal.is_finite());
    }
}
