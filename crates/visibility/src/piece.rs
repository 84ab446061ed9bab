//! Pieces that polygons become when planes cut them.

use bilux_math::DVec3;

/// Part of a triangle: a hull for its hits in some cell, and the tests that decide whether a hit is there.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub(crate) triangle: u32,
    pub(crate) polygon: Vec<DVec3>,
    /// The last of its tests, in the list of its tree.
    pub(crate) tests: Option<u32>,
}
