//! The triangles that structures are built over.

use bilux_math::{Aabb, Vec3};
use std::ops::Range;

/// Triangles in the form that every structure reads: corner by corner, so that a test touches one or two cache lines.
///
/// Triangles with a corner that is not finite are kept, so that the caller's indices remain valid, and are never hit.
#[derive(Clone, Debug, Default)]
pub struct TriangleMesh {
    corners: Vec<[[f32; 3]; 3]>,
    groups: Vec<Range<u32>>,
    bounds: Option<Aabb>,
}

/// Why a mesh cannot be created.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// An index refers to no vertex.
    #[error("triangle {triangle} refers to vertex {vertex}, but there are only {count} vertices")]
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The index that it contains.
        vertex: u32,
        /// The number of vertices.
        count: usize,
    },
    /// More triangles than an index can number.
    #[error("{0} triangles are more than one mesh can hold (4,294,967,294)")]
    TooManyTriangles(usize),
    /// The groups do not cover the triangles one after the other.
    #[error("the groups of a mesh must cover its {0} triangles one after the other")]
    GroupsDoNotCover(usize),
}

impl TriangleMesh {
    /// Creates a mesh from vertices and triples of indices into them.
    ///
    /// # Errors
    /// Returns an error when an index refers to no vertex, or there are more than 2³² − 2 triangles.
    pub fn new(positions: Vec<[f32; 3]>, indices: Vec<[u32; 3]>) -> Result<TriangleMesh, MeshError> {
        let corner = |triangle: usize, vertex: u32| {
            positions.get(vertex as usize).copied().ok_or(MeshError::IndexOutOfRange {
                triangle,
                vertex,
                count: positions.len(),
            })
        };
        let corners = indices
            .iter()
            .enumerate()
            .map(|(i, &[a, b, c])| Ok([corner(i, a)?, corner(i, b)?, corner(i, c)?]))
            .collect::<Result<Vec<_>, MeshError>>()?;
        TriangleMesh::from_corners(corners)
    }

    /// Creates a mesh from the corners of each triangle.
    ///
    /// # Errors
    /// Returns an error when there are more than 2³² − 2 triangles.
    pub fn from_corners(corners: Vec<[[f32; 3]; 3]>) -> Result<TriangleMesh, MeshError> {
        if corners.len() >= u32::MAX as usize {
            return Err(MeshError::TooManyTriangles(corners.len()));
        }
        let bounds = Aabb::of_points(
            corners.iter().filter(|t| is_finite(t)).flat_map(|t| t.iter().map(|&p| Vec3::from(p))),
        );
        let whole = 0..corners.len() as u32;
        Ok(TriangleMesh { corners, groups: vec![whole], bounds: Some(bounds) })
    }

    /// Groups the triangles into these objects, one after the other. Only structures that are asked to keep objects whole
    /// use the groups.
    ///
    /// # Errors
    /// Returns an error when the ranges do not cover the triangles one after the other.
    pub fn with_groups(mut self, groups: Vec<Range<u32>>) -> Result<TriangleMesh, MeshError> {
        let mut end = 0;
        for group in &groups {
            if group.start != end || group.end < group.start {
                return Err(MeshError::GroupsDoNotCover(self.len()));
            }
            end = group.end;
        }
        if end as usize != self.len() {
            return Err(MeshError::GroupsDoNotCover(self.len()));
        }
        self.groups = groups;
        Ok(self)
    }

    /// The corners of every triangle.
    #[inline]
    pub fn triangles(&self) -> &[[[f32; 3]; 3]] {
        &self.corners
    }

    /// The objects that the triangles belong to, as ranges of triangles.
    pub fn groups(&self) -> &[Range<u32>] {
        &self.groups
    }

    /// The number of triangles.
    #[inline]
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// True when there are no triangles.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The bounding box of all finite triangles.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        self.bounds.unwrap_or(Aabb::EMPTY)
    }

    /// The bounding box of one triangle; empty when the triangle is not finite.
    pub fn triangle_bounds(&self, index: u32) -> Aabb {
        let triangle = &self.corners[index as usize];
        if is_finite(triangle) {
            Aabb::of_points(triangle.iter().map(|&p| Vec3::from(p)))
        } else {
            Aabb::EMPTY
        }
    }

    /// Size of the triangles in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.corners.as_slice()) + size_of_val(self.groups.as_slice())
    }
}

fn is_finite(triangle: &[[f32; 3]; 3]) -> bool {
    triangle.iter().flatten().all(|c| c.is_finite())
}
