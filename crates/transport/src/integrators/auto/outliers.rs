//! The expected error of a picture without its outliers: a few pixels that one sample in a million makes thousands of
//! times too bright. They dominate the mean square over all pictures, though most pictures show none.
//!
//! The estimate is therefore the trimmed error of a typical picture: the brightest fireflies are left out until they
//! cover
//! [`TRIMMED`] of the pixels. Their light is then missing from the picture, and its square counts as error.

use super::contributions::Bin;
use super::pilot::Block;
use super::sets::DARK;

/// The fraction of a film's pixels that is left out, the worst first. It is a tenth of what trimmed errors of pictures
/// leave out: the pilot sees only some of the fireflies.
const TRIMMED: f64 = 1e-4;

/// Samples per pixel of a typical picture.
const SAMPLES: f64 = 64.0;

/// Fireflies of about one brightness in one block.
struct Dots {
    block: usize,
    bin: Bin,
    /// The square of one sample, relative to the light around it.
    error: f64,
    /// The fraction of the film's pixels that have one.
    pixels: f64,
}

/// Relative variance of one sample with the techniques of a set, as a mean over blocks, without outliers.
pub(super) fn error(blocks: &[Block], set: usize) -> f64 {
    let count = blocks.len().max(1) as f64;
    let dark = DARK * blocks.iter().map(|block| block.mean).sum::<f64>() / count;
    let around = |block: &Block| (block.mean * block.mean + dark * dark).max(f64::MIN_POSITIVE);
    let mut dots = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        for &bin in block.finds[set].0.iter().filter(|bin| bin.light > 0.0 && bin.square > 0.0) {
            let found = bin.square / bin.light;
            let pixels = (SAMPLES * bin.light / found).min(1.0) / count;
            dots.push(Dots { block: index, bin, error: found * found / around(block), pixels });
        }
    }
    dots.sort_by(|a, b| b.error.total_cmp(&a.error));
    let mut trimmed = vec![Bin::default(); blocks.len()];
    let mut left = TRIMMED;
    for dots in dots {
        let part = (left / dots.pixels).min(1.0);
        left -= part * dots.pixels;
        trimmed[dots.block].light += part * dots.bin.light;
        trimmed[dots.block].square += part * dots.bin.square;
        if part < 1.0 {
            break;
        }
    }
    let of = |(block, trimmed): (&Block, &Bin)| {
        let variance = block.variance[set] + block.finds[set].square() - trimmed.square;
        (variance.max(0.0) + SAMPLES * trimmed.light * trimmed.light) / around(block)
    };
    blocks.iter().zip(&trimmed).map(of).sum::<f64>() / count
}

#[cfg(test)]
mod tests {
    use super::super::contributions::Contributions;
    use super::super::sets::SET_COUNT;
    use super::*;

    /// 100 blocks of light 1 with variance 0.5, one of which has a part of its light in rare contributions.
    fn film(part: f64, found: f64) -> Vec<Block> {
        let mut blocks = vec![Block { mean: 1.0, variance: [0.5; SET_COUNT], ..Block::default() }; 100];
        blocks[7].finds[2].add(part, found);
        blocks
    }

    #[test]
    fn rare_fireflies_count_as_missing_light() {
        let usual = 0.5 / 1.09;
        // One sample in ten million: a hundred times the rest of the error, and in no picture.
        let blocks = film(0.1, 1e6);
        assert!(blocks[7].finds[2].square() / 100.0 > 100.0 * usual);
        let missing = 64.0 * 0.1 * 0.1 / 1.09 / 100.0;
        assert!((error(&blocks, 2) - usual - missing).abs() < 1e-9);
        assert!((error(&blocks, 1) - usual).abs() < 1e-9);
    }

    #[test]
    fn dots_on_many_pixels_count_in_full() {
        // One sample in a thousand: with 64 samples, a sixteenth of all pixels has one.
        let block = film(0.1, 100.0).swap_remove(7);
        let found = error(&vec![block; 100], 2);
        let all = (0.5 + 0.1 * 100.0) / 1.09;
        assert!((0.95 * all..all).contains(&found), "{found} of {all}");
    }

    #[test]
    fn finds_of_any_size_have_their_bin() {
        let mut finds = Contributions::default();
        for found in [0.0, 1e-300, 1e-9, 1.0, 3.9, 1e12, f64::MAX] {
            finds.add(0.0, found);
        }
        finds.add(2.0, 3.0);
        finds.add(1.0, 1e12);
        assert!((finds.square() / (6.0 + 1e12) - 1.0).abs() < 1e-12);
    }
}
