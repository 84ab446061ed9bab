//! Meshes: polygons with layers of normals, texture coordinates, colours and materials.

mod layers;
mod polygon_mesh;
mod polygons;
mod weld;
mod workshop;

pub(super) use layers::nodes as layers_named;
pub(super) use polygon_mesh::Geometry;
pub(super) use weld::{Part, parts};
pub(super) use workshop::Workshop;
