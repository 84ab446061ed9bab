//! Normals for meshes that bring none.

use bilux_math::transcendental::cos;
use bilux_math::{DVec3, Vec3};

/// How a face joins its neighbours: [`FLAT`], [`BY_ANGLE`], or the number of a group that is smooth.
pub(crate) type Smoothing = u32;
/// A face that is flat whatever its neighbours.
pub(crate) const FLAT: Smoothing = 0;
/// A face that is smooth towards neighbours at less than the crease angle.
pub(crate) const BY_ANGLE: Smoothing = u32::MAX;

/// Polygons over shared positions; the corners of face `f` are `ends[f - 1]..ends[f]`.
pub(crate) struct Faces<'a, P> {
    pub(crate) positions: &'a [Vec3],
    /// Where each face's corners end.
    pub(crate) ends: &'a [u32],
    /// The position of a corner; must be within `positions`.
    pub(crate) position_of: P,
    /// How each face joins its neighbours.
    pub(crate) smoothing: &'a [Smoothing],
}

/// Where more faces meet than this, all are averaged: looking at every pair would take too long.
const MOST_PAIRED: usize = 256;

impl<P: Fn(usize) -> u32> Faces<'_, P> {
    /// A normal for each corner: the area-weighted mean of the faces around its position that it is smooth
    /// towards. `None` where that is each face's own normal everywhere, so that none are needed.
    pub(crate) fn corner_normals(&self, crease_angle: f32) -> Option<Vec<Vec3>> {
        let (normals, any_smooth) = self.normals_and_whether_needed(crease_angle);
        any_smooth.then_some(normals)
    }

    /// The same, needed or not.
    pub(crate) fn all_corner_normals(&self, crease_angle: f32) -> Vec<Vec3> {
        self.normals_and_whether_needed(crease_angle).0
    }

    fn normals_and_whether_needed(&self, crease_angle: f32) -> (Vec<Vec3>, bool) {
        let limit = cos(crease_angle.clamp(0.0, 180.0).to_radians());
        let areas = self.face_normals();
        let around = self.faces_around();
        let mut any_smooth = false;
        let mut normals = Vec::with_capacity(self.corner_count());
        for face in 0..self.ends.len() {
            let own = areas[face];
            for corner in self.corners(face) {
                let neighbours = around.of((self.position_of)(corner));
                let many = neighbours.len() > MOST_PAIRED && self.smoothing[face] != FLAT;
                let mut sum = Vec3::ZERO;
                for &other in neighbours {
                    let other = other as usize;
                    if other == face || many || self.smooth_between(face, other, &areas, limit) {
                        sum += areas[other];
                    }
                }
                let normal = sum.normalize_or_zero();
                any_smooth |= own != Vec3::ZERO && normal.dot(own) < own.length() * ALIKE;
                normals.push(normal);
            }
        }
        (normals, any_smooth)
    }

    fn smooth_between(&self, a: usize, b: usize, areas: &[Vec3], limit: f32) -> bool {
        match (self.smoothing[a], self.smoothing[b]) {
            (BY_ANGLE, BY_ANGLE) => {
                let (a, b) = (areas[a], areas[b]);
                a.dot(b) > limit * (a.length() * b.length())
            }
            (a, b) => a == b && a != FLAT,
        }
    }

    fn corner_count(&self) -> usize {
        self.ends.last().map_or(0, |&end| end as usize)
    }

    fn corners(&self, face: usize) -> std::ops::Range<usize> {
        let start = if face == 0 { 0 } else { self.ends[face - 1] };
        start as usize..self.ends[face] as usize
    }

    /// Normals as long as the faces' areas are large.
    fn face_normals(&self) -> Vec<Vec3> {
        let at = |corner| self.positions[(self.position_of)(corner) as usize];
        let normal = |face| newell(self.corners(face).map(at)).as_vec3();
        (0..self.ends.len()).map(normal).collect()
    }

    /// For each position the faces around it.
    fn faces_around(&self) -> Around {
        let mut starts = vec![0u32; self.positions.len() + 2];
        for corner in 0..self.corner_count() {
            starts[(self.position_of)(corner) as usize + 2] += 1;
        }
        for i in 2..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut faces = vec![0u32; self.corner_count()];
        for face in 0..self.ends.len() {
            for corner in self.corners(face) {
                let slot = &mut starts[(self.position_of)(corner) as usize + 1];
                faces[*slot as usize] = face as u32;
                *slot += 1;
            }
        }
        Around { starts, faces }
    }
}

/// A cosine from which on two directions count as one: about a twelfth of a degree.
const ALIKE: f32 = 1.0 - 1e-6;

struct Around {
    /// Where each position's faces start.
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Around {
    fn of(&self, position: u32) -> &[u32] {
        let i = position as usize;
        &self.faces[self.starts[i] as usize..self.starts[i + 1] as usize]
    }
}

/// The normal of a polygon, as long as twice its area, by the right-hand rule. [Newell 1972]
pub(crate) fn newell(points: impl Iterator<Item = Vec3>) -> DVec3 {
    let mut points = points.map(Vec3::as_dvec3);
    let Some(first) = points.next() else { return DVec3::ZERO };
    let (mut previous, mut sum) = (DVec3::ZERO, DVec3::ZERO);
    for point in points {
        // Relative to the first point, so that what is far away keeps its digits.
        let point = point - first;
        sum += previous.cross(point);
        previous = point;
    }
    sum
}

/// The unit normal of a polygon, or zero.
pub(crate) fn unit_face_normal(points: &[Vec3]) -> Vec3 {
    newell(points.iter().copied()).try_normalize().map_or(Vec3::ZERO, DVec3::as_vec3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unit squares that share the edge x = 0, the second turned up by an angle.
    fn hinge(degrees: f32, smoothing: [Smoothing; 2]) -> Option<Vec<Vec3>> {
        let angle = degrees.to_radians();
        let (s, c) = (bilux_math::transcendental::sin(angle), cos(angle));
        let far = Vec3::new(-c, 0.0, s);
        let positions = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y, far, far + Vec3::Y];
        let corners = [0u32, 1, 2, 3, 4, 0, 3, 5];
        Faces { positions: &positions, ends: &[4, 8], position_of: |c| corners[c], smoothing: &smoothing }
            .corner_normals(40.0)
    }

    #[test]
    fn creases_stay_sharp_and_gentle_bends_become_smooth() {
        assert_eq!(hinge(0.0, [BY_ANGLE; 2]), None);
        assert_eq!(hinge(60.0, [BY_ANGLE; 2]), None);
        let normals = hinge(30.0, [BY_ANGLE; 2]).unwrap();
        assert_eq!(normals[1], Vec3::Z);
        let halfway = 15f32.to_radians();
        assert!(
            (normals[0] - Vec3::new(bilux_math::transcendental::sin(halfway), 0.0, cos(halfway))).length()
                < 1e-6
        );
        assert_eq!(normals[0], normals[5]);
    }

    #[test]
    fn smoothing_groups_overrule_the_angle() {
        assert!(hinge(80.0, [7, 7]).is_some());
        assert_eq!(hinge(10.0, [7, 8]), None);
        assert_eq!(hinge(10.0, [FLAT, FLAT]), None);
    }
}
