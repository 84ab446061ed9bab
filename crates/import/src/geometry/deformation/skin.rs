//! Linear blend skinning: each vertex follows several joints, by weights.

use crate::geometry::affine::cofactors;
use bilux_math::{DMat4, Vec3};

/// The matrices of all vertices, while joint after joint adds its share.
pub struct Blends {
    matrices: Vec<DMat4>,
    sums: Vec<f64>,
}

impl Blends {
    /// The size of its memory.
    pub fn bytes(vertices: usize) -> u64 {
        (vertices * size_of::<(DMat4, f64)>()) as u64
    }

    pub fn new(vertices: usize) -> Blends {
        Blends { matrices: vec![DMat4::ZERO; vertices], sums: vec![0.0; vertices] }
    }

    /// Adds the share of a joint. Weights that are not finite are skipped.
    #[inline]
    pub fn add(&mut self, vertex: usize, joint: &DMat4, weight: f64) {
        if weight != 0.0 && weight.is_finite() {
            self.matrices[vertex] += *joint * weight;
            self.sums[vertex] += weight;
        }
    }

    /// True if the weights of some vertex do not add up to 1.
    pub fn are_uneven(&self) -> bool {
        self.sums.iter().any(|&sum| sum != 0.0 && (sum - 1.0).abs() > 0.02)
    }

    /// True if some vertex has no weights.
    pub fn lack_some(&self) -> bool {
        self.sums.contains(&0.0)
    }

    /// The matrix of each vertex, by weights that add up to 1; `unbound` for those without weights.
    pub fn matrices(mut self, unbound: impl Fn(usize) -> DMat4) -> Vec<DMat4> {
        for (vertex, (matrix, sum)) in self.matrices.iter_mut().zip(self.sums).enumerate() {
            *matrix = if sum == 0.0 { unbound(vertex) } else { *matrix * (1.0 / sum) };
        }
        self.matrices
    }
}

/// Moves each point by its own matrix.
pub fn move_points(points: &mut [Vec3], by: &[DMat4]) {
    for (p, m) in points.iter_mut().zip(by) {
        *p = m.transform_point3(p.as_dvec3()).as_vec3();
    }
}

/// A normal where its vertex was moved by a matrix.
#[inline]
pub fn turned(normal: Vec3, by: &DMat4) -> Vec3 {
    (cofactors(by) * normal.as_dvec3()).normalize_or_zero().as_vec3()
}

/// True if the matrices mirror, so that faces run the other way around.
pub fn are_mirrored(matrices: &[DMat4]) -> bool {
    matrices.first().is_some_and(|m| m.determinant() < 0.0)
}
