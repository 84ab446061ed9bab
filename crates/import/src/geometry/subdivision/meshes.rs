//! A refined cage as triangles with normals.

use super::cage::{Attribute, Cage, LAYER_LIMIT};
use super::edges::Edges;
use super::rules::Value;
use bilux_math::{DVec3, Rgb, Vec2, Vec3};
use bilux_scene::Mesh;
use std::collections::HashMap;

impl Cage {
    /// The surface as one mesh for each group below `groups`. Normals are smooth, except across sharp edges.
    pub fn meshes(&self, groups: usize) -> Vec<Mesh> {
        let limit = self.limit();
        let edges = self.edges();
        let fans = self.fans(&edges);
        let normals = self.normals(&limit, &fans);
        let layers: Vec<Vec<Value>> = self.layers.iter().map(|layer| layer.limit(&edges)).collect();
        let mut makers: Vec<Maker> = (0..groups).map(|_| Maker::default()).collect();
        let mut start = 0;
        for (&end, &group) in self.ends.iter().zip(&self.groups) {
            let Some(maker) = makers.get_mut(group as usize) else { continue };
            let corners: Vec<u32> = (start..end)
                .map(|corner| {
                    let (point, fan) = (self.corners[corner as usize], fans[corner as usize]);
                    let uv = self.uvs.get(corner as usize).copied();
                    let has =
                        |i: usize| self.layers.get(i).filter(|l| l.groups.get(group as usize) == Some(&true));
                    let own = std::array::from_fn(|i| has(i).map(|l| l.cage.corners[corner as usize]));
                    maker.vertex(Key { point, fan, own }, uv, |mesh| {
                        let Value { position, colour } = limit[point as usize];
                        mesh.positions.push(position.as_vec3());
                        let normal = normals[fan as usize].try_normalize();
                        mesh.normals.push(normal.map_or(Vec3::Z, |normal| normal.as_vec3()));
                        if self.has_colours {
                            mesh.vertex_kd.push(Rgb::from_array(colour.as_vec3().to_array()));
                        }
                        for (i, at) in own.iter().enumerate().filter_map(|(i, at)| Some((i, (*at)?))) {
                            add(mesh, self.layers[i].attribute, layers[i][at as usize].position.as_vec3());
                        }
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

/// Adds what a vertex has.
fn add(mesh: &mut Mesh, attribute: Attribute, value: Vec3) {
    match attribute {
        Attribute::Uv => mesh.uvs.push(value.truncate()),
        Attribute::SecondUv => mesh.uvs2.push(value.truncate()),
        Attribute::Colour => mesh.vertex_kd.push(Rgb::from_array(value.max(Vec3::ZERO).to_array())),
        Attribute::Opacity => mesh.vertex_opacity.push(value.x.clamp(0.0, 1.0)),
    }
}

/// Key by which vertices differ: their points in the surface and in its layers, and their side of sharp edges.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Key {
    point: u32,
    fan: u32,
    own: [Option<u32>; LAYER_LIMIT],
}

/// A mesh under construction.
#[derive(Default)]
struct Maker {
    mesh: Mesh,
    /// Vertices, also by the bits of texture coordinates that are not smoothed.
    known: HashMap<(Key, [u32; 2]), u32>,
}

impl Maker {
    fn vertex(&mut self, key: Key, uv: Option<Vec2>, make: impl FnOnce(&mut Mesh)) -> u32 {
        let bits = uv.unwrap_or_default().to_array().map(f32::to_bits);
        let mesh = &mut self.mesh;
        *self.known.entry((key, bits)).or_insert_with(|| {
            make(mesh);
            mesh.uvs.extend(uv);
            mesh.positions.len() as u32 - 1
        })
    }
}
