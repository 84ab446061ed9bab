//! The corners of polygons. In the file the last corner of each is stored as its complement.

use super::workshop::Workshop;
use crate::FormatError;
use crate::fbx::tree::Node;

/// Polygons, each with its corners in the file's order.
#[derive(Default)]
pub(in crate::fbx) struct Polygons {
    /// The control point of each corner.
    pub(in crate::fbx) corners: Vec<u32>,
    /// The end of each polygon's corners.
    pub(in crate::fbx) ends: Vec<u32>,
    /// Polygons that cannot be drawn: of fewer than three corners, or with control points that do not exist.
    left_out: Vec<u32>,
}

impl Polygons {
    pub(super) fn read(
        node: Node,
        positions: usize,
        workshop: &mut Workshop,
    ) -> Result<Polygons, FormatError> {
        let indices: Vec<i32> = node.numbers(workshop.budget)?;
        let ends = indices.iter().filter(|&&index| index < 0).count();
        workshop.budget.take_bytes(4 * (ends + 1 + indices.len()) as u64, node.file())?;
        let mut polygons = Polygons {
            corners: Vec::with_capacity(indices.len()),
            ends: Vec::with_capacity(ends + 1),
            left_out: Vec::new(),
        };
        let (mut start, mut is_whole) = (0, true);
        let last = indices.len().saturating_sub(1);
        for (corner, &index) in indices.iter().enumerate() {
            let is_end = index < 0 || corner == last;
            let position = if index < 0 { !index } else { index } as u32;
            is_whole &= (position as usize) < positions;
            polygons.corners.push(if (position as usize) < positions { position } else { 0 });
            if is_end {
                polygons.end(start, is_whole, node, workshop)?;
                (start, is_whole) = (corner + 1, true);
            }
        }
        workshop.budget.release(4 * indices.len() as u64);
        if positions == 0 {
            return Ok(Polygons::default());
        }
        Ok(polygons)
    }

    /// Ends a polygon that began at a corner.
    fn end(
        &mut self,
        start: usize,
        is_whole: bool,
        node: Node,
        workshop: &mut Workshop,
    ) -> Result<(), FormatError> {
        let count = self.corners.len() - start;
        if !is_whole {
            let what = "a polygon refers to a vertex that the mesh does not have, and is left out";
            workshop.oddities.note(what, || node.at());
        } else if count < 3 {
            workshop.oddities.not_shown("lines and points among polygons", || node.at());
        }
        if !is_whole || count < 3 {
            workshop.budget.take::<u32>(1, node.file())?;
            self.left_out.push(self.ends.len() as u32);
        }
        self.ends.push(self.corners.len() as u32);
        Ok(())
    }

    /// The number of polygons.
    pub(in crate::fbx) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The first corner of a polygon.
    pub(super) fn start(&self, polygon: usize) -> usize {
        if polygon == 0 { 0 } else { self.ends[polygon - 1] as usize }
    }

    /// Whether a polygon is drawn.
    pub(super) fn is_drawn(&self, polygon: usize) -> bool {
        self.left_out.is_empty() || self.left_out.binary_search(&(polygon as u32)).is_err()
    }
}
