//! Meshes of polygons with layers of normals, texture coordinates, colours and materials, and how they become meshes of
//! triangles: what FBX and Collada share.

mod layer;
mod mesh;
mod polygons;
mod renewed;
mod weld;
mod workshop;

pub use layer::{Layer, Mapping};
pub use mesh::{PolygonMesh, reflectances};
pub use polygons::Polygons;
pub use weld::{Part, parts};
pub use workshop::Workshop;
