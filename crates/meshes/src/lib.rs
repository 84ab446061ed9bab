//! Readers and writers of meshes and point clouds, one folder a format.

pub mod asc;
pub mod e57;
pub mod las;
pub mod obj;
pub mod off;
pub mod ply;
pub mod stl;
pub mod threemf;
pub mod xyz;
