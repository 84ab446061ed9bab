//! Points and lines, which have no surface: little balls and tubes in their places.

use bilux_math::transcendental::{cos, sin};
use bilux_math::{Vec2, Vec3};
use bilux_scene::Mesh;
use bilux_scene::generators::shapes;
use std::f32::consts::TAU;

/// Sides of a tube.
const SIDES: u32 = 8;
/// Up to so many balls they have twenty triangles, and beyond eight.
const FEW_BALLS: usize = 20_000;
/// Bytes that balls and tubes take, each with its vertices' attributes.
pub(super) fn bytes(balls: usize, tubes: usize) -> u64 {
    let ball = if balls > FEW_BALLS { 6 * 52 + 8 * 12 } else { 12 * 52 + 20 * 12 };
    (balls as u64)
        .saturating_mul(ball)
        .saturating_add((tubes as u64).saturating_mul(u64::from(SIDES) * (2 * 52 + 24)))
}

/// Balls at the vertices that are named, and tubes between pairs of them, with what `bare` says of its vertices.
pub(super) fn solid(bare: &Mesh, balls: &[u32], tubes: &[[u32; 2]], radius: f32) -> Mesh {
    let mut made = Made { bare, mesh: Mesh { name: bare.name.clone(), ..Mesh::default() }, radius };
    let ball = if balls.len() > FEW_BALLS { octahedron() } else { shapes::icosphere(Vec3::ZERO, 1.0, 0) };
    for &vertex in balls {
        made.ball(vertex, &ball);
    }
    for &ends in tubes {
        made.tube(ends);
    }
    made.mesh
}

/// The coarsest of balls.
fn octahedron() -> Mesh {
    Mesh {
        positions: [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]).collect(),
        triangles: vec![
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 4],
            [3, 0, 4],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ],
        ..Mesh::default()
    }
}

struct Made<'m> {
    bare: &'m Mesh,
    mesh: Mesh,
    radius: f32,
}

impl Made<'_> {
    /// A vertex on the surface around one of the bare ones, in a direction from it.
    fn push(&mut self, vertex: u32, direction: Vec3) {
        fn again<T: Copy>(from: &[T], to: &mut Vec<T>, vertex: u32) {
            to.extend(from.get(vertex as usize));
        }
        self.mesh.positions.push(self.bare.positions[vertex as usize] + direction * self.radius);
        self.mesh.normals.push(direction);
        again::<Vec2>(&self.bare.uvs, &mut self.mesh.uvs, vertex);
        again::<Vec2>(&self.bare.uvs2, &mut self.mesh.uvs2, vertex);
        again(&self.bare.vertex_kd, &mut self.mesh.vertex_kd, vertex);
    }

    fn ball(&mut self, vertex: u32, unit: &Mesh) {
        let first = self.mesh.positions.len() as u32;
        for direction in &unit.positions {
            self.push(vertex, *direction);
        }
        self.mesh.triangles.extend(unit.triangles.iter().map(|face| face.map(|i| first + i)));
    }

    fn tube(&mut self, [a, b]: [u32; 2]) {
        let along = self.bare.positions[b as usize] - self.bare.positions[a as usize];
        // Between equal ends there is only the ball.
        let Some(along) = along.try_normalize() else { return };
        let (u, v) = along.any_orthonormal_pair();
        let first = self.mesh.positions.len() as u32;
        for side in 0..SIDES {
            let angle = side as f32 / SIDES as f32 * TAU;
            let out = u * cos(angle) + v * sin(angle);
            self.push(a, out);
            self.push(b, out);
        }
        for side in 0..SIDES {
            let (this, next) = (first + 2 * side, first + 2 * ((side + 1) % SIDES));
            self.mesh.triangles.extend([[this, next, next + 1], [this, next + 1, this + 1]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_and_tubes_are_closed_and_turned_outwards() {
        let bare = Mesh { positions: vec![Vec3::ZERO, Vec3::X * 4.0], ..Mesh::default() };
        for mesh in [
            solid(&bare, &[0], &[], 0.5),
            solid(&bare, &[], &[[0, 1]], 0.5),
            solid(&bare, &vec![1; FEW_BALLS + 1], &[], 0.5),
        ] {
            assert_eq!(mesh.positions.len(), mesh.normals.len());
            for t in &mesh.triangles[..8] {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                let n =
                    mesh.normals[t[0] as usize] + mesh.normals[t[1] as usize] + mesh.normals[t[2] as usize];
                assert!((b - a).cross(c - a).dot(n) > 0.0, "{t:?}");
            }
        }
        let tube = solid(&bare, &[], &[[0, 1], [1, 1]], 0.5);
        assert_eq!(tube.triangles.len(), 2 * SIDES as usize, "no tube between equal ends");
        assert!((tube.bounds().extent() - Vec3::new(4.0, 1.0, 1.0)).length() < 1e-6);
    }
}
