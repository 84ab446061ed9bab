//! Finds the triangles that touch a box.

use super::Bvh8;
use super::layout::{self, BLOCK_UNITS};
use bilux_math::glam::DVec3;

impl Bvh8 {
    /// The triangles that share a point with the closed box from `low` to `high`, in ascending order.
    ///
    /// Computed in f64: a triangle that misses the box by less than the rounding error may be included too.
    pub fn overlapping(&self, low: [f32; 3], high: [f32; 3]) -> Vec<u32> {
        let mut found = Vec::new();
        let mut stack = if self.units.is_empty() { Vec::new() } else { vec![self.outline.root] };
        while let Some(reference) = stack.pop() {
            if reference.is_node() {
                let touched = |planes: &layout::Planes| {
                    (0..3).all(|axis| planes[0][axis] <= high[axis] && planes[1][axis] >= low[axis])
                };
                let children = layout::children(&self.units[reference.unit()..]);
                stack.extend(children.filter(|(planes, _)| touched(planes)).map(|(_, child)| child));
                continue;
            }
            for block in self.units[reference.leaf_units()].chunks_exact(BLOCK_UNITS) {
                for (corners, primitive) in layout::triangles(block) {
                    if touches(&corners, low, high) {
                        found.push(primitive);
                    }
                }
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// Searches for a separating plane: perpendicular to an axis, parallel to the triangle, or parallel to an edge of
/// each. [Akenine-Möller 2001]
fn touches(corners: &[[f32; 3]; 3], low: [f32; 3], high: [f32; 3]) -> bool {
    let beside = |k: usize| corners.iter().all(|p| p[k] > high[k]) || corners.iter().all(|p| p[k] < low[k]);
    if (0..3).any(beside) || (0..3).any(|k| low[k] > high[k]) {
        return false;
    }
    let [low, high] = [low, high].map(|p| DVec3::from(p.map(f64::from)));
    let (centre, reach) = ((low + high) * 0.5, (high - low) * 0.5);
    let [a, b, c] = corners.map(|p| DVec3::from(p.map(f64::from)) - centre);
    // A margin for the rounding of the compared values, so that no touching triangle is left out.
    let scale = [a, b, c].iter().fold(reach, |scale, p| scale.max(p.abs())).max_element();
    let separates = |axis: DVec3| {
        let [p, q, r] = [a, b, c].map(|corner| corner.dot(axis));
        let radius = reach.dot(axis.abs()) + scale * axis.abs().max_element() * 1e-12;
        p.min(q).min(r) > radius || p.max(q).max(r) < -radius
    };
    let edges = [b - a, c - b, a - c];
    let between = edges.iter().flat_map(|edge| DVec3::AXES.map(|axis| axis.cross(*edge)));
    !between.chain([edges[0].cross(edges[1])]).any(separates)
}
