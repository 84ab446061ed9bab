//! Root mean squared error.

use super::{MetricEntry, Pair};
use bilux_math::registry::Entry;

/// The row of `rmse`.
pub(super) const ENTRY: MetricEntry = MetricEntry {
    entry: Entry {
        name: "rmse",
        summary: "root mean square error of light over pixels and channels; 0 if equal",
        source: "",
        parameters: &[],
    },
    higher_is_better: false,
    evaluate: |pair: &Pair| Pair::mean(&pair.light, |a, b| (a - b) * (a - b)).sqrt(),
};
