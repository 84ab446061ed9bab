//! The maximum difference.

use super::{MetricEntry, Pair};
use bilux_math::registry::Entry;

/// The row of `max`.
pub(super) const ENTRY: MetricEntry = MetricEntry {
    entry: Entry {
        name: "max",
        summary: "maximum absolute difference of light or alpha in any pixel; 0 if equal",
        source: "",
        parameters: &[],
    },
    higher_is_better: false,
    evaluate: max,
};

fn max(pair: &Pair) -> f64 {
    let [a, b] = &pair.light;
    let colours = a.iter().zip(b).flat_map(|(a, b)| a.to_array().into_iter().zip(b.to_array()));
    let alphas = pair.alpha[0].iter().copied().zip(pair.alpha[1].iter().copied());
    let differences = colours.chain(alphas).map(|(a, b)| (f64::from(a) - f64::from(b)).abs());
    // `f64::max` would skip NaN.
    differences.fold(0.0, |most, d| if d > most || d.is_nan() { d } else { most })
}
