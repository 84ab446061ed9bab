//! Small square matrices.

use std::ops::{Add, Mul, Sub};

/// A square matrix, in rows.
#[derive(Clone)]
pub(super) struct Matrix {
    pub(super) side: usize,
    values: Vec<f64>,
}

impl Matrix {
    /// By row and column.
    pub(super) fn from_fn(side: usize, value: impl Fn(usize, usize) -> f64) -> Matrix {
        Matrix { side, values: (0..side * side).map(|i| value(i / side, i % side)).collect() }
    }

    /// One with only a diagonal.
    pub(super) fn diagonal(side: usize, value: impl Fn(usize) -> f64) -> Matrix {
        Matrix::from_fn(side, |row, column| if row == column { value(row) } else { 0.0 })
    }

    pub(super) fn identity(side: usize) -> Matrix {
        Matrix::diagonal(side, |_| 1.0)
    }

    pub(super) fn scaled(mut self, factor: f64) -> Matrix {
        self.values.iter_mut().for_each(|value| *value *= factor);
        self
    }

    /// The largest absolute value.
    pub(super) fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |most, value| most.max(value.abs()))
    }

    pub(super) fn times(&self, vector: &[f64]) -> Vec<f64> {
        let row = |row: &[f64]| row.iter().zip(vector).map(|(a, b)| a * b).sum();
        self.values.chunks_exact(self.side).map(row).collect()
    }

    /// The inverse of this, times `right`, by elimination. Scattering loses light or keeps it, so diagonals dominate, and rows
    /// need no exchange.
    pub(super) fn solve(mut self, mut right: Matrix) -> Matrix {
        let side = self.side;
        for pivot in 0..side {
            let inverse = 1.0 / self.values[pivot * side + pivot];
            for row in (0..side).filter(|&row| row != pivot) {
                let factor = self.values[row * side + pivot] * inverse;
                self.subtract_row(row, pivot, factor);
                right.subtract_row(row, pivot, factor);
            }
            for matrix in [&mut self, &mut right] {
                matrix.values[pivot * side..][..side].iter_mut().for_each(|value| *value *= inverse);
            }
        }
        right
    }

    fn subtract_row(&mut self, row: usize, other: usize, factor: f64) {
        let side = self.side;
        let (low, high) = (row.min(other), row.max(other));
        let (before, behind) = self.values.split_at_mut(high * side);
        let (low, high) = (&mut before[low * side..][..side], &mut behind[..side]);
        let (row, other) = if row < other { (low, high) } else { (high, low) };
        row.iter_mut().zip(other).for_each(|(value, other)| *value -= factor * *other);
    }
}

impl Add for &Matrix {
    type Output = Matrix;
    fn add(self, other: &Matrix) -> Matrix {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| a + b).collect();
        Matrix { side: self.side, values }
    }
}

impl Sub for &Matrix {
    type Output = Matrix;
    fn sub(self, other: &Matrix) -> Matrix {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| a - b).collect();
        Matrix { side: self.side, values }
    }
}

impl Mul for &Matrix {
    type Output = Matrix;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "a product of matrices is made of sums")]
    fn mul(self, other: &Matrix) -> Matrix {
        let side = self.side;
        let mut values = vec![0.0; side * side];
        for (row, sums) in self.values.chunks_exact(side).zip(values.chunks_exact_mut(side)) {
            for (factor, other) in row.iter().zip(other.values.chunks_exact(side)) {
                sums.iter_mut().zip(other).for_each(|(sum, value)| *sum += factor * value);
            }
        }
        Matrix { side, values }
    }
}
