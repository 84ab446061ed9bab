//! Local linear regression: a weighted mean plus the slope of the light across the window.
//!
//! Next to a boundary all neighbours of a pixel lie on one side of it. If the light has a gradient there, as in a contact shadow,
//! their mean is biased towards the light farther away. A weighted linear fit in the pixels' positions has no such bias, and where the
//! neighbours lie symmetrically it is the mean. [Fan 1996, sec. 3.2]

/// Ridge regularisation of the slopes, in squared steps.
const RIDGE: f32 = 0.1;

/// Sums over the neighbours of each pixel of some rows.
pub(super) struct Moments {
    /// Weight · x, y, x², xy and y², where x and y count steps from the pixel.
    positions: [Vec<f32>; 5],
    /// Weight · light · x, and weight · light · y, each for R, G and B.
    light: [[Vec<f32>; 3]; 2],
}

impl Moments {
    pub(super) fn new(pixels: usize) -> Moments {
        let zeros = || vec![0.0; pixels];
        Moments {
            positions: std::array::from_fn(|_| zeros()),
            light: std::array::from_fn(|_| std::array::from_fn(|_| zeros())),
        }
    }

    /// Adds the neighbours at an offset of (x, y) steps to a row of pixels that starts at `to`.
    pub(super) fn add(&mut self, to: usize, [x, y]: [f32; 2], weights: &[f32], light: [&[f32]; 3]) {
        let to = to..to + weights.len();
        for (sums, factor) in self.positions.iter_mut().zip([x, y, x * x, x * y, y * y]) {
            sums[to.clone()].iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * factor);
        }
        for (channels, factor) in self.light.iter_mut().zip([x, y]) {
            for (sums, light) in channels.iter_mut().zip(light) {
                let pairs = weights.iter().zip(light);
                sums[to.clone()].iter_mut().zip(pairs).for_each(|(sum, (w, l))| *sum += w * factor * l);
            }
        }
    }

    /// The fit at pixel `i`, given the weighted means of R, G and B and one over the sum of weights; and the factor by which its
    /// variance is that of the mean.
    pub(super) fn fit(&self, i: usize, means: [f32; 3], one_over: f32) -> ([f32; 3], f32) {
        let [x, y, xx, xy, yy] = [0, 1, 2, 3, 4].map(|k| self.positions[k][i] * one_over);
        let (xx, xy, yy) = (xx - x * x + RIDGE, xy - x * y, yy - y * y + RIDGE);
        let one_over_determinant = 1.0 / (xx * yy - xy * xy);
        let along = [(yy * x - xy * y) * one_over_determinant, (xx * y - xy * x) * one_over_determinant];
        let mut fits = means;
        for (c, fit) in fits.iter_mut().enumerate() {
            let covariances = [
                self.light[0][c][i] * one_over - x * means[c],
                self.light[1][c][i] * one_over - y * means[c],
            ];
            *fit -= along[0] * covariances[0] + along[1] * covariances[1];
            *fit = if *fit > 0.0 { *fit } else { 0.0 };
        }
        (fits, 1.0 + along[0] * x + along[1] * y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light 5 + 2x - 3y, seen from neighbours on the right alone: the mean is far off, the fit nearly exact.
    #[test]
    fn a_gradient_at_a_boundary_is_followed() {
        let mut moments = Moments::new(1);
        let (mut weights, mut sum) = (0.0, 0.0);
        for (x, y) in [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1), (0, -1), (1, -1), (2, -1)] {
            let light = 15.0 + 2.0 * x as f32 - 3.0 * y as f32;
            weights += 1.0;
            sum += light;
            moments.add(0, [x as f32, y as f32], &[1.0], [&[light]; 3]);
        }
        let mean = sum / weights;
        let (fits, variance) = moments.fit(0, [mean; 3], 1.0 / weights);
        assert!((mean - 15.0).abs() > 1.9);
        assert!((fits[0] - 15.0).abs() < 0.3, "{fits:?}");
        // One side only: the fit extrapolates, which costs variance.
        assert!((1.5..3.0).contains(&variance), "{variance}");
    }

    #[test]
    fn among_symmetric_neighbours_the_fit_is_the_mean() {
        let mut moments = Moments::new(1);
        for (x, light) in [(-1.0, 1.0), (0.0, 4.0), (1.0, 7.0)] {
            moments.add(0, [x, 0.0], &[1.0], [&[light]; 3]);
        }
        assert_eq!(moments.fit(0, [4.0; 3], 1.0 / 3.0), ([4.0; 3], 1.0));
    }
}
