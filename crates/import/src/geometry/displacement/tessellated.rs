//! Triangles without long edges.

use crate::bytes::budget::Budget;
use bilux_math::Vec3;
use bilux_scene::Mesh;
use std::collections::HashMap;
use std::ops::{Add, Mul};

/// Halvings of any edge.
const ROUNDS: u32 = 16;

/// An edge, from the lower vertex to the higher one.
type Edge = [u32; 2];

/// The mesh with edges no longer than `longest`, but no more than `most` triangles; the flag says if it is as fine as that.
///
/// Long edges are cut in the middle, again and again. Which ones depends on their end points alone, so that triangles with
/// vertices of their own there, as at the seams of texture coordinates, still meet.
pub fn tessellated(mesh: &Mesh, longest: f32, most: usize, budget: &mut Budget, file: &str) -> (Mesh, bool) {
    let mut fine = Mesh { tangents: Vec::new(), ..mesh.clone() };
    for _ in 0..ROUNDS {
        let long = long_edges(&fine, longest);
        if long.is_empty() {
            return (fine, true);
        }
        let first = fine.positions.len() as u32;
        let middles: HashMap<Edge, u32> = long.iter().copied().zip(first..).collect();
        let pieces = |corners| 1 + edges(corners).iter().filter(|edge| middles.contains_key(*edge)).count();
        let triangles: usize = fine.triangles.iter().map(pieces).sum();
        let bytes = long.len() as u64 * 192 + triangles as u64 * 24;
        if triangles > most || budget.take_bytes(bytes, file).is_err() {
            return (fine, false);
        }
        add_middles(&mut fine, &long);
        let mut cut = Vec::with_capacity(triangles);
        for corners in &fine.triangles {
            let middles = edges(corners).map(|edge| middles.get(&edge).copied());
            cut_triangle(*corners, middles, &fine.positions, &mut cut);
        }
        fine.triangles = cut;
    }
    (fine, false)
}

/// The edges of a triangle: from the first corner to the second, and on.
fn edges([a, b, c]: &[u32; 3]) -> [Edge; 3] {
    [[a, b], [b, c], [c, a]].map(|[from, to]| [*from.min(to), *from.max(to)])
}

/// The edges that are longer than this, each once.
fn long_edges(mesh: &Mesh, longest: f32) -> Vec<Edge> {
    let length = |edge: &Edge| {
        let [from, to] = edge.map(|i| mesh.positions[i as usize]);
        from.distance(to)
    };
    let mut long: Vec<Edge> =
        mesh.triangles.iter().flat_map(edges).filter(|edge| length(edge) > longest).collect();
    long.sort_unstable();
    long.dedup();
    long
}

/// Adds the middle of each edge to the vertices.
fn add_middles(mesh: &mut Mesh, edges: &[Edge]) {
    fn add<T: Copy + Add<Output = T> + Mul<f32, Output = T>>(values: &mut Vec<T>, edges: &[Edge]) {
        if !values.is_empty() {
            values.reserve(edges.len());
            for [from, to] in edges {
                values.push((values[*from as usize] + values[*to as usize]) * 0.5);
            }
        }
    }
    add(&mut mesh.positions, edges);
    // The normals of an edge keep their lengths, and so their weights.
    add(&mut mesh.normals, edges);
    add(&mut mesh.uvs, edges);
    add(&mut mesh.uvs2, edges);
    add(&mut mesh.vertex_kd, edges);
    add(&mut mesh.vertex_ks, edges);
    add(&mut mesh.vertex_opacity, edges);
    add(&mut mesh.point_widths, edges);
}

/// Cuts a triangle at the middles of its edges.
fn cut_triangle([a, b, c]: [u32; 3], middles: [Option<u32>; 3], positions: &[Vec3], cut: &mut Vec<[u32; 3]>) {
    let distance = |i: u32, j: u32| positions[i as usize].distance_squared(positions[j as usize]);
    match middles {
        [None, None, None] => cut.push([a, b, c]),
        [Some(x), Some(y), Some(z)] => cut.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]),
        [Some(x), None, None] => cut.extend([[a, x, c], [x, b, c]]),
        [Some(x), Some(y), None] => {
            cut.push([x, b, y]);
            // What is left has four corners.
            let is_shorter = distance(a, y) < distance(x, c);
            cut.extend(if is_shorter { [[a, x, y], [a, y, c]] } else { [[a, x, c], [x, y, c]] });
        }
        // The same, turned.
        [None, y, z] => cut_triangle([b, c, a], [y, z, None], positions, cut),
        [x, None, z] => cut_triangle([c, a, b], [z, x, None], positions, cut),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Total area, and whether every edge within has a triangle on both sides.
    #[test]
    fn triangles_stay_closed_and_keep_their_area() {
        let mesh = Mesh {
            positions: vec![
                Vec3::ZERO,
                Vec3::new(3.0, 0.0, 0.0),
                Vec3::new(0.0, 1.0, 0.0),
                Vec3::new(0.2, 0.1, 1.0),
            ],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            ..Mesh::default()
        };
        let area = |mesh: &Mesh| -> f64 {
            let area = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                f64::from(0.5 * (b - a).cross(c - a).length())
            };
            mesh.triangles.iter().map(area).sum()
        };
        for longest in [2.0, 0.9, 0.3, 0.07] {
            let mut budget = Budget::new(1 << 30);
            let (fine, is_fine) = tessellated(&mesh, longest, 1 << 20, &mut budget, "");
            assert!(is_fine);
            assert!((area(&fine) - area(&mesh)).abs() < 1e-4);
            let mut directed: Vec<[u32; 2]> =
                fine.triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]).collect();
            directed.sort_unstable();
            assert!(directed.windows(2).all(|pair| pair[0] != pair[1]), "an edge twice in one direction");
            assert!(directed.iter().all(|[a, b]| directed.binary_search(&[*b, *a]).is_ok()), "an open edge");
        }
        let (coarse, is_fine) = tessellated(&mesh, 0.01, 1000, &mut Budget::new(1 << 30), "");
        assert!(!is_fine && coarse.triangles.len() <= 1000);
        let (coarse, is_fine) = tessellated(&mesh, 0.01, 1 << 20, &mut Budget::new(10_000), "");
        assert!(!is_fine && coarse.triangles.len() < 200);
    }
}
