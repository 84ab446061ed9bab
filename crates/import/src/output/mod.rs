//! The state of one write, and what scenes become for formats that know less.

pub mod bake;
pub mod ply;
pub mod strokes;
pub mod values;
pub mod writing;
