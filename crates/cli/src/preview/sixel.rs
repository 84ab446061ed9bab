//! Sixels, which many terminals understand: six rows of pixels in each line, in a palette of 216 colours with ordered dither.

use super::protocol::{Protocol, display_bytes};
use bilux::pictures::{Picture, WriteOptions};
use std::io::Write;

pub(super) const ENTRY: Protocol = Protocol {
    name: "sixel",
    // Cells are seldom smaller, so the picture does not reach below its rows.
    cell: [6, 12],
    detect: |terminal| {
        ["sixel", "foot", "mlterm", "yaft", "contour"].iter().any(|name| terminal.term.contains(name))
    },
    draw,
};

/// Steps of each colour channel.
const STEPS: u32 = 6;
/// Thresholds in sixteenths of a step, for places in squares of four by four pixels [Bayer 1973].
const THRESHOLDS: [[u32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

fn draw(picture: &Picture, options: &WriteOptions, _cells: [u32; 2]) -> anyhow::Result<Vec<u8>> {
    let bytes = display_bytes(picture, options)?;
    let (width, height) = (picture.width(), picture.height());
    let colours: Vec<u8> = bytes
        .as_chunks::<3>()
        .0
        .iter()
        .enumerate()
        .map(|(i, rgb)| colour(*rgb, THRESHOLDS[i / width % 4][i % width % 4]))
        .collect();
    let mut text = format!("\x1bP9;1q\"1;1;{width};{height}").into_bytes();
    for index in 0..STEPS.pow(3) {
        let percent = |step: u32| step * 100 / (STEPS - 1);
        let [r, g, b] = [index / (STEPS * STEPS), index / STEPS % STEPS, index % STEPS].map(percent);
        write!(text, "#{index};2;{r};{g};{b}")?;
    }
    for band in colours.chunks(6 * width) {
        let mut used = band.to_vec();
        used.sort_unstable();
        used.dedup();
        for colour in used {
            write!(text, "#{colour}")?;
            // Each column has a bit for each of the rows; equal columns are counted.
            let column = |x: usize| {
                let rows = band.chunks(width).enumerate();
                rows.map(|(row, pixels)| u8::from(pixels[x] == colour) << row).sum::<u8>()
            };
            let mut x = 0;
            while x < width {
                let bits = column(x);
                let length = (x..width).take_while(|&other| column(other) == bits).count();
                match length {
                    1..4 => text.extend(std::iter::repeat_n(63 + bits, length)),
                    _ => write!(text, "!{length}{}", char::from(63 + bits))?,
                }
                x += length;
            }
            text.push(b'$');
        }
        text.push(b'-');
    }
    text.extend_from_slice(b"\x1b\\");
    Ok(text)
}

/// The colour of the palette for a pixel, where the dither has this threshold.
fn colour(rgb: [u8; 3], threshold: u32) -> u8 {
    let step = |byte: u8| {
        let sixteenths = u32::from(byte) * (STEPS - 1) * 16 / 255;
        (sixteenths / 16 + u32::from(sixteenths % 16 > threshold)).min(STEPS - 1)
    };
    let [r, g, b] = rgb.map(step);
    ((r * STEPS + g) * STEPS + b) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::math::Rgb;

    #[test]
    fn rows_of_one_colour_are_counted() {
        let picture = Picture::from_rgb(5, 2, vec![Rgb::new(1.0, 0.0, 0.0); 10]).unwrap();
        let text = String::from_utf8(draw(&picture, &WriteOptions::default(), [1, 1]).unwrap()).unwrap();
        // Red is colour 180, and the two upper rows are 63 + 3.
        assert!(text.ends_with("#180!5B$-\x1b\\"), "{text}");
        assert!(text.contains("#180;2;100;0;0"));
    }

    #[test]
    fn dither_keeps_the_mean() {
        let mean = |grey: u8| {
            let greens =
                (0..16).map(|i| u32::from(colour([grey; 3], THRESHOLDS[i / 4][i % 4])) / STEPS % STEPS);
            greens.sum::<u32>() as f32 / 16.0 / (STEPS - 1) as f32 * 255.0
        };
        for grey in [0, 20, 77, 128, 200, 255] {
            assert!((mean(grey) - f32::from(grey)).abs() < 4.0, "{grey}: {}", mean(grey));
        }
    }
}
