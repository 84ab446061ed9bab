//! Corners of outlines.

use bilux_math::{DVec2, DVec3};

/// A point with its place in the plane that is triangulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub(super) at: DVec2,
    pub(super) point: DVec3,
}

impl Corner {
    pub(super) fn moved(self, by: DVec2) -> Corner {
        Corner { at: self.at + by, ..self }
    }
}

/// Twice the area within a closed line; positive if it is counter-clockwise.
pub(super) fn area(corners: &[Corner]) -> f64 {
    let Some(first) = corners.first() else { return 0.0 };
    let relative = |corner: &Corner| corner.at - first.at;
    corners.windows(2).map(|pair| relative(&pair[0]).perp_dot(relative(&pair[1]))).sum()
}

/// True if a point is within closed lines, by the even-odd rule.
pub(super) fn contain<'a>(loops: impl IntoIterator<Item = &'a [Corner]>, p: DVec2) -> bool {
    let mut is_inside = false;
    for corners in loops {
        let Some(last) = corners.last() else { continue };
        let mut a = last.at;
        for corner in corners {
            let b = corner.at;
            if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) {
                is_inside = !is_inside;
            }
            a = b;
        }
    }
    is_inside
}

/// The least and the greatest coordinates.
pub(super) fn bounds(loops: &[Vec<Corner>]) -> [DVec2; 2] {
    let all = loops.iter().flatten();
    all.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], corner| {
        [low.min(corner.at), high.max(corner.at)]
    })
}
