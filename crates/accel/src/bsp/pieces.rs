//! Pieces of triangles inside a cell, while a tree is built.

use super::plane::{Plane, Side, Space};
use crate::mesh::TriangleMesh;
use bilux_math::DVec3;

/// Convex polygons, each cut from one triangle. Leaves hold only the triangles' numbers; the pieces determine which
/// leaves a triangle belongs to.
///
/// A cut gives both sides the same new points, so the two pieces together are the whole piece; nothing is lost
/// between them, however inexact those points are.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    triangles: Vec<u32>,
    /// End of each piece in `points`, exclusive.
    ends: Vec<usize>,
    points: Vec<DVec3>,
}

/// The parts into which a plane splits a partition.
#[derive(Default)]
pub(super) struct Parts<P> {
    pub(super) left: P,
    pub(super) on: P,
    pub(super) right: P,
}

impl Pieces {
    /// All triangles of a mesh, whole. Triangles that are not finite are left out, since no ray hits them.
    pub(super) fn of_mesh(mesh: &TriangleMesh, space: &Space) -> Pieces {
        let mut pieces = Pieces::default();
        for (index, triangle) in mesh.triangles().iter().enumerate() {
            if triangle.iter().flatten().all(|c| c.is_finite()) {
                pieces.points.extend(triangle.iter().map(|&vertex| space.local(vertex)));
                pieces.close(index as u32);
            }
        }
        pieces
    }

    pub(super) fn len(&self) -> usize {
        self.triangles.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// The triangles that the pieces were cut from.
    pub(super) fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    pub(super) fn into_triangles(self) -> Vec<u32> {
        self.triangles
    }

    /// The corners of one piece.
    #[inline]
    pub(super) fn points(&self, piece: usize) -> &[DVec3] {
        let start = if piece == 0 { 0 } else { self.ends[piece - 1] };
        &self.points[start..self.ends[piece]]
    }

    /// The corners of every piece.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[DVec3]> {
        (0..self.len()).map(|piece| self.points(piece))
    }

    /// Cuts every piece by a plane.
    pub(super) fn split(&self, plane: &Plane, tolerance: f64) -> Parts<Pieces> {
        let mut parts = Parts::<Pieces>::default();
        for (points, &triangle) in self.iter().zip(&self.triangles) {
            match plane.side(points, tolerance) {
                Side::Left => parts.left.push(triangle, points),
                Side::Right => parts.right.push(triangle, points),
                Side::On => parts.on.push(triangle, points),
                Side::Both => {
                    cut(points, plane, &mut parts.left.points, &mut parts.right.points);
                    parts.left.close(triangle);
                    parts.right.close(triangle);
                }
            }
        }
        parts
    }

    /// Adds other pieces at the end.
    pub(super) fn append(&mut self, other: &Pieces) {
        for (points, &triangle) in other.iter().zip(&other.triangles) {
            self.push(triangle, points);
        }
    }

    fn push(&mut self, triangle: u32, points: &[DVec3]) {
        self.points.extend_from_slice(points);
        self.close(triangle);
    }

    /// Makes one piece of the points added since the last.
    fn close(&mut self, triangle: u32) {
        self.triangles.push(triangle);
        self.ends.push(self.points.len());
    }
}

/// Distributes the corners of a convex polygon over the two sides of a plane.
fn cut(points: &[DVec3], plane: &Plane, left: &mut Vec<DVec3>, right: &mut Vec<DVec3>) {
    let Some(&last) = points.last() else { return };
    let (mut from, mut from_distance) = (last, plane.distance(last));
    for &to in points {
        let to_distance = plane.distance(to);
        if (from_distance < 0.0 && to_distance > 0.0) || (from_distance > 0.0 && to_distance < 0.0) {
            let crossing = from + (to - from) * (from_distance / (from_distance - to_distance));
            left.push(crossing);
            right.push(crossing);
        }
        if to_distance <= 0.0 {
            left.push(to);
        }
        if to_distance >= 0.0 {
            right.push(to);
        }
        (from, from_distance) = (to, to_distance);
    }
}
