//! Whether two methods of rendering have the same mean, estimated from pictures with different seeds. [Jung 2020]

use bilux_math::transcendental::powf_f64;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Mean and variance of the mean.
pub fn estimate(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0) / n)
}

/// Probability that two sets of values with the same mean differ by as much as these; each has at least two values.
/// `None` where nothing varies and nothing differs, which is no evidence; zero where something is no number. [Welch 1947]
pub fn welch(a: &[f64], b: &[f64]) -> Option<f64> {
    let ((mean_a, va), (mean_b, vb)) = (estimate(a), estimate(b));
    if va + vb == 0.0 {
        return (mean_a != mean_b).then_some(0.0);
    }
    let freedom =
        (va + vb) * (va + vb) / (va * va / (a.len() as f64 - 1.0) + vb * vb / (b.len() as f64 - 1.0));
    let t = (mean_a - mean_b).abs() / (va + vb).sqrt();
    Some(StudentsT::new(0.0, 1.0, freedom).map_or(0.0, |student| 2.0 * student.sf(t)))
}

/// The minimum of `count` p-values as one p-value, corrected for their number. [Šidák 1967]
pub fn sidak(least: f64, count: usize) -> f64 {
    let n = count as f64;
    // Where the power would round to 1.
    if least * n < 1e-9 { least * n } else { 1.0 - powf_f64(1.0 - least, n) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minimum_of_many_is_corrected() {
        assert!((sidak(0.01, 100) - 0.633_967_658_7).abs() < 1e-9);
        assert!((sidak(1e-12, 100) / 1e-10 - 1.0).abs() < 1e-6);
        assert_eq!(sidak(1.0, 5), 1.0);
    }

    #[test]
    fn no_evidence_is_not_agreement() {
        assert_eq!(welch(&[0.0; 4], &[0.0; 4]), None);
        assert_eq!(welch(&[0.0; 4], &[1.0; 4]), Some(0.0));
    }

    #[test]
    fn what_is_no_number_agrees_with_nothing() {
        assert_eq!(welch(&[0.0, 1.0, f64::NAN], &[0.0, 1.0, 2.0]), Some(0.0));
    }
}
