//! Makes triangles of polygons. Corners at one control point that have the same attributes share a vertex.

use super::layer::Layer;
use super::mesh::PolygonMesh;
use super::workshop::Workshop;
use crate::FormatError;
use crate::geometry::polygon::Triangulator;
use crate::meshes::indexed_faces::NONE;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Mesh;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The faces of a mesh that have one material.
#[derive(Clone)]
pub struct Part {
    pub mesh: Arc<Mesh>,
    /// The number of its material among those of the mesh.
    pub material: usize,
}

/// A vertex: position, normal, two pairs of texture coordinates, colour, and its link.
type Vertex = [u32; 14];

/// Longer chains of vertices at one control point are not searched: a hostile file costs vertices, not time.
const MAX_CHAIN: usize = 32;

/// The mesh in parts of one material each.
pub fn parts(geometry: PolygonMesh, workshop: &mut Workshop, file: &str) -> Result<Vec<Part>, FormatError> {
    let materials = &geometry.materials_of_faces()[..];
    workshop.budget.take_bytes(12 * (geometry.polygons.len() + geometry.positions.len()) as u64, file)?;
    let mut of_material: BTreeMap<i32, Vec<u32>> = BTreeMap::new();
    if let &[only] = materials {
        of_material.insert(only, Vec::new());
    } else {
        for (polygon, &material) in materials.iter().enumerate() {
            of_material.entry(material).or_default().push(polygon as u32);
        }
    }
    let (polygons, first) = (geometry.polygons.len(), vec![NONE; geometry.positions.len()]);
    let mut welder = Welder { geometry, first, made: Vec::new(), has_uvs: false };
    let mut parts = Vec::new();
    let mut left = of_material.len();
    for (material, list) in of_material {
        left -= 1;
        workshop.budget.take::<(Part, Mesh)>(1, file)?;
        let mesh = match &list[..] {
            [] => welder.part(0..polygons, true, workshop, file)?,
            list => welder.part(list.iter().map(|&polygon| polygon as usize), left == 0, workshop, file)?,
        };
        if !mesh.triangles.is_empty() {
            parts.push(Part { mesh: Arc::new(mesh), material: material as usize });
        }
    }
    Ok(parts)
}

/// Makes one part after the other.
struct Welder {
    geometry: PolygonMesh,
    /// The last vertex at each control point.
    first: Vec<u32>,
    /// The vertices of the part.
    made: Vec<Made>,
    has_uvs: bool,
}

/// A vertex, by the corner that it was made of.
#[derive(Clone, Copy)]
struct Made {
    corner: u32,
    polygon: u32,
    position: u32,
    /// The vertex that was made before at the same control point.
    next: u32,
}

/// Attributes of a corner besides its position.
#[derive(Clone, Copy, PartialEq)]
struct Attributes {
    normal: Vec3,
    uvs: [Vec2; 2],
    colour: Rgb,
}

impl Welder {
    /// The mesh of some polygons, whose corners become vertices of it; of the last ones it gives up the lists one by one, so that little is
    /// held twice.
    fn part(
        &mut self,
        polygons: impl Iterator<Item = usize> + Clone,
        is_last: bool,
        workshop: &mut Workshop,
        file: &str,
    ) -> Result<Mesh, FormatError> {
        for polygon in polygons.clone() {
            if !self.geometry.polygons.is_drawn(polygon) {
                continue;
            }
            let corners = self.geometry.polygons.range(polygon);
            let made = self.made.len();
            for corner in corners.clone() {
                self.geometry.polygons.corners[corner] = self.vertex(corner, polygon);
            }
            workshop.budget.take::<Vertex>(self.made.len() - made, file)?;
            workshop.budget.take::<[u32; 3]>(corners.len() - 2, file)?;
        }
        let made = std::mem::take(&mut self.made);
        made.iter().for_each(|made| self.first[made.position as usize] = NONE);
        if is_last {
            self.first = Vec::new();
        }
        let geometry = &mut self.geometry;
        let mut mesh = Mesh { name: geometry.name.clone(), ..Mesh::default() };
        mesh.positions = made.iter().map(|made| geometry.positions[made.position as usize]).collect();
        if is_last {
            geometry.positions = Vec::new();
        }
        mesh.normals = of_vertices(&mut geometry.normals, &made, Vec3::ZERO, is_last);
        let [uvs, uvs2] = &mut geometry.uvs;
        mesh.uvs = of_vertices(uvs, &made, Vec2::ZERO, is_last);
        if !std::mem::take(&mut self.has_uvs) {
            mesh.uvs = Vec::new();
        }
        mesh.uvs2 = of_vertices(uvs2, &made, Vec2::ZERO, is_last);
        mesh.vertex_kd = of_vertices(&mut geometry.colours, &made, Rgb::WHITE, is_last);
        drop(made);
        mesh.triangles = self.triangles(polygons, &mesh.positions, workshop);
        Ok(mesh)
    }

    /// The triangles of polygons whose corners are vertices.
    fn triangles(
        &self,
        polygons: impl Iterator<Item = usize> + Clone,
        positions: &[Vec3],
        workshop: &mut Workshop,
    ) -> Vec<[u32; 3]> {
        let geometry = &self.geometry;
        let drawn = polygons.filter(|&polygon| geometry.polygons.is_drawn(polygon));
        let count = drawn.clone().map(|polygon| geometry.polygons.range(polygon).len() - 2).sum();
        let mut triangles = Vec::with_capacity(count);
        let mut triangulator = Triangulator::default();
        for polygon in drawn {
            let corners = &geometry.polygons.corners[geometry.polygons.range(polygon)];
            let exact = match *corners {
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
                workshop.diagnostics.note(what, bilux_scene::Span::default);
            }
        }
        if geometry.is_mirrored {
            triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        triangles.shrink_to_fit();
        triangles
    }

    /// The vertex of a corner, made if it is new.
    #[inline]
    fn vertex(&mut self, corner: usize, polygon: usize) -> u32 {
        let position = self.geometry.polygons.corners[corner];
        let attributes = self.attributes(corner, polygon, position as usize);
        self.has_uvs = self.has_uvs || self.geometry.uvs[0].at(corner, polygon, position as usize).is_some();
        let first = self.first[position as usize];
        let mut known = first;
        for _ in 0..MAX_CHAIN {
            let Some(made) = self.made.get(known as usize) else { break };
            if self.attributes(made.corner as usize, made.polygon as usize, position as usize) == attributes {
                return known;
            }
            known = made.next;
        }
        let vertex = self.made.len() as u32;
        self.made.push(Made { corner: corner as u32, polygon: polygon as u32, position, next: first });
        self.first[position as usize] = vertex;
        vertex
    }

    /// Attributes of a corner of a polygon at a control point.
    #[inline]
    fn attributes(&self, corner: usize, polygon: usize, position: usize) -> Attributes {
        let geometry = &self.geometry;
        Attributes {
            normal: geometry.normals.at(corner, polygon, position).unwrap_or(Vec3::ZERO),
            uvs: [0, 1].map(|set| geometry.uvs[set].at(corner, polygon, position).unwrap_or(Vec2::ZERO)),
            colour: geometry.colours.at(corner, polygon, position).unwrap_or(Rgb::WHITE),
        }
    }
}

/// Values of a layer at vertices; the layer is given up if they are the last ones.
fn of_vertices<T: Copy>(layer: &mut Layer<T>, made: &[Made], missing: T, is_last: bool) -> Vec<T> {
    if layer.is_empty() {
        return Vec::new();
    }
    let of = |made: &Made| layer.at(made.corner as usize, made.polygon as usize, made.position as usize);
    let values = made.iter().map(|made| of(made).unwrap_or(missing)).collect();
    if is_last {
        *layer = Layer::default();
    }
    values
}
