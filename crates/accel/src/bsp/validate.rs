//! Checks whether a tree maintains what traversal relies on.

use super::plane::Space;
use super::tree::{BspTree, Content, MAX_DEPTH};
use crate::mesh::TriangleMesh;
use bilux_math::DVec3;

impl BspTree {
    /// Checks the layout, and the invariant of [`super`]: that every point of every triangle is in some leaf which
    /// holds the triangle. It tries a grid of `(n + 1)(n + 2) / 2` points on each triangle.
    ///
    /// # Errors
    /// Describes the first violation.
    pub fn validate(&self, mesh: &TriangleMesh, n: usize) -> Result<(), String> {
        if self.is_empty() {
            return if mesh.bounds().is_empty() { Ok(()) } else { Err("there is no root".into()) };
        }
        let mut references = 0;
        self.check_layout(0, 0, &mut references)?;
        let space = Space::new(&mesh.bounds());
        for (index, triangle) in mesh.triangles().iter().enumerate() {
            if triangle.iter().flatten().any(|c| !c.is_finite()) {
                continue;
            }
            let corners = triangle.map(|vertex| space.local(vertex));
            if let Some(lost) = grid(corners, n).find(|&p| !self.holds(0, index as u32, p, space.tolerance)) {
                return Err(format!("triangle {index} is in no leaf at {lost}"));
            }
        }
        Ok(())
    }

    /// Checks that leaves use the references one after the other, that children come after their parents, and that
    /// nothing is too deep for the traversal stack.
    fn check_layout(&self, node: usize, depth: usize, references: &mut usize) -> Result<(), String> {
        if depth > MAX_DEPTH {
            return Err(format!("node {node} is too deep"));
        }
        match self.content(node) {
            Content::Leaf(range) => {
                if range.start != *references || range.end < range.start {
                    return Err(format!("leaf {node} has {range:?}, after {references} references"));
                }
                *references = range.end;
                Ok(())
            }
            Content::Fork { on, left, right, .. } => {
                if left <= node || right <= left {
                    return Err(format!("fork {node} has children {left} and {right}"));
                }
                if let Some(on) = on {
                    self.check_layout(on, depth, references)?;
                }
                self.check_layout(left, depth + 1, references)?;
                self.check_layout(right, depth + 1, references)
            }
        }
    }

    /// True when some leaf that contains a point, up to the tolerance at each plane, holds a triangle.
    fn holds(&self, node: usize, triangle: u32, point: DVec3, tolerance: f64) -> bool {
        match self.content(node) {
            Content::Leaf(range) => self.primitives(range).any(|primitive| primitive == triangle),
            Content::Fork { normal, at, on, left, right } => {
                let distance = normal.dot(point) - at;
                let slack = tolerance * (1.0 + 1e-6);
                let inside = distance.abs() <= slack;
                (inside && on.is_some_and(|on| self.holds(on, triangle, point, tolerance)))
                    || (distance <= slack && self.holds(left, triangle, point, tolerance))
                    || (distance >= -slack && self.holds(right, triangle, point, tolerance))
            }
        }
    }
}

/// Points spread over a triangle, corners and edges included.
fn grid([a, b, c]: [DVec3; 3], n: usize) -> impl Iterator<Item = DVec3> {
    let steps = n.max(1);
    (0..=steps).flat_map(move |i| {
        (0..=steps - i).map(move |j| {
            let (u, v) = (i as f64 / steps as f64, j as f64 / steps as f64);
            a + (b - a) * u + (c - a) * v
        })
    })
}
