//! Distance of a picture from its reference. To add a metric, add a file with its `ENTRY`, and a line in the table.
//!
//! `rmse`, `relmse` and `max` compare light: linear Rec. 709 with premultiplied alpha. `psnr`, `ssim` and `flip`
//! compare what is visible: encoded for a display, after exposure and tone map.

mod convolution;
mod flip;
mod heat_map;
mod max;
mod psnr;
mod relmse;
mod rmse;
mod ssim;

pub use heat_map::{HeatMap, false_colours, heat_map, ramp};

use crate::tonemap::{TONEMAPS, ToneMapEntry, to_display};
use crate::{Picture, PictureError};
use bilux_math::Rgb;
use bilux_math::registry::Entry;

/// Every available metric.
pub static METRICS: &[MetricEntry] =
    &[rmse::ENTRY, relmse::ENTRY, max::ENTRY, psnr::ENTRY, ssim::ENTRY, flip::ENTRY];

/// One metric.
#[derive(Clone, Copy, Debug)]
pub struct MetricEntry {
    /// Name, summary, source and parameters.
    pub entry: Entry,
    /// True if a higher value is better.
    pub higher_is_better: bool,
    /// One number for the whole picture: infinite if the pictures are equal and the metric has no maximum, NaN if a
    /// sample that it needs is NaN.
    pub evaluate: fn(&Pair) -> f64,
}

/// A picture and its reference, prepared once for all metrics.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Linear Rec. 709 with premultiplied alpha: the picture, then the reference.
    pub light: [Vec<Rgb>; 2],
    /// Both for a display: sRGB-encoded, each channel 0..=1.
    pub shown: [Vec<Rgb>; 2],
    /// Their alphas; 1 where a picture has none.
    pub alpha: [Vec<f32>; 2],
}

/// The result of [`compare`].
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Every metric's name and value, in the order of the table.
    pub values: Vec<(&'static str, f64)>,
    /// Number of samples that are infinite or NaN, in the picture, then in the reference.
    pub non_finite: [u64; 2],
}

impl Report {
    /// The value of this metric; `None` if it is infinite (a `psnr` of equal pictures) or NaN, or there is no such
    /// metric: the cases that JSON writes as `null`.
    pub fn finite(&self, name: &str) -> Option<f64> {
        self.value(name).filter(|value| value.is_finite())
    }

    /// The value of this metric, whatever it is. Compare as `value <= bound` or `value >= bound`, never the other way
    /// round: then NaN fails.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.values.iter().find(|(metric, _)| *metric == name).map(|&(_, value)| value)
    }
}

/// Computes every metric of a picture against its reference, shown as they are. Returns an error if their sizes
/// differ or one has no colour.
pub fn compare(picture: &Picture, reference: &Picture) -> Result<Report, PictureError> {
    let pair = Pair::new(picture, reference, 0.0, &TONEMAPS[0])?;
    let values = METRICS.iter().map(|row| (row.entry.name, (row.evaluate)(&pair))).collect();
    Ok(Report { values, non_finite: [picture, reference].map(|side| side.non_finite().count) })
}

impl Pair {
    /// Prepares two pictures. Exposure, in stops, and tone map apply to what is shown.
    pub fn new(
        picture: &Picture,
        reference: &Picture,
        exposure: f32,
        tone_map: &ToneMapEntry,
    ) -> Result<Pair, PictureError> {
        let size = |side: &Picture| (side.width(), side.height());
        if size(picture) != size(reference) {
            return Err(PictureError::SizesDiffer { a: size(picture), b: size(reference) });
        }
        let shown = |side: &Picture| {
            let shown = to_display(side, exposure, tone_map)?;
            // Both sides are composited over black.
            let colours = shown.to_rgb().unwrap_or_default().into_iter().enumerate();
            let colours = colours.map(|(i, c)| shown.channel("A").map_or(c, |a| c * a[i]));
            Ok::<_, PictureError>(colours.map(|c| c.clamp(0.0, 1.0)).collect())
        };
        let main = |side: &Picture| side.main().into_linear();
        let (a, b) = (main(picture), main(reference));
        let alpha =
            |side: &Picture| side.channel("A").map_or_else(|| vec![1.0; side.pixel_count()], <[f32]>::to_vec);
        Ok(Pair {
            width: picture.width(),
            height: picture.height(),
            shown: [shown(picture)?, shown(reference)?],
            light: [a.to_rgb().unwrap_or_default(), b.to_rgb().unwrap_or_default()],
            alpha: [alpha(&a), alpha(&b)],
        })
    }

    /// The mean over all pixels and channels of a function of a sample and its reference, summed in f64.
    fn mean(sides: &[Vec<Rgb>; 2], f: impl Fn(f64, f64) -> f64) -> f64 {
        let [a, b] = sides.each_ref().map(|side| side.iter().flat_map(|c| c.to_array()).map(f64::from));
        a.zip(b).map(|(a, b)| f(a, b)).sum::<f64>() / (3 * sides[0].len()) as f64
    }
}
