//! Place of a picture in a larger one.

/// The place of a picture in a larger one: the data window of an EXR in its display window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// The column of its left edge, in pixels.
    pub x: usize,
    /// The row of its upper edge.
    pub y: usize,
    /// Columns and rows of the larger picture.
    pub whole: [usize; 2],
}
