//! Single pixels that a rare path has made far brighter than all around them. To average them with their neighbours makes blots of
//! them; so they are brought down to the brightest of the others. Highlights stay: their brightness is the same in all samples.

use bilux_math::Rgb;
use rayon::prelude::*;

/// So many of the pixels around may be as bright, themselves by chance.
const BRIGHT: usize = 3;
/// So much brighter than these is too bright.
const TOO_BRIGHT: f32 = 2.0;
/// And by so much of it at least the noise has to account.
const NOISE: f32 = 0.4;

/// Pixels without outliers, and their variances, each taken from the brightest that counts.
pub(super) fn without((width, height): (usize, usize), pixels: &[(Rgb, f32)]) -> Vec<(Rgb, f32)> {
    let one = |i: usize| {
        let (colour, variance) = pixels[i];
        let light = colour.luminance();
        let (x, y) = (i % width, i / width);
        let (left, right) = (x.saturating_sub(2), (x + 3).min(width));
        let (top, bottom) = (y.saturating_sub(2), (y + 3).min(height));
        // The brightest around, the brightest first.
        let mut brightest = [(f32::MIN, 0); BRIGHT];
        for j in (top..bottom).flat_map(|y| (left..right).map(move |x| y * width + x)).filter(|&j| j != i) {
            let other = pixels[j].0.luminance();
            if other > brightest[BRIGHT - 1].0 {
                let place = brightest.iter().position(|(held, _)| other > *held).unwrap_or(BRIGHT - 1);
                brightest[place..].rotate_right(1);
                brightest[place] = (other, j);
            }
        }
        let (enough, j) = brightest[BRIGHT - 1];
        let is_outlier =
            enough >= 0.0 && light > TOO_BRIGHT * enough && variance.sqrt() > NOISE * (light - enough);
        if is_outlier { (colour * (enough / light), pixels[j].1) } else { (colour, variance) }
    };
    (0..pixels.len()).into_par_iter().map(one).collect()
}
