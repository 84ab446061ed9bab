//! Assembles meshes from faces with separate lists of positions, uvs and normals.

use super::cage::as_cage;
use super::{Corner, FaceList, IndexedFaces, NONE, Run};
use crate::FormatError;
use crate::geometry::normals::{FLAT, Faces};
use crate::geometry::polygon::Triangulator;
use crate::input::diagnostics::Diagnostics;
use crate::input::reading::{Reading, Source, plain_material};
use crate::input::sink::Sink;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::{Mesh, Object, Span};
use std::collections::HashMap;
use std::sync::Arc;

/// The size of a vertex under construction: position, normal, uv, kd and its entry in the welder.
type Vertex = [u32; 15];

/// Makes an object of every run. `place` converts the numbers in [`IndexedFaces::places`] to locations.
pub fn assemble(
    reading: &mut Reading,
    source: &Source,
    place: &dyn Fn(u64) -> Span,
    mut indexed: IndexedFaces,
    mut materials: HashMap<String, usize>,
    sink: &mut Sink,
) -> Result<(), FormatError> {
    check_indices(&mut indexed, place, &mut sink.diagnostics)?;
    if let Some(scheme) = reading.options.subdivide {
        return as_cage(scheme, reading, source, place, indexed, sink, |run, indexed, sink| {
            material_of(run, indexed, &mut materials, place, sink)
        });
    }
    add_normals(reading, source, &mut indexed)?;
    reading.budget.take_bytes((indexed.positions.len() * size_of::<Slot>()) as u64, source.name)?;
    // A polygon has two triangles fewer than it has corners.
    let triangles = indexed.faces.corner_count() - 2 * indexed.faces.len();
    reading.budget.take::<[u32; 3]>(triangles, source.name)?;
    let faces = std::mem::take(&mut indexed.faces);
    let mut welder = Welder::new(indexed.positions.len());
    let mut triangulator = Triangulator::default();
    let mut run_sizes = run_sizes(&indexed, &faces).into_iter();
    let mut piece = Piece::new(&indexed, run_sizes.next());
    let mut run = 0;
    let mut finish = |piece: Piece, run: &Run, sink: &mut Sink| {
        let name = if run.name.is_empty() { source.stem() } else { run.name.clone() };
        let mesh = Mesh { name: name.clone(), ..piece.into_mesh(run, place, &mut sink.diagnostics) };
        let material = material_of(run, &indexed, &mut materials, place, sink);
        sink.scene.objects.push(Object::new(&name, Arc::new(mesh), material));
    };
    // Corners are freed as triangles are made from them: holding both would be the peak of memory.
    faces.consume(|face, corners| {
        if indexed.runs.get(run + 1).is_some_and(|next| next.first_face <= face) {
            let done = std::mem::replace(&mut piece, Piece::new(&indexed, run_sizes.next()));
            finish(done, &indexed.runs[run], sink);
            (run, welder.run) = (run + 1, welder.run + 1);
        }
        let made = piece.made.len();
        if piece.add_face(face, corners, &mut welder, &mut triangulator).is_none() {
            let what =
                "a concave polygon has too many corners to triangulate exactly and is treated as convex";
            sink.diagnostics.note(what, || place(indexed.places.at(face)));
        }
        reading.budget.take::<Vertex>(piece.made.len() - made, source.name)
    })?;
    if let Some(last) = indexed.runs.get(run) {
        finish(piece, last, sink);
    }
    Ok(())
}

/// The number of corners and faces of a run.
#[derive(Clone, Copy, Default)]
struct RunSize {
    corners: usize,
    faces: usize,
}

fn run_sizes(indexed: &IndexedFaces, faces: &FaceList) -> Vec<RunSize> {
    let mut run_sizes = vec![RunSize::default(); indexed.runs.len()];
    let mut run = 0;
    for (face, corners) in faces.iter().enumerate() {
        run += usize::from(indexed.runs.get(run + 1).is_some_and(|next| next.first_face <= face));
        run_sizes[run].corners += corners.len();
        run_sizes[run].faces += 1;
    }
    run_sizes
}

/// Checks all indices after reading, since they may point forward.
///
/// A corner without a position is invalid; one without the rest is not.
fn check_indices(
    indexed: &mut IndexedFaces,
    place: &dyn Fn(u64) -> Span,
    diagnostics: &mut Diagnostics,
) -> Result<(), FormatError> {
    let mut first_fault = None;
    let counts = [indexed.positions.len(), indexed.uvs.len(), indexed.normals.len()].map(|n| n as u32);
    let places = &indexed.places;
    let mut left_out: Vec<usize> = Vec::new();
    for (face, corner) in indexed.faces.corners_mut() {
        if corner[0] >= counts[0] {
            let is_first = left_out.last() != Some(&face);
            if is_first {
                left_out.push(face);
            }
            // A corner without an index was reported where it was read.
            if corner[0] == NONE {
                continue;
            }
            let (named, count) = (u64::from(corner[0]) + u64::from(indexed.first_vertex), counts[0]);
            let from = if indexed.first_vertex == 0 { ", counted from 0" } else { "" };
            let message = format!("this face refers to vertex {named}, but the file has only {count}{from}");
            let at = || place(places.at(face));
            if !indexed.leaves_out || count == 0 {
                return Err(FormatError::malformed(message, at()));
            }
            if is_first {
                first_fault.get_or_insert_with(|| FormatError::malformed(message.clone(), at()));
                diagnostics.note_first(": this face is left out", || message, at);
            }
            continue;
        }
        for part in [1, 2] {
            if corner[part] != NONE && corner[part] >= counts[part] {
                corner[part] = NONE;
                let what = "a face refers to texture coordinates or a normal that the file does not have";
                diagnostics.note(what, || place(places.at(face)));
            }
        }
    }
    if left_out.len() == indexed.faces.len() {
        return indexed.first_fault.take().or(first_fault).map_or(Ok(()), Err);
    }
    // A face whose corners coincide has no area.
    let mut left_out = left_out.into_iter().peekable();
    for (face, corner) in indexed.faces.corners_mut() {
        while left_out.next_if(|&gone| gone < face).is_some() {}
        if left_out.peek() == Some(&face) {
            corner[0] = 0;
        }
    }
    Ok(())
}

/// Computes normals for corners without one, by smoothing groups or the crease angle.
fn add_normals(
    reading: &mut Reading,
    source: &Source,
    indexed: &mut IndexedFaces,
) -> Result<(), FormatError> {
    let lacking = indexed.faces.iter().flatten().any(|corner| corner[2] == NONE);
    let mixed = lacking && !indexed.normals.is_empty();
    let angle = reading.crease_angle;
    if !lacking || (angle <= 0.0 && !mixed) {
        return Ok(());
    }
    if angle <= 0.0 {
        indexed.smoothing = vec![(0, FLAT)];
    }
    // Each corner takes its position, its neighbours' entry, its face and at most one normal; each face its own
    // normal, and each position its neighbours.
    let needed = 24 * indexed.faces.corner_count() + 24 * (indexed.faces.len() + indexed.positions.len());
    reading.budget.take_bytes(needed as u64, source.name)?;
    let mut corners = Vec::with_capacity(indexed.faces.corner_count());
    corners.extend(indexed.faces.iter().flatten().map(|corner| corner[0]));
    let mut ends = Vec::new();
    if indexed.faces.iter().any(|corners| corners.len() != 3) {
        let mut end = 0;
        ends.extend(indexed.faces.iter().map(|corners| {
            end += corners.len() as u32;
            end
        }));
    }
    let faces =
        Faces { positions: &indexed.positions, corners, ends: &ends, smoothing: indexed.smoothing_of_each() };
    let found = if mixed { Some(faces.all_corner_normals(angle)) } else { faces.corner_normals(angle) };
    let Some(found) = found else { return Ok(()) };
    let given = indexed.normals.len() as u32;
    let corners = indexed.faces.corners_mut().map(|(_, corner)| corner);
    for (corner, index) in corners.zip(found.of_corner).filter(|(corner, _)| corner[2] == NONE) {
        corner[2] = given + index;
    }
    indexed.normals.extend(found.normals);
    Ok(())
}

/// The material of a run: one that was read, or a plain one in its place.
pub fn material_of(
    run: &Run,
    indexed: &IndexedFaces,
    materials: &mut HashMap<String, usize>,
    place: &dyn Fn(u64) -> Span,
    sink: &mut Sink,
) -> usize {
    let (name, offset) = match &run.material {
        Some((name, offset)) => (name.as_str(), Some(*offset)),
        None => ("", None),
    };
    // A library cannot define a material without a name.
    if let Some(&index) = materials.get(name) {
        return index;
    }
    if let Some(offset) = offset {
        let what = format!(
            "the material '{name}' is not in any material library that was read: a plain one is used instead"
        );
        sink.diagnostics.note(&what, || place(offset));
    }
    let mut spec = plain_material(indexed.has_colours(), !indexed.specular.is_empty());
    if offset.is_some() {
        name.clone_into(&mut spec.name);
    }
    let index = sink.scene.add_material(spec);
    materials.insert(name.to_owned(), index);
    index
}

/// Finds the vertex of a corner that already occurred in the same run.
struct Welder {
    slots: Vec<Slot>,
    run: u32,
}

/// The vertices made from a position in the run with this number: the head of a linked list.
#[derive(Clone, Copy, Default)]
struct Slot {
    run: u32,
    first: u32,
}

/// Longer chains are not searched: a hostile file costs vertices, not time.
const MAX_CHAIN: usize = 32;

impl Welder {
    fn new(positions: usize) -> Welder {
        Welder { slots: vec![Slot::default(); positions], run: 1 }
    }
}

/// A mesh under construction.
struct Piece<'s> {
    indexed: &'s IndexedFaces,
    mesh: Mesh,
    /// For each vertex its uv, its normal, its face's colour, and the next vertex at the same position.
    made: Vec<[u32; 4]>,
    /// The colour of the current face.
    colour: u32,
    corners: Vec<u32>,
    has_uvs: bool,
    lacks_uvs: bool,
}

impl<'s> Piece<'s> {
    /// Reserves memory for all triangles and the likely number of vertices; unused memory costs nothing.
    fn new(indexed: &'s IndexedFaces, size: Option<RunSize>) -> Piece<'s> {
        let RunSize { corners, faces } = size.unwrap_or_default();
        let longest = indexed.positions.len().max(indexed.uvs.len()).max(indexed.normals.len());
        let vertices = corners.min(longest);
        let of = |wanted: bool| if wanted { vertices } else { 0 };
        let mesh = Mesh {
            positions: Vec::with_capacity(vertices),
            uvs: Vec::with_capacity(of(!indexed.uvs.is_empty())),
            normals: Vec::with_capacity(of(!indexed.normals.is_empty())),
            vertex_kd: Vec::with_capacity(of(indexed.has_colours())),
            vertex_ks: Vec::with_capacity(of(!indexed.specular.is_empty())),
            triangles: Vec::with_capacity(corners - 2 * faces),
            ..Mesh::default()
        };
        let made = Vec::with_capacity(vertices);
        Piece { indexed, mesh, made, colour: NONE, corners: Vec::new(), has_uvs: false, lacks_uvs: false }
    }

    /// Returns `None` if a polygon could not be triangulated properly.
    fn add_face(
        &mut self,
        face: usize,
        corners: &[Corner],
        welder: &mut Welder,
        triangulator: &mut Triangulator,
    ) -> Option<()> {
        self.colour = self.indexed.face_colours.of(face);
        if let [a, b, c] = corners {
            let triangle = [self.vertex(*a, welder), self.vertex(*b, welder), self.vertex(*c, welder)];
            self.mesh.triangles.push(triangle);
            return Some(());
        }
        self.corners.clear();
        for &corner in corners {
            let vertex = self.vertex(corner, welder);
            self.corners.push(vertex);
        }
        let (corners, triangles) = (&self.corners, &mut self.mesh.triangles);
        let points = corners.iter().map(|&i| self.mesh.positions[i as usize]);
        triangulator.triangulate(points, |t| triangles.push(t.map(|i| corners[i as usize])))
    }

    /// The vertex of a corner, created if it is new.
    #[inline]
    fn vertex(&mut self, [position, uv, normal]: Corner, welder: &mut Welder) -> u32 {
        let slot = &mut welder.slots[position as usize];
        let mut next = if slot.run == welder.run { slot.first } else { NONE };
        let chain = next;
        for _ in 0..MAX_CHAIN {
            let Some(&[old_uv, old_normal, old_colour, after]) = self.made.get(next as usize) else { break };
            if (old_uv, old_normal, old_colour) == (uv, normal, self.colour) {
                return next;
            }
            next = after;
        }
        let vertex = self.made.len() as u32;
        *slot = Slot { run: welder.run, first: vertex };
        self.made.push([uv, normal, self.colour, chain]);
        self.push_attributes([position, uv, normal]);
        vertex
    }

    fn push_attributes(&mut self, [position, uv, normal]: Corner) {
        let (indexed, mesh) = (self.indexed, &mut self.mesh);
        mesh.positions.push(indexed.positions[position as usize]);
        if !indexed.uvs.is_empty() {
            let given = indexed.uvs.get(uv as usize);
            self.has_uvs |= given.is_some();
            self.lacks_uvs |= given.is_none();
            mesh.uvs.push(given.copied().unwrap_or(Vec2::ZERO));
        }
        if !indexed.normals.is_empty() {
            mesh.normals.push(indexed.normals.get(normal as usize).copied().unwrap_or(Vec3::ZERO));
        }
        if !indexed.face_colours.is_empty() {
            mesh.vertex_kd.push(indexed.face_colours.colour(self.colour));
        } else if !indexed.colours.is_empty() {
            mesh.vertex_kd.push(indexed.colours.get(position as usize).copied().unwrap_or(Rgb::WHITE));
        }
        if !indexed.specular.is_empty() {
            mesh.vertex_ks.push(indexed.specular.get(position as usize).copied().unwrap_or(Rgb::WHITE));
        }
    }

    /// Finishes the mesh; it has texture coordinates at all vertices or at none.
    fn into_mesh(mut self, run: &Run, place: &dyn Fn(u64) -> Span, diagnostics: &mut Diagnostics) -> Mesh {
        if !self.has_uvs {
            self.mesh.uvs = Vec::new();
        } else if self.lacks_uvs {
            let what = "some corners of an object have no texture coordinates; they are set to 0";
            diagnostics.note(what, || place(self.indexed.places.at(run.first_face)));
        }
        let mesh = &mut self.mesh;
        mesh.positions.shrink_to_fit();
        mesh.uvs.shrink_to_fit();
        mesh.normals.shrink_to_fit();
        mesh.vertex_kd.shrink_to_fit();
        mesh.vertex_ks.shrink_to_fit();
        self.mesh
    }
}
