//! Whether triangles enclose a solid. Vertices are the same point where their positions are equal, bit for bit.

use bilux_math::Vec3;
use std::collections::HashMap;

/// The number of edges that do not occur exactly once in each direction: 0 for a closed mesh.
pub fn open_edges(positions: &[Vec3], triangles: &[[u32; 3]]) -> usize {
    let mut edges: HashMap<[[u32; 3]; 2], u32> = HashMap::new();
    for t in triangles {
        let corner = |k: usize| positions[t[k % 3] as usize].to_array().map(f32::to_bits);
        for k in 0..3 {
            *edges.entry([corner(k), corner(k + 1)]).or_insert(0) += 1;
        }
    }
    edges.iter().filter(|([a, b], n)| **n != 1 || edges.get(&[*b, *a]) != Some(&1)).count()
}

/// The volume that closed triangles enclose, from the signed tetrahedra to the origin: above 0 where they face outwards.
pub fn volume(positions: &[Vec3], triangles: &[[u32; 3]]) -> f64 {
    let corner = |i: u32| positions[i as usize].as_dvec3();
    let six: f64 = triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c)))).sum();
    six / 6.0
}

/// The minimum cosine between a triangle's normal and the normals of its corners.
pub fn least_agreement(positions: &[Vec3], normals: &[Vec3], triangles: &[[u32; 3]]) -> f32 {
    let normal = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a).normalize();
    let cosines = triangles.iter().flat_map(|t| {
        let winding = normal(t.map(|i| positions[i as usize]));
        t.map(|i| winding.dot(normals[i as usize]))
    });
    cosines.fold(1.0, f32::min)
}
