//! Meshes: polygons in several forms, with an index for each kind of data.

mod builder;
mod channel;
mod holes;
mod lines;
mod mesh;
mod primitives;

pub(super) use builder::Symbol;
pub(super) use lines::lines;
pub(super) use mesh::{Mesh, read};
