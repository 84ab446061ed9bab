//! Automatic exposure.

use crate::Picture;
use bilux_math::transcendental::log2;

/// The average brightness of a picture, as a fraction of white: the grey of a photographer's grey card.
const MIDDLE_GREY: f32 = 0.18;
/// Fractions of the darkest and of the brightest pixels that are ignored, so that neither a black backdrop nor the
/// sun decides.
const SHARE_OF_DARK: f64 = 0.05;
const SHARE_OF_BRIGHT: f64 = 0.05;
/// Maximum exposure, in stops, in either direction.
const MAX_STOPS: f32 = 20.0;

/// The exposure in stops that makes a linear picture as bright as a photograph: it brings the mean of the logarithms
/// of its luminances, without the darkest and the brightest, to that of middle grey. [Reinhard 2002, eq. 1 and 2] 0
/// for a black picture.
pub fn auto_exposure(picture: &Picture) -> f32 {
    let colours = picture.clone().into_linear().to_rgb().unwrap_or_default();
    let alpha = picture.channel("A");
    let seen = colours.iter().enumerate().filter(|(i, _)| alpha.is_none_or(|alpha| alpha[*i] > 0.5));
    let mut luminances: Vec<f32> =
        seen.map(|(_, colour)| colour.luminance()).filter(|&l| l > 0.0 && l < f32::MAX).collect();
    luminances.sort_unstable_by(f32::total_cmp);
    let left_out = |share: f64| (luminances.len() as f64 * share) as usize;
    let kept = &luminances[left_out(SHARE_OF_DARK)..luminances.len() - left_out(SHARE_OF_BRIGHT)];
    if kept.is_empty() {
        return 0.0;
    }
    let mean = kept.iter().map(|&l| f64::from(log2(l))).sum::<f64>() / kept.len() as f64;
    // Rounded to invisible steps, so that noise does not change it.
    let stops = (log2(MIDDLE_GREY) - mean as f32).clamp(-MAX_STOPS, MAX_STOPS);
    (stops * 16.0).round() / 16.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Rgb;

    fn stops(of: impl Fn(usize) -> f32) -> f32 {
        let pixels = (0..400).map(|i| Rgb::grey(of(i))).collect();
        auto_exposure(&Picture::from_rgb(20, 20, pixels).unwrap())
    }

    #[test]
    fn grey_becomes_middle_grey_and_outliers_do_not_count() {
        for light in [1e-6, 0.18, 3.0, 1e5] {
            let shown = light * bilux_math::transcendental::powf(2.0, stops(|_| light));
            assert!((shown / MIDDLE_GREY - 1.0).abs() < 0.03, "{light}: {shown}");
            let light_and_night = |i| {
                if i < 19 {
                    0.0
                } else if i < 38 {
                    1e7
                } else {
                    light
                }
            };
            assert!((stops(light_and_night) - stops(|_| light)).abs() < 1e-6);
        }
        assert_eq!(stops(|_| 0.0), 0.0);
        assert_eq!(stops(|_| f32::NAN), 0.0);
    }
}
