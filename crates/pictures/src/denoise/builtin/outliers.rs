//! Removes fireflies: single pixels that a rare path has made far brighter than all pixels around them. Averaging
//! them with their neighbours would turn them into blotches, so they are scaled down to little more than the brightest of the other
//! pixels. What exceeds these by less stays, since the mean of uneven noise is in its brightest pixels: without them the picture would
//! be too dark. Highlights stay too: their brightness is the same in all samples.

use bilux_math::Rgb;
use bilux_math::parallel::{fill, for_each};

/// Number of pixels around a firefly that may be as bright by chance.
const BRIGHT: usize = 2;
/// Maximum ratio to the brightest other pixels, and how much larger it is in fog and all else that is hazy: few samples find its light,
/// and passes spread it over many pixels.
const TOO_BRIGHT: f32 = 1.5;
const HAZY: f32 = 3.0;
/// The noise must account for at least this fraction of the difference.
const NOISE: f32 = 0.4;

/// The pixels without fireflies, and their variances. Both are scaled: with the neighbour's variance, a pixel that is still brighter
/// would look as if its light were certain.
pub(super) fn without(
    (width, height): (usize, usize),
    pixels: Vec<(Rgb, f32)>,
    haze: Option<&[f32]>,
) -> Vec<(Rgb, f32)> {
    let mut lights = vec![0.0; pixels.len()];
    fill(&mut lights, 1 << 14, |i| pixels[i].0.luminance());
    let mut without = pixels;
    for_each(without.chunks_mut(width).enumerate(), |(y, row)| {
        for (x, (colour, variance)) in row.iter_mut().enumerate() {
            let light = lights[y * width + x];
            if let Some(j) = brightest((width, height), &lights, x, y)
                && variance.sqrt() > NOISE * (light - lights[j])
            {
                let limit = TOO_BRIGHT + HAZY * haze.map_or(0.0, |haze| haze[y * width + x]);
                let share = (limit * lights[j] / light).min(1.0);
                (*colour, *variance) = (*colour * share, *variance * (share * share));
            }
        }
    });
    without
}

/// The brightest neighbour that counts, for a pixel that is far brighter than it. Most pixels are not, which the
/// first few neighbours decide.
fn brightest((width, height): (usize, usize), lights: &[f32], x: usize, y: usize) -> Option<usize> {
    let light = lights[y * width + x];
    let mut brightest = [(0.0, usize::MAX); BRIGHT];
    let mut as_bright = 0;
    for row in y.saturating_sub(2)..(y + 3).min(height) {
        let first = row * width + x.saturating_sub(2);
        let around = &lights[first..row * width + (x + 3).min(width)];
        for (j, &other) in around.iter().enumerate().map(|(i, other)| (first + i, other)) {
            if j == y * width + x || other < brightest[BRIGHT - 1].0 {
                continue;
            }
            if TOO_BRIGHT * other >= light {
                as_bright += 1;
                if as_bright >= BRIGHT {
                    return None;
                }
            }
            let place = brightest.iter().position(|(held, _)| other >= *held).unwrap_or(BRIGHT - 1);
            brightest[place..].rotate_right(1);
            brightest[place] = (other, j);
        }
    }
    Some(brightest[BRIGHT - 1].1).filter(|&j| j != usize::MAX)
}
