//! Local linear regression: a weighted mean plus the slope of the light across the window.
//!
//! Next to a boundary all neighbours of a pixel lie on one side of it. If the light has a gradient there, as in a contact shadow,
//! their mean is biased towards the light farther away. A weighted linear fit in the pixels' positions has no such bias, and where the
//! neighbours lie symmetrically it is the mean. [Fan 1996, sec. 3.2]

use super::lanes::{LANES, Lanes, add_products, add_scaled};

/// Ridge regularisation of the slopes, in squared steps.
const RIDGE: f32 = 0.1;

/// Sums over the neighbours of each of some pixels.
pub(super) struct Moments {
    /// Weight · x, y, x², xy and y², where x and y count steps from the pixel.
    positions: [Lanes; 5],
    /// Weight · light · x, and weight · light · y, each for R, G and B.
    light: [[Lanes; 3]; 2],
}

impl Moments {
    /// Sums over no neighbours.
    pub(super) const NONE: Moments = Moments { positions: [[0.0; LANES]; 5], light: [[[0.0; LANES]; 3]; 2] };

    /// Adds neighbours at an offset of (x, y) steps.
    #[inline(always)]
    pub(super) fn add(&mut self, [x, y]: [f32; 2], weights: &Lanes, light: [&Lanes; 3]) {
        for (sums, factor) in self.positions.iter_mut().zip([x, y, x * x, x * y, y * y]) {
            add_scaled(sums, weights, factor);
        }
        for (channels, factor) in self.light.iter_mut().zip([x, y]) {
            let weights = weights.map(|weight| weight * factor);
            for (sums, light) in channels.iter_mut().zip(light) {
                add_products(sums, &weights, light);
            }
        }
    }

    /// The fits at the pixels, given the weighted means of R, G and B and one over the sums of weights; and the factors
    /// by which their variances are those of the means.
    #[inline(always)]
    pub(super) fn fits(&self, means: &[Lanes; 3], one_over: &Lanes) -> ([Lanes; 3], Lanes) {
        let (mut fits, mut variance) = (*means, [1.0; LANES]);
        for lane in 0..LANES {
            let one_over = one_over[lane];
            let [x, y, xx, xy, yy] = [0, 1, 2, 3, 4].map(|k| self.positions[k][lane] * one_over);
            let (xx, xy, yy) = (xx - x * x + RIDGE, xy - x * y, yy - y * y + RIDGE);
            let one_over_determinant = 1.0 / (xx * yy - xy * xy);
            let along = [(yy * x - xy * y) * one_over_determinant, (xx * y - xy * x) * one_over_determinant];
            for (c, fit) in fits.iter_mut().enumerate() {
                let covariances = [
                    self.light[0][c][lane] * one_over - x * means[c][lane],
                    self.light[1][c][lane] * one_over - y * means[c][lane],
                ];
                let light = fit[lane] - (along[0] * covariances[0] + along[1] * covariances[1]);
                fit[lane] = if light > 0.0 { light } else { 0.0 };
            }
            variance[lane] = 1.0 + along[0] * x + along[1] * y;
        }
        (fits, variance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light 5 + 2x - 3y, seen from neighbours on the right alone: the mean is far off, the fit nearly exact.
    #[test]
    fn a_gradient_at_a_boundary_is_followed() {
        let mut moments = Moments::NONE;
        let (mut weights, mut sum) = (0.0, 0.0);
        for (x, y) in [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1), (0, -1), (1, -1), (2, -1)] {
            let light = 15.0 + 2.0 * x as f32 - 3.0 * y as f32;
            weights += 1.0;
            sum += light;
            moments.add([x as f32, y as f32], &[1.0; LANES], [&[light; LANES]; 3]);
        }
        let mean = sum / weights;
        let (fits, variance) = moments.fits(&[[mean; LANES]; 3], &[1.0 / weights; LANES]);
        let (fits, variance) = (fits[0][LANES - 1], variance[LANES - 1]);
        assert!((mean - 15.0).abs() > 1.9);
        assert!((fits - 15.0).abs() < 0.3, "{fits}");
        // One side only: the fit extrapolates, which costs variance.
        assert!((1.5..3.0).contains(&variance), "{variance}");
    }

    #[test]
    fn among_symmetric_neighbours_the_fit_is_the_mean() {
        let mut moments = Moments::NONE;
        for (x, light) in [(-1.0, 1.0), (0.0, 4.0), (1.0, 7.0)] {
            moments.add([x, 0.0], &[1.0; LANES], [&[light; LANES]; 3]);
        }
        let (means, thirds) = ([[4.0; LANES]; 3], [1.0 / 3.0; LANES]);
        assert_eq!(moments.fits(&means, &thirds), (means, [1.0; LANES]));
    }
}
