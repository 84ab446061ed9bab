//! Means of samples, and whether two of them estimate the same value. [Welch 1947]

use statrs::distribution::{ContinuousCDF, Normal};

/// Sums of samples, enough of them for their mean to be normally distributed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    count: f64,
    sum: f64,
    squares: f64,
    nonzero: u64,
}

impl Tally {
    /// Adds a sample.
    pub fn add(&mut self, x: f64) {
        self.count += 1.0;
        self.sum += x;
        self.squares += x * x;
        self.nonzero += u64::from(x != 0.0);
    }

    /// True when too few samples are non-zero for the mean to be normally distributed.
    pub fn is_sparse(&self) -> bool {
        self.nonzero < 30
    }

    /// The mean; zero without samples.
    pub fn mean(&self) -> f64 {
        self.sum / self.count.max(1.0)
    }

    /// Variance of the mean.
    fn variance(&self) -> f64 {
        let n = self.count.max(2.0);
        (self.squares / n - self.mean() * self.mean()).max(0.0) / (n - 1.0)
    }

    /// The probability that two means of the same expected value differ by as much as these. Differences that rounding
    /// explains, a hundred-thousandth, do not count.
    pub fn p_value(&self, other: &Tally) -> f64 {
        let rounding = 1e-5 * self.mean().abs().max(other.mean().abs());
        let difference = ((self.mean() - other.mean()).abs() - rounding).max(0.0);
        if difference == 0.0 {
            return 1.0;
        }
        let deviations = difference / (self.variance() + other.variance()).sqrt();
        2.0 * Normal::standard().cdf(-deviations)
    }

    /// The p-value of the mean against a known number.
    pub fn p_value_of(&self, known: f64) -> f64 {
        let exact = Tally { count: 1.0, sum: known, squares: 0.0, nonzero: 0 };
        self.p_value(&exact)
    }
}
