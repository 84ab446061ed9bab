//! A material on a mesh.

use crate::fbx::document::Index;

/// A material, with what decides how it looks on a mesh.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(in crate::fbx) struct Worn<'d> {
    pub(in crate::fbx) material: Option<Index>,
    /// The name of the mesh's second set of texture coordinates.
    pub(in crate::fbx) second_set: Option<&'d [u8]>,
    /// The texture of the node's, before version 7.
    pub(in crate::fbx) texture: Option<Index>,
}
