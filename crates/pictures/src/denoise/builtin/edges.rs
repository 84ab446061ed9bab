//! Reconstructs pixels on edges of geometry and textures. No neighbour of such a pixel shows the same mixture of
//! surfaces, so averaging leaves it as noisy as before, and edges look jagged. But its albedo, normal and depth have
//! far less noise than its light, and light is nearly linear in these features within a few pixels. A first-order fit
//! to the denoised pixels around it predicts the light of the mixture. [Moon 2014; Bitterli 2016, eq. 4]

use super::guides::{ALBEDO, Guides, INVERSE, NORMAL, WITHIN};
use super::planes::{MARGIN, Planes};
use crate::PictureError;
use crate::limits::zeroed;
use bilux_math::Rgb;
use rayon::prelude::*;

/// Radius of a fit, in pixels.
pub(super) const RADIUS: usize = 2;
const SIDE: usize = 2 * RADIUS + 1;

/// Weights of pixels by their distance along each axis: a Gaussian of standard deviation 1.4.
const NEAR: [f32; SIDE] = [0.36, 0.775, 1.0, 0.775, 0.36];

/// Squared difference from which on neighbours show different surfaces.
const APART: f32 = 0.01;
/// Weight of squared differences of normals, and of inverse depths, relative to those of albedo.
const OF_NORMALS: f32 = 0.25;
const OF_DEPTHS: f32 = 9.0;

/// Ridge regularisation of the slopes, as a fraction of the weights, so that a fit is well-defined where there is
/// only one surface.
const RIDGE: f32 = 3e-3;

/// Fraction of a fit's squared residual that counts as error of the fit itself; the rest is noise of the light around
/// it.
const RESIDUAL_FRACTION: f32 = 0.4;

/// A pixel's weight in a fit is the inverse of its variance, plus the variance of the pixel that the fit is for, plus this fraction of
/// its squared light: neighbours off the edge are smooth already, and those on it are as noisy as the pixel itself, but a fit
/// to the smooth ones alone would rely on light being linear.
const OF_LIGHT: f32 = 0.5;

/// Factor on the weight of the pixel itself: its own light is taken into account once more, when the fit is blended with it.
const OF_ITSELF: f32 = 0.6;

/// Weight of a pixel's distance in the image, relative to differences of features: light also has gradients that no feature shows.
const OF_POSITIONS: f32 = 0.3;

/// Columns of a fit: albedo, normal, inverse depth, position, and 1.
const COLUMNS: usize = 10;

/// The picture with its edge pixels reconstructed. `colours` has three planes, and the variance of each pixel in a
/// fourth.
///
/// # Errors
/// Returns an error when the machine has no memory left.
pub(super) fn rebuilt(colours: &Planes, guides: &Guides) -> Result<Vec<Rgb>, PictureError> {
    let width = colours.width;
    let is_edge = edges(guides);
    let mut all = zeroed("denoising", width * colours.height)?;
    all.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        for (x, to) in row.iter_mut().enumerate() {
            let i = colours.index(x, y);
            let own = colours.rgb(y * width + x);
            *to = if is_edge[i] {
                Fit::around(colours, guides, i).blended(own, colours.planes[3][i])
            } else {
                own
            };
        }
    });
    Ok(all)
}

/// Marks the pixels that have a neighbour with another surface; the result includes the margin around the picture,
/// where no pixel is marked.
fn edges(guides: &Guides) -> Vec<bool> {
    let planes = &guides.planes;
    let (stride, width) = (planes.stride(), planes.width);
    let mut edges = vec![false; planes.planes[ALBEDO].len()];
    let (first, last) = (planes.index(0, 0) - MARGIN, planes.index(0, planes.height) - MARGIN);
    edges[first..last].par_chunks_mut(stride).enumerate().for_each(|(y, row)| {
        let p = planes.index(0, y);
        for offset in [1, stride - 1, stride, stride + 1] {
            for q in [p - offset, p + offset] {
                apart(guides, p, q, &mut row[MARGIN..MARGIN + width]);
            }
        }
    });
    edges
}

/// In a row of pixels that starts at `p`, marks those whose surface differs from that of the pixels starting at `q`.
fn apart(guides: &Guides, p: usize, q: usize, row: &mut [bool]) {
    let pair = |plane: usize| {
        let plane = &guides.planes.planes[plane];
        (&plane[p..p + row.len()], &plane[q..q + row.len()])
    };
    let [ar, ag, ab] = [0, 1, 2].map(|c| pair(ALBEDO + c));
    let [nx, ny, nz] = [0, 1, 2].map(|c| pair(NORMAL + c));
    let z = pair(INVERSE);
    for (x, is_edge) in row.iter_mut().enumerate() {
        let square = |(p, q): (&[f32], &[f32])| (p[x] - q[x]) * (p[x] - q[x]);
        let albedo = square(ar) + square(ag) + square(ab);
        let normal = square(nx) + square(ny) + square(nz);
        let greater = if z.0[x] > z.1[x] { z.0[x] } else { z.1[x] };
        // The relative difference of depth, without a division.
        let differs =
            albedo + OF_NORMALS * normal > APART || OF_DEPTHS * square(z) > APART * greater * greater;
        *is_edge |= differs;
    }
}

/// The normal equations of a weighted fit around one pixel. The pixel's own features are the origin, so the constant
/// term is its light.
struct Fit {
    matrix: [[f32; COLUMNS]; COLUMNS],
    /// By column, for R, G and B.
    light: [[f32; 4]; COLUMNS],
    /// Sum of weight · light².
    squares: f32,
    /// The minimum and maximum of the fitted light.
    bounds: [Rgb; 2],
}

impl Fit {
    fn around(colours: &Planes, guides: &Guides, middle: usize) -> Fit {
        let planes = &guides.planes.planes;
        let mut fit = Fit {
            matrix: [[0.0; COLUMNS]; COLUMNS],
            light: [[0.0; 4]; COLUMNS],
            squares: 0.0,
            bounds: [Rgb::grey(f32::INFINITY), Rgb::BLACK],
        };
        let variances = &colours.planes[3];
        let first = middle - RADIUS * colours.stride() - RADIUS;
        let rows = (0..SIDE).map(|row| first + row * colours.stride());
        let farthest = rows
            .clone()
            .flat_map(|row| planes[INVERSE][row..row + SIDE].iter())
            .fold(0.0, |a: f32, &z| a.max(z));
        let by_depth = if farthest > 0.0 { 1.0 / farthest } else { 0.0 };
        let position = |i: usize| OF_POSITIONS * (i as f32 - RADIUS as f32);
        for (j, (row, down)) in rows.zip(NEAR).enumerate() {
            for (column, across) in NEAR.into_iter().enumerate() {
                let q = row + column;
                let feature = |plane: usize| planes[plane][q] - planes[plane][middle];
                let [r, g, b] = [0, 1, 2].map(|c| feature(ALBEDO + c));
                let [x, y, z] = [0, 1, 2].map(|c| feature(NORMAL + c));
                let features =
                    [r, g, b, x, y, z, feature(INVERSE) * by_depth, position(column), position(j), 1.0];
                let light = [0, 1, 2].map(|c| colours.planes[c][q]);
                let mean = (light[0] + light[1] + light[2]) * (1.0 / 3.0);
                let uncertain = variances[q] + variances[middle] + OF_LIGHT * mean * mean + 1e-12;
                let itself = if q == middle { OF_ITSELF } else { 1.0 };
                fit.add(&features, light, down * across * itself * planes[WITHIN][q] / uncertain);
            }
        }
        fit
    }

    fn add(&mut self, features: &[f32; COLUMNS], [r, g, b]: [f32; 3], weight: f32) {
        if weight <= 0.0 {
            return;
        }
        for (i, &feature) in features.iter().enumerate() {
            let scaled = weight * feature;
            for (sum, other) in self.matrix[i].iter_mut().zip(features) {
                *sum += scaled * other;
            }
            for (sum, light) in self.light[i].iter_mut().zip([r, g, b, 0.0]) {
                *sum += scaled * light;
            }
        }
        self.squares += weight * (r * r + g * g + b * b);
        let light = Rgb::new(r, g, b);
        self.bounds = [each(self.bounds[0], light, f32::min), each(self.bounds[1], light, f32::max)];
    }

    /// The light of the pixel according to the fit, and the fit's mean squared residual, summed over all channels.
    fn solved(mut self) -> (Rgb, f32) {
        let weights = self.matrix[COLUMNS - 1][COLUMNS - 1];
        let mut missed = self.squares;
        for i in 0..COLUMNS {
            if i + 1 < COLUMNS {
                self.matrix[i][i] += RIDGE * weights;
            }
            let one_over = 1.0 / self.matrix[i][i];
            let light = self.light[i];
            missed -= (light[0] * light[0] + light[1] * light[1] + light[2] * light[2]) * one_over;
            if i + 1 == COLUMNS {
                let constant = Rgb::new(light[0], light[1], light[2]) * one_over;
                return (constant, (missed / weights).max(0.0));
            }
            for j in i + 1..COLUMNS {
                let factor = self.matrix[j][i] * one_over;
                for k in i + 1..COLUMNS {
                    self.matrix[j][k] -= factor * self.matrix[i][k];
                }
                for (to, from) in self.light[j].iter_mut().zip(light) {
                    *to -= factor * from;
                }
            }
        }
        (Rgb::BLACK, 0.0)
    }

    /// Blends the light of the fit with the pixel's own, weighted by their expected errors.
    fn blended(self, own: Rgb, variance: f32) -> Rgb {
        let [low, high] = self.bounds;
        let (light, missed) = self.solved();
        if !light.is_finite() {
            return own;
        }
        // The light of a mixture lies between the light of its parts.
        let light = each(each(light, low, f32::max), high, f32::min);
        let trust = variance / (variance + RESIDUAL_FRACTION * missed + f32::MIN_POSITIVE);
        own + (light - own) * trust
    }
}

fn each(a: Rgb, b: Rgb, of: fn(f32, f32) -> f32) -> Rgb {
    Rgb::new(of(a.r, b.r), of(a.g, b.g), of(a.b, b.b))
}
