//! Which polygon's plane to divide by [Fuchs 1983].

use super::partition::Piece;
use super::polygon::{Plane, corners};
use super::screen::Slack;
use crate::mesh::TriangleMesh;
use bilux_math::{DVec3, hash};

/// Candidates that a plane is chosen from, and polygons that it is judged by.
const CANDIDATES: usize = 5;
const JUDGES: usize = 64;
/// What one cut polygon weighs against one polygon of imbalance among the judges.
const SPLIT_WEIGHT: usize = 4;

/// A few of so many pieces, by a hash so that no order of the triangles is the worst one.
pub(super) fn candidates(pieces: usize, salt: usize) -> Vec<usize> {
    (0..CANDIDATES.min(pieces))
        .map(|k| (hash::mix64((salt * CANDIDATES + k) as u64) % pieces as u64) as usize)
        .collect()
}

/// Of the planes of some candidates, the one that cuts fewest pieces and balances the rest, with how far its own
/// triangle strays from it.
pub(super) fn fewest_splits(
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
