//! The errors of pictures against a reference. All sums are in f64; pictures are rows of linear light.

use bilux_math::Rgb;

/// The side of the blocks whose means reveal bias, in pixels.
pub const BLOCK: usize = 8;

/// Trimmed errors leave out the worst pixel of every thousand: 0.1%.
const TRIMMED: usize = 1000;

/// The mean of (x − r)² / (r² + 0.01) over pixels and channels. [Rousselle 2011]
pub fn relmse(picture: &[Rgb], reference: &[Rgb]) -> f64 {
    let errors = pixel_errors(picture, reference);
    errors.iter().sum::<f64>() / errors.len().max(1) as f64
}

/// The mean of [`relmse`] without the worst 0.1% of the pixels, so that single fireflies do not dominate.
pub fn relmse_trimmed(picture: &[Rgb], reference: &[Rgb]) -> f64 {
    let mut errors = pixel_errors(picture, reference);
    errors.sort_by(f64::total_cmp);
    errors.truncate(errors.len() - errors.len() / TRIMMED);
    errors.iter().sum::<f64>() / errors.len().max(1) as f64
}

/// The error of each pixel, averaged over its channels.
pub(super) fn pixel_errors(picture: &[Rgb], reference: &[Rgb]) -> Vec<f64> {
    let error = |x: &Rgb, r: &Rgb| {
        (0..3).map(|c| relative(f64::from(x[c]) - f64::from(r[c]), f64::from(r[c]))).sum::<f64>() / 3.0
    };
    picture.iter().zip(reference).map(|(x, r)| error(x, r)).collect()
}

/// The squared difference relative to the reference's square.
fn relative(difference: f64, reference: f64) -> f64 {
    difference * difference / (reference * reference + 0.01)
}

/// The part of the error that more pictures would not reduce: the squared bias of the block means, relative as in
/// [`relmse`], minus what the noise of so few pictures contributes (the variance of their mean), and at least 0. `None`
/// for a single picture, whose noise cannot be distinguished from bias. The noise of the reference itself is still
/// included.
pub fn bias2(pictures: &[Vec<Rgb>], reference: &[Rgb], width: usize) -> Option<f64> {
    if pictures.len() < 2 {
        return None;
    }
    let count = pictures.len() as f64;
    let of_pictures: Vec<Vec<f64>> = pictures.iter().map(|p| block_means(p, width, BLOCK)).collect();
    let of_reference = block_means(reference, width, BLOCK);
    let bias = |block: usize| {
        let r = of_reference[block];
        let mean = of_pictures.iter().map(|p| p[block]).sum::<f64>() / count;
        let spread = of_pictures.iter().map(|p| (p[block] - mean) * (p[block] - mean)).sum::<f64>();
        relative(mean - r, r) - spread / (count - 1.0) / count / (r * r + 0.01)
    };
    let all: f64 = (0..of_reference.len()).map(bias).sum();
    Some((all / of_reference.len().max(1) as f64).max(0.0))
}

/// The means of all blocks of `side`² pixels, three channels each; the picture's sides are multiples of `side`.
pub(super) fn block_means(picture: &[Rgb], width: usize, side: usize) -> Vec<f64> {
    let across = width / side;
    let mut sums = vec![0.0; across * (picture.len() / width / side) * 3];
    for (i, pixel) in picture.iter().enumerate() {
        let block = (i / width / side) * across + i % width / side;
        (0..3).for_each(|c| sums[block * 3 + c] += f64::from(pixel[c]));
    }
    sums.iter().map(|sum| sum / (side * side) as f64).collect()
}

/// The relMSE between the block means of two pictures: what is left where noise has averaged out.
pub(crate) fn block_relmse(picture: &[Rgb], reference: &[Rgb], width: usize) -> f64 {
    let blocks = [picture, reference].map(|p| block_means(p, width, BLOCK));
    let all: f64 = blocks[0].iter().zip(&blocks[1]).map(|(x, r)| relative(x - r, *r)).sum();
    all / blocks[0].len().max(1) as f64
}

/// The mean over pixels and channels.
pub(crate) fn mean(picture: &[Rgb]) -> f64 {
    let all = picture.iter().flat_map(|p| p.to_array()).map(f64::from);
    all.sum::<f64>() / (3 * picture.len()).max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 16 × 8 pixels: two blocks, each of one grey.
    fn two_blocks(left: f32, right: f32) -> Vec<Rgb> {
        (0..128).map(|i| Rgb::grey(if i % 16 < 8 { left } else { right })).collect()
    }

    #[test]
    fn errors_are_relative_to_the_reference() {
        let reference = vec![Rgb::new(1.0, 0.5, 0.0), Rgb::grey(2.0)];
        let picture = vec![Rgb::new(1.5, 0.5, 0.1), Rgb::grey(2.0)];
        // (0.25 / 1.01 + 0 + 0.01 / 0.01) / 6.
        let wanted = (0.25 / 1.01 + 1.0) / 6.0;
        assert!((relmse(&picture, &reference) - wanted).abs() < 1e-7);
        assert_eq!(relmse(&reference, &reference), 0.0);
        assert!((mean(&reference) - 7.5 / 6.0).abs() < 1e-12);
    }

    #[test]
    fn trimming_leaves_out_the_worst_thousandth_and_no_more() {
        let reference = vec![Rgb::grey(1.0); 2000];
        let mut picture = vec![Rgb::grey(1.1); 2000];
        picture[3] = Rgb::grey(500.0);
        picture[700] = Rgb::grey(900.0);
        picture[701] = Rgb::grey(3.0);
        let usual = 0.01 / 1.01;
        let wanted = (usual * 1997.0 + 4.0 / 1.01) / 1998.0;
        assert!((relmse_trimmed(&picture, &reference) - wanted).abs() < 1e-6);
        assert!(relmse(&picture, &reference) > 400.0);
        // Of fewer than a thousand pixels, none is left out.
        let few = relmse_trimmed(&picture[..999], &reference[..999]);
        assert!((few / relmse(&picture[..999], &reference[..999]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn blocks_have_their_means() {
        let means = block_means(&two_blocks(0.25, 0.75), 16, 8);
        assert_eq!(means, [0.25, 0.25, 0.25, 0.75, 0.75, 0.75]);
        let found = block_relmse(&two_blocks(0.25, 0.85), &two_blocks(0.25, 0.75), 16);
        assert!((found - 0.5 * 0.01 / (0.75 * 0.75 + 0.01)).abs() < 1e-6, "{found}");
    }

    #[test]
    fn bias_is_the_error_without_noise() {
        let reference = two_blocks(1.0, 1.0);
        // The left block is unbiased, 1 ± 0.2; the right one is 1.5 ± 0.1: by hand, b² = 0.25, v / n = 0.02 / 2.
        let pictures = [two_blocks(0.8, 1.4), two_blocks(1.2, 1.6)];
        let left = 0.0 - 0.08 / 2.0 / 1.01;
        let right = (0.25 - 0.02 / 2.0) / 1.01;
        let found = bias2(&pictures, &reference, 16).unwrap();
        assert!((found - 0.5 * (left + right)).abs() < 1e-6, "{found}");
        assert_eq!(bias2(&[two_blocks(0.9, 1.1), two_blocks(1.1, 0.9)], &reference, 16), Some(0.0));
        assert_eq!(bias2(&pictures[..1], &reference, 16), None);
    }
}
