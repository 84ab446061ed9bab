//! Meshes and clouds of points as files describe them.

pub mod cloud;
pub mod displacing;
pub mod indexed_faces;
pub mod polygon_mesh;
pub mod refining;
