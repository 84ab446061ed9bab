//! Computes normals for meshes without them.

use bilux_math::parallel::{map, table, threads};
use bilux_math::transcendental::cos;
use bilux_math::{DVec3, Vec3};

/// Smoothing of a face with its neighbours: [`FLAT`], [`BY_ANGLE`], or the number of a smoothing group.
pub type Smoothing = u32;
/// The face is flat, whatever its neighbours.
pub const FLAT: Smoothing = 0;
/// The face is smooth towards neighbours within the crease angle.
pub const BY_ANGLE: Smoothing = u32::MAX;

/// Polygons that share positions.
pub struct Faces<'a> {
    pub positions: &'a [Vec3],
    /// The position index of each corner, face after face; must be within `positions`.
    pub corners: Vec<u32>,
    /// The end of each face's corners; empty if all faces are triangles.
    pub ends: &'a [u32],
    /// The smoothing of each face; a single entry if all faces share it.
    pub smoothing: Vec<Smoothing>,
}

/// Normals that corners share, and the index for each corner.
#[derive(Debug, Default, PartialEq)]
pub struct CornerNormals {
    pub normals: Vec<Vec3>,
    /// For each corner, its index into the normals.
    pub of_corner: Vec<u32>,
    /// The position of each normal, which no two positions share.
    pub position_of: Vec<u32>,
}

impl CornerNormals {
    /// The position of each corner: those that the faces had, which need not be kept meanwhile.
    pub fn corners(&self) -> impl ExactSizeIterator<Item = u32> {
        self.of_corner.iter().map(|&normal| self.position_of[normal as usize])
    }
}

/// At positions with more faces than this all are averaged: comparing every pair would take too long.
const MAX_PAIRED: usize = 256;

/// The number of positions that a thread processes at a time.
const PIECE: usize = 1 << 14;

/// Number of faces whose normals one thread computes at least.
const LEAST: usize = 1 << 12;

/// The normal of a face, and its area.
#[derive(Clone, Copy)]
struct Facing {
    unit: Vec3,
    area: f32,
}

/// The cosines of the angle up to which faces are smooth towards each other, and of half of it.
struct Crease {
    whole: f32,
    half: f32,
}

/// The normals of some positions, and the index of the normal for each corner there.
#[derive(Default)]
struct PositionNormals {
    normals: Vec<Vec3>,
    /// The position of each normal.
    positions: Vec<u32>,
    indices: Vec<u32>,
    any_smooth: bool,
}

impl Faces<'_> {
    /// The normal of each corner: the area-weighted mean of the faces at its position that it is smooth towards.
    ///
    /// `None` if every corner would get its own face's normal, so that none are needed.
    pub fn corner_normals(self, crease_angle: f32) -> Option<CornerNormals> {
        let (normals, any_smooth) = self.normals_and_whether_needed(crease_angle);
        any_smooth.then_some(normals)
    }

    /// Normals of [`Faces::corner_normals`], whether or not they are needed.
    pub fn all_corner_normals(self, crease_angle: f32) -> CornerNormals {
        self.normals_and_whether_needed(crease_angle).0
    }

    /// Normals of [`Faces::corner_normals`], and whether they are needed.
    pub fn normals_and_whether_needed(mut self, crease_angle: f32) -> (CornerNormals, bool) {
        let angle = crease_angle.clamp(0.0, 180.0).to_radians();
        let crease = Crease { whole: cos(angle), half: cos(0.5 * angle) };
        let face_of = self.face_of();
        let facing = self.facing();
        let around = CornersByPosition::of(&self.corners, self.positions.len());
        let count = self.positions.len();
        let mut all = CornerNormals {
            normals: Vec::with_capacity(count),
            of_corner: std::mem::take(&mut self.corners),
            position_of: Vec::with_capacity(count),
        };
        let mut any_smooth = false;
        // Works in batches, to hold few intermediate results.
        let batch = PIECE * threads();
        for start in (0..count).step_by(batch) {
            let found = map((start..(start + batch).min(count)).step_by(PIECE), |start| {
                let mut found = PositionNormals::default();
                let mut here = Vec::new();
                for position in start..(start + PIECE).min(count) {
                    here.clear();
                    let faces = around.corners_at(position).iter().map(|&corner| match &face_of[..] {
                        [] => corner / 3,
                        each => each[corner as usize],
                    });
                    here.extend(faces);
                    self.add_position(&here, &facing, &crease, &mut found);
                    found.positions.resize(found.normals.len(), position as u32);
                }
                found
            });
            for (found, start) in found.into_iter().zip((start..count).step_by(PIECE)) {
                let first = all.normals.len() as u32;
                let corners = around.corners_from(start);
                for (&corner, index) in corners.iter().zip(found.indices) {
                    all.of_corner[corner as usize] = first + index;
                }
                all.normals.extend(found.normals);
                all.position_of.extend(found.positions);
                any_smooth |= found.any_smooth;
            }
        }
        (all, any_smooth)
    }

    /// Adds the normals of the corners of these faces at one position.
    fn add_position(&self, here: &[u32], facing: &[Facing], crease: &Crease, found: &mut PositionNormals) {
        let first = found.normals.len();
        let weighted = |&face: &u32| facing[face as usize].unit * facing[face as usize].area;
        let sum: Vec3 = here.iter().map(weighted).sum();
        let is_crowd = here.len() > MAX_PAIRED;
        let middle = sum.normalize_or_zero();
        // Faces within half of the crease angle of the mean are within the whole angle of each other.
        let near = |&face: &u32| facing[face as usize].unit.dot(middle) > crease.half + 1e-5;
        let goes_by_angle = |&face: &u32| self.smoothing_of(face) == BY_ANGLE;
        if !is_crowd && here.iter().all(near) && here.iter().all(goes_by_angle) {
            let leans = |&face: &u32| middle.dot(facing[face as usize].unit) < ALIKE;
            found.any_smooth = found.any_smooth || here.iter().any(leans);
            found.indices.extend(here.iter().map(|_| first as u32));
            found.normals.extend((!here.is_empty()).then_some(middle));
            return;
        }
        for &face in here {
            let own = facing[face as usize].unit;
            let normal = if is_crowd && self.smoothing_of(face) != FLAT {
                sum.normalize_or(own)
            } else {
                self.normal_at(&here[..here.len().min(MAX_PAIRED)], face, facing, crease.whole)
            };
            found.any_smooth |= own != Vec3::ZERO && normal.dot(own) < ALIKE;
            let known = found.normals[first..].iter().take(MAX_PAIRED).position(|&n| n == normal);
            let index = first + known.unwrap_or(found.normals.len() - first);
            if index == found.normals.len() {
                found.normals.push(normal);
            }
            found.indices.push(index as u32);
        }
    }

    /// The normal of a face at a position, given all faces there.
    fn normal_at(&self, here: &[u32], face: u32, facing: &[Facing], limit: f32) -> Vec3 {
        let own = facing[face as usize];
        let smoothing = self.smoothing_of(face);
        let mut sum = Vec3::ZERO;
        for &other in here {
            let theirs = facing[other as usize];
            let joined = match (smoothing, self.smoothing_of(other)) {
                (BY_ANGLE, BY_ANGLE) => other == face || own.unit.dot(theirs.unit) > limit,
                (a, b) => other == face || (a == b && a != FLAT),
            };
            if joined {
                sum += theirs.unit * theirs.area;
            }
        }
        sum.normalize_or(own.unit)
    }

    fn smoothing_of(&self, face: u32) -> Smoothing {
        if let [all] = self.smoothing[..] { all } else { self.smoothing[face as usize] }
    }

    fn facing(&self) -> Vec<Facing> {
        let at = |&corner: &u32| self.positions[corner as usize];
        let facing = |corners: &[u32]| {
            let normal = newell(corners.iter().map(at)).as_vec3();
            Facing { unit: normal.normalize_or_zero(), area: normal.length() }
        };
        if self.ends.is_empty() {
            let triangles = self.corners.as_chunks::<3>().0;
            return table(triangles.len(), LEAST, |face| facing(&triangles[face]));
        }
        let start = |face: usize| if face == 0 { 0 } else { self.ends[face - 1] as usize };
        table(self.ends.len(), LEAST, |face| facing(&self.corners[start(face)..self.ends[face] as usize]))
    }

    /// The face of each corner; empty if all faces are triangles.
    fn face_of(&self) -> Vec<u32> {
        let mut face_of = Vec::with_capacity(if self.ends.is_empty() { 0 } else { self.corners.len() });
        for (face, &end) in self.ends.iter().enumerate() {
            face_of.resize(end as usize, face as u32);
        }
        face_of
    }
}

/// The corners at each position.
struct CornersByPosition {
    /// The start of each position's corners.
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl CornersByPosition {
    fn of(position_of: &[u32], positions: usize) -> CornersByPosition {
        let mut starts = vec![0u32; positions + 2];
        for &position in position_of {
            starts[position as usize + 2] += 1;
        }
        for i in 2..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut corners = vec![0u32; position_of.len()];
        for (corner, &position) in position_of.iter().enumerate() {
            let slot = &mut starts[position as usize + 1];
            corners[*slot as usize] = corner as u32;
            *slot += 1;
        }
        CornersByPosition { starts, corners }
    }

    fn corners_at(&self, position: usize) -> &[u32] {
        &self.corners[self.starts[position] as usize..self.starts[position + 1] as usize]
    }

    /// The corners of a position and of all positions after it.
    fn corners_from(&self, position: usize) -> &[u32] {
        &self.corners[self.starts[position] as usize..]
    }
}

/// Directions with a cosine above this count as equal: about a twelfth of a degree.
const ALIKE: f32 = 1.0 - 1e-6;

/// The normal of a polygon by the right-hand rule, whose length is twice the area. [Newell 1972]
pub fn newell(points: impl Iterator<Item = Vec3>) -> DVec3 {
    let mut points = points.map(Vec3::as_dvec3);
    let Some(first) = points.next() else { return DVec3::ZERO };
    let (mut previous, mut sum) = (DVec3::ZERO, DVec3::ZERO);
    for point in points {
        // Relative to the first point, to keep the precision of polygons far from the origin.
        let point = point - first;
        sum += previous.cross(point);
        previous = point;
    }
    sum
}

/// The unit normal of a polygon, or zero.
pub fn unit_face_normal(points: &[Vec3]) -> Vec3 {
    newell(points.iter().copied()).try_normalize().map_or(Vec3::ZERO, DVec3::as_vec3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unit squares that share the edge x = 0, the second one folded up by an angle.
    fn hinge(degrees: f32, smoothing: [Smoothing; 2]) -> Option<Vec<Vec3>> {
        let angle = degrees.to_radians();
        let (s, c) = (bilux_math::transcendental::sin(angle), cos(angle));
        let far = Vec3::new(-c, 0.0, s);
        let positions = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y, far, far + Vec3::Y];
        let corners = vec![0u32, 1, 2, 3, 4, 0, 3, 5];
        Faces { positions: &positions, corners, ends: &[4, 8], smoothing: smoothing.to_vec() }
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
    fn corners_are_found_again_by_their_normals() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let corners = vec![0u32, 1, 2, 3, 1, 0, 2, 1, 3];
        for angle in [0.0, 180.0] {
            let faces = Faces {
                positions: &positions,
                corners: corners.clone(),
                ends: &[],
                smoothing: vec![BY_ANGLE],
            };
            let (found, _) = faces.normals_and_whether_needed(angle);
            assert_eq!(found.corners().collect::<Vec<_>>(), corners);
        }
    }

    #[test]
    fn normals_are_the_same_on_any_number_of_threads() {
        let n = 200u32;
        let height = |x: u32, y: u32| 0.3 * f32::from((x * 7919 + y * 104_729) as u8) / 255.0;
        let positions: Vec<Vec3> =
            (0..n * n).map(|i| Vec3::new((i % n) as f32, (i / n) as f32, height(i % n, i / n))).collect();
        assert!(positions.len() > 2 * PIECE);
        let quad = |x: u32, y: u32| [y * n + x, y * n + x + 1, (y + 1) * n + x + 1, (y + 1) * n + x];
        let of = |threads: usize, as_triangles: bool| {
            let quads = (0..(n - 1) * (n - 1)).map(|i| quad(i % (n - 1), i / (n - 1)));
            let corners: Vec<u32> = match as_triangles {
                true => quads.flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).collect(),
                false => quads.flatten().collect(),
            };
            let ends: Vec<u32> =
                (0..if as_triangles { 0 } else { corners.len() as u32 / 4 }).map(|i| 4 * i + 4).collect();
            let faces = Faces { positions: &positions, corners, ends: &ends, smoothing: vec![BY_ANGLE] };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| faces.all_corner_normals(30.0))
        };
        for as_triangles in [true, false] {
            assert_eq!(of(1, as_triangles), of(3, as_triangles));
        }
    }

    #[test]
    fn smoothing_groups_overrule_the_angle() {
        assert!(hinge(80.0, [7, 7]).is_some());
        assert_eq!(hinge(10.0, [7, 8]), None);
        assert_eq!(hinge(10.0, [FLAT, FLAT]), None);
    }
}
