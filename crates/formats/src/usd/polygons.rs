//! From faces with primvars to triangles.

use super::primvars::{Place, Primvar};
use crate::normals::CornerNormals;
use crate::polygon::Triangulator;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Mesh;

/// The faces of a mesh, and what its places have.
pub(super) struct Polygons {
    pub(super) points: Vec<Vec3>,
    /// The vertex of each corner.
    pub(super) corners: Vec<u32>,
    /// The end of each face's corners.
    pub(super) ends: Vec<u32>,
    /// True for faces that are not drawn.
    pub(super) is_hole: Vec<bool>,
    /// Faces run clockwise.
    pub(super) is_left_handed: bool,
    pub(super) normals: Option<Primvar>,
    /// The file has normals.
    pub(super) has_normals: bool,
    /// In place of those.
    pub(super) computed: Option<CornerNormals>,
    pub(super) colours: Option<Primvar>,
    pub(super) opacities: Option<Primvar>,
}

/// No vertex.
const NONE: u32 = u32::MAX;
/// Longer chains are not searched: a hostile file costs vertices, not time.
const MAX_CHAIN: usize = 32;

/// Finds vertices that a part of a mesh has already, for one part after the other.
pub(super) struct Welder {
    /// The part and the last vertex that was made of each point.
    last: Vec<(u32, u32)>,
    part: u32,
}

impl Welder {
    pub(super) fn new(points: usize) -> Welder {
        Welder { last: vec![(0, 0); points], part: 0 }
    }
}

/// The attributes of a vertex.
#[derive(Clone, Copy, PartialEq)]
struct Vertex {
    uv: Vec2,
    uv2: Vec2,
    normal: Vec3,
    colour: Rgb,
    opacity: f32,
}

/// A part of a mesh under construction.
struct Part<'p> {
    polygons: &'p Polygons,
    uvs: &'p [Option<Primvar>; 2],
    /// Corners of one point are one vertex.
    is_by_point: bool,
    mesh: Mesh,
    /// The vertex that was made before this one of the same point.
    before: Vec<u32>,
}

impl Polygons {
    pub(super) fn face(&self, face: usize) -> std::ops::Range<usize> {
        let start = if face == 0 { 0 } else { self.ends[face - 1] as usize };
        start..self.ends[face] as usize
    }

    /// The triangles of some faces; false, too, if some polygon was too large to be triangulated well.
    pub(super) fn part(
        &self,
        faces: impl Iterator<Item = usize>,
        uvs: &[Option<Primvar>; 2],
        welder: &mut Welder,
    ) -> (Mesh, bool) {
        welder.part += 1;
        let is_by_point = self.is_by_point(uvs);
        let mut part = Part { polygons: self, uvs, is_by_point, mesh: Mesh::default(), before: Vec::new() };
        let mut triangulator = Triangulator::default();
        let (mut vertices, mut is_fine) = (Vec::new(), true);
        for face in faces.filter(|face| !self.is_hole.get(*face).is_some_and(|hole| *hole)) {
            let range = self.face(face);
            if range.len() < 3 {
                continue;
            }
            vertices.clear();
            for corner in range {
                let place = Place { corner, vertex: self.corners[corner] as usize, face };
                vertices.push(part.vertex(place, welder));
            }
            let Mesh { positions, triangles, .. } = &mut part.mesh;
            if let [a, b, c] = vertices[..] {
                triangles.push(if self.is_left_handed { [a, c, b] } else { [a, b, c] });
                continue;
            }
            let points = vertices.iter().map(|&vertex| positions[vertex as usize]);
            is_fine &= triangulator
                .triangulate(points, |t| {
                    let [a, b, c] = t.map(|i| vertices[i as usize]);
                    triangles.push(if self.is_left_handed { [a, c, b] } else { [a, b, c] });
                })
                .is_some();
        }
        (part.mesh, is_fine)
    }

    /// True if nothing differs between the corners of a point.
    fn is_by_point(&self, uvs: &[Option<Primvar>; 2]) -> bool {
        let others = [&self.normals, &self.colours, &self.opacities].into_iter().chain(uvs);
        self.computed.is_none() && others.flatten().all(Primvar::is_by_point)
    }

    fn normal(&self, place: Place) -> Vec3 {
        if let Some(found) = &self.computed {
            return found.normals[found.of_corner[place.corner] as usize];
        }
        self.normals.as_ref().map_or(Vec3::ZERO, |normals| Vec3::from(normals.at::<3>(place)))
    }
}

impl Part<'_> {
    fn vertex(&mut self, place: Place, welder: &mut Welder) -> u32 {
        let (made_in, made) = welder.last[place.vertex];
        if self.is_by_point && made_in == welder.part {
            return made;
        }
        let [uv, uv2] =
            [0, 1].map(|set| self.uvs[set].as_ref().map_or(Vec2::ZERO, |uv| uv.at::<2>(place).into()));
        let polygons = self.polygons;
        let colour =
            polygons.colours.as_ref().map_or(Rgb::BLACK, |list| Rgb::from_array(list.at::<3>(place)));
        let opacity = polygons.opacities.as_ref().map_or(1.0, |list| list.at::<1>(place)[0]);
        let vertex = Vertex { uv, uv2, normal: polygons.normal(place), colour, opacity };
        let slot = &mut welder.last[place.vertex];
        let mut next = if slot.0 == welder.part { slot.1 } else { NONE };
        let last = next;
        for _ in 0..MAX_CHAIN {
            if next == NONE {
                break;
            }
            if self.is(next as usize, &vertex) {
                return next;
            }
            next = self.before[next as usize];
        }
        let index = self.mesh.positions.len() as u32;
        *slot = (welder.part, index);
        self.before.push(last);
        self.push(place, &vertex);
        index
    }

    /// True if a vertex has these attributes.
    fn is(&self, i: usize, wanted: &Vertex) -> bool {
        let mesh = &self.mesh;
        let same = |uvs: &[Vec2], wanted: Vec2| uvs.get(i).is_none_or(|uv| *uv == wanted);
        same(&mesh.uvs, wanted.uv)
            && same(&mesh.uvs2, wanted.uv2)
            && mesh.normals.get(i).is_none_or(|n| *n == wanted.normal)
            && mesh.vertex_kd.get(i).is_none_or(|c| *c == wanted.colour)
            && mesh.vertex_opacity.get(i).is_none_or(|o| *o == wanted.opacity)
    }

    fn push(&mut self, place: Place, vertex: &Vertex) {
        let (mesh, polygons) = (&mut self.mesh, self.polygons);
        mesh.positions.push(polygons.points[place.vertex]);
        if self.uvs[0].is_some() {
            mesh.uvs.push(vertex.uv);
        }
        if self.uvs[1].is_some() {
            mesh.uvs2.push(vertex.uv2);
        }
        if polygons.normals.is_some() || polygons.computed.is_some() {
            mesh.normals.push(vertex.normal);
        }
        if polygons.colours.is_some() {
            mesh.vertex_kd.push(vertex.colour);
        }
        if polygons.opacities.is_some() {
            mesh.vertex_opacity.push(vertex.opacity);
        }
    }
}
