//! Colours of a mosaic of filters.

use super::Pattern;
use bilux_math::parallel::for_each;

/// For each pixel, red, green and blue: its own number, and of the other two channels the mean of the neighbours that have them, in rows,
/// columns and diagonals. With a mosaic of squares that is bilinear interpolation. A channel that no neighbour has is 0.
pub(super) fn bilinear(
    mosaic: &[f32],
    width: usize,
    [left, top]: [u64; 2],
    pattern: &Pattern,
) -> Vec<[f32; 3]> {
    let height = mosaic.len() / width;
    let mut pixels = vec![[0.0; 3]; mosaic.len()];
    for_each(pixels.chunks_mut(width).enumerate(), |(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let (mut sums, mut counts) = ([0.0f64; 3], [0u32; 3]);
            let channel = |x: usize, y: usize| pattern.channel(left + x as u64, top + y as u64, 0);
            let own = channel(x, y);
            for ny in y.saturating_sub(1)..(y + 2).min(height) {
                for nx in x.saturating_sub(1)..(x + 2).min(width) {
                    let Some(of) = channel(nx, ny).filter(|of| Some(*of) != own || (nx, ny) == (x, y)) else {
                        continue;
                    };
                    sums[of] += f64::from(mosaic[ny * width + nx]);
                    counts[of] += 1;
                }
            }
            *pixel = std::array::from_fn(|of| (sums[of] / f64::from(counts[of].max(1))) as f32);
        }
    });
    pixels
}
