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

/// Normals that corners share, and which each has.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct CornerNormals {
    pub(crate) normals: Vec<Vec3>,
    /// For each corner an index into the normals.
    pub(crate) of_corner: Vec<u32>,
}

/// Where more faces meet than this, all are averaged: looking at every pair would take too long.
const MOST_PAIRED: usize = 256;

/// The normal of a face, and its area.
#[derive(Clone, Copy)]
struct Facing {
    unit: Vec3,
    area: f32,
}

impl<P: Fn(usize) -> u32> Faces<'_, P> {
    /// A normal for each corner: the area-weighted mean of the faces around its position that it is smooth
    /// towards. `None` where that is each face's own normal everywhere, so that none are needed.
    pub(crate) fn corner_normals(&self, crease_angle: f32) -> Option<CornerNormals> {
        let (normals, any_smooth) = self.normals_and_whether_needed(crease_angle);
        any_smooth.then_some(normals)
    }

    /// The same, needed or not.
    pub(crate) fn all_corner_normals(&self, crease_angle: f32) -> CornerNormals {
        self.normals_and_whether_needed(crease_angle).0
    }

    fn normals_and_whether_needed(&self, crease_angle: f32) -> (CornerNormals, bool) {
        let limit = cos(crease_angle.clamp(0.0, 180.0).to_radians());
        let facing = self.facing();
        let around = self.around();
        let mut any_smooth = false;
        let mut result = CornerNormals { normals: Vec::new(), of_corner: vec![0; self.corner_count()] };
        for position in 0..self.positions.len() {
            let first = result.normals.len();
            let here = around.of(position);
            let weighted = |&(_, face): &(u32, u32)| facing[face as usize].unit * facing[face as usize].area;
            let crowd: Option<Vec3> = (here.len() > MOST_PAIRED).then(|| here.iter().map(weighted).sum());
            for &(corner, face) in here {
                let normal = match crowd {
                    Some(sum) if self.smoothing[face as usize] != FLAT => {
                        sum.normalize_or(facing[face as usize].unit)
                    }
                    _ => self.normal_at(&here[..here.len().min(MOST_PAIRED)], face, &facing, limit),
                };
                let own = facing[face as usize].unit;
                any_smooth |= own != Vec3::ZERO && normal.dot(own) < ALIKE;
                let known = result.normals[first..].iter().take(MOST_PAIRED).position(|&n| n == normal);
                let index = first + known.unwrap_or(result.normals.len() - first);
                if index == result.normals.len() {
                    result.normals.push(normal);
                }
                result.of_corner[corner as usize] = index as u32;
            }
        }
        (result, any_smooth)
    }

    /// The normal of a face at a position, among the corners there.
    fn normal_at(&self, here: &[(u32, u32)], face: u32, facing: &[Facing], limit: f32) -> Vec3 {
        let own = facing[face as usize];
        let smoothing = self.smoothing[face as usize];
        let mut sum = Vec3::ZERO;
        for &(_, other) in here {
            let theirs = facing[other as usize];
            let joined = match (smoothing, self.smoothing[other as usize]) {
                (BY_ANGLE, BY_ANGLE) => other == face || own.unit.dot(theirs.unit) > limit,
                (a, b) => other == face || (a == b && a != FLAT),
            };
            if joined {
                sum += theirs.unit * theirs.area;
            }
        }
        sum.normalize_or(own.unit)
    }

    fn corner_count(&self) -> usize {
        self.ends.last().map_or(0, |&end| end as usize)
    }

    fn corners(&self, face: usize) -> std::ops::Range<usize> {
        let start = if face == 0 { 0 } else { self.ends[face - 1] };
        start as usize..self.ends[face] as usize
    }

    fn facing(&self) -> Vec<Facing> {
        let at = |corner| self.positions[(self.position_of)(corner) as usize];
        let facing = |face| {
            let normal = newell(self.corners(face).map(at)).as_vec3();
            Facing { unit: normal.normalize_or_zero(), area: normal.length() }
        };
        (0..self.ends.len()).map(facing).collect()
    }

    /// For each position the corners there, with their faces.
    fn around(&self) -> Around {
        let mut starts = vec![0u32; self.positions.len() + 2];
        for corner in 0..self.corner_count() {
            starts[(self.position_of)(corner) as usize + 2] += 1;
        }
        for i in 2..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut corners = vec![(0u32, 0u32); self.corner_count()];
        for face in 0..self.ends.len() {
            for corner in self.corners(face) {
                let slot = &mut starts[(self.position_of)(corner) as usize + 1];
                corners[*slot as usize] = (corner as u32, face as u32);
                *slot += 1;
            }
        }
        Around { starts, corners }
    }
}

/// A cosine from which on two directions count as one: about a twelfth of a degree.
const ALIKE: f32 = 1.0 - 1e-6;

struct Around {
    /// Where each position's corners start.
    starts: Vec<u32>,
    corners: Vec<(u32, u32)>,
}

impl Around {
    fn of(&self, position: usize) -> &[(u32, u32)] {
        &self.corners[self.starts[position] as usize..self.starts[position + 1] as usize]
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
            .map(|found| found.of_corner.iter().map(|&i| found.normals[i as usize]).collect())
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
