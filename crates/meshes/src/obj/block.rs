//! One block of lines of an OBJ file.

use bilux_import::FormatError;
use bilux_import::bytes::text::TextPosition;
use bilux_import::geometry::normals::Smoothing;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::meshes::indexed_faces::Corner;
use bilux_math::{Rgb, Vec2, Vec3};

/// The contents of a block of lines. Line and face numbers are relative to its start.
#[derive(Debug, Default)]
pub(super) struct Block {
    pub(super) positions: Vec<Vec3>,
    /// One per position, as stored, or none.
    pub(super) colours: Vec<Rgb>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    pub(super) corners: Vec<Corner>,
    /// The end of each face's corners.
    pub(super) ends: Vec<u32>,
    pub(super) places: Vec<TextPosition>,
    /// Corners with indices that count backwards.
    pub(super) backward: Vec<Backward>,
    /// Points and lines.
    pub(super) strokes: Vec<Stroke>,
    /// State changes between faces, in order.
    pub(super) turns: Vec<(usize, StateChange)>,
    pub(super) diagnostics: Diagnostics,
    /// The number of line ends.
    pub(super) lines: u32,
    /// The memory that reading the block took from the budget.
    pub(super) spent: u64,
    /// The fault of the first element that is left out.
    pub(super) fault: Option<FormatError>,
    /// The error that ended the block early.
    pub(super) failure: Option<FormatError>,
}

/// A part of a corner with an index that counts backwards.
#[derive(Debug)]
pub(super) struct Backward {
    /// The corner; `None` if its face is left out.
    pub(super) corner: Option<u32>,
    /// The part: position, uv or normal.
    pub(super) part: u8,
    /// Index relative to the first element of the block.
    pub(super) index: i64,
    /// The offset of the corner in the block.
    pub(super) offset: usize,
}

/// A state change between two faces.
#[derive(Debug)]
pub(super) enum StateChange {
    Name(String),
    Material(String, TextPosition),
    Smoothing(Smoothing),
    /// The rest of an `mtllib` line.
    Libraries(String, TextPosition),
}

impl Block {
    /// An empty block that keeps the capacity of its lists: repeated large allocations would fragment memory.
    pub(super) fn emptied(mut self) -> Block {
        self.positions.clear();
        self.colours.clear();
        self.uvs.clear();
        self.normals.clear();
        self.corners.clear();
        self.ends.clear();
        self.places.clear();
        self.backward.clear();
        self.turns.clear();
        self.strokes.clear();
        Block { diagnostics: Diagnostics::default(), fault: None, failure: None, ..self }
    }
}

/// A point, or a line between two vertices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    /// The number of state changes before it.
    pub(super) turns: usize,
    /// Both ends are the same for a point.
    pub(super) ends: [End; 2],
    pub(super) is_point: bool,
    pub(super) place: TextPosition,
}

/// A vertex of a point or a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// An index from 0.
    Whole(u32),
    /// An index relative to the first vertex of the block; negative for earlier blocks.
    OfBlock(i64),
}
