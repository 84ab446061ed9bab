//! Meshes of polygons with layers of normals, texture coordinates, colours and materials, and how they become meshes of
//! triangles: what FBX and Collada share.

mod layer;
mod mesh;
mod polygons;
mod renewed;
mod weld;
mod workshop;

pub(crate) use layer::{Layer, Mapping};
pub(crate) use mesh::{PolygonMesh, reflectances};
pub(crate) use polygons::Polygons;
pub(crate) use weld::{Part, parts};
pub(crate) use workshop::Workshop;
