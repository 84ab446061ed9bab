//! `loopsubdiv`: Loop subdivision, which splits each triangle into four per level. [Loop 1987]

use super::super::document::ShapeGeometry;
use super::super::parameters::ParameterList;
use super::maker::{ShapeMaker, corners, needed_points};
use crate::FormatError;
use bilux_math::Vec3;
use bilux_math::glam::DVec3;
use bilux_math::transcendental::cos_f64;
use bilux_scene::Mesh;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// More levels would be finer than any image.
const MAX_LEVELS: i32 = 8;

pub(super) fn make(
    maker: &mut ShapeMaker,
    list: &ParameterList,
) -> Result<Option<ShapeGeometry>, FormatError> {
    let points = needed_points(list)?;
    let triangles = corners::<3>(list, points.len())?;
    // Version 3 calls the parameter nlevels; the scheme is always this one.
    let levels = match list.integer("levels")? {
        Some(levels) => levels,
        None => list.integer("nlevels")?.unwrap_or(3),
    };
    list.has("scheme");
    if levels > MAX_LEVELS {
        let what = format!("a mesh is subdivided at most {MAX_LEVELS} times");
        maker.loader.note(&what, || list.place("levels"));
    }
    let mut cage = Cage { points: points.iter().map(|p| p.as_dvec3()).collect(), triangles };
    for _ in 0..levels.clamp(0, MAX_LEVELS) {
        // Each triangle becomes four, with about half as many points, plus the edges during construction.
        maker.loader.reading.budget.take::<[u32; 40]>(cage.triangles.len() * 2, &list.at.file)?;
        cage = cage.refined();
    }
    let limit = cage.limit();
    let mut mesh = Mesh {
        positions: limit.iter().map(|p| p.as_vec3()).collect::<Vec<Vec3>>(),
        triangles: cage.triangles,
        ..Mesh::default()
    };
    mesh.normals = mesh.smooth_normals();
    maker.finished(mesh, list)
}

struct Cage {
    points: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// The corners opposite an edge, and its number of triangles.
#[derive(Default)]
struct Edge {
    opposite: [u32; 2],
    triangles: u32,
}

/// The neighbours of a point: their sum and count, for all of them and for those along the border.
#[derive(Clone, Copy, Default)]
struct Ring {
    sum: DVec3,
    count: f64,
    border_sum: DVec3,
    border_count: f64,
}

impl Cage {
    fn edges(&self) -> HashMap<[u32; 2], Edge> {
        let mut edges: HashMap<[u32; 2], Edge> = HashMap::with_capacity(self.triangles.len() * 3 / 2);
        for &[a, b, c] in &self.triangles {
            for [from, to, opposite] in [[a, b, c], [b, c, a], [c, a, b]] {
                let edge = edges.entry([from.min(to), from.max(to)]).or_default();
                if let Some(slot) = edge.opposite.get_mut(edge.triangles as usize) {
                    *slot = opposite;
                }
                edge.triangles += 1;
            }
        }
        edges
    }

    fn rings(&self, edges: &HashMap<[u32; 2], Edge>) -> Vec<Ring> {
        // Sums in the order of the triangles, since the order of a hash table changes from run to run.
        let mut rings = vec![Ring::default(); self.points.len()];
        let mut seen = std::collections::HashSet::with_capacity(edges.len());
        for &[a, b, c] in &self.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let key = [from.min(to), from.max(to)];
                if !seen.insert(key) {
                    continue;
                }
                let is_border = edges[&key].triangles == 1;
                for [at, other] in [[from, to], [to, from]] {
                    let (ring, p) = (&mut rings[at as usize], self.points[other as usize]);
                    (ring.sum, ring.count) = (ring.sum + p, ring.count + 1.0);
                    if is_border {
                        (ring.border_sum, ring.border_count) = (ring.border_sum + p, ring.border_count + 1.0);
                    }
                }
            }
        }
        rings
    }

    fn refined(&self) -> Cage {
        let edges = self.edges();
        let rings = self.rings(&edges);
        let moved = |(p, ring): (&DVec3, &Ring)| match ring.border_count {
            2.0 => *p * 0.75 + ring.border_sum * 0.125,
            b if b > 0.0 => *p,
            _ => blended(*p, ring, beta(ring.count)),
        };
        let mut points: Vec<DVec3> = self.points.iter().zip(&rings).map(moved).collect();
        let mut middles: HashMap<[u32; 2], u32> = HashMap::with_capacity(edges.len());
        let mut triangles = Vec::with_capacity(self.triangles.len() * 4);
        for &[a, b, c] in &self.triangles {
            let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[from, to]| {
                let key = [from.min(to), from.max(to)];
                *middles.entry(key).or_insert_with(|| {
                    points.push(self.middle(key, &edges[&key]));
                    points.len() as u32 - 1
                })
            });
            triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        Cage { points, triangles }
    }

    fn middle(&self, [a, b]: [u32; 2], edge: &Edge) -> DVec3 {
        let ends = self.points[a as usize] + self.points[b as usize];
        if edge.triangles != 2 {
            return ends * 0.5;
        }
        let [c, d] = edge.opposite.map(|i| self.points[i as usize]);
        ends * 0.375 + (c + d) * 0.125
    }

    /// The limit positions of the points.
    fn limit(&self) -> Vec<DVec3> {
        let rings = self.rings(&self.edges());
        let settled = |(p, ring): (&DVec3, &Ring)| match ring.border_count {
            2.0 => *p * 0.6 + ring.border_sum * 0.2,
            b if b > 0.0 => *p,
            _ => blended(*p, ring, 1.0 / (ring.count + 3.0 / (8.0 * beta(ring.count)))),
        };
        self.points.iter().zip(&rings).map(settled).collect()
    }
}

/// Blends a point with its neighbours, each weighted by `part`.
fn blended(p: DVec3, ring: &Ring, part: f64) -> DVec3 {
    if ring.count == 0.0 { p } else { p * (1.0 - ring.count * part) + ring.sum * part }
}

/// The weight of each neighbour for this number of them. [Loop 1987]
fn beta(count: f64) -> f64 {
    let middle = 0.375 + 0.25 * cos_f64(TAU / count);
    (0.625 - middle * middle) / count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_octahedron_becomes_round_and_stays_closed() {
        let points = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z].to_vec();
        let triangles =
            vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]];
        let mut cage = Cage { points, triangles };
        for _ in 0..3 {
            cage = cage.refined();
        }
        assert_eq!((cage.triangles.len(), cage.points.len()), (8 * 64, 2 + 8 * 64 / 2));
        let limit = cage.limit();
        let (least, most) =
            limit.iter().map(|p| p.length()).fold((f64::MAX, 0f64), |(a, b), l| (a.min(l), b.max(l)));
        assert!(least > 0.4 && most < 0.75 && most / least < 1.3, "{least} {most}");
        assert!(cage.edges().values().all(|edge| edge.triangles == 2));
    }

    #[test]
    fn a_flat_square_stays_flat_with_straight_sides() {
        let points = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let cage = Cage { points, triangles: vec![[0, 1, 2], [0, 2, 3]] }.refined().refined();
        assert!(cage.limit().iter().all(|p| p.z == 0.0 && (-1e-9..=1.0 + 1e-9).contains(&p.x)));
    }
}
