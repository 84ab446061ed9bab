//! Half blocks in 24-bit colour: two pixels in each character cell, which every modern terminal shows.

use super::protocol::{Protocol, display_bytes};
use bilux::pictures::{Picture, WriteOptions};
use std::io::Write;

pub(super) const ENTRY: Protocol = Protocol { name: "blocks", cell: [1, 2], detect: |_| true, draw };

fn draw(picture: &Picture, options: &WriteOptions, _cells: [u32; 2]) -> anyhow::Result<Vec<u8>> {
    let bytes = display_bytes(picture, options)?;
    let pixels = bytes.as_chunks::<3>().0;
    let rows: Vec<&[[u8; 3]]> = pixels.chunks(picture.width()).collect();
    let mut text = Vec::new();
    for pair in rows.chunks(2) {
        for (column, [r, g, b]) in pair[0].iter().enumerate() {
            write!(text, "\x1b[38;2;{r};{g};{b}m")?;
            if let Some([r, g, b]) = pair.get(1).map(|row| row[column]) {
                write!(text, "\x1b[48;2;{r};{g};{b}m")?;
            }
            text.extend_from_slice("▀".as_bytes());
        }
        write!(text, "\x1b[0m\r\x1b[B")?;
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::math::Rgb;

    #[test]
    fn a_cell_has_the_upper_pixel_in_front_and_the_lower_behind() {
        let pixels = vec![Rgb::new(1.0, 0.0, 0.0), Rgb::new(0.0, 0.0, 1.0)];
        let picture = Picture::from_rgb(1, 2, pixels).unwrap();
        let text = String::from_utf8(draw(&picture, &WriteOptions::default(), [1, 1]).unwrap()).unwrap();
        assert_eq!(text, "\x1b[38;2;255;0;0m\x1b[48;2;0;0;255m▀\x1b[0m\r\x1b[B");
    }
}
