//! The meshes that an object of a file becomes: one for each look of its triangles.

use super::groups::GroupKind;
use super::looks::Look;
use super::mesh_data::{MeshData, NONE, TriangleProperties};
use super::model::{Model, Property};
use crate::FormatError;
use crate::normals::{BY_ANGLE, CornerNormals, Faces};
use crate::reading::Reading;
use bilux_math::{Rgb, Vec2};
use bilux_scene::Mesh;
use std::collections::HashMap;
use std::sync::Arc;

/// Triangles that share a look.
#[derive(Clone)]
pub(super) struct Piece {
    pub(super) look: Look,
    pub(super) mesh: Arc<Mesh>,
}

/// Splits a mesh by the looks of its triangles.
pub(super) fn pieces(
    reading: &mut Reading,
    file: &str,
    model: &Model,
    mut data: MeshData,
    of_object: Option<Property>,
    name: &str,
) -> Result<Vec<Piece>, FormatError> {
    let mut pieces = Vec::new();
    let of_object = of_object.map_or(TriangleProperties::OF_OBJECT, |own| TriangleProperties {
        group: own.group as u32,
        corners: [own.index; 3],
    });
    if let Some(lattice) = data.lattice.take() {
        reading.budget.take_bytes(lattice.size(), file)?;
        let look = Look::of(model, &of_object);
        for mesh in [lattice.tubes(&data.positions), lattice.spheres(&data.positions)] {
            if !mesh.is_empty() {
                // What is painted at corners is that of the object everywhere.
                let paint = look.paint(model, of_object.corners[0]);
                let count = mesh.positions.len();
                let mesh = Mesh { name: name.to_owned(), vertex_kd: vec_of(paint.colour, count), ..mesh };
                pieces.push(Piece { look, mesh: Arc::new(mesh) });
            }
        }
    }
    if data.triangles.is_empty() {
        return Ok(pieces);
    }
    let normals = normals(reading, file, &data)?;
    let look = Look::of(model, &of_object);
    if data.properties.is_empty() && normals.is_none() {
        let paint = look.paint(model, of_object.corners[0]);
        let count = data.positions.len();
        reading.budget.take_bytes((count * size_of::<(Rgb, Vec2)>()) as u64, file)?;
        let mesh = Mesh {
            name: name.to_owned(),
            positions: data.positions,
            triangles: data.triangles,
            uvs: vec_of(paint.uv, count),
            vertex_kd: vec_of(paint.colour, count),
            ..Mesh::default()
        };
        pieces.push(Piece { look, mesh: Arc::new(mesh) });
        return Ok(pieces);
    }
    let mut welder = Welder::new(reading, file, model, data.positions.len())?;
    for (triangle, corners) in data.triangles.iter().enumerate() {
        let own = data.properties.get(triangle).filter(|own| own.group != NONE).unwrap_or(&of_object);
        let look = Look::of(model, own);
        let piece = welder.piece(look, name);
        let mut made = [0; 3];
        for corner in 0..3 {
            let normal = normals.as_ref().map_or(NONE, |normals| normals.of_corner[3 * triangle + corner]);
            let property = if look.is_painted() { own.corners[corner] } else { 0 };
            made[corner] = welder.vertex(piece, corners[corner], normal, property, &data, normals.as_ref());
        }
        welder.pieces[piece].1.triangles.push(made);
        reading.budget.take::<[u32; 3]>(1 + 2 * welder.take_made(), file)?;
    }
    pieces.extend(welder.pieces.into_iter().map(|(look, mesh)| Piece { look, mesh: Arc::new(mesh) }));
    Ok(pieces)
}

/// The same value for each of some vertices, if there is one.
fn vec_of<T: Copy>(value: Option<T>, count: usize) -> Vec<T> {
    value.map_or_else(Vec::new, |value| vec![value; count])
}

/// The normals at corners by the crease angle; `None` if the mesh is flat everywhere.
fn normals(reading: &mut Reading, file: &str, data: &MeshData) -> Result<Option<CornerNormals>, FormatError> {
    let angle = reading.crease_angle;
    if angle <= 0.0 {
        return Ok(None);
    }
    let needed = 24 * 3 * data.triangles.len() + 24 * (data.triangles.len() + data.positions.len());
    reading.budget.take_bytes(needed as u64, file)?;
    let corners = data.triangles.iter().flatten().copied().collect();
    let faces = Faces { positions: &data.positions, corners, ends: Vec::new(), smoothing: vec![BY_ANGLE] };
    let found = faces.corner_normals(angle);
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

/// What the vertices of a look have.
#[derive(Clone, Copy, Default)]
pub(super) struct Paint {
    pub(super) colour: Option<Rgb>,
    pub(super) uv: Option<Vec2>,
}

impl Look {
    /// What a vertex with a property has.
    pub(super) fn paint(self, model: &Model, property: u32) -> Paint {
        let colour = |colour: Rgb| Paint { colour: Some(colour), uv: None };
        let uv_of = |group: usize, index: u32| match &model.groups[group].kind {
            GroupKind::Coordinates { uvs, .. } => uvs.get(index as usize).copied().unwrap_or_default(),
            _ => Vec2::ZERO,
        };
        match self {
            Look::Plain | Look::Solid { .. } => Paint::default(),
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
