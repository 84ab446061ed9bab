//! Partition planes as a tree stores them, and the side of a plane on which something lies.

use bilux_math::{Aabb, DVec3, Vec3};

/// The origin of a tree's own coordinates, and their precision.
///
/// Planes are stored in f32 relative to the centre of the mesh, so that their rounding is bounded by the size of the
/// mesh, however far the mesh is from the origin. Builders work in f64.
#[derive(Clone, Copy, Debug)]
pub(super) struct Space {
    /// Centre of the mesh.
    pub(super) centre: Vec3,
    /// Largest distance that counts as touching a plane: 8 · 2⁻²⁴ of half the largest extent of the mesh. A plane through points of
    /// the mesh, once its coefficients are rounded to f32, is never further from them.
    pub(super) tolerance: f64,
}

impl Space {
    pub(super) fn new(bounds: &Aabb) -> Space {
        if bounds.is_empty() {
            return Space { centre: Vec3::ZERO, tolerance: 0.0 };
        }
        let centre = bounds.centre();
        let half = 0.5 * (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max_element();
        Space { centre, tolerance: half * (8.0 / 16_777_216.0) }
    }

    /// A vertex in the tree's coordinates.
    pub(super) fn local(&self, vertex: [f32; 3]) -> DVec3 {
        Vec3::from(vertex).as_dvec3() - self.centre.as_dvec3()
    }
}

/// A plane: the points where `normal · x = at`. The coefficients are exact f32 values, whatever type holds them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    normal: DVec3,
    at: f64,
    /// The axis that the normal points along, or 3.
    axis: u8,
}

/// The side of a plane on which something lies, within the tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Points where `normal · x` is less.
    Left,
    /// Points where `normal · x` is greater.
    Right,
    /// In the plane.
    On,
    /// Reaches into both sides.
    Both,
}

/// A normal that deviates less than this from an axis is snapped to it: the plane then moves by less than the
/// tolerance.
const NEARLY_STRAIGHT: f64 = 1.0 / 16_777_216.0;

impl Plane {
    /// The plane perpendicular to an axis.
    pub(super) fn perpendicular(axis: usize, at: f64) -> Plane {
        Plane { normal: DVec3::AXES[axis], at: f64::from(at as f32), axis: axis as u8 }
    }

    /// The plane through a point; `None` when the normal has no direction.
    pub(super) fn through(point: DVec3, normal: DVec3) -> Option<Plane> {
        let normal = normal.try_normalize()?;
        let slant = |axis: usize| (normal - normal[axis] * DVec3::AXES[axis]).abs().max_element();
        if let Some(axis) = (0..3).find(|&axis| slant(axis) < NEARLY_STRAIGHT) {
            return Some(Plane::perpendicular(axis, point[axis]));
        }
        let normal = normal.as_vec3().as_dvec3();
        Some(Plane { normal, at: f64::from(normal.dot(point) as f32), axis: 3 })
    }

    /// The plane moved to the right by a distance; no longer exactly f32, so not for a tree.
    pub(super) fn moved(&self, by: f64) -> Plane {
        Plane { at: self.at + by, ..*self }
    }

    /// The axis that it is perpendicular to, if any.
    pub(super) fn axis(&self) -> Option<usize> {
        (self.axis < 3).then_some(usize::from(self.axis))
    }

    /// The normal, and the distance from the origin of the tree's coordinates.
    pub(super) fn coefficients(&self) -> ([f32; 3], f32) {
        (self.normal.as_vec3().to_array(), self.at as f32)
    }

    /// Two directions within the plane; with the normal they form a right-handed frame.
    pub(super) fn axes(&self) -> (DVec3, DVec3) {
        let x = self.normal.any_orthonormal_vector();
        (x, self.normal.cross(x))
    }

    /// Signed distance, positive on the right.
    #[inline(always)]
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.at
    }

    /// The side on which the convex hull of some points lies.
    #[inline]
    pub(super) fn side(&self, points: &[DVec3], tolerance: f64) -> Side {
        let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        for &point in points {
            let distance = self.distance(point);
            least = least.min(distance);
            greatest = greatest.max(distance);
        }
        match (least < -tolerance, greatest > tolerance) {
            (true, false) => Side::Left,
            (false, true) => Side::Right,
            (false, false) => Side::On,
            (true, true) => Side::Both,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Stream;

    /// Half the largest extent times 8 · 2⁻²⁴ is enough, and an eighth of that is not.
    #[test]
    fn planes_through_points_of_a_mesh_pass_them_within_the_tolerance() {
        let bounds = Aabb { min: Vec3::new(-1.0, -3.0, -2.0) + 10.0, max: Vec3::new(1.0, 3.0, 2.0) + 10.0 };
        let Space { centre, tolerance } = Space::new(&bounds);
        assert_eq!((centre, tolerance), (Vec3::splat(10.0), 3.0 * 8.0 / 16_777_216.0));
        let mut stream = Stream::new([5]);
        let mut farthest = 0.0f64;
        for i in 0..100_000 {
            // Every other one nearly along an axis.
            let flat = if i % 2 == 0 { 1.0 } else { 3e-7 };
            let mut point = || {
                let mut at = || 2.0 * stream.uniform() - 1.0;
                DVec3::new(at(), 3.0 * at(), 2.0 * flat * at())
            };
            let [a, b, c] = [point(), point(), point()];
            let Some(plane) = Plane::through(a, (b - a).cross(c - a)) else { continue };
            farthest = [a, b, c].into_iter().fold(farthest, |far, p| far.max(plane.distance(p).abs()));
        }
        assert!((tolerance / 8.0..tolerance).contains(&farthest), "{farthest}, not {tolerance}");
    }
}
