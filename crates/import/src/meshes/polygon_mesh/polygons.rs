//! The corners of polygons.

use super::workshop::Workshop;
use crate::FormatError;
use bilux_scene::Span;

/// Polygons, each with its corners in the file's order.
#[derive(Default)]
pub struct Polygons {
    /// The control point of each corner.
    pub corners: Vec<u32>,
    /// The end of each polygon's corners.
    pub ends: Vec<u32>,
    /// Polygons that cannot be drawn: of fewer than three corners, or with control points that do not exist.
    left_out: Vec<u32>,
}

impl Polygons {
    /// None yet, with room for as many as stated, which have been charged.
    pub fn with_capacity(corners: usize, polygons: usize) -> Polygons {
        Polygons {
            corners: Vec::with_capacity(corners),
            ends: Vec::with_capacity(polygons),
            left_out: Vec::new(),
        }
    }

    /// Ends a polygon that began at a corner. It is whole if all its control points exist.
    pub fn end(
        &mut self,
        start: usize,
        is_whole: bool,
        at: impl Fn() -> Span,
        workshop: &mut Workshop,
        file: &str,
    ) -> Result<(), FormatError> {
        let count = self.corners.len() - start;
        if !is_whole {
            let what = "a polygon refers to a vertex that the mesh does not have, and is left out";
            workshop.diagnostics.note(what, &at);
        } else if count < 3 {
            workshop.diagnostics.not_shown("lines and points among polygons", &at);
        }
        if !is_whole || count < 3 {
            workshop.budget.take::<u32>(1, file)?;
            self.left_out.push(self.ends.len() as u32);
        }
        self.ends.push(self.corners.len() as u32);
        Ok(())
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The number of polygons.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// The first corner of a polygon.
    pub fn start(&self, polygon: usize) -> usize {
        if polygon == 0 { 0 } else { self.ends[polygon - 1] as usize }
    }

    /// The corners of a polygon.
    #[inline]
    pub fn range(&self, polygon: usize) -> std::ops::Range<usize> {
        self.start(polygon)..self.ends[polygon] as usize
    }

    /// Whether a polygon is drawn.
    pub fn is_drawn(&self, polygon: usize) -> bool {
        self.left_out.is_empty() || self.left_out.binary_search(&(polygon as u32)).is_err()
    }
}
