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

    const SIZE: (usize, usize) = (45, 37);

    /// A picture of which everything differs from pixel to pixel: two layers, edges, fog, an outline.
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
            depth: Some((0..SIZE.0 * SIZE.1).map(|i| 3.0 + (i % SIZE.0) as f32 * 0.01).collect()),
            haze: Some(numbers(21, 0.5)),
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
