//! Blotches: errors that are several pixels wide, which the eye does not average away. Both pictures are blurred until
//! pixel-to-pixel noise is gone; a pixel is blotched if the lightness still differs visibly there.

use bilux::math::Rgb;
use bilux::math::transcendental::{exp_f64, powf_f64};
use bilux::pictures::Picture;

/// The difference in CIE L* from which two adjacent fields look different. [Mahy 1994]
pub(super) const SEEN: f64 = 2.3;

/// The standard deviation of the blur, in pixels: what remains is wider than about ten pixels.
const BLUR: f64 = 4.0;

/// The fraction of a picture's pixels that are blotched compared with its reference, 0..=1; 1 if the sizes differ.
pub(super) fn share([picture, reference]: [&Picture; 2]) -> f64 {
    let (width, height) = (picture.width(), picture.height());
    if (reference.width(), reference.height()) != (width, height) {
        return 1.0;
    }
    let [a, b] = [picture, reference].map(|picture| {
        let light = picture.clone().into_linear().to_rgb().unwrap_or_default();
        let lightness: Vec<f64> = light.into_iter().map(lightness).collect();
        // The first blur transposes, so the second one runs along the columns.
        blurred(&blurred(&lightness, width), height)
    });
    let blotched = a.iter().zip(&b).filter(|(a, b)| (**a - **b).abs() >= SEEN).count();
    blotched as f64 / (width * height).max(1) as f64
}

/// CIE L* of linear light; white is 100.
fn lightness(light: Rgb) -> f64 {
    let y = f64::from(light.luminance()).clamp(0.0, 1.0);
    if y > 216.0 / 24_389.0 { 116.0 * powf_f64(y, 1.0 / 3.0) - 16.0 } else { y * 24_389.0 / 27.0 }
}

/// Blurs a plane along its rows, repeating the edges, and transposes it.
fn blurred(plane: &[f64], width: usize) -> Vec<f64> {
    let reach = (3.0 * BLUR) as isize;
    let kernel: Vec<f64> =
        (-reach..=reach).map(|x| exp_f64(-((x * x) as f64) / (2.0 * BLUR * BLUR))).collect();
    let sum: f64 = kernel.iter().sum();
    let height = plane.len() / width.max(1);
    let mut transposed = vec![0.0; plane.len()];
    for (y, row) in plane.chunks_exact(width.max(1)).enumerate() {
        for x in 0..width {
            let near =
                |k: usize| row[(x as isize + k as isize - reach).clamp(0, width as isize - 1) as usize];
            let all: f64 = kernel.iter().enumerate().map(|(k, weight)| weight * near(k)).sum();
            transposed[x * height + y] = all / sum;
        }
    }
    transposed
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::math::hash::{hash_words, unit_f32};

    const SIDE: usize = 96;

    fn picture(at: impl Fn(usize) -> f32) -> Picture {
        Picture::from_rgb(SIDE, SIDE, (0..SIDE * SIDE).map(|i| Rgb::grey(at(i))).collect()).unwrap()
    }

    #[test]
    fn wide_errors_are_blotches_and_noise_from_pixel_to_pixel_is_none() {
        let even = picture(|_| 0.2);
        assert_eq!(share([&even, &even]), 0.0);
        let noise = picture(|i| 0.2 + 0.1 * (unit_f32(hash_words([i as u64]) as u32) - 0.5));
        assert!(share([&noise, &even]) < 0.01);
        // A quarter of the picture is a tenth or more brighter: 0.2 is L* 51.8, 0.22 is 54.0, 0.23 is 55.1.
        let quarter = |light: f32| {
            picture(move |i| if i % SIDE < SIDE / 2 && i / SIDE < SIDE / 2 { light } else { 0.2 })
        };
        assert_eq!(share([&quarter(0.22), &even]), 0.0);
        let blotched = share([&quarter(0.24), &even]);
        assert!((0.19..0.25).contains(&blotched), "{blotched}");
    }
}
