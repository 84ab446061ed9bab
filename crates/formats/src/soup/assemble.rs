//! Faces over separate lists of positions, uvs and normals, into meshes.

use super::{Corner, NONE, Run, Soup};
use crate::FormatError;
use crate::normals::{FLAT, Faces};
use crate::polygon::Triangulator;
use crate::reading::{Oddities, Reading, Source, plain_material};
use crate::text::Places;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Mesh, Object, SceneBuilder};
use std::collections::HashMap;
use std::sync::Arc;

/// What a vertex takes while it is made: position, normal, uv, kd and what finds it again.
type Vertex = [u32; 14];

/// Makes an object of every run.
pub(crate) fn assemble(
    reading: &mut Reading,
    source: &Source,
    places: &Places,
    mut soup: Soup,
    mut materials: HashMap<String, usize>,
    scene: &mut SceneBuilder,
    oddities: &mut Oddities,
) -> Result<(), FormatError> {
    check_indices(&mut soup, places, oddities)?;
    add_normals(reading, source, &mut soup)?;
    reading.budget.take_bytes((soup.positions.len() * size_of::<Slot>()) as u64, source.name)?;
    // A polygon has two triangles fewer than corners.
    reading.budget.take::<[u32; 3]>(soup.corners.len() - 2 * soup.ends.len(), source.name)?;
    let mut welder = Welder::new(soup.positions.len());
    let mut triangulator = Triangulator::default();
    let stem = source.stem();
    let runs = std::mem::take(&mut soup.runs);
    for (i, run) in runs.iter().enumerate() {
        let end = runs.get(i + 1).map_or(soup.ends.len(), |next| next.first_face);
        let mut piece = Piece::new(&soup, &mut welder);
        for face in run.first_face..end {
            let made = piece.made.len();
            if piece.add_face(face, &mut triangulator).is_none() {
                let what = "a hollow polygon has too many corners to be cut, and is drawn as if it bulged";
                oddities.note(what, || places.at(soup.offsets[face]));
            }
            reading.budget.take::<Vertex>(piece.made.len() - made, source.name)?;
        }
        piece.note_gaps(run, places, &soup, oddities);
        let material = material_of(run, &soup, &mut materials, places, scene, oddities);
        let mut mesh = piece.mesh;
        let name = if run.name.is_empty() { &stem } else { &run.name };
        mesh.name.clone_from(name);
        scene.objects.push(Object::new(name, Arc::new(mesh), material));
    }
    Ok(())
}

/// Indices may point forward, so they are looked at when everything has been read. Without its position a
/// corner is nothing; it can do without the rest.
fn check_indices(soup: &mut Soup, places: &Places, oddities: &mut Oddities) -> Result<(), FormatError> {
    let counts = [soup.positions.len(), soup.uvs.len(), soup.normals.len()].map(|n| n as u32);
    let (ends, offsets) = (&soup.ends, &soup.offsets);
    let place = |corner: usize| places.at(offsets[ends.partition_point(|&end| end as usize <= corner)]);
    for (i, corner) in soup.corners.iter_mut().enumerate() {
        if corner[0] >= counts[0] {
            let (named, count) = (u64::from(corner[0]) + u64::from(soup.first_vertex), counts[0]);
            let from = if soup.first_vertex == 0 { ", counted from 0" } else { "" };
            let message = format!("this face names vertex {named}, but the file has only {count}{from}");
            return Err(FormatError::malformed(message, place(i)));
        }
        for part in [1, 2] {
            if corner[part] != NONE && corner[part] >= counts[part] {
                corner[part] = NONE;
                let what = "a face names texture coordinates or a normal that the file does not have";
                oddities.note(what, || place(i));
            }
        }
    }
    Ok(())
}

/// Gives corners without a normal one by smoothing groups or the crease angle, if any of them needs one.
fn add_normals(reading: &mut Reading, source: &Source, soup: &mut Soup) -> Result<(), FormatError> {
    let lacking = soup.corners.iter().any(|corner| corner[2] == NONE);
    let mixed = lacking && !soup.normals.is_empty();
    let angle = reading.crease_angle;
    if !lacking || (angle <= 0.0 && !mixed) {
        return Ok(());
    }
    if angle <= 0.0 {
        soup.smoothing.fill(FLAT);
    }
    // Each corner its neighbours, its index and at most a normal; each face its own.
    let needed = 24 * soup.corners.len() + 16 * (soup.ends.len() + soup.positions.len());
    reading.budget.take_bytes(needed as u64, source.name)?;
    let faces = Faces {
        positions: &soup.positions,
        ends: &soup.ends,
        position_of: |corner: usize| soup.corners[corner][0],
        smoothing: &soup.smoothing,
    };
    let found = if mixed { Some(faces.all_corner_normals(angle)) } else { faces.corner_normals(angle) };
    let Some(found) = found else { return Ok(()) };
    let given = soup.normals.len() as u32;
    for (corner, index) in
        soup.corners.iter_mut().zip(found.of_corner).filter(|(corner, _)| corner[2] == NONE)
    {
        corner[2] = given + index;
    }
    soup.normals.extend(found.normals);
    Ok(())
}

fn material_of(
    run: &Run,
    soup: &Soup,
    materials: &mut HashMap<String, usize>,
    places: &Places,
    scene: &mut SceneBuilder,
    oddities: &mut Oddities,
) -> usize {
    let (name, offset) = match &run.material {
        Some((name, offset)) => (name.as_str(), Some(*offset)),
        None => ("", None),
    };
    // No library can have a material without a name.
    if let Some(&index) = materials.get(name) {
        return index;
    }
    if let Some(offset) = offset {
        let what = "a material is in no library that was read; a plain one stands in its place";
        oddities.note(what, || places.at(offset));
    }
    let mut spec = plain_material(!soup.colours.is_empty(), !soup.specular.is_empty());
    if offset.is_some() {
        name.clone_into(&mut spec.name);
    }
    let index = scene.add_material(spec);
    materials.insert(name.to_owned(), index);
    index
}

/// Finds again the vertex of a corner that was seen before in the same run.
struct Welder {
    slots: Vec<Slot>,
    run: u32,
}

/// The vertices made of a position in the run with this number: the first of a chain.
#[derive(Clone, Copy, Default)]
struct Slot {
    run: u32,
    first: u32,
}

/// Chains longer than this are not searched: what a hostile file gains is vertices, not time.
const LONGEST_CHAIN: usize = 32;

impl Welder {
    fn new(positions: usize) -> Welder {
        Welder { slots: vec![Slot::default(); positions], run: 0 }
    }
}

/// A mesh in the making.
struct Piece<'s> {
    soup: &'s Soup,
    welder: &'s mut Welder,
    mesh: Mesh,
    /// For each vertex: its uv and normal, and the next vertex of the same position.
    made: Vec<[u32; 3]>,
    corners: Vec<u32>,
    has_uvs: bool,
    lacks_uvs: bool,
}

impl<'s> Piece<'s> {
    fn new(soup: &'s Soup, welder: &'s mut Welder) -> Piece<'s> {
        welder.run += 1;
        let (mesh, made, corners) = (Mesh::default(), Vec::new(), Vec::new());
        Piece { soup, welder, mesh, made, corners, has_uvs: false, lacks_uvs: false }
    }

    /// `None` when a polygon could not be cut properly.
    fn add_face(&mut self, face: usize, triangulator: &mut Triangulator) -> Option<()> {
        let start = if face == 0 { 0 } else { self.soup.ends[face - 1] } as usize;
        let corners = &self.soup.corners[start..self.soup.ends[face] as usize];
        if let [a, b, c] = corners {
            let triangle = [self.vertex(*a), self.vertex(*b), self.vertex(*c)];
            self.mesh.triangles.push(triangle);
            return Some(());
        }
        self.corners.clear();
        for &corner in corners {
            let vertex = self.vertex(corner);
            self.corners.push(vertex);
        }
        let (corners, triangles) = (&self.corners, &mut self.mesh.triangles);
        let points = corners.iter().map(|&i| self.mesh.positions[i as usize]);
        triangulator.triangulate(points, |t| triangles.push(t.map(|i| corners[i as usize])))
    }

    /// The vertex of a corner, made when it is new.
    #[inline]
    fn vertex(&mut self, [position, uv, normal]: Corner) -> u32 {
        let slot = &mut self.welder.slots[position as usize];
        let mut next = if slot.run == self.welder.run { slot.first } else { NONE };
        let chain = next;
        for _ in 0..LONGEST_CHAIN {
            let Some(&[old_uv, old_normal, after]) = self.made.get(next as usize) else { break };
            if (old_uv, old_normal) == (uv, normal) {
                return next;
            }
            next = after;
        }
        let vertex = self.made.len() as u32;
        *slot = Slot { run: self.welder.run, first: vertex };
        self.made.push([uv, normal, chain]);
        self.push_attributes([position, uv, normal]);
        vertex
    }

    fn push_attributes(&mut self, [position, uv, normal]: Corner) {
        let (soup, mesh) = (self.soup, &mut self.mesh);
        mesh.positions.push(soup.positions[position as usize]);
        if !soup.uvs.is_empty() {
            let given = soup.uvs.get(uv as usize);
            self.has_uvs |= given.is_some();
            self.lacks_uvs |= given.is_none();
            mesh.uvs.push(given.copied().unwrap_or(Vec2::ZERO));
        }
        if !soup.normals.is_empty() {
            mesh.normals.push(soup.normals.get(normal as usize).copied().unwrap_or(Vec3::ZERO));
        }
        if !soup.colours.is_empty() {
            mesh.vertex_kd.push(soup.colours.get(position as usize).copied().unwrap_or(Rgb::WHITE));
        }
        if !soup.specular.is_empty() {
            mesh.vertex_ks.push(soup.specular.get(position as usize).copied().unwrap_or(Rgb::WHITE));
        }
    }

    /// A mesh has texture coordinates at all vertices or at none.
    fn note_gaps(&mut self, run: &Run, places: &Places, soup: &Soup, oddities: &mut Oddities) {
        if !self.has_uvs {
            self.mesh.uvs = Vec::new();
        } else if self.lacks_uvs {
            let what = "some corners of an object have no texture coordinates; they are 0 there";
            oddities.note(what, || places.at(soup.offsets[run.first_face]));
        }
    }
}
