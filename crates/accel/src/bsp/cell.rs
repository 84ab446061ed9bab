//! Convex cells, for the areas that the surface-area heuristic needs. They affect only the quality of a tree, never
//! an answer.

use super::plane::Plane;
use bilux_math::DVec3;

/// A convex polyhedron: its faces one after the other, corners counter-clockwise seen from outside.
#[derive(Clone, Debug, Default)]
pub(super) struct Cell {
    points: Vec<DVec3>,
    faces: Vec<Face>,
    area: f64,
}

#[derive(Clone, Copy, Debug)]
struct Face {
    end: usize,
    area: f64,
}

impl Cell {
    /// The box between two corners.
    pub(super) fn of_box(low: DVec3, high: DVec3) -> Cell {
        let corner = |bits: usize| {
            let pick = |axis: usize| if bits >> axis & 1 == 0 { low[axis] } else { high[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        };
        let mut cell = Cell::default();
        for face in BOX_FACES {
            cell.points.extend(face.map(corner));
            cell.close();
        }
        cell
    }

    /// Surface area of the cell.
    pub(super) fn area(&self) -> f64 {
        self.area
    }

    /// The surface areas of the parts left and right of a plane.
    pub(super) fn areas(&self, plane: &Plane) -> [f64; 2] {
        let (mut left, mut right, mut cap) = (0.0, 0.0, FanArea::default());
        for (face, points) in self.faces() {
            let mut fan = FanArea::default();
            let (mut any_left, mut any_right, mut crossings) = (false, false, Crossings::default());
            around(points, plane, |corner| match corner {
                Corner::Left(point) => {
                    any_left = true;
                    fan.add(point);
                }
                Corner::Right(_) => any_right = true,
                Corner::Crossing(point, leaves) => {
                    fan.add(point);
                    crossings.add(point, leaves);
                }
            });
            match (any_left, any_right) {
                (true, true) => {
                    let part = fan.area().min(face.area);
                    left += part;
                    right += face.area - part;
                    cap.add_segment(crossings);
                }
                (false, true) => right += face.area,
                _ => left += face.area,
            }
        }
        let cap = if left > 0.0 && right > 0.0 { cap.area() } else { 0.0 };
        [left + cap, right + cap]
    }

    /// The parts left and right of a plane, each extended over the plane by `tolerance`. The pieces on a side reach
    /// that far, and a cell thinner than that would not contain the pieces it is meant to hold.
    pub(super) fn split(&self, plane: &Plane, tolerance: f64) -> [Cell; 2] {
        [self.cut(&plane.moved(tolerance), false), self.cut(&plane.moved(-tolerance), true)]
    }

    /// The part to the left of a plane, or to the right.
    fn cut(&self, plane: &Plane, right: bool) -> Cell {
        let (mut part, mut rim) = (Cell::default(), Vec::new());
        for (_, points) in self.faces() {
            around(points, plane, |corner| match corner {
                Corner::Left(point) if !right => part.points.push(point),
                Corner::Right(point) if right => part.points.push(point),
                Corner::Crossing(point, _) => {
                    part.points.push(point);
                    rim.push(point);
                }
                _ => {}
            });
            part.close();
        }
        let rim = in_order(rim, plane);
        if right {
            part.points.extend(rim.iter().rev())
        } else {
            part.points.extend(&rim)
        }
        part.close();
        part
    }

    fn faces(&self) -> impl Iterator<Item = (Face, &[DVec3])> {
        let mut start = 0;
        self.faces.iter().map(move |&face| {
            let points = &self.points[start..face.end];
            start = face.end;
            (face, points)
        })
    }

    /// Closes a face from the points added since the last one; drops them if they have no area.
    fn close(&mut self) {
        let start = self.faces.last().map_or(0, |face| face.end);
        let mut fan = FanArea::default();
        self.points[start..].iter().for_each(|&point| fan.add(point));
        let area = fan.area();
        if self.points.len() - start < 3 || area == 0.0 {
            self.points.truncate(start);
        } else {
            self.faces.push(Face { end: self.points.len(), area });
            self.area += area;
        }
    }
}

/// Corners of a box by their bits (x lowest), counter-clockwise seen from outside.
const BOX_FACES: [[usize; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

enum Corner {
    Left(DVec3),
    Right(DVec3),
    /// Point where an edge crosses the plane, and whether the edge leaves the left side there.
    Crossing(DVec3, bool),
}

/// Goes around a polygon and reports its corners and where its edges cross a plane. Corners in the plane count as
/// left.
#[inline]
fn around(points: &[DVec3], plane: &Plane, mut visit: impl FnMut(Corner)) {
    let Some(&last) = points.last() else { return };
    let (mut from, mut from_distance) = (last, plane.distance(last));
    for &to in points {
        let to_distance = plane.distance(to);
        let leaves = from_distance <= 0.0;
        if leaves != (to_distance <= 0.0) {
            let crossing = from + (to - from) * (from_distance / (from_distance - to_distance));
            visit(Corner::Crossing(crossing, leaves));
        }
        visit(if to_distance <= 0.0 { Corner::Left(to) } else { Corner::Right(to) });
        (from, from_distance) = (to, to_distance);
    }
}

/// The two points where a face crosses the plane.
#[derive(Default)]
struct Crossings {
    leaves: Option<DVec3>,
    returns: Option<DVec3>,
}

impl Crossings {
    fn add(&mut self, point: DVec3, leaves: bool) {
        let slot = if leaves { &mut self.leaves } else { &mut self.returns };
        *slot = Some(point);
    }
}

/// The area of a polygon, as half the length of a sum of cross products about its first point. The order of the
/// segments does not matter to the sum, so the rim of a cut need not be sorted to be measured.
#[derive(Default)]
struct FanArea {
    first: Option<DVec3>,
    last: DVec3,
    sum: DVec3,
}

impl FanArea {
    #[inline]
    fn add(&mut self, point: DVec3) {
        match self.first {
            None => self.first = Some(point),
            Some(first) => {
                let arm = point - first;
                self.sum += self.last.cross(arm);
                self.last = arm;
            }
        }
    }

    #[inline]
    fn add_segment(&mut self, crossings: Crossings) {
        if let Crossings { leaves: Some(from), returns: Some(to) } = crossings {
            let first = *self.first.get_or_insert(from);
            self.sum += (from - first).cross(to - first);
        }
    }

    #[inline]
    fn area(&self) -> f64 {
        self.sum.length() * 0.5
    }
}

/// The points of a convex polygon in a plane, counter-clockwise seen from the right of the plane.
fn in_order(mut points: Vec<DVec3>, plane: &Plane) -> Vec<DVec3> {
    let Some(&first) = points.first() else { return points };
    let middle = first + points.iter().map(|&p| p - first).sum::<DVec3>() / points.len() as f64;
    let (x_axis, y_axis) = plane.axes();
    points.sort_by(|&a, &b| {
        let key = |p: DVec3| pseudo_angle((p - middle).dot(x_axis), (p - middle).dot(y_axis));
        key(a).total_cmp(&key(b))
    });
    points.dedup();
    points
}

/// Grows with the angle of (x, y), from -2 to 2, without trigonometry.
fn pseudo_angle(x: f64, y: f64) -> f64 {
    let length = x.abs() + y.abs();
    if length == 0.0 {
        return 0.0;
    }
    if x >= 0.0 { y / length } else { (2.0 - y.abs() / length).copysign(y) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> Cell {
        Cell::of_box(DVec3::ZERO, DVec3::ONE)
    }

    #[test]
    fn a_box_is_closed_and_faces_outwards() {
        let cell = unit_box();
        assert_eq!(cell.area(), 6.0);
        for (_, points) in cell.faces() {
            let normal = (points[1] - points[0]).cross(points[2] - points[0]);
            assert!(normal.dot(points[0] - DVec3::splat(0.5)) > 0.0);
        }
    }

    #[test]
    fn a_corner_cut_off_leaves_the_known_areas() {
        let plane = Plane::through(DVec3::new(1.0, 0.0, 0.0), DVec3::ONE).unwrap();
        let triangle = f64::sqrt(3.0) / 2.0;
        let [left, right] = unit_box().areas(&plane);
        assert!((left - (1.5 + triangle)).abs() < 1e-6, "{left}");
        assert!((right - (4.5 + triangle)).abs() < 1e-6, "{right}");
    }

    #[test]
    fn areas_predict_the_result_of_a_split() {
        let mut cell = unit_box();
        for (point, normal) in [
            ([0.5, 0.5, 0.5], [0.3, -0.9, 0.2]),
            ([0.4, 0.2, 0.5], [1.0, 0.9, -0.8]),
            ([0.4, 0.3, 0.4], [0.0, 0.1, 1.0]),
            ([0.3, 0.3, 0.3], [1.0, 0.0, 0.0]),
        ] {
            let plane = Plane::through(DVec3::from(point), DVec3::from(normal)).unwrap();
            let areas = cell.areas(&plane);
            let parts = cell.split(&plane, 0.0);
            for (area, part) in areas.iter().zip(&parts) {
                assert!((area - part.area()).abs() < 1e-9, "{area} {}", part.area());
            }
            let [left, right] = parts;
            cell = if left.area() > right.area() { left } else { right };
        }
    }

    #[test]
    fn parts_extend_over_the_plane_by_the_tolerance() {
        let [left, right] = unit_box().split(&Plane::perpendicular(0, 0.5), 0.25);
        assert_eq!((left.area(), right.area()), (5.0, 5.0));
    }

    #[test]
    fn a_plane_that_misses_a_cell_leaves_it_whole() {
        let plane = Plane::perpendicular(1, 2.0);
        assert_eq!(unit_box().areas(&plane), [6.0, 0.0]);
        let [left, right] = unit_box().split(&plane, 0.1);
        assert_eq!((left.area(), right.area()), (6.0, 0.0));
    }
}
