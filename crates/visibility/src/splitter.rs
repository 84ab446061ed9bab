//! Chooses the polygon whose plane divides the others [Fuchs 1983].

use crate::piece::Piece;
use crate::polygon::{Plane, corners};
use crate::screen::Slack;
use bilux_accel::TriangleMesh;
use bilux_math::{DVec3, hash};

/// Number of candidate planes, and of polygons by which they are judged.
const CANDIDATES: usize = 5;
const JUDGES: usize = 64;
/// The cost of one cut polygon, relative to one polygon of imbalance among the judges.
const SPLIT_WEIGHT: usize = 4;

/// A few of the pieces, chosen by a hash so that no order of the triangles is a worst case.
pub(crate) fn candidates(pieces: usize, salt: usize) -> Vec<usize> {
    (0..CANDIDATES.min(pieces))
        .map(|k| (hash::mix64((salt * CANDIDATES + k) as u64) % pieces as u64) as usize)
        .collect()
}

/// Among the candidates' planes, the one that cuts the fewest pieces and balances the rest, and how far its own
/// triangle deviates from it.
pub(crate) fn fewest_splits(
    pieces: &[Piece],
    candidates: &[usize],
    mesh: &TriangleMesh,
    slack: &Slack,
) -> (Plane, f64) {
    let stride = pieces.len().div_ceil(JUDGES).max(1);
    let plane_of = |&candidate: &usize| {
        let triangle = &mesh.triangles()[pieces[candidate].triangle as usize];
        let corners = corners(triangle).unwrap_or([DVec3::ZERO; 3]);
        let plane = Plane::of_triangle(&corners);
        let (low, high) = plane.range(&corners);
        (plane, high.max(-low))
    };
    let cost = |(plane, thickness): &(Plane, f64)| {
        let half = thickness + 2.0 * slack.radius;
        let (mut cut, mut front, mut back) = (0, 0usize, 0usize);
        for judge in pieces.iter().step_by(stride) {
            let (low, high) = plane.range(&judge.polygon);
            match (low < -half, high > half) {
                (true, true) => cut += 1,
                (false, true) => front += 1,
                (true, false) => back += 1,
                (false, false) => {}
            }
        }
        SPLIT_WEIGHT * cut + front.abs_diff(back)
    };
    let best = candidates.iter().map(plane_of).min_by_key(cost);
    best.unwrap_or_else(|| (Plane::through(DVec3::ZERO, DVec3::X), 0.0))
}
