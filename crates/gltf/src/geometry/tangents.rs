//! Generates tangents for meshes without them, as normal map bakers do. [Mikkelsen 2008]

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use bilux_math::glam::Vec4;
use bilux_math::transcendental::acos;
use bilux_math::{Vec2, Vec3};
use bilux_scene::Mesh;
use std::collections::HashMap;

/// Adds tangents to a mesh from its first or second set of texture coordinates.
///
/// Splits vertices where the two sides of a seam have different tangents. Does nothing without texture
/// coordinates, or if any number is not finite.
pub(crate) fn add(mesh: &mut Mesh, second_uv: bool) {
    let uvs = if second_uv && !mesh.uvs2.is_empty() { &mesh.uvs2 } else { &mesh.uvs };
    let is_whole = mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite())
        && uvs.len() == mesh.positions.len()
        && uvs.iter().all(|uv| uv.is_finite());
    if !is_whole {
        return;
    }
    let tangents = vec![None; mesh.triangles.len() * 3];
    let mut corners = Corners { mesh, uvs, tangents };
    if generate_tangents::<_, Exact>(&mut corners).is_err() {
        return;
    }
    let tangents = corners.tangents;
    split(mesh, &tangents);
}

/// Assigns each corner's tangent to its vertex, and copies the vertex for tangents that differ from the first.
fn split(mesh: &mut Mesh, tangents: &[Option<[f32; 4]>]) {
    let unset = Vec4::ZERO;
    mesh.tangents = vec![unset; mesh.positions.len()];
    let mut copies: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    for (i, tangent) in tangents.iter().enumerate() {
        // A corner without a defined tangent gets an arbitrary one.
        let tangent = Vec4::from(tangent.unwrap_or([1.0, 0.0, 0.0, 1.0]));
        let vertex = mesh.triangles[i / 3][i % 3];
        let own = &mut mesh.tangents[vertex as usize];
        if *own == unset {
            *own = tangent;
        }
        if *own == tangent {
            continue;
        }
        let key = (vertex, tangent.to_array().map(f32::to_bits));
        let copy = *copies.entry(key).or_insert_with(|| copy_of(mesh, vertex as usize, tangent));
        mesh.triangles[i / 3][i % 3] = copy;
    }
}

fn copy_of(mesh: &mut Mesh, vertex: usize, tangent: Vec4) -> u32 {
    fn again<T: Copy>(list: &mut Vec<T>, i: usize) {
        if let Some(&item) = list.get(i) {
            list.push(item);
        }
    }
    let index = mesh.positions.len() as u32;
    again(&mut mesh.positions, vertex);
    again(&mut mesh.normals, vertex);
    again(&mut mesh.uvs, vertex);
    again(&mut mesh.uvs2, vertex);
    again(&mut mesh.vertex_kd, vertex);
    again(&mut mesh.vertex_ks, vertex);
    mesh.tangents.push(tangent);
    index
}

/// A mesh as the generator sees it: corners with all of their attributes.
struct Corners<'m> {
    mesh: &'m Mesh,
    uvs: &'m [Vec2],
    tangents: Vec<Option<[f32; 4]>>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry<Exact> for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        if let Some(n) = self.mesh.normals.get(self.vertex(face, corner)) {
            return n.normalize_or_zero().to_array();
        }
        let [a, b, c] = self.mesh.triangles[face].map(|i| self.mesh.positions[i as usize]);
        (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::Z).to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.uvs[self.vertex(face, corner)].to_array()
    }

    fn set_tangent(&mut self, tangent: Option<TangentSpace>, face: usize, corner: usize) {
        self.tangents[face * 3 + corner] = tangent.map(|tangent| tangent.tangent_encoded());
    }
}

/// Arithmetic that gives the same result on every machine.
struct Exact;

impl Ops for Exact {
    fn sqrt(x: f32) -> f32 {
        x.sqrt()
    }

    fn acos(x: f32) -> f32 {
        acos(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two triangles with the given texture coordinates.
    fn square(uvs: [[f32; 2]; 4]) -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            normals: vec![Vec3::Z; 4],
            uvs: uvs.map(Vec2::from).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn tangents_go_as_u_grows_and_know_the_other_hand() {
        let mut plain = square([[0., 0.], [1., 0.], [1., 1.], [0., 1.]]);
        add(&mut plain, false);
        assert_eq!(plain.tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
        let mut mirrored = square([[1., 0.], [0., 0.], [0., 1.], [1., 1.]]);
        add(&mut mirrored, false);
        assert_eq!(mirrored.tangents, [Vec4::new(-1.0, 0.0, 0.0, -1.0); 4]);
        // In the second set, u increases upwards.
        plain.uvs2 = [[0., 0.], [0., 1.], [1., 1.], [1., 0.]].map(Vec2::from).to_vec();
        add(&mut plain, true);
        assert_eq!(plain.tangents, [Vec4::new(0.0, 1.0, 0.0, -1.0); 4]);
    }

    #[test]
    fn vertices_are_split_where_hands_change() {
        // The second triangle's texture is mirrored.
        let mut mesh = square([[0., 0.], [1., 0.], [1., 1.], [1., 0.]]);
        add(&mut mesh, false);
        assert_eq!((mesh.positions.len(), mesh.tangents.len(), mesh.uvs.len()), (6, 6, 6));
        let hand = |t: usize| mesh.triangles[t].map(|i| mesh.tangents[i as usize].w);
        assert_eq!((hand(0), hand(1)), ([1.0; 3], [-1.0; 3]));
        let mut odd = square([[0., 0.], [f32::NAN, 0.], [1., 1.], [1., 0.]]);
        add(&mut odd, false);
        assert!(odd.tangents.is_empty());
        let mut nowhere = square([[0., 0.]; 4]);
        add(&mut nowhere, false);
        assert!(nowhere.tangents.iter().all(|t| t.is_finite()));
    }
}
