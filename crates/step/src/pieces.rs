//! The meshes of a shape: one for each look of its faces.

use super::part21::Table;
use super::structure::placements::Placed;
use super::structure::styles::{Style, Styles};
use super::tessellated::triangles;
use super::tessellation::{Face, Patch, Shape, faces};
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_scene::Mesh;
use std::collections::HashMap;
use std::sync::Arc;

/// Triangles that share a look.
#[derive(Clone)]
pub(super) struct Piece {
    /// Style that the file gives these faces; `None` for the look of what they are in.
    pub(super) style: Option<Style>,
    pub(super) mesh: Arc<Mesh>,
}

/// The meshes of a shape, and how many of its faces are missing.
#[derive(Clone, Default)]
pub(super) struct Pieces {
    pub(super) pieces: Vec<Piece>,
    pub(super) faces: usize,
    pub(super) lost: usize,
}

/// The meshes of a shape in the units of its representation.
pub(super) fn pieces(
    reading: &mut Reading,
    table: &Table,
    styles: &Styles,
    placed: &Placed,
) -> Result<Pieces, FormatError> {
    let mut by_style = ByStyle::default();
    if let Some(all) = triangles(reading, table, styles, placed.item)? {
        for (style, patch) in all {
            by_style.add(style, &patch);
        }
        return Ok(Pieces { pieces: by_style.finished(), ..Pieces::default() });
    }
    let faces: Vec<Face> = faces(reading, table, styles, placed.item)?;
    let shape = Shape::new(reading, table, &faces, placed.units.angle)?;
    let patches = shape.patches(reading, &faces)?;
    let lost = patches.iter().filter(|patch| patch.is_none()).count();
    for (face, patch) in faces.iter().zip(patches) {
        let Some(patch) = patch else { continue };
        let bytes = 24 * patch.positions.len() + 12 * patch.triangles.len();
        reading.budget.take_bytes(2 * bytes as u64, &table.file())?;
        by_style.add(face.style, &patch);
    }
    Ok(Pieces { pieces: by_style.finished(), faces: faces.len(), lost })
}

#[derive(Default)]
struct ByStyle {
    meshes: Vec<(Option<Style>, Mesh)>,
    known: HashMap<Option<[u32; 4]>, usize>,
}

impl ByStyle {
    fn add(&mut self, style: Option<Style>, patch: &Patch) {
        let next = self.meshes.len();
        let index = *self.known.entry(style.map(|style| style.key())).or_insert(next);
        if index == next {
            self.meshes.push((style, Mesh::default()));
        }
        let mesh = &mut self.meshes[index].1;
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(patch.positions.iter().map(|p| p.as_vec3()));
        mesh.normals.extend(patch.normals.iter().map(|normal| normal.as_vec3()));
        mesh.triangles.extend(patch.triangles.iter().map(|corners| corners.map(|i| first + i)));
    }

    fn finished(self) -> Vec<Piece> {
        let made = self.meshes.into_iter().filter(|(_, mesh)| !mesh.triangles.is_empty());
        made.map(|(style, mesh)| Piece { style, mesh: Arc::new(mesh) }).collect()
    }
}
