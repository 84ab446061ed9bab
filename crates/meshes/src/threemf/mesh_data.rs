//! The mesh of an object, as the file has it.

use super::beams::Lattice;
use bilux_math::Vec3;

/// A mesh as the file has it.
#[derive(Default)]
pub(super) struct MeshData {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The properties of each triangle; empty if none has its own.
    pub(super) properties: Vec<TriangleProperties>,
    /// Paint of a slicer on triangles, each with its index.
    pub(super) paint: Vec<(u32, Box<str>)>,
    pub(super) lattice: Option<Lattice>,
}

impl MeshData {
    /// Adds a triangle, and what makes the list of properties as long as that of the triangles before it.
    #[inline]
    pub(super) fn add(&mut self, corners: [u32; 3], properties: Option<TriangleProperties>) {
        if let Some(own) = properties {
            self.properties.resize(self.triangles.len(), TriangleProperties::OF_OBJECT);
            self.properties.push(own);
        }
        self.triangles.push(corners);
    }
}

/// The properties of a triangle's corners; of a group [`NONE`], those of the object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TriangleProperties {
    pub(super) group: u32,
    pub(super) corners: [u32; 3],
}

/// No group.
pub(super) const NONE: u32 = u32::MAX;

impl TriangleProperties {
    pub(super) const OF_OBJECT: TriangleProperties = TriangleProperties { group: NONE, corners: [0; 3] };
}
