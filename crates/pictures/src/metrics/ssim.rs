//! Structural similarity.

use super::convolution::{Plane, kernel, normalised};
use super::{MetricEntry, Pair};
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use bilux_math::transcendental::exp_f64;

/// The row of `ssim`.
pub(super) const ENTRY: MetricEntry = MetricEntry {
    entry: Entry {
        name: "ssim",
        summary: "structural similarity of the displayed picture, on luma; 1 if equal",
        source: "Wang 2004",
        parameters: &[],
    },
    higher_is_better: true,
    evaluate: ssim,
};

/// Radius of the window.
const RADIUS: usize = 5;
/// Standard deviation of the window, in pixels.
const DEVIATION: f64 = 1.5;
/// Stabilisers for quotients of very small numbers. [Wang 2004, eq. 13]
const STABILISERS: [f64; 2] = [0.01 * 0.01, 0.03 * 0.03];

/// The mean over all windows that lie within the picture, or over all pixels if none does.
fn ssim(pair: &Pair) -> f64 {
    let window = normalised(kernel(RADIUS, |x| exp_f64(-x * x / (2.0 * DEVIATION * DEVIATION))));
    let [a, b] = pair.shown.each_ref().map(|side| side.iter().map(luma).collect::<Vec<f64>>());
    let blurred =
        |samples: Vec<f64>| Plane { width: pair.width, samples }.convolved(&window, &window).samples;
    let product = |a: &[f64], b: &[f64]| blurred(a.iter().zip(b).map(|(a, b)| a * b).collect());
    let (aa, bb, ab) = (product(&a, &a), product(&b, &b), product(&a, &b));
    let (mean_a, mean_b) = (blurred(a), blurred(b));
    let (width, height) = (pair.width, pair.height);
    let whole = width > 2 * RADIUS && height > 2 * RADIUS;
    let margin = if whole { RADIUS } else { 0 };
    let inside = |i: &usize| {
        let (x, y) = (i % width, i / width);
        (margin..width - margin).contains(&x) && (margin..height - margin).contains(&y)
    };
    let (mut sum, mut count) = (0.0, 0u64);
    for i in (0..width * height).filter(inside) {
        let [ma, mb, aa, bb, ab] = [mean_a[i], mean_b[i], aa[i], bb[i], ab[i]];
        let (variances, covariance) = ((aa - ma * ma) + (bb - mb * mb), ab - ma * mb);
        let [c1, c2] = STABILISERS;
        sum += (2.0 * ma * mb + c1) * (2.0 * covariance + c2) / ((ma * ma + mb * mb + c1) * (variances + c2));
        count += 1;
    }
    sum / count as f64
}

fn luma(colour: &Rgb) -> f64 {
    let [r, g, b] = colour.to_array().map(f64::from);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
