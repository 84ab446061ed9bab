//! Points within an outline.

use super::corner::{Corner, bounds};
use bilux_math::DVec2;

/// Least distance of a point from the outline, in steps.
const MARGIN: f64 = 0.35;

/// The most corners next to a row that its points are compared with.
const NEAREST: usize = 4096;

/// The most rows, and points of each.
const MOST: usize = 160;

/// Places within closed lines, about one step apart in rows, where the lines leave room.
pub(super) fn inner(loops: &[Vec<Corner>], step: DVec2) -> Vec<DVec2> {
    let [low, high] = bounds(loops);
    let rows = (((high.y - low.y) / step.y - 1e-6).ceil().max(0.0) as usize).min(MOST);
    let mut found = Vec::new();
    for row in 1..rows {
        let y = low.y + (high.y - low.y) * row as f64 / rows as f64;
        let mut crossings: Vec<f64> = Vec::new();
        let mut near: Vec<DVec2> = Vec::new();
        for corners in loops {
            for (i, corner) in corners.iter().enumerate() {
                let (a, b) = (corner.at, corners[(i + 1) % corners.len()].at);
                if (a.y > y) != (b.y > y) {
                    crossings.push(a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y));
                }
                if (a.y - y).abs() < MARGIN * step.y {
                    near.push(a);
                }
            }
        }
        crossings.sort_by(f64::total_cmp);
        near.truncate(NEAREST);
        for pair in crossings.as_chunks::<2>().0 {
            let pieces = ((pair[1] - pair[0]) / step.x - 1e-6).ceil().max(0.0);
            let pieces = (pieces as usize).min(MOST);
            for i in 1..pieces {
                let p = DVec2::new(pair[0] + (pair[1] - pair[0]) * i as f64 / pieces as f64, y);
                let is_free = near.iter().all(|q| ((*q - p) / step).length() > MARGIN);
                if is_free {
                    found.push(p);
                }
            }
        }
    }
    found
}
