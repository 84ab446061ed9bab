//! The teapot as a solid for glass: closed, and without self-intersections.
//!
//! Light that enters glass has to leave it again, so the outside has to be one closed surface. Newell's is not: handle
//! and spout are tubes that pass through the wall, and the lid lies in the rim without touching it. Here a flat ring
//! connects lid and rim, the tubes end where they meet the body, the body has holes of exactly the same outline, bit
//! for bit, and the spout has a flat end below its lip. A cavity, if there is one, is a second closed surface that
//! faces inwards, within body and lid; handle and spout are solid.

use super::graft::{Graft, Tube};
use super::{FOOT, LID, NEWELL_HEIGHT, PROFILE, RIM, SHOULDER, quarter_of};
use bilux_math::{DVec2, DVec3};
use bilux_scene::Mesh;
use std::f64::consts::TAU;

/// Tessellation and scale of the vessel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vessel {
    /// Segments along each patch edge, at least 4.
    pub tessellation: u32,
    /// From the table to the top of the lid, metres.
    pub height: f64,
    /// Thickness of the wall, as a fraction of the height; `None` for solid glass.
    pub wall: Option<f64>,
}

impl Vessel {
    /// The mesh: closed, counter-clockwise when seen from the air, with normals.
    pub fn mesh(&self) -> Mesh {
        let n = self.tessellation.clamp(4, 256);
        let mut maker = Maker { n, corners: Vec::new(), triangles: Vec::new() };
        maker.body();
        if let Some(wall) = self.wall {
            maker.cavity(wall * NEWELL_HEIGHT);
        }
        maker.finish(self.height)
    }
}

impl Vessel {
    /// The contents of a hollow vessel: a closed mesh that fills its cavity up to this fraction of the height.
    ///
    /// It keeps a gap of a hundredth of the wall's thickness, since two coincident surfaces have no order.
    pub fn filling(&self, level: f64) -> Mesh {
        let n = self.tessellation.clamp(4, 256);
        let mut maker = Maker { n, corners: Vec::new(), triangles: Vec::new() };
        maker.liquid(self.wall.unwrap_or(0.0) * NEWELL_HEIGHT * 1.01, level * NEWELL_HEIGHT);
        Mesh { name: "filling".to_owned(), ..maker.finish(self.height) }
    }
}

struct Maker {
    n: u32,
    /// Positions and normals.
    corners: Vec<(DVec3, DVec3)>,
    triangles: Vec<[u32; 3]>,
}

impl Maker {
    fn finish(mut self, height: f64) -> Mesh {
        let scale = height / NEWELL_HEIGHT;
        let positions: Vec<_> = self.corners.iter().map(|(p, _)| (*p * scale).as_vec3()).collect();
        let has_area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| positions[i as usize]);
            a != b && b != c && c != a
        };
        self.triangles.retain(has_area);
        let normals = self.corners.iter().map(|(_, n)| n.as_vec3()).collect();
        Mesh { name: "vessel".into(), positions, normals, triangles: self.triangles, ..Mesh::default() }
    }

    /// The number of corners around the body.
    fn around(&self) -> u32 {
        4 * self.n
    }

    /// A point of the body, by step around it and by step down a curve of the profile.
    fn on_body(&self, i: u32, curve: u32, j: u32) -> (DVec3, DVec3) {
        let i = i % self.around();
        quarter_of(&PROFILE[curve as usize], (i / self.n) as usize).at(i % self.n, j, self.n)
    }

    fn push(&mut self, corner: (DVec3, DVec3)) -> u32 {
        self.corners.push(corner);
        self.corners.len() as u32 - 1
    }

    /// Adds a ring of corners around the body, and returns the index of the first.
    fn ring(&mut self, at: impl Fn(&Maker, u32) -> (DVec3, DVec3)) -> u32 {
        let first = self.corners.len() as u32;
        for i in 0..self.around() {
            let corner = at(self, i);
            self.corners.push(corner);
        }
        first
    }

    /// Adds the squares between two rings, upper and lower, where `keep` is true.
    fn band(&mut self, upper: u32, lower: u32, keep: impl Fn(u32) -> bool) {
        let around = self.around();
        for i in (0..around).filter(|&i| keep(i)) {
            let k = (i + 1) % around;
            self.triangles.push([upper + i, upper + k, lower + k]);
            self.triangles.push([upper + i, lower + k, lower + i]);
        }
    }

    fn body(&mut self) {
        let n = self.n;
        // Two rows coincide where curves meet; row (c, j) begins at `(c * (n + 1) + j) * around`.
        for (curve, j) in (0..PROFILE.len() as u32).flat_map(|c| (0..=n).map(move |j| (c, j))) {
            self.ring(|m, i| m.on_body(i, curve, j));
        }
        let grafts = [Graft::spout(n), Graft::handle_top(n), Graft::handle_foot(n)];
        for (curve, j) in (0..PROFILE.len() as u32).flat_map(|c| (0..n).map(move |j| (c, j))) {
            let upper = self.row(curve * n + j, curve);
            let whole = |i: u32| !grafts.iter().any(|g| g.takes(i, curve * n + j));
            self.band(upper, upper + self.around(), whole);
        }
        let flat = |m: &Maker, i, curve, j| (m.on_body(i, curve, j).0, DVec3::Y);
        let inner = self.ring(|m, i| flat(m, i, LID, n));
        let outer = self.ring(|m, i| flat(m, i, RIM, 0));
        self.band(inner, outer, |_| true);
        let [spout, top, foot] = &grafts;
        for graft in &grafts {
            self.sew(graft);
        }
        self.tube(&Tube::SPOUT, &spout.ends, &vec![2.0; spout.ends.len()], true);
        self.tube(&Tube::HANDLE, &top.ends, &foot.ends, false);
    }

    /// The first corner of a row, by steps down the whole profile, as a row of the given curve.
    fn row(&self, down: u32, curve: u32) -> u32 {
        (down + curve) * self.around()
    }

    /// Connects the outline of the cells that a graft removes with the ring where the tube meets the body.
    ///
    /// It walks both by angle around the centre.
    fn sew(&mut self, graft: &Graft) {
        let outline = graft.outline();
        let outer: Vec<(f64, u32)> = outline
            .iter()
            .map(|&(i, down)| {
                let curve = (down / self.n).min(FOOT);
                let index = self.row(down, curve) + i % self.around();
                (graft.angle(DVec2::new(f64::from(i), f64::from(down))), index)
            })
            .collect();
        let inner: Vec<(f64, u32)> =
            graft.ring.iter().map(|(cell, corner)| (graft.angle(*cell), self.push(*corner))).collect();
        let (outer, inner) = (by_angle(outer), by_angle(inner));
        let (mut a, mut b) = (0, 0);
        let turned = |ring: &[(f64, u32)], k: usize| ring[k % ring.len()].0 + TAU * (k / ring.len()) as f64;
        let index = |ring: &[(f64, u32)], k: usize| ring[k % ring.len()].1;
        while a < outer.len() || b < inner.len() {
            let outer_next =
                b == inner.len() || (a < outer.len() && turned(&outer, a + 1) <= turned(&inner, b + 1));
            if outer_next {
                self.triangles.push([index(&outer, a), index(&outer, a + 1), index(&inner, b)]);
                a += 1;
            } else {
                self.triangles.push([index(&outer, a), index(&inner, b + 1), index(&inner, b)]);
                b += 1;
            }
        }
    }

    /// A tube between two parameters for every point around it, with a cap at its end if `capped`.
    fn tube(&mut self, tube: &Tube, from: &[f64], to: &[f64], capped: bool) {
        let (around, along) = (2 * self.n, 2 * self.n);
        let first = self.corners.len() as u32;
        for (k, t) in (0..=along).flat_map(|k| (0..around).map(move |t| (k, t))) {
            let (a, b) = (from[t as usize], to[t as usize]);
            let fraction = f64::from(k) / f64::from(along);
            let s = if k == along { b } else { a + (b - a) * fraction };
            self.corners.push(tube.at(t, self.n, s));
        }
        for (k, t) in (0..along).flat_map(|k| (0..around).map(move |t| (k, t))) {
            let corner = |t: u32, k: u32| first + k * around + t % around;
            let (a, b, c, d) = (corner(t, k), corner(t + 1, k), corner(t + 1, k + 1), corner(t, k + 1));
            self.triangles.extend([[a, b, c], [a, c, d]]);
        }
        if capped {
            let last = first + along * around;
            let rim: Vec<DVec3> = (0..around).map(|t| self.corners[(last + t) as usize].0).collect();
            let middle = rim.iter().sum::<DVec3>() / rim.len() as f64;
            let centre = self.push((middle, DVec3::Y));
            let flat: Vec<u32> = rim.iter().map(|&p| self.push((p, DVec3::Y))).collect();
            for t in 0..flat.len() {
                self.triangles.push([flat[t], flat[(t + 1) % flat.len()], centre]);
            }
        }
    }

    /// The inside of the wall: lid and body moved inwards, facing inwards.
    fn cavity(&mut self, wall: f64) {
        let first_triangle = self.triangles.len();
        let first_corner = self.corners.len();
        let inwards = |(p, normal): (DVec3, DVec3)| (p - normal * wall, normal);
        let top = inwards(self.on_body(0, LID, 0)).0.y;
        let mut upper = self.ring(|_, _| (DVec3::Y * top, DVec3::Y));
        for (curve, j) in self.cavity_rows(inwards) {
            let lower = self.ring(|m, i| inwards(m.on_body(i, curve, j)));
            self.band(upper, lower, |_| true);
            upper = lower;
        }
        for triangle in &mut self.triangles[first_triangle..] {
            triangle.reverse();
        }
        for (_, normal) in &mut self.corners[first_corner..] {
            *normal = -*normal;
        }
    }

    /// The body below a level, moved inwards, under a flat surface with sharp edges.
    fn liquid(&mut self, wall: f64, level: f64) {
        let inwards = |(p, normal): (DVec3, DVec3)| (p - normal * wall, normal);
        let mut rows = self.cavity_rows(inwards);
        rows.retain(|&(curve, j)| {
            let p = inwards(self.on_body(0, curve, j)).0;
            curve >= SHOULDER && p.y < level
        });
        let Some(&(curve, j)) = rows.first() else { return };
        let brim = |m: &Maker, i| (inwards(m.on_body(i, curve, j)).0, DVec3::Y);
        let middle = DVec3::Y * brim(self, 0).0.y;
        let (centre, edge) = (self.ring(|_, _| (middle, DVec3::Y)), self.ring(brim));
        self.band(centre, edge, |_| true);
        let rings: Vec<u32> =
            rows.iter().map(|&(c, j)| self.ring(|m, i| inwards(m.on_body(i, c, j)))).collect();
        for pair in rings.windows(2) {
            self.band(pair[0], pair[1], |_| true);
        }
    }

    /// The rows of the body that the cavity keeps, by curve and step.
    ///
    /// The lid's edge and the beginning of the shoulder would touch the rim from below. Where the outside curves more
    /// tightly than the wall is thick, the inside would fold back on itself.
    fn cavity_rows(&self, inwards: impl Fn((DVec3, DVec3)) -> (DVec3, DVec3)) -> Vec<(u32, u32)> {
        let n = self.n;
        let lid = (0..=n * 3 / 4).map(|j| (LID, j));
        let shoulder = (n.div_ceil(6)..n).map(|j| (SHOULDER, j));
        let below = (SHOULDER + 1..=FOOT).flat_map(|c| (0..n).map(move |j| (c, j)));
        let mut kept: Vec<((u32, u32), DVec3, DVec3)> = Vec::new();
        for (curve, j) in lid.chain(shoulder).chain(below).chain([(FOOT, n)]) {
            let (here, normal) = inwards(self.on_body(0, curve, j));
            let onwards = DVec3::new(normal.y, -normal.x, 0.0);
            let agrees = |from: DVec3, along: DVec3| (here - from).dot(along) > 0.5 * (here - from).length();
            if kept.last().is_some_and(|(_, last, _)| !agrees(*last, onwards)) {
                continue;
            }
            while kept.last().is_some_and(|(_, last, along)| !agrees(*last, *along)) {
                kept.pop();
            }
            kept.push(((curve, j), here, onwards));
        }
        kept.into_iter().map(|(row, ..)| row).collect()
    }
}

fn by_angle(mut ring: Vec<(f64, u32)>) -> Vec<(f64, u32)> {
    ring.sort_by(|a, b| a.0.total_cmp(&b.0));
    ring
}
