//! A plane that was chosen, and its cost by the surface-area heuristic.

use super::plane::Plane;

/// The cost of a plane perpendicular to an axis, in triangle tests.
pub(super) const AXIS_STEP: f64 = 0.4;

/// A plane and its expected cost, in triangle tests.
#[derive(Clone, Copy)]
pub(super) struct Choice {
    pub(super) plane: Plane,
    pub(super) cost: f64,
    /// Whether what lies in the plane goes left.
    pub(super) on_left: bool,
}

impl Choice {
    /// From the ratios of the two parts' surface areas to the whole's, and the numbers of references left, right and
    /// in the plane. `None` for a plane that separates nothing.
    pub(super) fn new(plane: Plane, step: f64, areas: [f64; 2], counts: [usize; 3]) -> Option<Choice> {
        let [left, right, on] = counts.map(|count| count as f64);
        let on_left = areas[0] < areas[1];
        let cost = step + areas[0] * left + areas[1] * right + areas[0].min(areas[1]) * on;
        // Also rejects NaN.
        (cost >= step && areas[0] > 0.0 && areas[1] > 0.0).then_some(Choice { plane, cost, on_left })
    }
}
