//! Replaces points and lines by small spheres and tubes, for formats that support only triangles.

use crate::output::writing::Writing;
use bilux_math::transcendental::{cos, sin};
use bilux_math::{Vec2, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, Object, SceneBuilder};
use std::borrow::Cow;
use std::f32::consts::TAU;
use std::sync::Arc;

/// The number of sides of a tube.
const SIDES: u32 = 8;
/// Up to this many spheres have twenty triangles each; more have eight.
const FEW_SPHERES: usize = 20_000;

/// Replaces points and lines by triangles if the format does not support them.
pub fn as_triangles<'a>(
    scene: Cow<'a, SceneBuilder>,
    capabilities: &[&str],
    writing: &mut Writing,
) -> Cow<'a, SceneBuilder> {
    let has_strokes = |object: &&Object| object.mesh.stroke_count() > 0;
    if capabilities.contains(&CAPABILITY) || !scene.objects.iter().any(|object| has_strokes(&object)) {
        return scene;
    }
    writing.warn("the format cannot store points and lines: they are written as small spheres and tubes");
    let widths = scene.stroke_widths.for_size(scene.bounds(0.0).extent().length());
    let mut scene = scene.into_owned();
    let mut objects = Vec::new();
    for object in std::mem::take(&mut scene.objects) {
        if !has_strokes(&&object) {
            objects.push(object);
            continue;
        }
        let volume = f64::from(object.motion.at(0.0).matrix().determinant()).abs();
        let scale = bilux_math::transcendental::powf_f64(volume, 1.0 / 3.0) as f32;
        let bare = &*object.mesh;
        let mut body = solid(bare, &bare.points, &[], widths.points * 0.5 / scale);
        if !bare.lines.is_empty() {
            let mut ends: Vec<u32> = bare.lines.iter().flatten().copied().collect();
            ends.sort_unstable();
            ends.dedup();
            append(&mut body, solid(bare, &ends, &bare.lines, widths.lines * 0.5 / scale));
        }
        if !bare.triangles.is_empty() {
            let rest = Mesh { points: Vec::new(), lines: Vec::new(), ..bare.clone() };
            objects.push(Object { mesh: Arc::new(rest), ..object.clone() });
        }
        objects.push(Object { mesh: Arc::new(body), ..object });
    }
    scene.objects = objects;
    Cow::Owned(scene)
}

/// The capability of formats that support points and lines.
pub const CAPABILITY: &str = "points and lines";

/// Appends a mesh with the same attributes.
fn append(mesh: &mut Mesh, mut more: Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.append(&mut more.positions);
    mesh.normals.append(&mut more.normals);
    mesh.uvs.append(&mut more.uvs);
    mesh.uvs2.append(&mut more.uvs2);
    mesh.vertex_kd.append(&mut more.vertex_kd);
    mesh.vertex_ks.append(&mut more.vertex_ks);
    mesh.triangles.extend(more.triangles.iter().map(|t| t.map(|i| first + i)));
}

/// Spheres at the given vertices and tubes between the given pairs, with the vertex attributes of `bare`.
fn solid(bare: &Mesh, balls: &[u32], tubes: &[[u32; 2]], radius: f32) -> Mesh {
    let mut solid = SolidStrokes { bare, mesh: Mesh { name: bare.name.clone(), ..Mesh::default() }, radius };
    let ball = if balls.len() > FEW_SPHERES { octahedron() } else { shapes::icosphere(Vec3::ZERO, 1.0, 0) };
    for &vertex in balls {
        solid.ball(vertex, &ball);
    }
    for &ends in tubes {
        solid.tube(ends);
    }
    solid.mesh
}

/// The coarsest sphere.
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

struct SolidStrokes<'m> {
    bare: &'m Mesh,
    mesh: Mesh,
    radius: f32,
}

impl SolidStrokes<'_> {
    /// Adds a vertex at the radius around a vertex of `bare`, in this direction.
    fn push(&mut self, vertex: u32, direction: Vec3) {
        fn again<T: Copy>(from: &[T], to: &mut Vec<T>, vertex: u32) {
            to.extend(from.get(vertex as usize));
        }
        self.mesh.positions.push(self.bare.positions[vertex as usize] + direction * self.radius);
        self.mesh.normals.push(direction);
        again::<Vec2>(&self.bare.uvs, &mut self.mesh.uvs, vertex);
        again::<Vec2>(&self.bare.uvs2, &mut self.mesh.uvs2, vertex);
        again(&self.bare.vertex_kd, &mut self.mesh.vertex_kd, vertex);
        again(&self.bare.vertex_ks, &mut self.mesh.vertex_ks, vertex);
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
        // Coinciding ends leave only the sphere.
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
            solid(&bare, &vec![1; FEW_SPHERES + 1], &[], 0.5),
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
