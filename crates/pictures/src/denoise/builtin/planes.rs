//! Planes with a margin around them, so that neighbours beyond the edge need no special case.

use super::lanes::COLUMNS;
use super::outliers;
use crate::PictureError;
use crate::denoise::Layer;
use crate::limits::zeroed;
use bilux_math::Rgb;
use bilux_math::parallel::{for_each, map, table};

/// The maximum reach of a pass: two steps and half a patch.
pub(super) const MARGIN: usize = 2 * 8 + 1;

/// Numbers after the end of each plane, which a tile at the end of its last row may read.
const SLACK: usize = 2 * COLUMNS;

/// Planes of a picture, each with a margin that repeats its edge.
#[derive(Clone)]
pub(super) struct Planes {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) planes: Vec<Vec<f32>>,
}

impl Planes {
    /// Planes of zeros.
    pub(super) fn new(width: usize, height: usize, count: usize) -> Result<Planes, PictureError> {
        let size = (width + 2 * MARGIN).saturating_mul(height + 2 * MARGIN).saturating_add(SLACK);
        let planes = map(0..count, |_| zeroed("denoising", size)).into_iter().collect::<Result<_, _>>()?;
        Ok(Planes { width, height, planes })
    }

    /// Fills each plane with its samples, pixel by pixel.
    pub(super) fn filled<const N: usize>(
        (width, height): (usize, usize),
        at: impl Fn(usize) -> [f32; N] + Sync,
    ) -> Result<Planes, PictureError> {
        let mut all = Planes::new(width, height, N)?;
        for_each(all.rows_mut().iter_mut().enumerate(), |(y, row)| {
            for x in 0..width {
                row.iter_mut().zip(at(y * width + x)).for_each(|(plane, sample)| plane[x] = sample);
            }
        });
        all.pad();
        Ok(all)
    }

    /// The rows, each with its samples in every plane, without the margins.
    pub(super) fn rows_mut(&mut self) -> Vec<Vec<&mut [f32]>> {
        let (stride, width) = (self.stride(), self.width);
        let mut rows: Vec<_> = (0..self.height).map(|_| Vec::with_capacity(self.planes.len())).collect();
        for plane in &mut self.planes {
            let samples = plane.chunks_exact_mut(stride).skip(MARGIN);
            rows.iter_mut().zip(samples).for_each(|(row, all)| row.push(&mut all[MARGIN..MARGIN + width]));
        }
        rows
    }

    /// The distance from one row to the next.
    pub(super) fn stride(&self) -> usize {
        self.width + 2 * MARGIN
    }

    /// The index of a pixel's sample.
    pub(super) fn index(&self, x: usize, y: usize) -> usize {
        (y + MARGIN) * self.stride() + x + MARGIN
    }

    /// The first three planes at a pixel.
    pub(super) fn rgb(&self, pixel: usize) -> Rgb {
        let i = self.index(pixel % self.width, pixel / self.width);
        Rgb::new(self.planes[0][i], self.planes[1][i], self.planes[2][i])
    }

    /// Adds planes of the same size.
    pub(super) fn add(&mut self, more: &Planes) {
        for_each(self.planes.iter_mut().zip(&more.planes), |(plane, more)| {
            plane.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        });
    }

    /// Repeats the edges in the margins.
    pub(super) fn pad(&mut self) {
        let (stride, width, height) = (self.stride(), self.width, self.height);
        for_each(&mut self.planes, |plane| {
            for row in plane.chunks_exact_mut(stride).skip(MARGIN).take(height) {
                let (first, last) = (row[MARGIN], row[MARGIN + width - 1]);
                row[..MARGIN].fill(first);
                row[MARGIN + width..].fill(last);
            }
            let (top, bottom) = (MARGIN * stride, (MARGIN + height - 1) * stride);
            for y in 0..MARGIN {
                plane.copy_within(top..top + stride, y * stride);
                plane.copy_within(bottom..bottom + stride, (MARGIN + height + y) * stride);
            }
        });
    }
}

/// Light with the albedo divided out, and its variance: planes R, G, B and V, the mean over the channels.
pub(super) struct Light {
    pub(super) planes: Planes,
}

/// Minimum albedo that is divided out: on darker surfaces noise is not visible.
const MIN_ALBEDO: f32 = 0.02;

/// The divisor of the light.
pub(super) fn divisor(albedo: Rgb) -> Rgb {
    // A surface that reflects almost nothing of one colour may still show a reflection of that colour.
    let least = MIN_ALBEDO.max(0.1 * albedo.max_channel());
    albedo.map(|c| c.max(least))
}

impl Light {
    /// The light of a layer, divided by the albedo: `by`. Where `coverage` is 0 there is only background, and where `haze` is 1 only a medium.
    pub(super) fn of(
        size: (usize, usize),
        layer: Layer,
        by: &(impl Fn(usize) -> Rgb + Sync),
        coverage: Option<&[f32]>,
        haze: Option<&[f32]>,
    ) -> Result<Light, PictureError> {
        let colour = |i: usize| layer.colour[i] / by(i);
        let guessed = if layer.variance.is_none() { guess(size, &colour) } else { Vec::new() };
        let variance = |i: usize| match &layer.variance {
            Some(variance) => {
                let (variance, by) = (variance[i], by(i));
                mean(variance / (by * by))
            }
            None => guessed[i],
        };
        let pixels: Vec<(Rgb, f32)> = table(size.0 * size.1, 1 << 12, |i| (colour(i), variance(i)));
        drop((layer, guessed));
        let pixels = outliers::without(size, pixels, haze);
        // A single estimate of a pixel's variance is uncertain, so its neighbours' estimates are included.
        let blurred = blur(&pixels, size.0, coverage);
        let planes = Planes::filled(size, |i| {
            let Rgb { r, g, b } = pixels[i].0;
            [r, g, b, blurred[i]]
        })?;
        Ok(Light { planes })
    }
}

pub(super) fn mean(c: Rgb) -> f32 {
    (c.r + c.g + c.b) / 3.0
}

/// Factor on a guessed variance: strongly non-uniform noise looks weaker than it is wherever no rare sample fell.
const GUESS_FACTOR: f32 = 3.0;

/// Guesses a missing variance: from how much pixels differ from the mean of their neighbours, which counts edges as
/// noise.
fn guess((width, height): (usize, usize), colour: &impl Fn(usize) -> Rgb) -> Vec<f32> {
    let at = |x: usize, y: usize| colour(y.min(height - 1) * width + x.min(width - 1));
    let one = |i: usize| {
        let (x, y) = (i % width, i / width);
        let around = at(x.saturating_sub(1), y) + at(x + 1, y) + at(x, y.saturating_sub(1)) + at(x, y + 1);
        let apart = colour(i) - around * 0.25;
        // A fifth of the squared difference is the noise of the neighbours.
        mean(apart * apart) * (0.8 * GUESS_FACTOR)
    };
    (0..width * height).map(one).collect()
}

/// Means of the variances of 3 × 3 pixels, of those that are not background.
fn blur(pixels: &[(Rgb, f32)], width: usize, coverage: Option<&[f32]>) -> Vec<f32> {
    let height = pixels.len() / width;
    let mut all = vec![0.0; pixels.len()];
    for_each(all.chunks_mut(width).enumerate(), |(y, row)| {
        let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| y * width);
        let weight = |i: usize| coverage.map_or(1.0, |coverage| if coverage[i] > 0.0 { 1.0 } else { 0.0 });
        for (x, mean) in row.iter_mut().enumerate() {
            let columns = [x.saturating_sub(1), x, (x + 1).min(width - 1)];
            let (mut sum, mut weights) = (0.0, 0.0);
            for row in rows {
                let [a, b, c] = columns.map(|x| row + x);
                sum += pixels[a].1 * weight(a) + pixels[b].1 * weight(b) + pixels[c].1 * weight(c);
                weights += weight(a) + weight(b) + weight(c);
            }
            *mean = if weights > 0.0 { sum / weights } else { 0.0 };
        }
    });
    all
}
