//! Mean squared error relative to the squared reference, so that dark parts count as much as bright ones.

use super::{MetricEntry, Pair};
use bilux_math::registry::Entry;

/// The row of `relmse`.
pub(super) const ENTRY: MetricEntry = MetricEntry {
    entry: Entry {
        name: "relmse",
        summary: "mean of (x − r)² / (r² + 0.01) of light over pixels and channels; 0 if equal",
        source: "Rousselle 2011",
        parameters: &[],
    },
    higher_is_better: false,
    evaluate: |pair: &Pair| Pair::mean(&pair.light, |x, r| (x - r) * (x - r) / (r * r + 0.01)),
};
