//! First-order fits of light to features, around several pixels side by side. [Moon 2014; Bitterli 2016, eq. 4]

use super::guides::{ALBEDO, Guides, INVERSE, NORMAL, WITHIN};
use super::lanes::{LANES, Lanes, add_products};
use super::planes::Planes;

/// Radius of a fit, in pixels.
pub(super) const RADIUS: usize = 2;
const SIDE: usize = 2 * RADIUS + 1;

/// Weights of pixels by their distance along each axis: a Gaussian of standard deviation 1.4.
const NEAR: [f32; SIDE] = [0.36, 0.775, 1.0, 0.775, 0.36];

/// Ridge regularisation of the slopes, as a fraction of the weights, so that a fit is well-defined where there is
/// only one surface.
const RIDGE: f32 = 2e-3;

/// A pixel's weight in a fit is the inverse of its variance, plus the variance of the pixel that the fit is for, plus this fraction of
/// its squared light: neighbours off the edge are smooth already, and those on it are as noisy as the pixel itself, but a fit
/// to the smooth ones alone would rely on light being linear.
const OF_LIGHT: f32 = 0.65;

/// Factor on the weight of the pixel itself: its own light is taken into account once more, when the fit is blended with it.
const OF_ITSELF: f32 = 0.4;

/// Weight of a pixel's distance in the image, relative to differences of features: light also has gradients that no feature shows.
const OF_POSITIONS: f32 = 0.3;

/// The planes of features: albedo, normal and inverse depth.
const FEATURES: [usize; 7] = [ALBEDO, ALBEDO + 1, ALBEDO + 2, NORMAL, NORMAL + 1, NORMAL + 2, INVERSE];
const DEPTH_COLUMN: usize = 6;
/// Columns of a fit: features, position in the picture, and 1.
const COLUMNS: usize = FEATURES.len() + 3;
/// The column of ones. Its coefficient is the light of the pixel in the middle, whose features are the origin.
const ONE: usize = COLUMNS - 1;

/// The normal equations of weighted fits around some pixels.
pub(super) struct Fits {
    /// The upper triangle: rows from their diagonal on.
    matrix: [[Lanes; COLUMNS]; COLUMNS],
    /// By column, for R, G and B.
    light: [[Lanes; 3]; COLUMNS],
    /// Sum of weight · light².
    squares: Lanes,
    /// The minimum and maximum of the fitted light.
    low: [Lanes; 3],
    high: [Lanes; 3],
}

impl Fits {
    /// Fits around pixels, given by where they are in the planes.
    #[inline(always)]
    pub(super) fn around(colours: &Planes, guides: &Guides, middles: [usize; LANES]) -> Fits {
        let planes = &guides.planes.planes;
        let mut fits = Fits {
            matrix: [[[0.0; LANES]; COLUMNS]; COLUMNS],
            light: [[[0.0; LANES]; 3]; COLUMNS],
            squares: [0.0; LANES],
            low: [[f32::INFINITY; LANES]; 3],
            high: [[0.0; LANES]; 3],
        };
        let firsts = middles.map(|middle| middle - RADIUS * colours.stride() - RADIUS);
        let by_depth = firsts.map(|first| {
            let rows = (0..SIDE).map(|row| first + row * colours.stride());
            let inverse = rows.flat_map(|row| planes[INVERSE][row..row + SIDE].iter());
            let farthest = inverse.fold(0.0, |a: f32, &z| a.max(z));
            if farthest > 0.0 { 1.0 / farthest } else { 0.0 }
        });
        let position = |i: usize| OF_POSITIONS * (i as f32 - RADIUS as f32);
        let variance = middles.map(|middle| colours.planes[3][middle]);
        let own = FEATURES.map(|plane| middles.map(|middle| planes[plane][middle]));
        for (j, down) in NEAR.into_iter().enumerate() {
            let starts = firsts.map(|first| first + j * colours.stride());
            let features = FEATURES.map(|plane| row(&planes[plane], starts));
            let within = row(&planes[WITHIN], starts);
            let [red, green, blue, variances] = [0, 1, 2, 3].map(|plane| row(&colours.planes[plane], starts));
            for (i, across) in NEAR.into_iter().enumerate() {
                let mut columns = [[1.0; LANES]; COLUMNS];
                for (k, column) in columns[..FEATURES.len()].iter_mut().enumerate() {
                    *column = std::array::from_fn(|lane| features[k][i][lane] - own[k][lane]);
                }
                (0..LANES).for_each(|lane| columns[DEPTH_COLUMN][lane] *= by_depth[lane]);
                columns[FEATURES.len()] = [position(i); LANES];
                columns[FEATURES.len() + 1] = [position(j); LANES];
                let itself = if (i, j) == (RADIUS, RADIUS) { OF_ITSELF } else { 1.0 };
                let share = down * across * itself;
                let mut light = [red[i], green[i], blue[i]];
                let weights = std::array::from_fn(|lane| {
                    let mean = (light[0][lane] + light[1][lane] + light[2][lane]) * (1.0 / 3.0);
                    let uncertain = variances[i][lane] + variance[lane] + OF_LIGHT * mean * mean;
                    share * within[i][lane] / (uncertain + 1e-12)
                });
                for lane in 0..LANES {
                    // Light without weight may be infinite.
                    light
                        .iter_mut()
                        .for_each(|light| light[lane] = if weights[lane] > 0.0 { light[lane] } else { 0.0 });
                }
                fits.add(&columns, &light, &weights);
            }
        }
        fits
    }

    #[inline(always)]
    fn add(&mut self, features: &[Lanes; COLUMNS], light: &[Lanes; 3], weights: &Lanes) {
        for (i, feature) in features.iter().enumerate() {
            let scaled: Lanes = std::array::from_fn(|lane| weights[lane] * feature[lane]);
            for (sum, other) in self.matrix[i][i..].iter_mut().zip(&features[i..]) {
                add_products(sum, &scaled, other);
            }
            for (sum, light) in self.light[i].iter_mut().zip(light) {
                add_products(sum, &scaled, light);
            }
        }
        for (c, light) in light.iter().enumerate() {
            for lane in 0..LANES {
                self.squares[lane] += weights[lane] * light[lane] * light[lane];
                let counts = weights[lane] > 0.0;
                let (low, high) = (&mut self.low[c][lane], &mut self.high[c][lane]);
                *low = if counts && light[lane] < *low { light[lane] } else { *low };
                *high = if counts && light[lane] > *high { light[lane] } else { *high };
            }
        }
    }

    /// The light of the pixels according to the fits, and their mean squared residuals, summed over all channels.
    #[inline(always)]
    fn solve(&mut self) -> ([Lanes; 3], Lanes) {
        let weights = self.matrix[ONE][ONE];
        let mut missed = self.squares;
        for i in 0..COLUMNS {
            let ridge = if i < ONE { RIDGE } else { 0.0 };
            let one_over: Lanes =
                std::array::from_fn(|lane| 1.0 / (self.matrix[i][i][lane] + ridge * weights[lane]));
            let light = self.light[i];
            for light in &light {
                (0..LANES).for_each(|lane| missed[lane] -= light[lane] * light[lane] * one_over[lane]);
            }
            let pivot = self.matrix[i];
            for j in i + 1..COLUMNS {
                let factor: Lanes = std::array::from_fn(|lane| -pivot[j][lane] * one_over[lane]);
                for (to, from) in self.matrix[j][j..].iter_mut().zip(&pivot[j..]) {
                    add_products(to, &factor, from);
                }
                for (to, from) in self.light[j].iter_mut().zip(&light) {
                    add_products(to, &factor, from);
                }
            }
        }
        let last = &self.matrix[ONE][ONE];
        let constant = self.light[ONE].map(|light| std::array::from_fn(|lane| light[lane] / last[lane]));
        (constant, std::array::from_fn(|lane| (missed[lane] / weights[lane]).max(0.0)))
    }

    /// Blends the light of the fits with the pixels' own, weighted by their expected errors: R, G, B and the variance that is left.
    #[inline(always)]
    pub(super) fn blended(mut self, colours: &Planes, middles: [usize; LANES]) -> [Lanes; 4] {
        let (light, missed) = self.solve();
        let mut all = [0, 1, 2, 3].map(|plane| middles.map(|middle| colours.planes[plane][middle]));
        for lane in 0..LANES {
            if light.iter().any(|light| !light[lane].is_finite()) {
                continue;
            }
            let variance = all[3][lane];
            let trust = variance / (variance + missed[lane] + f32::MIN_POSITIVE);
            for c in 0..3 {
                // The light of a mixture lies between the light of its parts.
                let light = light[c][lane].max(self.low[c][lane]).min(self.high[c][lane]);
                all[c][lane] += (light - all[c][lane]) * trust;
            }
            all[3][lane] = variance * (1.0 - trust);
        }
        all
    }
}

/// The samples of a plane in a row of each fit.
#[inline(always)]
fn row(plane: &[f32], starts: [usize; LANES]) -> [Lanes; SIDE] {
    let mut row = [[0.0; LANES]; SIDE];
    for (lane, start) in starts.into_iter().enumerate() {
        for (to, sample) in row.iter_mut().zip(&plane[start..start + SIDE]) {
            to[lane] = *sample;
        }
    }
    row
}
