//! A refined cage as triangles with normals.

use super::cage::Cage;
use super::edges::Edges;
use super::rules::Value;
use bilux_math::{DVec3, Rgb, Vec2, Vec3};
use bilux_scene::Mesh;
use std::collections::HashMap;

impl Cage {
    /// The surface as one mesh for each group below `groups`. Normals are smooth, except across sharp edges.
    pub(crate) fn meshes(&self, groups: usize) -> Vec<Mesh> {
        let limit = self.limit();
        let edges = self.edges();
        let fans = self.fans(&edges);
        let normals = self.normals(&limit, &fans);
        let mut makers: Vec<Maker> = (0..groups).map(|_| Maker::default()).collect();
        let mut start = 0;
        for (&end, &group) in self.ends.iter().zip(&self.groups) {
            let Some(maker) = makers.get_mut(group as usize) else { continue };
            let corners: Vec<u32> = (start..end)
                .map(|corner| {
                    let (point, fan) = (self.corners[corner as usize], fans[corner as usize]);
                    let uv = self.uvs.get(corner as usize).copied();
                    maker.vertex(point, fan, uv, || {
                        let Value { position, colour } = limit[point as usize];
                        let colour = self.has_colours.then_some(colour);
                        (position, normals[fan as usize], colour)
                    })
                })
                .collect();
            (2..corners.len())
                .for_each(|i| maker.mesh.triangles.push([corners[0], corners[i - 1], corners[i]]));
            start = end;
        }
        makers.into_iter().map(|maker| maker.mesh).collect()
    }

    /// For each corner a number that it shares with the corners at its point that no sharp edge separates from it.
    fn fans(&self, edges: &Edges) -> Vec<u32> {
        let mut of_corner: Vec<u32> = (0..self.corners.len() as u32).collect();
        for edge in edges.all.iter().filter(|edge| self.sharpness(edge) < 1.0) {
            let [one, other] = edge.corners;
            let [one_next, other_next] = edge.corners.map(|corner| edges.next[corner as usize]);
            // Polygons that face the same way run through their edge in opposite directions.
            if self.corners[one as usize] == self.corners[other_next as usize] {
                join(&mut of_corner, one, other_next);
                join(&mut of_corner, one_next, other);
            }
        }
        (0..of_corner.len() as u32).map(|corner| root(&mut of_corner, corner)).collect()
    }

    /// For each fan the sum of the normals of its polygons, weighted by area.
    fn normals(&self, limit: &[Value], fans: &[u32]) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; self.corners.len()];
        let mut start = 0;
        for &end in &self.ends {
            let face = start..end as usize;
            let at = |i: usize| limit[self.corners[i] as usize].position;
            let fan = (face.start + 2..face.end)
                .fold(DVec3::ZERO, |sum, i| sum + (at(i - 1) - at(face.start)).cross(at(i) - at(face.start)));
            face.for_each(|corner| normals[fans[corner] as usize] += fan);
            start = end as usize;
        }
        normals
    }
}

/// The number that stands for a corner's fan.
fn root(of_corner: &mut [u32], mut corner: u32) -> u32 {
    while of_corner[corner as usize] != corner {
        // Halving the way keeps it short.
        let above = of_corner[of_corner[corner as usize] as usize];
        of_corner[corner as usize] = above;
        corner = above;
    }
    corner
}

fn join(of_corner: &mut [u32], a: u32, b: u32) {
    let [a, b] = [root(of_corner, a), root(of_corner, b)];
    of_corner[a.max(b) as usize] = a.min(b);
}

/// A mesh under construction.
#[derive(Default)]
struct Maker {
    mesh: Mesh,
    /// Vertices by point, fan and the bits of the texture coordinates.
    known: HashMap<(u32, u32, [u32; 2]), u32>,
}

impl Maker {
    fn vertex(
        &mut self,
        point: u32,
        fan: u32,
        uv: Option<Vec2>,
        of: impl FnOnce() -> (DVec3, DVec3, Option<DVec3>),
    ) -> u32 {
        let bits = uv.unwrap_or_default().to_array().map(f32::to_bits);
        let mesh = &mut self.mesh;
        *self.known.entry((point, fan, bits)).or_insert_with(|| {
            let (position, normal, colour) = of();
            mesh.positions.push(position.as_vec3());
            mesh.normals.push(normal.try_normalize().map_or(Vec3::Z, |normal| normal.as_vec3()));
            mesh.uvs.extend(uv);
            mesh.vertex_kd.extend(colour.map(|c| Rgb::from_array(c.as_vec3().to_array())));
            mesh.positions.len() as u32 - 1
        })
    }
}
