//! `builtin`: our own filter, for when no other denoiser is available. It divides light by albedo, so that textures
//! stay sharp, and averages the result over neighbours that show the same surface and, as far as the noise allows a
//! decision, the same light: it compares small patches, relative to the variance of both. The passes cover increasing
//! distances, with gaps (à-trous). [Dammertz 2010; Rousselle 2012; Schied 2017]
//!
//! In a cut-out it filters the light of what covers the pixels, and weights each by how much of it is covered.

mod edges;
mod fits;
mod guides;
mod lanes;
mod linear;
mod outliers;
mod pass;
mod planes;

use super::noisy::{self, Noisy, Source};
use super::task::{Denoiser, DenoiserEntry};
use crate::PictureError;
use crate::limits::reserved;
use bilux_math::parallel::{self, ThreadPool, for_each, install};
use bilux_math::registry::Entry;
use bilux_math::{CpuLevel, Rgb};
use guides::Guides;
use pass::pass;
use planes::{Light, Planes};
use std::time::Duration;

pub(super) const ENTRY: DenoiserEntry = DenoiserEntry {
    entry: Entry {
        name: "builtin",
        summary: "cross-bilateral filter guided by albedo, normal, depth and variance, with first-order regression at edges",
        source: "Dammertz 2010",
        parameters: &[],
    },
    time: |task| {
        let nanoseconds = if CpuLevel::detect() >= CpuLevel::Avx2 { 1000 } else { 1600 };
        Duration::from_nanos(task.pixels().saturating_mul(nanoseconds) / task.thread_count() as u64)
    },
    is_library: false,
    find: |task| match Builtin::new(task.threads) {
        Ok(builtin) => Ok(Box::new(builtin)),
        Err(why) => Err(why.to_string()),
    },
};

/// Distance between neighbours in pixels, pass by pass.
const STEPS: [usize; 4] = [1, 2, 4, 8];

/// Rows that are filtered at a time: a picture of any height takes no more memory than this many rows.
const MAX_ROWS: usize = 288;

/// The distance over which one row can affect another: the reach of all passes, of the means of variances, outliers
/// and guesses before them, and of the edges after them.
const REACH: usize = 34 + 1 + 2 + 1 + edges::REACH;

pub(super) struct Builtin {
    pool: ThreadPool,
    /// The instructions that it uses; the pictures are the same.
    level: CpuLevel,
}

impl Builtin {
    pub(super) fn new(threads: usize) -> Result<Builtin, PictureError> {
        let pool = parallel::pool(threads, None)
            .map_err(|why| PictureError::NoDenoiser { what: format!("cannot start its threads: {why}") })?;
        Ok(Builtin { pool, level: CpuLevel::detect() })
    }
}

impl Denoiser for Builtin {
    fn describe(&self) -> String {
        "the built-in filter".to_owned()
    }

    fn denoise(&self, source: &dyn Source) -> Result<Vec<Rgb>, PictureError> {
        let (width, height) = source.size();
        let mut all = reserved("denoising", width * height)?;
        let strips = height.div_ceil(MAX_ROWS).max(1);
        for strip in 0..strips {
            let rows = height * strip / strips..height * (strip + 1) / strips;
            let around = rows.start.saturating_sub(REACH)..(rows.end + REACH).min(height);
            let smooth = install(&self.pool, || smoothed(source.rows(around.clone())?, self.level))?;
            let kept = (rows.start - around.start) * width..(rows.end - around.start) * width;
            all.extend_from_slice(&smooth[kept]);
        }
        Ok(all)
    }
}

/// The sum of the denoised layers. What is not needed any more is freed as early as possible: this takes some hundred bytes per pixel.
fn smoothed(mut noisy: Noisy, level: CpuLevel) -> Result<Vec<Rgb>, PictureError> {
    let coverage = noisy.take_coverage();
    let (size, layers) = ((noisy.width, noisy.height), std::mem::take(&mut noisy.layers));
    let albedo = noisy.albedo.as_deref();
    let by = |i: usize| albedo.map_or(Rgb::WHITE, |a| planes::divisor(a[i]));
    let haze = noisy.haze.as_deref();
    let divided = |layer| Light::of(size, layer, &by, coverage.as_deref(), haze);
    let lights = layers.into_iter().map(divided).collect::<Result<Vec<_>, _>>()?;
    let guides = Guides::of(&noisy, coverage.as_deref())?;
    let has_albedo = albedo.is_some();
    drop(noisy);
    let mut sum: Option<Planes> = None;
    for light in lights {
        let mut light = smooth_light(light, &guides, level)?.planes;
        if has_albedo {
            multiply(&mut light, &guides);
        }
        match &mut sum {
            Some(sum) => sum.add(&light),
            None => sum = Some(light),
        }
    }
    let Some(mut colours) = sum else { return Ok(Vec::new()) };
    if has_albedo {
        edges::rebuild(&mut colours, &guides, level)?;
    }
    let mut smooth: Vec<Rgb> = (0..size.0 * size.1).map(|i| colours.rgb(i)).collect();
    noisy::multiply(&mut smooth, coverage.as_deref());
    Ok(smooth)
}

/// Multiplies light by the albedo that it was divided by.
fn multiply(light: &mut Planes, guides: &Guides) {
    let first = |y: usize| guides.planes.index(0, y);
    for_each(light.rows_mut().iter_mut().enumerate(), |(y, row)| {
        let [r, g, b, variance] = &mut row[..] else { return };
        for x in 0..r.len() {
            let back = planes::divisor(guides.albedo(first(y) + x));
            Rgb { r: r[x], g: g[x], b: b[x] } = Rgb::new(r[x], g[x], b[x]) * back;
            variance[x] *= planes::mean(back * back);
        }
    });
}

/// The denoised light of a layer.
fn smooth_light(mut light: Light, guides: &Guides, level: CpuLevel) -> Result<Light, PictureError> {
    let mut smooth = Light { planes: Planes::new(light.planes.width, light.planes.height, 4)? };
    for step in STEPS {
        pass(&light, guides, step, level, &mut smooth);
        std::mem::swap(&mut light, &mut smooth);
    }
    Ok(light)
}

#[cfg(test)]
mod tests {
    use super::super::Layer;
    use super::*;
    use bilux_math::hash::{hash_words, unit_f32};

    const SIZE: (usize, usize) = (75, 21);

    /// A picture of more than one tile either way, of which everything differs from pixel to pixel: two layers, edges, fog, an outline.
    fn noisy() -> Noisy {
        let number = |i: usize, k: u64| unit_f32(hash_words([i as u64, k]) as u32);
        let plane = |of: &dyn Fn(usize) -> Rgb| (0..SIZE.0 * SIZE.1).map(of).collect::<Vec<Rgb>>();
        let colour =
            |k: u64| plane(&move |i| Rgb::new(number(i, k), 2.0 * number(i, k + 1), number(i, k + 2)));
        let layer = |k: u64| Layer { colour: colour(k), variance: Some(colour(k + 3)) };
        let numbers = |k: u64, scale: f32| (0..SIZE.0 * SIZE.1).map(move |i| scale * number(i, k)).collect();
        let block = |i: usize| (i % SIZE.0) / 5 + i / SIZE.0 / 7;
        Noisy {
            width: SIZE.0,
            height: SIZE.1,
            layers: vec![layer(0), layer(10)],
            coverage: Some(numbers(20, 1.0)),
            albedo: Some(plane(&|i| Rgb::new(0.8, 0.5, 0.2) * ((block(i) % 3) as f32 * 0.4 + 0.1))),
            normal: Some((0..SIZE.0 * SIZE.1).map(|i| [0.0, (block(i) % 2) as f32, 0.6]).collect()),
            depth: Some((0..SIZE.0 * SIZE.1).map(depth).collect()),
            haze: Some(numbers(21, 0.5)),
        }
    }

    fn square(x: f64) -> f64 {
        x * x
    }

    /// A curved surface, which lies aside of the plane that touches it.
    fn depth(i: usize) -> f32 {
        let (x, y) = ((i % SIZE.0) as f32, (i / SIZE.0) as f32);
        3.0 + 0.01 * x + 0.001 * x * x - 0.02 * y
    }

    /// A number of a plane, whose edge goes on beyond it.
    fn at(planes: &Planes, plane: usize, [x, y]: [isize; 2]) -> f64 {
        let inside = |x: isize, size: usize| x.clamp(0, size as isize - 1) as usize;
        f64::from(planes.planes[plane][planes.index(inside(x, SIZE.0), inside(y, SIZE.1))])
    }

    /// Difference of two pixels in their light beyond that of their noise, in units of the tolerance of a step.
    fn apart(light: &Light, guides: &Guides, p: [isize; 2], q: [isize; 2], step: usize) -> f64 {
        let of = |k: usize| [at(&light.planes, k, p), at(&light.planes, k, q)];
        let squared: f64 = (0..3).map(|c| square(of(c)[0] - of(c)[1])).sum();
        let [mine, other] = of(3);
        let product: f64 = (0..2).map(|side| (0..3).map(|c| of(c)[side]).sum::<f64>()).product();
        // It grows by a tenth from one pass to the next.
        let growth = [1.4, 1.54, 1.694, 1.8634][step.ilog2() as usize];
        let tolerance = 3.0 * square(growth) * (mine + other);
        let haze = guides.haze.as_ref().map_or(0.0, |haze| at(haze, 0, p).min(at(haze, 0, q)));
        let noise = 3.0 * (mine + mine.min(other));
        (squared - noise) / (tolerance + 1e-5 * product.abs() + 1e-12) / (1.0 + 7.0 * haze)
    }

    /// Weight of a neighbour.
    fn weight(light: &Light, guides: &Guides, p: [isize; 2], d: [isize; 2], step: usize) -> f64 {
        let all = &guides.planes;
        let beside = d.map(|d| d * step as isize);
        let [x, y] = [p[0] + beside[0], p[1] + beside[1]];
        if x < 0 || y < 0 || x >= SIZE.0 as isize || y >= SIZE.1 as isize {
            return 0.0;
        }
        let q = [x, y];
        let mut patch = 0.0;
        for [i, j] in (0..9).map(|i| [i % 3 - 1, i / 3 - 1]) {
            patch += apart(light, guides, [p[0] + i, p[1] + j], [q[0] + i, q[1] + j], step);
        }
        let differences = |planes: [usize; 3]| -> f64 {
            planes.iter().map(|&plane| square(at(all, plane, p) - at(all, plane, q))).sum()
        };
        let plane =
            at(all, guides::SLOPE, p) * beside[0] as f64 + at(all, guides::SLOPE + 1, p) * beside[1] as f64;
        let aside =
            (at(all, guides::DEPTH, q) - at(all, guides::DEPTH, p) - plane) * at(all, guides::TIGHTNESS, p);
        let [mine, other] = [p, q].map(|at_| at(&light.planes, 3, at_));
        let own = 0.5 * apart(light, guides, p, q, step) * (mine + other) / (mine + 1e-12) - 2.0;
        let apart = patch.max(0.0) / 9.0
            + own.max(0.0) * 0.5
            + differences([1, 2, 3]) / square(0.05)
            + differences([4, 5, 6]) / square(0.2)
            + square(aside / step as f64);
        let near = |d: isize| [1.0, 0.9, 0.7][d.unsigned_abs()];
        near(d[0]) * near(d[1]) * at(all, guides::WITHIN, q) * square(square((1.0 - 0.25 * apart).max(0.0)))
    }

    /// One pixel of a pass, one neighbour after the other, as the paper and the record of denoising describe it.
    fn smoothed_alone(light: &Light, guides: &Guides, p: [isize; 2], step: usize) -> [f64; 4] {
        let (mut sum, mut sums, mut slopes) = (0.0, [0.0; 4], [[0.0; 2]; 3]);
        let (mut places, mut squares) = ([0.0; 2], [0.0; 3]);
        for d in (0..25).map(|i| [i % 5 - 2, i / 5 - 2]) {
            let w = if d == [0, 0] {
                at(&guides.planes, guides::WITHIN, p)
            } else {
                weight(light, guides, p, d, step)
            };
            let [x, y] = d.map(|d| d as f64);
            sum += w;
            let q = d.map(|d| d * step as isize);
            let own = |k: usize| at(&light.planes, k, [p[0] + q[0], p[1] + q[1]]);
            (0..3).for_each(|c| sums[c] += w * own(c));
            sums[3] += w * w * own(3);
            for (c, [along_x, along_y]) in slopes.iter_mut().enumerate() {
                (*along_x, *along_y) = (*along_x + w * x * own(c), *along_y + w * y * own(c));
            }
            places = [places[0] + w * x, places[1] + w * y];
            squares = [squares[0] + w * x * x, squares[1] + w * x * y, squares[2] + w * y * y];
        }
        let means = [0, 1, 2].map(|c| sums[c] / sum);
        let variance = sums[3] / (sum * sum);
        if step > 4 {
            return [means[0], means[1], means[2], variance];
        }
        let [x, y] = places.map(|place| place / sum);
        let [xx, xy, yy] =
            [squares[0] / sum - x * x + 0.1, squares[1] / sum - x * y, squares[2] / sum - y * y + 0.1];
        let determinant = xx * yy - xy * xy;
        let along = [(yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant];
        let fit = |c: usize| {
            let slopes = [slopes[c][0] / sum - x * means[c], slopes[c][1] / sum - y * means[c]];
            (means[c] - along[0] * slopes[0] - along[1] * slopes[1]).max(0.0)
        };
        [fit(0), fit(1), fit(2), variance * (1.0 + along[0] * x + along[1] * y)]
    }

    #[test]
    fn tiles_and_lanes_give_what_one_pixel_after_the_other_does() {
        let mut noisy = noisy();
        let coverage = noisy.take_coverage();
        let layer = noisy.layers.remove(0);
        let light =
            Light::of(SIZE, layer, &|_| Rgb::WHITE, coverage.as_deref(), noisy.haze.as_deref()).unwrap();
        let guides = Guides::of(&noisy, coverage.as_deref()).unwrap();
        for step in STEPS {
            let mut smooth = Light { planes: Planes::new(SIZE.0, SIZE.1, 4).unwrap() };
            pass(&light, &guides, step, CpuLevel::detect(), &mut smooth);
            for i in 0..SIZE.0 * SIZE.1 {
                let p = [i % SIZE.0, i / SIZE.0].map(|x| x as isize);
                let alone = smoothed_alone(&light, &guides, p, step);
                for (k, alone) in alone.into_iter().enumerate() {
                    let found = at(&smooth.planes, k, p);
                    let is_near = (found - alone).abs() <= 1e-3 * alone.abs() + 1e-5;
                    assert!(is_near, "step {step}, pixel {p:?}, plane {k}: {found} for {alone}");
                }
            }
        }
    }

    #[test]
    fn all_levels_of_instructions_give_the_same_bits() {
        let baseline = smoothed(noisy(), CpuLevel::Baseline).unwrap();
        assert!(baseline.iter().any(|c| c.r > 0.0) && baseline.iter().all(|c| c.is_finite()));
        for level in CpuLevel::ALL.into_iter().filter(|&level| level <= CpuLevel::detect()) {
            let smooth = smoothed(noisy(), level).unwrap();
            let bits = |c: &Rgb| [c.r.to_bits(), c.g.to_bits(), c.b.to_bits()];
            assert!(smooth.iter().map(bits).eq(baseline.iter().map(bits)), "{}", level.name());
        }
    }
}
