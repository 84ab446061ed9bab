//! Contours of a plan: lines where it has given values.

use bilux::pictures::{Picture, PictureError};

/// A lightness, as displays show it, above which lines are black.
const BRIGHT: f32 = 0.55;

/// The picture with a line between pixels on different sides of each level. It is as wide as the plan, of these columns and rows,
/// and may have more rows below.
///
/// # Errors
/// If memory is short.
pub fn drawn(
    picture: Picture,
    (width, height): (usize, usize),
    values: &[f32],
    levels: &[f32],
) -> Result<Picture, PictureError> {
    let mut colours = picture.to_rgb().unwrap_or_default();
    let differs =
        |a: usize, b: usize| levels.iter().any(|level| (values[a] < *level) != (values[b] < *level));
    for i in 0..width * height {
        let (x, y) = (i % width, i / width);
        let is_crossed = x + 1 < width && differs(i, i + 1) || y + 1 < height && differs(i, i + width);
        if is_crossed && let Some(colour) = colours.get_mut(i) {
            *colour = bilux::math::Rgb::grey(if colour.luminance() > BRIGHT { 0.0 } else { 1.0 });
        }
    }
    let colour_space = picture.colour_space;
    let mut drawn = Picture::from_rgb(picture.width(), picture.height(), colours)?;
    drawn.colour_space = colour_space;
    Ok(drawn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::math::Rgb;

    #[test]
    fn lines_are_between_what_is_less_and_what_is_more() {
        // Rising to the right by 10, and down by 100.
        let values: Vec<f32> = (0..12).map(|i| (i % 4 * 10 + i / 4 * 100) as f32).collect();
        let plain = Picture::from_rgb(4, 4, vec![Rgb::grey(0.2); 16]).unwrap();
        let lines = drawn(plain, (4, 3), &values, &[15.0, 205.0]).unwrap().to_rgb().unwrap();
        let white: Vec<usize> = (0..16).filter(|i| lines[*i] == Rgb::WHITE).collect();
        // 15 is between columns 1 and 2 of the first row, and below its first two; 205 above the last three of the last row,
        // and right of its first.
        assert_eq!(white, [0, 1, 5, 6, 7, 8]);
    }
}
