//! Pictures side by side, downscaled, and with text labels: for figures and reports.

use crate::font::{GLYPH_HEIGHT, GLYPH_WIDTH, glyph};
use crate::{Picture, PictureError};
use bilux_math::Rgb;

/// Arranges the main pictures in a row from left to right, all linear, aligned at the top, with `gap` black pixels
/// between them. Returns an error if there are none, or one has no colour.
pub fn side_by_side(pictures: &[Picture], gap: usize) -> Result<Picture, PictureError> {
    let width = pictures.iter().map(|picture| picture.width() + gap).sum::<usize>().saturating_sub(gap);
    let height = pictures.iter().map(Picture::height).max().unwrap_or(0);
    // Rejects sizes that do not fit before any memory is allocated.
    Picture::new(width, height)?;
    let mut pixels = vec![Rgb::BLACK; width * height];
    let mut left = 0;
    for picture in pictures {
        let colours = linear_colours(picture)?;
        for (y, row) in colours.chunks_exact(picture.width()).enumerate() {
            pixels[y * width + left..][..picture.width()].copy_from_slice(row);
        }
        left += picture.width() + gap;
    }
    Picture::from_rgb(width, height, pixels)
}

/// Arranges the main pictures from top to bottom, under the conditions of [`side_by_side`].
pub fn stacked(pictures: &[Picture], gap: usize) -> Result<Picture, PictureError> {
    let width = pictures.iter().map(Picture::width).max().unwrap_or(0);
    let height = pictures.iter().map(|picture| picture.height() + gap).sum::<usize>().saturating_sub(gap);
    Picture::new(width, height)?;
    let mut pixels = vec![Rgb::BLACK; width * height];
    let mut top = 0;
    for picture in pictures {
        for (y, row) in linear_colours(picture)?.chunks_exact(picture.width()).enumerate() {
            pixels[(top + y) * width..][..picture.width()].copy_from_slice(row);
        }
        top += picture.height() + gap;
    }
    Picture::from_rgb(width, height, pixels)
}

/// The main picture in linear light, `factor` times smaller in each direction: every pixel is the mean of a square of
/// the old ones, or of the remaining part of it at the right and bottom edges. Returns an error if the factor is zero
/// or the picture has no colour.
pub fn downscaled(picture: &Picture, factor: usize) -> Result<Picture, PictureError> {
    if factor == 0 {
        return Err(PictureError::Malformed("a picture cannot be made smaller by a factor of 0".to_owned()));
    }
    let colours = linear_colours(picture)?;
    let (width, height) = (picture.width().div_ceil(factor), picture.height().div_ceil(factor));
    let mean = |i: usize| {
        let (left, top) = (i % width * factor, i / width * factor);
        let columns = left..(left + factor).min(picture.width());
        let rows = top..(top + factor).min(picture.height());
        let mut sum = [0f64; 3];
        for y in rows.clone() {
            for colour in &colours[y * picture.width()..][columns.clone()] {
                (0..3).for_each(|channel| sum[channel] += f64::from(colour[channel]));
            }
        }
        Rgb::from_array(sum.map(|channel| (channel / (rows.len() * columns.len()) as f64) as f32))
    };
    Picture::from_rgb(width, height, (0..width * height).map(mean).collect())
}

fn linear_colours(picture: &Picture) -> Result<Vec<Rgb>, PictureError> {
    let colours = picture.main().into_linear().to_rgb();
    colours.ok_or_else(|| PictureError::Malformed("a panel needs the channels R, G and B, or Y".to_owned()))
}

/// Writes a line of text: white letters on a dark ground, each `6 × 8` pixels times `scale`, with their top left
/// corner at (x, y). Whatever lies beyond the picture's edges is dropped; letters that the font lacks are boxes.
/// Alpha, if present, becomes 1 under the text.
pub fn label(picture: &mut Picture, x: usize, y: usize, text: &str, scale: usize) {
    let scale = scale.max(1);
    let (cell_width, cell_height) = ((GLYPH_WIDTH + 1) * scale, (GLYPH_HEIGHT + 1) * scale);
    let (width, height) = (picture.width(), picture.height());
    let columns = text.chars().count().saturating_mul(cell_width).saturating_add(scale);
    let (right, bottom) =
        (x.saturating_add(columns).min(width), y.saturating_add(cell_height + scale).min(height));
    let letters: Vec<[u8; GLYPH_HEIGHT]> = text.chars().take(width / cell_width + 1).map(glyph).collect();
    let lit = |column: usize, row: usize| {
        // One empty row and column before the first letter.
        let (Some(column), Some(row)) = (column.checked_sub(scale), row.checked_sub(scale)) else {
            return false;
        };
        let (column, row) = (column / scale, row / scale);
        let bits = letters.get(column / (GLYPH_WIDTH + 1)).and_then(|letter| letter.get(row));
        bits.is_some_and(|bits| {
            column % (GLYPH_WIDTH + 1) < GLYPH_WIDTH
                && bits >> (GLYPH_WIDTH - 1 - column % (GLYPH_WIDTH + 1)) & 1 == 1
        })
    };
    for name in ["R", "G", "B", "Y", "A"] {
        let Some(samples) = picture.channel_mut(name) else { continue };
        for (px, py) in (y..bottom).flat_map(|py| (x..right).map(move |px| (px, py))) {
            let value = if name == "A" || lit(px - x, py - y) { 1.0 } else { GROUND };
            samples[py * width + px] = value;
        }
    }
}

/// Dark enough for white text, and not black.
const GROUND: f32 = 0.01;

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(width: usize, height: usize, value: f32) -> Picture {
        Picture::from_rgb(width, height, vec![Rgb::grey(value); width * height]).unwrap()
    }

    #[test]
    fn panels_stand_where_they_should() {
        let row = side_by_side(&[plain(2, 3, 0.25), plain(4, 1, 0.5)], 1).unwrap();
        assert_eq!((row.width(), row.height()), (7, 3));
        assert_eq!(
            [row.rgb(1, 2).r, row.rgb(2, 0).r, row.rgb(6, 0).r, row.rgb(6, 1).r],
            [0.25, 0.0, 0.5, 0.0]
        );
        let column = stacked(&[plain(2, 1, 0.25), plain(1, 2, 0.5)], 2).unwrap();
        assert_eq!((column.width(), column.height()), (2, 5));
        assert_eq!(
            [column.rgb(1, 0).r, column.rgb(0, 2).r, column.rgb(0, 4).r, column.rgb(1, 4).r],
            [0.25, 0.0, 0.5, 0.0]
        );
        assert!(side_by_side(&[], 0).is_err() && stacked(&[], 3).is_err());
    }

    #[test]
    fn smaller_pictures_have_the_same_light() {
        let ramp = (0..35).map(|i| Rgb::grey(i as f32)).collect();
        let small = downscaled(&Picture::from_rgb(7, 5, ramp).unwrap(), 3).unwrap();
        assert_eq!((small.width(), small.height()), (3, 2));
        assert_eq!(small.rgb(0, 0).r, (1 + 2 + 7 + 8 + 9 + 14 + 15 + 16) as f32 / 9.0);
        assert_eq!(small.rgb(2, 1).r, (27 + 34) as f32 / 2.0);
        assert!(downscaled(&small, 0).is_err());
    }

    #[test]
    fn labels_are_seen_and_stay_inside() {
        let mut picture = plain(40, 12, 0.5);
        label(&mut picture, 2, 1, "I", 1);
        let column: Vec<bool> = (1..10).map(|y| picture.rgb(5, y).r == 1.0).collect();
        assert_eq!(column, [false, true, true, true, true, true, true, true, false]);
        assert_eq!(picture.rgb(1, 1).r, 0.5);
        label(&mut picture, 30, 8, "far too long for it, é", 3);
        label(&mut picture, 400, 800, "outside", 1);
        label(&mut picture, 0, 0, "", 0);
        assert_eq!(picture.rgb(10, 11).r, 0.5);
    }
}
