//! Visualises where two pictures differ.

use super::{Pair, flip};
use crate::{ColourSpace, Picture, PictureError};
use bilux_math::Rgb;

/// The error that a heat map shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HeatMap {
    /// The FLIP error, 0..=1.
    #[default]
    Flip,
    /// The maximum absolute difference of the channels of light, relative to that of the whole picture.
    Absolute,
}

/// The error of every pixel as a colour of [`ramp`], ready for a display.
pub fn heat_map(pair: &Pair, kind: HeatMap) -> Result<Picture, PictureError> {
    let errors = match kind {
        HeatMap::Flip => flip::map(pair),
        HeatMap::Absolute => absolute(pair),
    };
    false_colours((pair.width, pair.height), &errors, 1.0)
}

/// Samples of so many columns and rows as colours of [`ramp`], from 0 to `most`, ready for a display.
pub fn false_colours(
    (width, height): (usize, usize),
    samples: &[f32],
    most: f32,
) -> Result<Picture, PictureError> {
    let share = |&sample: &f32| ramp(if sample == 0.0 { 0.0 } else { sample / most });
    let mut picture = Picture::from_rgb(width, height, samples.iter().map(share).collect())?;
    picture.colour_space = ColourSpace::Srgb;
    Ok(picture)
}

/// A NaN is the maximum error.
fn absolute(pair: &Pair) -> Vec<f32> {
    let [a, b] = &pair.light;
    let differences = a.iter().zip(b).map(|(a, b)| (*a - *b).map(f32::abs));
    let errors: Vec<f32> =
        differences.map(|d| if d.is_finite() { d.max_channel() } else { f32::INFINITY }).collect();
    let most = errors.iter().copied().filter(|e| e.is_finite()).fold(0.0, f32::max);
    let relative = |error: f32| if error == 0.0 { 0.0 } else { (error / most).min(1.0) };
    errors.into_iter().map(relative).collect()
}

/// Black through violet, red and orange to pale yellow, with increasing lightness: sRGB-encoded, for an error of
/// 0..=1.
pub fn ramp(error: f32) -> Rgb {
    const STOPS: [[u8; 3]; 9] = [
        [0, 0, 4],
        [28, 16, 68],
        [79, 18, 123],
        [129, 37, 129],
        [181, 54, 122],
        [229, 80, 100],
        [251, 135, 97],
        [254, 194, 135],
        [252, 253, 191],
    ];
    let place = crate::picture::clamp_sample(error, 1.0) * (STOPS.len() - 1) as f32;
    let stop = (place as usize).min(STOPS.len() - 2);
    let [low, high] =
        [STOPS[stop], STOPS[stop + 1]].map(|s| Rgb::from_array(s.map(|c| f32::from(c) / 255.0)));
    low.lerp(high, place - stop as f32)
}
