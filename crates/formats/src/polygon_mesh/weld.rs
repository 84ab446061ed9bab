//! Makes triangles of polygons. Corners at one control point that have the same attributes share a vertex.

use super::mesh::PolygonMesh;
use super::workshop::Workshop;
use crate::FormatError;
use crate::indexed_faces::NONE;
use crate::polygon::Triangulator;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Mesh;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The faces of a mesh that have one material.
#[derive(Clone)]
pub(crate) struct Part {
    pub(crate) mesh: Arc<Mesh>,
    /// The number of its material among those of the mesh.
    pub(crate) material: usize,
}

/// A vertex: position, normal, two pairs of texture coordinates, colour, and its link.
type Vertex = [u32; 14];

/// Longer chains of vertices at one control point are not searched: a hostile file costs vertices, not time.
const MAX_CHAIN: usize = 32;

/// The mesh in parts of one material each.
pub(crate) fn parts(
    geometry: PolygonMesh,
    workshop: &mut Workshop,
    file: &str,
) -> Result<Vec<Part>, FormatError> {
    let materials = &geometry.materials_of_faces()[..];
    workshop.budget.take_bytes(12 * (geometry.polygons.len() + geometry.positions.len()) as u64, file)?;
    let mut of_material: BTreeMap<i32, Vec<u32>> = BTreeMap::new();
    if let &[only] = materials {
        of_material.insert(only, (0..geometry.polygons.len() as u32).collect());
    } else {
        for (polygon, &material) in materials.iter().enumerate() {
            of_material.entry(material).or_default().push(polygon as u32);
        }
    }
    let mut welder = Welder {
        geometry: &geometry,
        first: vec![NONE; geometry.positions.len()],
        next: Vec::new(),
        mesh: Mesh::default(),
        has_uvs: false,
    };
    let mut parts = Vec::new();
    for (material, polygons) in of_material {
        workshop.budget.take::<(Part, Mesh)>(1, file)?;
        let mesh = welder.part(&polygons, workshop, file)?;
        if !mesh.triangles.is_empty() {
            parts.push(Part { mesh: Arc::new(mesh), material: material as usize });
        }
    }
    Ok(parts)
}

/// Makes one part after the other.
struct Welder<'g> {
    geometry: &'g PolygonMesh,
    /// The first vertex at each control point.
    first: Vec<u32>,
    /// For each vertex the next one at the same control point.
    next: Vec<u32>,
    mesh: Mesh,
    has_uvs: bool,
}

/// What a corner has besides its position.
#[derive(Clone, Copy, PartialEq)]
struct Attributes {
    normal: Vec3,
    uvs: [Vec2; 2],
    colour: Rgb,
}

impl Welder<'_> {
    fn part(&mut self, polygons: &[u32], workshop: &mut Workshop, file: &str) -> Result<Mesh, FormatError> {
        let geometry = self.geometry;
        let mut triangulator = Triangulator::default();
        let mut corners = Vec::new();
        for &polygon in polygons {
            let polygon = polygon as usize;
            if !geometry.polygons.is_drawn(polygon) {
                continue;
            }
            let (start, end) = (geometry.polygons.start(polygon), geometry.polygons.ends[polygon] as usize);
            corners.clear();
            let made = self.next.len();
            corners.extend((start..end).map(|corner| self.vertex(corner, polygon)));
            workshop.budget.take::<Vertex>(self.next.len() - made, file)?;
            workshop.budget.take::<[u32; 3]>(corners.len() - 2, file)?;
            let (positions, triangles) = (&self.mesh.positions, &mut self.mesh.triangles);
            let exact = match corners[..] {
                [a, b, c] => {
                    triangles.push([a, b, c]);
                    Some(())
                }
                _ => triangulator.triangulate(corners.iter().map(|&i| positions[i as usize]), |t| {
                    triangles.push(t.map(|i| corners[i as usize]));
                }),
            };
            if exact.is_none() {
                let what =
                    "a concave polygon has too many corners to triangulate exactly and is treated as convex";
                workshop.oddities.note(what, bilux_scene::Span::default);
            }
        }
        // Only the control points of this part have vertices.
        for &polygon in polygons {
            let range =
                geometry.polygons.start(polygon as usize)..geometry.polygons.ends[polygon as usize] as usize;
            geometry.polygons.corners[range]
                .iter()
                .for_each(|&position| self.first[position as usize] = NONE);
        }
        self.next.clear();
        let mut mesh = std::mem::take(&mut self.mesh);
        mesh.name.clone_from(&geometry.name);
        if !std::mem::take(&mut self.has_uvs) {
            mesh.uvs = Vec::new();
        }
        if geometry.is_mirrored {
            mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        mesh.positions.shrink_to_fit();
        mesh.normals.shrink_to_fit();
        mesh.uvs.shrink_to_fit();
        mesh.uvs2.shrink_to_fit();
        mesh.vertex_kd.shrink_to_fit();
        mesh.triangles.shrink_to_fit();
        Ok(mesh)
    }

    /// The vertex of a corner, made if it is new.
    #[inline]
    fn vertex(&mut self, corner: usize, polygon: usize) -> u32 {
        let geometry = self.geometry;
        let position = geometry.polygons.corners[corner];
        let at = position as usize;
        let uv = geometry.uvs[0].at(corner, polygon, at);
        let attributes = Attributes {
            normal: geometry.normals.at(corner, polygon, at).unwrap_or(Vec3::ZERO),
            uvs: [uv.unwrap_or(Vec2::ZERO), geometry.uvs[1].at(corner, polygon, at).unwrap_or(Vec2::ZERO)],
            colour: geometry.colours.at(corner, polygon, at).unwrap_or(Rgb::WHITE),
        };
        self.has_uvs |= uv.is_some();
        let mut known = self.first[at];
        for _ in 0..MAX_CHAIN {
            if known == NONE {
                break;
            }
            if self.attributes(known as usize) == attributes {
                return known;
            }
            known = self.next[known as usize];
        }
        let vertex = self.next.len() as u32;
        self.next.push(std::mem::replace(&mut self.first[at], vertex));
        let mesh = &mut self.mesh;
        mesh.positions.push(geometry.positions[at]);
        fn push_if<T>(is_there: bool, list: &mut Vec<T>, item: T) {
            if is_there {
                list.push(item);
            }
        }
        push_if(!geometry.normals.is_empty(), &mut mesh.normals, attributes.normal);
        push_if(!geometry.uvs[0].is_empty(), &mut mesh.uvs, attributes.uvs[0]);
        push_if(!geometry.uvs[1].is_empty(), &mut mesh.uvs2, attributes.uvs[1]);
        push_if(!geometry.colours.is_empty(), &mut mesh.vertex_kd, attributes.colour);
        vertex
    }

    /// What a vertex has.
    #[inline]
    fn attributes(&self, vertex: usize) -> Attributes {
        let mesh = &self.mesh;
        Attributes {
            normal: mesh.normals.get(vertex).copied().unwrap_or(Vec3::ZERO),
            uvs: [&mesh.uvs, &mesh.uvs2].map(|uvs| uvs.get(vertex).copied().unwrap_or(Vec2::ZERO)),
            colour: mesh.vertex_kd.get(vertex).copied().unwrap_or(Rgb::WHITE),
        }
    }
}
