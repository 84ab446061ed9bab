//! The meshes that an object of a file becomes: one for each look of its triangles.

use super::beams::Lattice;
use super::groups::GroupKind;
use super::looks::Look;
use super::mesh_data::{MeshData, NONE, TriangleProperties};
use super::model::{Model, Property};
use super::slicers::{Leaf, ObjectSettings, leaves};
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::geometry::normals::{BY_ANGLE, CornerNormals, Faces};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::Mesh;
use std::collections::HashMap;
use std::sync::Arc;

/// Triangles that share a look.
#[derive(Clone)]
pub(super) struct Piece {
    pub(super) look: Look,
    pub(super) mesh: Arc<Mesh>,
}

/// An object whose mesh becomes pieces.
pub(super) struct Whole<'a> {
    pub(super) model: &'a Model,
    pub(super) name: &'a str,
    /// The property of triangles without one.
    pub(super) property: Option<Property>,
    /// True if what has no property is printed with a filament whose colour is known.
    pub(super) has_filaments: bool,
    /// Settings of a slicer for parts of the mesh.
    pub(super) settings: Option<&'a ObjectSettings>,
}

impl Whole<'_> {
    fn of_object(&self) -> TriangleProperties {
        self.property.map_or(TriangleProperties::OF_OBJECT, |own| TriangleProperties {
            group: own.group as u32,
            corners: [own.index; 3],
        })
    }

    /// The look of a triangle with properties, of a part that an extruder prints.
    fn look(&self, properties: &TriangleProperties, extruder: u32) -> Look {
        match Look::of(self.model, properties) {
            Look::Plain if self.has_filaments => Look::Filament(extruder),
            look => look,
        }
    }

    /// The beams and balls of a mesh.
    fn lattice(&self, lattice: &Lattice, positions: &[Vec3], pieces: &mut Vec<Piece>) {
        let own = self.of_object();
        let look = self.look(&own, 0);
        let mesh = lattice.mesh(positions);
        if !mesh.is_empty() {
            // What is painted at corners is that of the object everywhere.
            let paint = look.paint(self.model, own.corners[0]);
            let vertex_kd = vec_of(paint.colour, mesh.positions.len());
            let mesh = Mesh { name: self.name.to_owned(), vertex_kd, ..mesh };
            pieces.push(Piece { look, mesh: Arc::new(mesh) });
        }
    }

    /// The whole mesh as one piece, with a vertex for each position, or for each normal of a position.
    fn piece(&self, mut data: MeshData, normals: Option<CornerNormals>) -> Piece {
        let own = self.of_object();
        let look = self.look(&own, 0);
        let paint = look.paint(self.model, own.corners[0]);
        let normals = normals.map_or_else(Vec::new, |normals| by_normal(&mut data, &normals));
        let count = data.positions.len();
        let mesh = Mesh {
            name: self.name.to_owned(),
            positions: data.positions,
            triangles: data.triangles,
            normals,
            uvs: vec_of(paint.uv, count),
            vertex_kd: vec_of(paint.colour, count),
            ..Mesh::default()
        };
        Piece { look, mesh: Arc::new(mesh) }
    }
}

/// Splits a mesh by the looks of its triangles.
pub(super) fn pieces(
    reading: &mut Reading,
    file: &str,
    whole: &Whole,
    mut data: MeshData,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<Piece>, FormatError> {
    let mut pieces = Vec::new();
    if let Some(lattice) = data.lattice.take() {
        reading.budget.take_bytes(lattice.size(), file)?;
        whole.lattice(&lattice, &data.positions, &mut pieces);
    }
    if data.triangles.is_empty() {
        return Ok(pieces);
    }
    let normals = normals(reading, file, &mut data)?;
    let is_painted = whole.has_filaments && !data.paint.is_empty();
    let has_volumes = whole.settings.is_some_and(|settings| !settings.volumes.is_empty());
    if data.properties.is_empty() && !is_painted && !has_volumes {
        let count = normals.as_ref().map_or(data.positions.len(), |normals| normals.normals.len());
        reading.budget.take_bytes((count * size_of::<([Vec3; 2], Rgb, Vec2, u32)>()) as u64, file)?;
        pieces.push(whole.piece(data, normals));
        return Ok(pieces);
    }
    let mut welder = Welder::new(reading, file, whole.model, data.positions.len(), normals.is_some())?;
    let (own, mut paint) = (whole.of_object(), data.paint.iter().peekable());
    for (triangle, corners) in data.triangles.iter().enumerate() {
        let code = paint.next_if(|(painted, _)| *painted as usize == triangle).map(|(_, code)| code);
        let part = whole.settings.map(|all| all.of_triangle(triangle as u32)).unwrap_or_default();
        if let Some(what) = part.unprinted {
            diagnostics.not_shown(what, || whole_file(&file.into()));
            continue;
        }
        let own = data.properties.get(triangle).filter(|own| own.group != NONE).unwrap_or(&own);
        let look = whole.look(own, part.extruder.unwrap_or(0));
        let normal_of =
            [0, 1, 2].map(|i| normals.as_ref().map_or(NONE, |all| all.of_corner[3 * triangle + i]));
        if let (Some(code), Look::Filament(_)) = (code, look) {
            let leaves = leaves(code).unwrap_or_else(|| {
                let what = "a triangle is painted by a code that is not understood";
                diagnostics.note(what, || whole_file(&file.into()));
                vec![Leaf::whole(0)]
            });
            reading.budget.take::<[[Vec3; 3]; 3]>(leaves.len(), file)?;
            let normals =
                normal_of.map(|i| normals.as_ref().map_or(Vec3::ZERO, |all| all.normals[i as usize]));
            for leaf in leaves {
                let look = if leaf.filament > 0 { Look::Filament(leaf.filament) } else { look };
                let piece = welder.piece(look, whole.name);
                welder.leaf(piece, &leaf, corners.map(|i| data.positions[i as usize]), normals);
            }
            continue;
        }
        let piece = welder.piece(look, whole.name);
        let mut made = [0; 3];
        for corner in 0..3 {
            let property = if look.is_painted() { own.corners[corner] } else { 0 };
            made[corner] =
                welder.vertex(piece, corners[corner], normal_of[corner], property, &data, normals.as_ref());
        }
        welder.pieces[piece].1.triangles.push(made);
        reading.budget.take::<[u32; 3]>(1 + 2 * welder.take_made(), file)?;
    }
    pieces.extend(welder.into_pieces());
    Ok(pieces)
}

/// Makes a vertex of each normal, in the order of the triangles, and returns the normals in this order. Positions share no normals.
fn by_normal(data: &mut MeshData, normals: &CornerNormals) -> Vec<Vec3> {
    let count = normals.normals.len();
    let mut vertex_of = vec![NONE; count];
    let (mut positions, mut turned) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for (corner, &normal) in data.triangles.as_flattened_mut().iter_mut().zip(&normals.of_corner) {
        let vertex = &mut vertex_of[normal as usize];
        if *vertex == NONE {
            *vertex = positions.len() as u32;
            positions.push(data.positions[*corner as usize]);
            turned.push(normals.normals[normal as usize]);
        }
        *corner = *vertex;
    }
    data.positions = positions;
    turned
}

/// A list with one value for all of some vertices; empty if there is none.
fn vec_of<T: Copy>(value: Option<T>, count: usize) -> Vec<T> {
    value.map_or_else(Vec::new, |value| vec![value; count])
}

/// The normals at corners by the crease angle; `None` if the mesh is flat everywhere.
fn normals(
    reading: &mut Reading,
    file: &str,
    data: &mut MeshData,
) -> Result<Option<CornerNormals>, FormatError> {
    let angle = reading.crease_angle;
    if angle <= 0.0 {
        return Ok(None);
    }
    let needed = 24 * 3 * data.triangles.len() + 24 * (data.triangles.len() + data.positions.len());
    reading.budget.take_bytes(needed as u64, file)?;
    let corners = std::mem::take(&mut data.triangles).into_flattened();
    let faces = Faces { positions: &data.positions, corners, ends: &[], smoothing: vec![BY_ANGLE] };
    let (found, are_needed) = faces.normals_and_whether_needed(angle);
    let corners_of = |of: &[u32; 3]| of.map(|normal| found.position_of[normal as usize]);
    data.triangles = found.of_corner.as_chunks::<3>().0.iter().map(corners_of).collect();
    let found = are_needed.then_some(found);
    let held = found.as_ref().map_or(0, |found| 4 * found.of_corner.len() + 12 * found.normals.len());
    reading.budget.release(needed.saturating_sub(held) as u64);
    Ok(found)
}

/// Finds the vertex of a corner that occurred before.
struct Welder<'m> {
    model: &'m Model,
    pieces: Vec<(Look, Mesh)>,
    known: HashMap<Look, usize>,
    last: Option<(Look, usize)>,
    /// For each position, the vertex that was made from it last.
    heads: Vec<u32>,
    made: Vec<Made>,
    /// The vertices that were counted already.
    counted: usize,
    has_normals: bool,
}

/// A vertex that was made from a position.
#[derive(Clone, Copy)]
struct Made {
    piece: u32,
    normal: u32,
    property: u32,
    vertex: u32,
    /// The one that was made before from the same position.
    next: u32,
}

/// Longer chains are not searched: a hostile file costs vertices, not time.
const MAX_CHAIN: usize = 32;

impl<'m> Welder<'m> {
    fn new(
        reading: &mut Reading,
        file: &str,
        model: &'m Model,
        positions: usize,
        has_normals: bool,
    ) -> Result<Welder<'m>, FormatError> {
        reading.budget.take_bytes(4 * positions as u64, file)?;
        let heads = vec![NONE; positions];
        Ok(Welder {
            model,
            pieces: Vec::new(),
            known: HashMap::new(),
            last: None,
            heads,
            made: Vec::new(),
            counted: 0,
            has_normals,
        })
    }

    /// The number of vertices made since the last call, in units of [`Made`].
    fn take_made(&mut self) -> usize {
        let new = self.made.len() - self.counted;
        self.counted = self.made.len();
        2 * new
    }

    fn piece(&mut self, look: Look, name: &str) -> usize {
        if let Some((_, piece)) = self.last.filter(|(last, _)| *last == look) {
            return piece;
        }
        let next = self.pieces.len();
        let piece = *self.known.entry(look).or_insert(next);
        if piece == next {
            self.pieces.push((look, Mesh { name: name.to_owned(), ..Mesh::default() }));
        }
        self.last = Some((look, piece));
        piece
    }

    fn into_pieces(self) -> impl Iterator<Item = Piece> {
        self.pieces.into_iter().map(|(look, mesh)| Piece { look, mesh: Arc::new(mesh) })
    }

    /// Adds a part of a triangle with these corners and normals.
    fn leaf(&mut self, piece: usize, leaf: &Leaf, places: [Vec3; 3], normals: [Vec3; 3]) {
        let mesh = &mut self.pieces[piece].1;
        let first = mesh.positions.len() as u32;
        let at = |of: [Vec3; 3], w: Vec3| of[0] * w.x + of[1] * w.y + of[2] * w.z;
        for weights in leaf.corners {
            mesh.positions.push(at(places, weights));
            if self.has_normals {
                mesh.normals.push(at(normals, weights));
            }
        }
        mesh.triangles.push([first, first + 1, first + 2]);
    }

    fn vertex(
        &mut self,
        piece: usize,
        position: u32,
        normal: u32,
        property: u32,
        data: &MeshData,
        normals: Option<&CornerNormals>,
    ) -> u32 {
        let head = self.heads[position as usize];
        let mut next = head;
        for _ in 0..MAX_CHAIN {
            let Some(made) = self.made.get(next as usize) else { break };
            if (made.piece, made.normal, made.property) == (piece as u32, normal, property) {
                return made.vertex;
            }
            next = made.next;
        }
        let (look, mesh) = &mut self.pieces[piece];
        let vertex = mesh.positions.len() as u32;
        mesh.positions.push(data.positions[position as usize]);
        mesh.normals.extend(normals.map(|normals| normals.normals[normal as usize]));
        if look.is_painted() {
            let paint = look.paint(self.model, property);
            mesh.vertex_kd.extend(paint.colour);
            mesh.uvs.extend(paint.uv);
        }
        self.heads[position as usize] = self.made.len() as u32;
        self.made.push(Made { piece: piece as u32, normal, property, vertex, next: head });
        vertex
    }
}

/// Attributes of a vertex of a look.
#[derive(Clone, Copy, Default)]
pub(super) struct Paint {
    pub(super) colour: Option<Rgb>,
    pub(super) uv: Option<Vec2>,
}

impl Look {
    /// Attributes of a vertex with a property.
    pub(super) fn paint(self, model: &Model, property: u32) -> Paint {
        let colour = |colour: Rgb| Paint { colour: Some(colour), uv: None };
        let uv_of = |group: usize, index: u32| match &model.groups[group].kind {
            GroupKind::Coordinates { uvs, .. } => uvs.get(index as usize).copied().unwrap_or_default(),
            _ => Vec2::ZERO,
        };
        match self {
            Look::Plain | Look::Filament(_) | Look::Solid { .. } => Paint::default(),
            Look::Colours { group } => {
                colour(model.groups[group].colour(property).map_or(Rgb::WHITE, |colour| colour.rgb))
            }
            Look::Picture { group } => Paint { colour: None, uv: Some(uv_of(group, property)) },
            Look::Layers { group, .. } => match &model.groups[group].kind {
                GroupKind::Layers(layers) => match layers.textured(model) {
                    Some(layer) => {
                        let index = layers.entry(property).get(layer).copied().unwrap_or(0);
                        Paint { colour: None, uv: Some(uv_of(layers.groups[layer], index)) }
                    }
                    None => colour(layers.colour(model, property)),
                },
                _ => Paint::default(),
            },
        }
    }
}
