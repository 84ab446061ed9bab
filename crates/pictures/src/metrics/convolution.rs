//! Convolution with a separable kernel; pixels beyond the edges repeat the nearest one.

/// A plane of samples in rows.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    pub(super) width: usize,
    pub(super) samples: Vec<f64>,
}

impl Plane {
    /// The plane convolved with `across` along its rows and `down` along its columns, both of odd length.
    pub(super) fn convolved(&self, across: &[f64], down: &[f64]) -> Plane {
        self.across(across).down(down)
    }

    fn across(&self, kernel: &[f64]) -> Plane {
        let radius = kernel.len() / 2;
        let mut sums = vec![0.0; self.samples.len()];
        let mut padded = Vec::with_capacity(self.width + 2 * radius);
        for (row, sums) in self.samples.chunks_exact(self.width).zip(sums.chunks_exact_mut(self.width)) {
            padded.clear();
            padded.resize(radius, row[0]);
            padded.extend_from_slice(row);
            padded.resize(self.width + 2 * radius, row[self.width - 1]);
            for (tap, weight) in kernel.iter().enumerate() {
                add(sums, &padded[tap..], *weight);
            }
        }
        Plane { width: self.width, samples: sums }
    }

    fn down(&self, kernel: &[f64]) -> Plane {
        let radius = kernel.len() / 2;
        let mut sums = vec![0.0; self.samples.len()];
        let height = self.samples.len() / self.width;
        for (y, sums) in sums.chunks_exact_mut(self.width).enumerate() {
            for (tap, weight) in kernel.iter().enumerate() {
                let row = (y + tap).saturating_sub(radius).min(height - 1);
                add(sums, &self.samples[row * self.width..], *weight);
            }
        }
        Plane { width: self.width, samples: sums }
    }
}

fn add(sums: &mut [f64], samples: &[f64], weight: f64) {
    sums.iter_mut().zip(samples).for_each(|(sum, sample)| *sum += weight * sample);
}

/// Samples `f` at −radius ..= radius.
pub(super) fn kernel(radius: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..=2 * radius).map(|i| f(i as f64 - radius as f64)).collect()
}

/// The kernel divided by its sum.
pub(super) fn normalised(kernel: Vec<f64>) -> Vec<f64> {
    let sum: f64 = kernel.iter().sum();
    kernel.into_iter().map(|weight| weight / sum).collect()
}
