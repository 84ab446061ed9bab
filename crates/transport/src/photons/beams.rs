//! The rays of the light subpaths of one iteration through media that are the same everywhere, indexed by place, for camera
//! subpaths to merge with where the two come close. [Jarosz 2011; Křivánek 2014]

use crate::photons::beam::{Beam, Line};
use bilux_math::Vec3;

/// All beams of an iteration, in a grid of cells that each list the beams that come near.
pub(crate) struct PhotonBeams<const N: usize = 1> {
    /// Beams that are no further apart are merged, in metres.
    radius: f32,
    beams: Vec<Beam<N>>,
    /// Their lines: all that is read of most.
    lines: Vec<Line>,
    cells: Cells,
    /// `starts[c]..starts[c + 1]` of `listed` are the beams near cell `c`, in order.
    starts: Vec<u32>,
    listed: Vec<u32>,
}

/// A box that is divided into cubes.
struct Cells {
    min: Vec3,
    /// The length of their sides, in metres.
    side: f32,
    counts: [u32; 3],
}

/// Cells along the longest side of the box, at most: more of them list more beams altogether, but fewer each.
const MAX_CELLS: f32 = 64.0;

/// Beams that cells may list altogether, about.
const MAX_LISTED: f32 = 16e6;

impl<const N: usize> PhotonBeams<N> {
    /// Sorts beams into cells, in the order in which they are given.
    pub(crate) fn new(beams: Vec<Beam<N>>, radius: f32) -> PhotonBeams<N> {
        let cells = Cells::around(beams.iter().map(|beam| &beam.line), radius);
        let mut starts = vec![0_u32; cells.len() + 2];
        for beam in &beams {
            cells.near(&beam.line, radius, |cell| starts[cell + 2] += 1);
        }
        for i in 2..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut listed = vec![0; starts[starts.len() - 1] as usize];
        for (i, beam) in beams.iter().enumerate() {
            cells.near(&beam.line, radius, |cell| {
                let place = &mut starts[cell + 1];
                listed[*place as usize] = i as u32;
                *place += 1;
            });
        }
        starts.pop();
        let lines = beams.iter().map(|beam| beam.line).collect();
        PhotonBeams { radius, beams, lines, cells, starts, listed }
    }

    /// Calls `visit` with every beam that a line comes near, and the distances along the line and along the beam to where they are
    /// closest.
    #[inline]
    pub(crate) fn crossing(&self, line: &Line, mut visit: impl FnMut(&Beam<N>, [f32; 2])) {
        self.cells.along(line, |cell, [enter, leave]| {
            let listed = self.starts[cell] as usize..self.starts[cell + 1] as usize;
            for &i in &self.listed[listed] {
                // Each pair has one closest point, in one cell.
                if let Some([t, along]) = line.closest(&self.lines[i as usize], self.radius)
                    && enter <= t
                    && t < leave
                {
                    visit(&self.beams[i as usize], [t, along]);
                }
            }
        });
    }
}

impl Cells {
    fn around<'l>(lines: impl Iterator<Item = &'l Line> + Clone, radius: f32) -> Cells {
        let count = lines.clone().count();
        if count == 0 {
            return Cells { min: Vec3::ZERO, side: 1.0, counts: [0; 3] };
        }
        let ends = lines.flat_map(|line| [line.origin, line.end()]);
        let (min, max) = ends.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
        let (min, max) = (min - radius, max + radius);
        // A beam is listed by two cells in each layer that it passes, more or less.
        let beams = count as f32;
        let along = (2.0 * beams.sqrt()).min(MAX_CELLS).min(MAX_LISTED / (2.0 * beams)).max(1.0);
        let side = ((max - min).max_element() / along).max(2.0 * radius);
        let counts = ((max - min) / side).ceil().to_array().map(|count| count.max(1.0) as u32);
        Cells { min, side, counts }
    }

    fn len(&self) -> usize {
        self.counts.iter().map(|&count| count as usize).product()
    }

    #[inline]
    fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        (z as usize * self.counts[1] as usize + y as usize) * self.counts[0] as usize + x as usize
    }

    /// The cell along an axis that this coordinate belongs to, or the nearest one.
    #[inline]
    fn cell(&self, axis: usize, x: f32) -> u32 {
        (((x - self.min[axis]) / self.side) as u32).min(self.counts[axis] - 1)
    }

    /// Visits every cell that has a point within the radius of a line, and some more.
    fn near(&self, line: &Line, radius: f32, mut visit: impl FnMut(usize)) {
        // Somewhat wider, since cells along a line are found by other sums.
        let radius = radius + 1e-3 * self.side;
        let direction = line.direction.to_array();
        let axis = (0..3).fold(0, |a, b| if direction[b].abs() > direction[a].abs() { b } else { a });
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let (a, b) = (line.origin[axis], line.end()[axis]);
        for layer in self.cell(axis, a.min(b) - radius)..=self.cell(axis, a.max(b) + radius) {
            let begin = self.min[axis] + layer as f32 * self.side;
            let ends = [begin - radius, begin + self.side + radius];
            let ends = ends.map(|x| ((x - a) / direction[axis]).clamp(0.0, line.length));
            let [p, q] = ends.map(|t| line.at(t));
            let range =
                |k: usize| self.cell(k, p[k].min(q[k]) - radius)..=self.cell(k, p[k].max(q[k]) + radius);
            for v in range(others[1]) {
                for u in range(others[0]) {
                    let mut cell = [layer; 3];
                    (cell[others[0]], cell[others[1]]) = (u, v);
                    visit(self.index(cell));
                }
            }
        }
    }

    /// Visits the cells that a line passes, with the distances at which it enters and leaves them. [Amanatides 1987]
    #[inline]
    fn along(&self, line: &Line, mut visit: impl FnMut(usize, [f32; 2])) {
        if self.len() == 0 {
            return;
        }
        let (origin, direction) = (line.origin.to_array(), line.direction.to_array());
        let (mut enter, mut end) = (0.0_f32, line.length.next_up());
        for k in 0..3 {
            let walls = [self.min[k], self.min[k] + self.counts[k] as f32 * self.side];
            if direction[k] == 0.0 {
                if origin[k] < walls[0] || origin[k] > walls[1] {
                    return;
                }
                continue;
            }
            let [a, b] = walls.map(|x| (x - origin[k]) / direction[k]);
            (enter, end) = (enter.max(a.min(b)), end.min(a.max(b)));
        }
        if enter >= end {
            return;
        }
        let at = line.at(enter);
        let mut cell: [u32; 3] = std::array::from_fn(|k| self.cell(k, at[k]));
        let wall = |k: usize, cell: u32| match direction[k] {
            0.0 => f32::INFINITY,
            d => (self.min[k] + (cell + u32::from(d > 0.0)) as f32 * self.side - origin[k]) / d,
        };
        let mut walls: [f32; 3] = std::array::from_fn(|k| wall(k, cell[k]));
        loop {
            let k = (0..3).fold(0, |a, b| if walls[b] < walls[a] { b } else { a });
            let leave = walls[k].min(end);
            visit(self.index(cell), [enter, leave]);
            if leave >= end {
                return;
            }
            enter = enter.max(leave);
            let next = if direction[k] > 0.0 { cell[k].checked_add(1) } else { cell[k].checked_sub(1) };
            match next.filter(|&next| next < self.counts[k]) {
                Some(next) => cell[k] = next,
                None => return,
            }
            walls[k] = wall(k, cell[k]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Vec2;
    use bilux_math::hash::{hash_words, unit_f32};
    use bilux_math::warp::sample_sphere;

    /// Lines of a cube; some lie along an axis.
    fn line(i: u64) -> Line {
        let u = |k: u64| unit_f32(hash_words([i, k]) as u32);
        let direction = match i % 10 {
            k @ 0..3 => Vec3::AXES[k as usize] * if i % 4 < 2 { 1.0 } else { -1.0 },
            _ => sample_sphere(Vec2::new(u(3), u(4))),
        };
        Line { origin: Vec3::new(u(0), u(1), u(2)), direction, length: 0.01 + u(5) * u(5) * 1.5 }
    }

    #[test]
    fn each_beam_that_is_near_is_crossed_once() {
        let mut met = 0;
        for (count, radius) in [(0, 0.1), (1, 0.05), (9, 0.2), (300, 0.02), (4000, 0.003)] {
            let beams: Vec<Beam> = (0..count).map(|i| Beam::of_line(line(i), i as u16)).collect();
            let all = PhotonBeams::new(beams.clone(), radius);
            for ray in (0..400).map(|i| line(1 << 32 | i)) {
                let mut found = Vec::new();
                all.crossing(&ray, |beam, [t, along]| {
                    let apart = ray.at(t).distance(beam.line.at(along));
                    assert!(apart <= radius * 1.001 + 1e-6, "{apart}");
                    found.push(beam.subpath.origin);
                });
                found.sort_unstable();
                let is_near = |beam: &&Beam| ray.closest(&beam.line, radius).is_some();
                met += found.len();
                assert!(
                    beams.iter().filter(is_near).map(|beam| beam.subpath.origin).eq(found),
                    "{count} {radius}"
                );
            }
        }
        assert!(met > 500, "{met}");
    }

    #[test]
    fn lines_are_closest_where_a_search_finds_it() {
        let distance = |a: &Line, b: &Line, [t, along]: [f32; 2]| a.at(t).distance(b.at(along));
        let mut crossed = 0;
        for i in 0..200 {
            let (a, b) = (line(i), line(1 << 33 | i));
            let Some([t, along]) = a.closest(&b, 0.3) else { continue };
            crossed += 1;
            let least = distance(&a, &b, [t, along]);
            for step in [1e-2, -1e-2] {
                assert!(distance(&a, &b, [t + step, along]) > least);
                assert!(distance(&a, &b, [t, along + step]) > least);
            }
        }
        assert!(crossed > 5, "{crossed}");
    }
}
