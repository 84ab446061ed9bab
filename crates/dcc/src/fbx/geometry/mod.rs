//! Meshes: polygons with layers of normals, texture coordinates, colours and materials.

mod layers;
mod nurbs;
mod polygon_mesh;
mod polygons;

pub(super) use layers::nodes as layers_named;
pub(super) use polygon_mesh::read;
