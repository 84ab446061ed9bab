//! The corners of faces.

/// A missing index.
pub const NONE: u32 = u32::MAX;

/// Position, texture coordinates and normal of a corner, as indices from 0 or [`NONE`].
pub type Corner = [u32; 3];
