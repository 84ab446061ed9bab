//! Beam lattices: beams between vertices, and balls at them.

use bilux_math::transcendental::{cos, sin};
use bilux_math::{Vec2, Vec3};
use bilux_scene::Mesh;
use std::f32::consts::TAU;

/// The beams and balls of a mesh.
#[derive(Default)]
pub(super) struct Lattice {
    pub(super) beams: Vec<Beam>,
    /// Balls at vertices, each with its radius.
    pub(super) balls: Vec<(u32, f32)>,
}

/// A beam, with the radius at each end.
#[derive(Clone, Copy)]
pub(super) struct Beam {
    pub(super) ends: [u32; 2],
    pub(super) radii: [f32; 2],
}

/// The number of sides of a beam, if there are few and if there are many.
const SIDES: [u32; 2] = [16, 8];
const FEW: usize = 10_000;

impl Lattice {
    /// The memory that its meshes take at most, in bytes.
    pub(super) fn size(&self) -> u64 {
        let tubes = self.beams.len() * self.sides() as usize * 2 * size_of::<[Vec3; 3]>();
        (tubes + self.balls.len() * size_of::<[Vec3; 2]>()) as u64
    }

    fn sides(&self) -> u32 {
        SIDES[usize::from(self.beams.len() > FEW)]
    }

    /// The beams as open tubes of triangles, and the balls as points with widths.
    pub(super) fn mesh(&self, positions: &[Vec3]) -> Mesh {
        let mut mesh = self.tubes(positions);
        let balls = self.balls.iter().filter(|(_, radius)| *radius > 0.0);
        mesh.point_widths.resize(mesh.positions.len(), 0.0);
        for &(vertex, radius) in balls {
            mesh.points.push(mesh.positions.len() as u32);
            mesh.positions.push(positions[vertex as usize]);
            mesh.normals.push(Vec3::Z);
            mesh.point_widths.push(2.0 * radius);
        }
        mesh
    }

    fn tubes(&self, positions: &[Vec3]) -> Mesh {
        let (mut mesh, sides) = (Mesh::default(), self.sides());
        let circle: Vec<Vec2> = (0..sides)
            .map(|side| {
                let angle = side as f32 / sides as f32 * TAU;
                Vec2::new(cos(angle), sin(angle))
            })
            .collect();
        for Beam { ends, radii } in &self.beams {
            let [a, b] = ends.map(|vertex| positions[vertex as usize]);
            let Some(along) = (b - a).try_normalize() else { continue };
            let (u, v) = along.any_orthonormal_pair();
            let first = mesh.positions.len() as u32;
            let slope = (radii[0] - radii[1]) / (b - a).length();
            for at in &circle {
                let out = u * at.x + v * at.y;
                mesh.positions.extend([a + out * radii[0], b + out * radii[1]]);
                let normal = (out + along * slope).normalize();
                mesh.normals.extend([normal; 2]);
            }
            for side in 0..sides {
                let (this, next) = (first + 2 * side, first + 2 * ((side + 1) % sides));
                mesh.triangles.extend([[this, next, next + 1], [this, next + 1, this + 1]]);
            }
        }
        mesh
    }
}
