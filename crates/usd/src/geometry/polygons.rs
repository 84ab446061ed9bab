//! From faces with primvars to triangles.

use crate::geometry::primvars::{Place, Primvar};
use bilux_import::geometry::normals::CornerNormals;
use bilux_import::geometry::polygon::Triangulator;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Mesh;

/// The faces of a mesh, and what its places have.
pub(crate) struct Polygons {
    pub(crate) points: Vec<Vec3>,
    /// The vertex of each corner.
    pub(crate) corners: Vec<u32>,
    /// The end of each face's corners.
    pub(crate) ends: Vec<u32>,
    /// True for faces that are not drawn.
    pub(crate) is_hole: Vec<bool>,
    /// Faces run clockwise.
    pub(crate) is_left_handed: bool,
    pub(crate) normals: Option<Primvar>,
    /// The file has normals.
    pub(crate) has_normals: bool,
    /// In place of those.
    pub(crate) computed: Option<CornerNormals>,
    pub(crate) colours: Option<Primvar>,
    pub(crate) opacities: Option<Primvar>,
}

/// No vertex.
const NONE: u32 = u32::MAX;
/// Longer chains are not searched: a hostile file costs vertices, not time.
const MAX_CHAIN: usize = 32;

/// Finds vertices that a part of a mesh has already, for one part after the other.
pub(crate) struct Welder {
    /// The part and the last vertex that was made of each point.
    last: Vec<(u32, u32)>,
    part: u32,
}

impl Welder {
    pub(crate) fn new(points: usize) -> Welder {
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
    pub(crate) fn face(&self, face: usize) -> std::ops::Range<usize> {
        let start = if face == 0 { 0 } else { self.ends[face - 1] as usize };
        start..self.ends[face] as usize
    }

    /// All of it as one mesh, whose vertices are the points in use, in the order of the faces. It gives up its lists one by one, so that
    /// little is held twice. `None` if there are faces other than triangles, or points with more than one vertex.
    pub(crate) fn take_triangles(&mut self, uvs: &mut [Option<Primvar>; 2]) -> Option<Mesh> {
        let all_triangles = 3 * self.ends.len() == self.corners.len()
            && self.ends.iter().enumerate().all(|(face, &end)| end as usize == 3 * face + 3);
        if !all_triangles || !self.is_hole.is_empty() || !self.is_by_point(uvs) {
            return None;
        }
        let mut vertex_of = vec![NONE; self.points.len()];
        let mut used = Vec::with_capacity(self.points.len());
        for corner in &mut self.corners {
            let vertex = &mut vertex_of[*corner as usize];
            if *vertex == NONE {
                *vertex = used.len() as u32;
                used.push(*corner);
            }
            *corner = *vertex;
        }
        drop(vertex_of);
        let points = std::mem::take(&mut self.points);
        let positions = used.iter().map(|&point| points[point as usize]).collect();
        drop(points);
        let [uv, uv2] = uvs;
        let mut mesh = Mesh {
            positions,
            normals: values(self.normals.take(), &used, Vec3::from),
            uvs: values(uv.take(), &used, Vec2::from),
            uvs2: values(uv2.take(), &used, Vec2::from),
            vertex_kd: values(self.colours.take(), &used, Rgb::from_array),
            vertex_opacity: values(self.opacities.take(), &used, |[opacity]| opacity),
            ..Mesh::default()
        };
        let corners = std::mem::take(&mut self.corners);
        let is_left_handed = self.is_left_handed;
        let turned = |&[a, b, c]: &[u32; 3]| if is_left_handed { [a, c, b] } else { [a, b, c] };
        mesh.triangles = corners.as_chunks::<3>().0.iter().map(turned).collect();
        Some(mesh)
    }

    /// The triangles of some faces, or of all; false, too, if some polygon was too large to be triangulated well.
    pub(crate) fn part(
        &self,
        faces: impl Iterator<Item = usize>,
        uvs: &[Option<Primvar>; 2],
        welder: &mut Welder,
        is_all: bool,
    ) -> (Mesh, bool) {
        welder.part += 1;
        let is_by_point = self.is_by_point(uvs);
        let mesh = if is_all { self.with_capacity(uvs) } else { Mesh::default() };
        let mut part = Part { polygons: self, uvs, is_by_point, mesh, before: Vec::new() };
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
        let mut mesh = part.mesh;
        mesh.positions.shrink_to_fit();
        mesh.normals.shrink_to_fit();
        mesh.uvs.shrink_to_fit();
        mesh.uvs2.shrink_to_fit();
        mesh.triangles.shrink_to_fit();
        (mesh, is_fine)
    }

    /// An empty mesh with room for all triangles, and for as many vertices as there are points or computed normals.
    fn with_capacity(&self, uvs: &[Option<Primvar>; 2]) -> Mesh {
        let vertices = self.computed.as_ref().map_or(self.points.len(), |found| found.normals.len());
        let has_normals = self.normals.is_some() || self.computed.is_some();
        let or_none = |is_there: bool| if is_there { vertices } else { 0 };
        Mesh {
            positions: Vec::with_capacity(vertices),
            normals: Vec::with_capacity(or_none(has_normals)),
            uvs: Vec::with_capacity(or_none(uvs[0].is_some())),
            uvs2: Vec::with_capacity(or_none(uvs[1].is_some())),
            triangles: Vec::with_capacity(self.corners.len().saturating_sub(2 * self.ends.len())),
            ..Mesh::default()
        }
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

/// Values of an attribute at some points; none if there is no such attribute.
fn values<T, const N: usize>(primvar: Option<Primvar>, points: &[u32], of: impl Fn([f32; N]) -> T) -> Vec<T> {
    let Some(primvar) = primvar else { return Vec::new() };
    let place = |&point: &u32| Place { corner: 0, vertex: point as usize, face: 0 };
    points.iter().map(|point| of(primvar.at::<N>(place(point)))).collect()
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
        if !self.is_by_point {
            self.before.push(last);
        }
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
