//! Primitives, from accessors to triangles.

#[cfg(feature = "draco")]
pub(crate) mod draco;
pub(crate) mod meshes;
pub(crate) mod primitive;
pub(crate) mod tangents;
pub(crate) mod topology;
