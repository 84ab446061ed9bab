//! Judges whether two sets of pictures have the same mean in a cell, as far as they know it.

use crate::statistics::{estimate, is_skewed, welch};

/// Largest standard error for a decision, as a fraction of the light: beyond it, too little has been found.
const COARSE: f64 = 0.03;

/// The verdict on a cell.
pub(crate) enum CellVerdict {
    /// There is no light apart from that of the lights themselves.
    Empty,
    /// Too little has been found.
    Undecided,
    /// The probability that equal means differ by as much, and one standard error of their difference as a fraction of
    /// the light.
    Decided { p: f64, error: f64 },
}

/// Judges two sets of pictures of a cell.
pub(crate) type Judge = fn([&[f64]; 2], f64, bool) -> CellVerdict;

/// Judges as [`judge`] does, if each half of each set is enough to know it.
pub(crate) fn judge_known(pair: [&[f64]; 2], seen: f64, sure: bool) -> CellVerdict {
    let is_known = |values: &[f64]| {
        let (first, second) = values.split_at(values.len() / 2);
        !matches!(judge([first, second], seen, sure), CellVerdict::Undecided)
    };
    if pair.into_iter().all(is_known) { judge(pair, seen, sure) } else { CellVerdict::Undecided }
}

/// Judges two sets of pictures of a cell, in which `seen` is the light of the lights themselves. That one technique
/// finds nothing at all counts only where it is `sure` to find something: it may just not have happened yet.
pub(crate) fn judge(pair: [&[f64]; 2], seen: f64, sure: bool) -> CellVerdict {
    let estimates = pair.map(estimate);
    let light = estimates.map(|(mean, _)| mean).into_iter().fold(0.0, f64::max) - seen;
    // The lights' edges are not the same in all pictures.
    if light < 1e-2 * seen || light <= 0.0 {
        return CellVerdict::Empty;
    }
    let is_unknown = |(values, (mean, variance)): (&[f64], (f64, f64))| {
        let finds_nothing = mean - seen < 1e-2 * light;
        variance.sqrt() > COARSE * light || is_skewed(values) || (finds_nothing && !sure)
    };
    let Some(p) = welch(pair[0], pair[1]) else { return CellVerdict::Empty };
    if pair.into_iter().zip(estimates).any(is_unknown) {
        return CellVerdict::Undecided;
    }
    CellVerdict::Decided { p, error: (estimates[0].1 + estimates[1].1).sqrt() / light }
}
