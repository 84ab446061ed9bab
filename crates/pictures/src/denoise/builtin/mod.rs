//! `builtin`: our own filter, for when no other denoiser is available. It divides light by albedo, so that textures
//! stay sharp, and averages the result over neighbours that show the same surface and, as far as the noise allows a
//! decision, the same light: it compares small patches, relative to the variance of both. The passes cover increasing
//! distances, with gaps (à-trous). [Dammertz 2010; Rousselle 2012; Schied 2017]
//!
//! In a cut-out it filters the light of what covers the pixels, and weights each by how much of it is covered.

mod edges;
mod fits;
mod guides;
mod linear;
mod outliers;
mod pass;
mod planes;

use super::noisy::{self, Noisy, Source};
use super::task::{Denoiser, DenoiserEntry};
use crate::PictureError;
use crate::limits::reserved;
use bilux_math::Rgb;
use bilux_math::parallel::{self, ThreadPool, for_each, install};
use bilux_math::registry::Entry;
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
    time: |task| Duration::from_nanos(task.pixels().saturating_mul(1600) / task.thread_count() as u64),
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
}

impl Builtin {
    pub(super) fn new(threads: usize) -> Result<Builtin, PictureError> {
        let pool = parallel::pool(threads, None)
            .map_err(|why| PictureError::NoDenoiser { what: format!("cannot start its threads: {why}") })?;
        Ok(Builtin { pool })
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
            let smooth = install(&self.pool, || smoothed(source.rows(around.clone())?))?;
            let kept = (rows.start - around.start) * width..(rows.end - around.start) * width;
            all.extend_from_slice(&smooth[kept]);
        }
        Ok(all)
    }
}

/// The sum of the denoised layers. What is not needed any more is freed as early as possible: this takes some hundred bytes per pixel.
fn smoothed(mut noisy: Noisy) -> Result<Vec<Rgb>, PictureError> {
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
        let mut light = smooth_light(light, &guides)?.planes;
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
        edges::rebuild(&mut colours, &guides)?;
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
fn smooth_light(mut light: Light, guides: &Guides) -> Result<Light, PictureError> {
    let mut smooth = Light { planes: Planes::new(light.planes.width, light.planes.height, 4)? };
    for step in STEPS {
        pass(&light, guides, step, &mut smooth);
        std::mem::swap(&mut light, &mut smooth);
    }
    Ok(light)
}
