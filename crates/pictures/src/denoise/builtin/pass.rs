//! One à-trous pass over all pixels: each becomes a weighted mean of 5 × 5 pixels that are `step` pixels apart.

use super::guides::{ALBEDO, DEPTH, Guides, NORMAL, SLOPE, TIGHTNESS, WITHIN};
use super::linear::Moments;
use super::planes::{Light, MARGIN, Planes};
use bilux_math::parallel::for_each;

/// Rows that one thread processes at a time.
const BAND: usize = 16;

/// Weights of neighbours by their distance in steps, along each axis.
const NEAR: [f32; 5] = [0.7, 0.9, 1.0, 0.9, 0.7];
/// Tolerance for differences in light, in standard deviations of the noise, and the factor by which it grows from one pass to the
/// next: later passes see errors that their neighbours share, and so underestimate them.
const LIGHT: f32 = 1.4;
const LIGHT_GROWTH: f32 = 1.1;
/// Tolerances for differences in albedo and in normals.
const ALBEDO_APART: f32 = 0.05;
const NORMAL_APART: f32 = 0.2;
/// Relative increase of the tolerance for squared differences in fog and all else that is hazy. Its light has no edges, but few
/// samples find it, so that most pixels are too dark and do not know it.
const HAZY: f32 = 7.0;
/// Squared relative difference below which light counts as the same where there is no noise at all.
const SAME: f32 = 1e-5;

/// A neighbour that differs by more than this many of the pixel's own variances does not belong to the patch around it. This
/// keeps bright light out of sharp shadows, whose pixels have little noise, and does not keep a firefly from being smoothed.
const BEYOND: f32 = 2.0;

/// Up to this step, passes fit a slope to the light too. Neighbours farther away differ by more than the noise where there is a slope.
const LAST_LINEAR: usize = 4;

/// Applies one pass to the light, and stores the result in `smooth`, which has the same size.
pub(super) fn pass(light: &Light, guides: &Guides, step: usize, smooth: &mut Light) {
    let width = light.planes.width;
    for_each(smooth.planes.rows_mut().chunks_mut(BAND).enumerate(), |(i, rows)| {
        let mut band = Band::new(light, guides, step, i * BAND..i * BAND + rows.len());
        band.take_all();
        for (plane, samples) in band.finish().iter().enumerate() {
            rows.iter_mut()
                .zip(samples.chunks_exact(width))
                .for_each(|(to, row)| to[plane].copy_from_slice(row));
        }
    });
    smooth.planes.pad();
}

/// Some rows while neighbours are being added.
struct Band<'a> {
    light: &'a Planes,
    guides: &'a Planes,
    haze: Option<&'a [f32]>,
    step: usize,
    rows: std::ops::Range<usize>,
    /// Sums of weight · light, for R, G and B, of weight² · variance, and of weights.
    sums: [Vec<f32>; 5],
    moments: Option<Moments>,
    /// Differences between pixels in their light, with one more row and column on each side.
    apart: Vec<f32>,
    weights: Vec<f32>,
}

impl<'a> Band<'a> {
    fn new(light: &'a Light, guides: &'a Guides, step: usize, rows: std::ops::Range<usize>) -> Band<'a> {
        let (width, count) = (light.planes.width, rows.len());
        Band {
            light: &light.planes,
            guides: &guides.planes,
            haze: guides.haze.as_ref().map(|haze| &*haze.planes[0]),
            step,
            sums: std::array::from_fn(|_| vec![0.0; width * count]),
            moments: (step <= LAST_LINEAR).then(|| Moments::new(width * count)),
            apart: vec![0.0; (width + 2) * (count + 2)],
            weights: vec![0.0; width],
            rows,
        }
    }

    fn take_all(&mut self) {
        for (j, down) in NEAR.iter().enumerate() {
            for (i, across) in NEAR.iter().enumerate() {
                let [dx, dy] = [i, j].map(|k| (k as isize - 2) * self.step as isize);
                if (dx, dy) == (0, 0) {
                    self.take_itself();
                } else {
                    self.compare(dx, dy);
                    self.take(dx, dy, down * across);
                }
            }
        }
    }

    /// Adds the pixels themselves, with the fraction that is not background as their weight; one that is nothing else keeps its
    /// light.
    fn take_itself(&mut self) {
        let width = self.light.width;
        for (row, y) in self.rows.clone().enumerate() {
            let (to, from) = (row * width..(row + 1) * width, self.light.index(0, y));
            let within = &self.guides.planes[WITHIN][from..from + width];
            let weights = &mut self.weights[..width];
            weights.iter_mut().zip(within).for_each(|(to, &own)| *to = if own > 0.0 { own } else { 1.0 });
            for k in 0..4 {
                let own = self.light.planes[k][from..from + width].iter().zip(weights.iter());
                let sums = self.sums[k][to.clone()].iter_mut().zip(own);
                sums.for_each(|(sum, (own, w))| *sum += own * if k == 3 { w * w } else { *w });
            }
            self.sums[4][to].iter_mut().zip(weights.iter()).for_each(|(sum, weight)| *sum += weight);
        }
    }

    /// Measures how much pixels differ from those at an offset, minus the difference expected from noise alone, in
    /// units of the tolerance. [Rousselle 2012, eq. 3]
    fn compare(&mut self, dx: isize, dy: isize) {
        let (width, stride) = (self.light.width + 2, self.light.stride());
        let offset = dy * stride as isize + dx;
        let growth = (0..self.step.trailing_zeros()).fold(LIGHT, |growth, _| growth * LIGHT_GROWTH);
        let tolerance = 3.0 * growth * growth;
        for row in 0..self.rows.len() + 2 {
            let p = (self.rows.start + row + MARGIN - 1) * stride + MARGIN - 1;
            let q = (p as isize + offset) as usize;
            let [r, g, b, v] = [0, 1, 2, 3].map(|k| {
                let plane = &self.light.planes[k];
                (&plane[p..p + width], &plane[q..q + width])
            });
            let to = &mut self.apart[row * width..(row + 1) * width];
            for (x, to) in to.iter_mut().enumerate() {
                let (dr, dg, db) = (r.0[x] - r.1[x], g.0[x] - g.1[x], b.0[x] - b.1[x]);
                let (vp, vq) = (v.0[x], v.1[x]);
                let squared = dr * dr + dg * dg + db * db;
                let sum = (r.0[x] + g.0[x] + b.0[x]) * (r.1[x] + g.1[x] + b.1[x]);
                let noise = 3.0 * (vp + if vp < vq { vp } else { vq });
                *to = (squared - noise) / (tolerance * (vp + vq) + SAME * sum.abs() + 1e-12);
            }
            if let Some(haze) = self.haze {
                for (to, (p, q)) in to.iter_mut().zip(haze[p..p + width].iter().zip(&haze[q..q + width])) {
                    *to /= 1.0 + HAZY * if p < q { *p } else { *q };
                }
            }
        }
    }

    /// Adds the pixels at an offset.
    fn take(&mut self, dx: isize, dy: isize, share: f32) {
        let (width, stride) = (self.light.width, self.light.stride());
        let offset = dy * stride as isize + dx;
        let [by_albedo, by_normal] = [ALBEDO_APART, NORMAL_APART].map(|apart| 1.0 / (apart * apart));
        let by_depth = 1.0 / (self.step * self.step) as f32;
        for row in 0..self.rows.len() {
            let p = self.light.index(0, self.rows.start + row);
            let q = (p as isize + offset) as usize;
            let pair = |plane: usize| {
                let plane = &self.guides.planes[plane];
                (&plane[p..p + width], &plane[q..q + width])
            };
            let patch = [0, 1, 2].map(|r| &self.apart[(row + r) * (width + 2)..(row + r + 1) * (width + 2)]);
            let [ar, ag, ab] = [0, 1, 2].map(|c| pair(ALBEDO + c));
            let [nx, ny, nz] = [0, 1, 2].map(|c| pair(NORMAL + c));
            let (z, tight, within) = (pair(DEPTH), pair(TIGHTNESS).0, pair(WITHIN).1);
            let slope = [pair(SLOPE).0, pair(SLOPE + 1).0];
            let (fx, fy) = (dx as f32, dy as f32);
            let v = &self.light.planes[3];
            let v = (&v[p..p + width], &v[q..q + width]);
            let weights = &mut self.weights[..width];
            for x in 0..width {
                let mut light = 0.0;
                for patch in patch {
                    light += patch[x] + patch[x + 1] + patch[x + 2];
                }
                let square = |(p, q): (&[f32], &[f32])| (p[x] - q[x]) * (p[x] - q[x]);
                let albedo = square(ar) + square(ag) + square(ab);
                let normal = square(nx) + square(ny) + square(nz);
                let beside = (z.1[x] - z.0[x] - slope[0][x] * fx - slope[1][x] * fy) * tight[x];
                let own = 0.5 * patch[1][x + 1] * (v.0[x] + v.1[x]) / (v.0[x] + 1e-12) - BEYOND;
                let apart = (if light > 0.0 { light } else { 0.0 }) * (1.0 / 9.0)
                    + (if own > 0.0 { own } else { 0.0 }) * 0.5
                    + albedo * by_albedo
                    + normal * by_normal
                    + beside * beside * by_depth;
                // Approximates e to the minus `apart`, and is zero from 4 on.
                let near = 1.0 - 0.25 * apart;
                let near = if near > 0.0 { near } else { 0.0 };
                weights[x] = share * within[x] * (near * near) * (near * near);
            }
            let to = row * width..(row + 1) * width;
            for k in 0..4 {
                let plane = &self.light.planes[k][q..q + width];
                let sums = &mut self.sums[k][to.clone()];
                for x in 0..width {
                    let weight = if k == 3 { weights[x] * weights[x] } else { weights[x] };
                    sums[x] += weight * plane[x];
                }
            }
            self.sums[4][to.clone()].iter_mut().zip(weights.iter()).for_each(|(sum, weight)| *sum += weight);
            if let Some(moments) = &mut self.moments {
                let light = [0, 1, 2].map(|c| &self.light.planes[c][q..q + width]);
                let steps = [dx, dy].map(|d| (d / self.step as isize) as f32);
                moments.add(to.start, steps, weights, light);
            }
        }
    }

    fn finish(self) -> [Vec<f32>; 4] {
        let [mut r, mut g, mut b, mut v, weights] = self.sums;
        for (i, weight) in weights.into_iter().enumerate() {
            let one_over = 1.0 / weight;
            r[i] *= one_over;
            g[i] *= one_over;
            b[i] *= one_over;
            v[i] *= one_over * one_over;
            if let Some(moments) = &self.moments {
                let (fits, variance) = moments.fit(i, [r[i], g[i], b[i]], one_over);
                [r[i], g[i], b[i]] = fits;
                v[i] *= variance;
            }
        }
        [r, g, b, v]
    }
}
