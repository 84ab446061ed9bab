//! `builtin`: our own filter, for when no other denoiser is available. It divides light by albedo, so that textures
//! stay sharp, and averages the result over neighbours that show the same surface and, as far as the noise allows a
//! decision, the same light: it compares small patches, relative to the variance of both. The passes cover increasing
//! distances, with gaps (à-trous). [Dammertz 2010; Rousselle 2012; Schied 2017]

mod edges;
mod guides;
mod linear;
mod outliers;
mod pass;
mod planes;

use super::{Denoiser, DenoiserEntry, Layer, Noisy, Source};
use crate::PictureError;
use crate::limits::reserved;
use bilux_math::Rgb;
use bilux_math::registry::Entry;
use guides::Guides;
use pass::pass;
use planes::{Light, Planes};
use rayon::{ThreadPool, ThreadPoolBuilder};
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

/// The maximum reach of a pass: two steps and half a patch.
const MARGIN: usize = 2 * 8 + 1;

/// Rows that are filtered at a time: a picture of any height takes no more memory than this many rows.
const MAX_ROWS: usize = 512;

/// The distance over which one row can affect another: the reach of all passes, of the means of variances, outliers
/// and guesses before them, and of the edges after them.
const REACH: usize = 34 + 1 + 2 + 1 + edges::RADIUS;

pub(super) struct Builtin {
    pool: ThreadPool,
}

impl Builtin {
    pub(super) fn new(threads: usize) -> Result<Builtin, PictureError> {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool
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
            let smooth = self.pool.install(|| smoothed(source.rows(around.clone())?))?;
            let kept = (rows.start - around.start) * width..(rows.end - around.start) * width;
            all.extend_from_slice(&smooth[kept]);
        }
        Ok(all)
    }
}

/// The sum of the denoised layers.
fn smoothed(noisy: Noisy) -> Result<Vec<Rgb>, PictureError> {
    let guides = Guides::of(&noisy)?;
    let Noisy { width, height, layers, albedo, .. } = noisy;
    let mut sum = vec![[0.0; 4]; width * height];
    for layer in layers {
        let light = smooth_light((width, height), layer, albedo.as_deref(), &guides)?;
        let back = |i: usize| albedo.as_ref().map_or(Rgb::WHITE, |albedo| planes::divisor(albedo[i]));
        for (i, sum) in sum.iter_mut().enumerate() {
            let (back, variance) =
                (back(i), light.planes.planes[3][light.planes.index(i % width, i / width)]);
            let Rgb { r, g, b } = light.planes.rgb(i) * back;
            let own = [r, g, b, variance * planes::mean(back * back)];
            sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
    }
    if albedo.is_none() {
        return Ok(sum.into_iter().map(|[r, g, b, _]| Rgb::new(r, g, b)).collect());
    }
    let colours = Planes::filled((width, height), |i| sum[i])?;
    Ok(edges::rebuilt(&colours, &guides))
}

/// The denoised light of a layer, with the albedo divided out.
fn smooth_light(
    size: (usize, usize),
    layer: Layer,
    albedo: Option<&[Rgb]>,
    guides: &Guides,
) -> Result<Light, PictureError> {
    STEPS.iter().try_fold(Light::of(size, layer, albedo)?, |light, &step| pass(&light, guides, step))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Picture;
    use bilux_math::hash::{hash_words, unit_f32};

    /// A picture with every layer, all noise, and with guides that separate few pixels.
    fn noise(width: usize, height: usize) -> Picture {
        let mut picture = Picture::new(width, height).unwrap();
        let layers = ["", "albedo", "normal", "depth", "variance", "light", "light_variance"];
        for (k, layer) in layers.into_iter().enumerate() {
            let names: &[&str] = match layer {
                "normal" => &["X", "Y", "Z"],
                "depth" => &["Z"],
                _ => &["R", "G", "B"],
            };
            for (c, name) in names.iter().enumerate() {
                let apart = if ["albedo", "normal", "depth"].contains(&layer) { 0.001 } else { 1.0 };
                let at = |i| 1.0 + apart * unit_f32(hash_words([i as u64, (3 * k + c) as u64]) as u32);
                let samples = (0..width * height).map(at).collect();
                picture.push_channel(crate::picture::qualified(layer, name), samples).unwrap();
            }
        }
        picture
    }

    /// Strips leave no visible seam: each includes all rows that its passes reach.
    #[test]
    fn strips_match_the_whole_picture_to_the_bit() {
        let picture = noise(37, MAX_ROWS + 83);
        let whole = smoothed(picture.rows(0..picture.height()).unwrap()).unwrap();
        let strips = Builtin::new(2).unwrap().denoise(&picture).unwrap();
        assert!(whole == strips);
        // And no more rows than needed: with one row less, there would be a difference.
        let rows = picture.height() / 2;
        let with = |reach: usize| smoothed(picture.rows(0..rows + reach).unwrap()).unwrap();
        assert!(whole[..rows * 37] == with(REACH)[..rows * 37]);
        assert!(whole[..rows * 37] != with(REACH - 12)[..rows * 37]);
    }
}
