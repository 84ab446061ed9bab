//! Whether two methods of rendering have the same mean, estimated from pictures with different seeds. [Jung 2020]

use bilux_math::transcendental::exp_f64;

pub use bilux_testing::statistics::{estimate, sidak, welch};

/// True where the mean is not normally distributed, because the variance comes from a few rare, large values: skewness
/// over the root of the number of values, which is 1 where one value alone differs from the rest.
pub fn is_skewed(values: &[f64]) -> bool {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let moment = |of: fn(f64) -> f64| values.iter().map(|v| of(v - mean)).sum::<f64>() / n;
    let variance = moment(|d| d * d);
    variance > 0.0 && moment(|d| d * d * d).abs() > 0.25 * variance * variance.sqrt() * n.sqrt()
}

/// The number of values, 0..=1, in each tenth.
pub fn histogram(p_values: &[f64]) -> [usize; 10] {
    let mut bins = [0; 10];
    p_values.iter().for_each(|p| bins[((p * 10.0) as usize).min(9)] += 1);
    bins
}

/// A histogram as a line of bars, the highest bin as high as a character.
pub fn bars(bins: &[usize]) -> String {
    const BARS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let most = bins.iter().copied().max().unwrap_or(0).max(1);
    bins.iter().map(|&count| BARS[(count * 8).div_ceil(most)]).collect()
}

/// The probability that independent, uniform values in 0..=1 look less uniform than these do. [Kolmogorov 1933]
pub fn uniformity_p(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let gap = |(i, v): (usize, &f64)| (v - i as f64 / n).max((i as f64 + 1.0) / n - v);
    let farthest = sorted.iter().enumerate().map(gap).fold(0.0, f64::max);
    // The limit for many values, with the usual correction for few.
    let x = farthest * (n.sqrt() + 0.12 + 0.11 / n.sqrt().max(1.0));
    if x < 0.3 {
        return 1.0;
    }
    let term = |k: i32| f64::from(1 - 2 * ((k + 1) % 2)) * exp_f64(-2.0 * f64::from(k * k) * x * x);
    (2.0 * (1..=20).map(term).sum::<f64>()).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chi_square::uniforms;
    use bilux_math::transcendental::{ln_f64, powf_f64};

    /// Sums of this many numbers of a distribution, each from a uniform number in 0..1.
    fn sums(stream: u64, groups: usize, of: usize, value: impl Fn(f64) -> f64) -> Vec<f64> {
        let one = |i: usize| value(f64::from(uniforms(stream, i as u64).0));
        (0..groups).map(|g| (0..of).map(|i| one(g * of + i)).sum()).collect()
    }

    #[test]
    fn p_values_of_equal_means_are_even_and_of_others_are_not() {
        let skewed = |u: f64| -ln_f64(1.0 - u);
        let p_values = |factor: f64| -> Vec<f64> {
            let test = |k: u64| {
                let (a, b) = (sums(2 * k, 16, 64, skewed), sums(2 * k + 1, 16, 64, |u| skewed(u) * factor));
                welch(&a, &b).unwrap()
            };
            (0..400).map(test).collect()
        };
        let (same, off) = (p_values(1.0), p_values(1.05));
        assert!(uniformity_p(&same) > 1e-3, "{:?}", histogram(&same));
        assert!(uniformity_p(&off) < 1e-6, "{:?}", histogram(&off));
        assert!(off.iter().copied().fold(1.0, f64::min) < 1e-3);
        // A wrong number of degrees of freedom, as if the variances of single values were those of means.
        let timid: Vec<f64> = same.iter().map(|p| powf_f64(*p, 0.25)).collect();
        assert!(uniformity_p(&timid) < 1e-6);
    }

    #[test]
    fn uniformity_matches_the_table() {
        // The usual critical values: 1.358 / √n for 0.05, 1.628 / √n for 0.01.
        for (x, wanted) in [(1.358, 0.05), (1.628, 0.01)] {
            let n = 10_000;
            let shift = x / f64::from(n).sqrt() - 0.5 / f64::from(n);
            let values: Vec<f64> =
                (0..n).map(|i| ((f64::from(i) + 0.5) / f64::from(n) - shift).max(0.0)).collect();
            assert!((uniformity_p(&values) / wanted - 1.0).abs() < 0.05, "{}", uniformity_p(&values));
        }
    }

    #[test]
    fn one_bright_dot_is_a_skew() {
        let mut values = sums(9, 32, 16, |u| u);
        assert!(!is_skewed(&values));
        values[5] += 40.0;
        assert!(is_skewed(&values));
    }

    #[test]
    fn bars_are_as_high_as_their_bins() {
        assert_eq!(bars(&histogram(&[0.05, 0.05, 0.15, 1.0])), "█▄       ▄");
    }
}
