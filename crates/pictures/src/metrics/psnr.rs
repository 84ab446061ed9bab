//! Peak signal-to-noise ratio.

use super::{MetricEntry, Pair};
use bilux_math::registry::Entry;
use bilux_math::transcendental::ln_f64;

/// The row of `psnr`.
pub(super) const ENTRY: MetricEntry = MetricEntry {
    entry: Entry {
        name: "psnr",
        summary: "peak signal-to-noise ratio of the displayed picture, in decibels; infinite if equal",
        source: "",
        parameters: &[],
    },
    higher_is_better: true,
    evaluate: psnr,
};

fn psnr(pair: &Pair) -> f64 {
    let squared = Pair::mean(&pair.shown, |a, b| (a - b) * (a - b));
    if squared == 0.0 { f64::INFINITY } else { -10.0 * ln_f64(squared) / std::f64::consts::LN_10 }
}
