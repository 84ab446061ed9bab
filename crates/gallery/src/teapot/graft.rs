//! The outlines where the teapot's tubes meet its body, to which both are cut.

use super::{Cubic, PROFILE, Patch, SHOULDER, TUBES, half_of, quarter_of};
use bilux_math::transcendental::atan2_f64;
use bilux_math::{DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;

/// A tube of two patches, with a parameter from 0 to 2.
pub(super) struct Tube {
    halves: [&'static [[f64; 5]; 4]; 2],
}

impl Tube {
    pub(super) const HANDLE: Tube = Tube { halves: [&TUBES[0], &TUBES[1]] };
    pub(super) const SPOUT: Tube = Tube { halves: [&TUBES[2], &TUBES[3]] };

    /// The point and normal at step `t` of `2 n` around the tube, and at parameter `s` along it.
    pub(super) fn at(&self, t: u32, n: u32, s: f64) -> (DVec3, DVec3) {
        let patch: Patch = half_of(self.halves[usize::from(s > 1.0)]);
        let u = Cubic::new(if t <= n { t } else { 2 * n - t }, n);
        let (p, normal) = patch.blend(&u, &Cubic::at(if s > 1.0 { s - 1.0 } else { s }));
        let mirror = |v: DVec3| if t <= n { v } else { DVec3::new(v.x, v.y, 0.0 - v.z) };
        (mirror(p), mirror(normal))
    }
}

/// The seam where a tube meets the body.
pub(super) struct Graft {
    /// Points around the tube: the position in cells of the body, and the point with the body's normal.
    pub(super) ring: Vec<(DVec2, (DVec3, DVec3))>,
    /// The tube's parameter at each of these.
    pub(super) ends: Vec<f64>,
    /// The range of cells removed from the body (first, last plus one), around and down.
    cells: [[u32; 2]; 2],
    /// The number of cells around the body.
    around: u32,
    /// The centre of the ring, in cells; then half of its width and height.
    middle: DVec2,
    half: DVec2,
}

impl Graft {
    pub(super) fn spout(n: u32) -> Graft {
        Graft::new(&Tube::SPOUT, n, 0.0, 1.0)
    }

    pub(super) fn handle_top(n: u32) -> Graft {
        Graft::new(&Tube::HANDLE, n, 0.0, 1.0)
    }

    pub(super) fn handle_foot(n: u32) -> Graft {
        Graft::new(&Tube::HANDLE, n, 2.0, 1.0)
    }

    /// Finds where the tube leaves the body, between its parameters `inside` and `outside`.
    fn new(tube: &Tube, n: u32, inside: f64, outside: f64) -> Graft {
        let ends: Vec<f64> = (0..2 * n)
            .map(|t| {
                let (mut a, mut b) = (inside, outside);
                for _ in 0..60 {
                    let middle = (a + b) * 0.5;
                    if BodyPoint::of(tube.at(t, n, middle).0).outside > 0.0 { b = middle } else { a = middle }
                }
                a
            })
            .collect();
        let around_and_down = |p: DVec3| {
            let at = BodyPoint::of(p);
            (DVec2::new(at.around, at.down) * f64::from(n), (p, at.normal))
        };
        let ring: Vec<_> = (0..2 * n).map(|t| around_and_down(tube.at(t, n, ends[t as usize]).0)).collect();
        let (mut low, mut high) = (ring[0].0, ring[0].0);
        for (cell, _) in &ring {
            (low, high) = (low.min(*cell), high.max(*cell));
        }
        let (first, last) = ((low - 0.25).floor(), (high + 0.25).ceil());
        let cells = [[first.x as u32, last.x as u32], [first.y as u32, last.y as u32]];
        Graft { ring, ends, cells, around: 4 * n, middle: (low + high) * 0.5, half: (high - low) * 0.5 }
    }

    pub(super) fn takes(&self, i: u32, down: u32) -> bool {
        let [[i0, i1], [j0, j1]] = self.cells;
        let columns = i0..i1;
        // The spout's cells continue beyond the last quarter.
        (j0..j1).contains(&down) && (columns.contains(&i) || columns.contains(&(i + self.around)))
    }

    /// Corners around the removed cells.
    pub(super) fn outline(&self) -> Vec<(u32, u32)> {
        let [[i0, i1], [j0, j1]] = self.cells;
        let right = (i0..i1).map(|i| (i, j0));
        let down = (j0..j1).map(|j| (i1, j));
        let left = (i0 + 1..=i1).rev().map(|i| (i, j1));
        let up = (j0 + 1..=j1).rev().map(|j| (i0, j));
        right.chain(down).chain(left).chain(up).collect()
    }

    pub(super) fn angle(&self, cell: DVec2) -> f64 {
        let d = (cell - self.middle) / self.half;
        atan2_f64(d.y, d.x)
    }
}

/// A point in the coordinates of the body, which is a profile swept along a curve that is nearly a circle.
struct BodyPoint {
    /// Distance outside the body, in units of the profile's radius.
    outside: f64,
    /// Quarter turns from +z over -x and -z to +x and beyond, so that neither spout nor handle crosses the end.
    around: f64,
    /// Position down the profile, in curves.
    down: f64,
    normal: DVec3,
}

impl BodyPoint {
    fn of(p: DVec3) -> BodyPoint {
        let turn = atan2_f64(p.z, p.x) / FRAC_PI_2;
        // The spout is at 0, where the quarters begin and end: count it as 4.
        let around = if turn < 1.0 { turn + 4.0 } else { turn };
        let quarter = around.floor() as usize % 4;
        let wanted = (around - around.floor()) * FRAC_PI_2;
        let arc = [[1.0, 0.0, 0.0], [1.0, 0.56, 0.0], [0.56, 1.0, 0.0], [0.0, 1.0, 0.0]].map(DVec3::from);
        let u = solve(|u| {
            let q = Cubic::at(u).blend(&arc);
            atan2_f64(q.y, q.x) - wanted
        });
        let curve = if p.y > PROFILE[SHOULDER as usize][3][2] { SHOULDER } else { SHOULDER + 1 };
        let profile = PROFILE[curve as usize].map(|[r, _, y]| DVec3::new(r, y, 0.0));
        let v = solve(|v| p.y - Cubic::at(v).blend(&profile).y);
        let radius = p.with_y(0.0).length() / Cubic::at(u).blend(&arc).length();
        let (_, normal) = quarter_of(&PROFILE[curve as usize], quarter).blend(&Cubic::at(u), &Cubic::at(v));
        BodyPoint {
            outside: radius - Cubic::at(v).blend(&profile).x,
            around: around.floor() + u,
            down: f64::from(curve) + v,
            normal,
        }
    }
}

/// The root of a rising function on 0..=1.
fn solve(f: impl Fn(f64) -> f64) -> f64 {
    let (mut a, mut b) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = (a + b) * 0.5;
        if f(middle) > 0.0 { b = middle } else { a = middle }
    }
    (a + b) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tubes_end_on_the_body() {
        for n in [4, 16, 33] {
            for graft in [Graft::spout(n), Graft::handle_top(n), Graft::handle_foot(n)] {
                let outside = graft.ring.iter().map(|(_, (p, _))| BodyPoint::of(*p).outside.abs());
                let gap = outside.fold(0.0, f64::max);
                assert!(gap < 1e-9, "{gap}");
            }
        }
    }
}
