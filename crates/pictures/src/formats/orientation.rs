//! Orientation of a picture, which is turned or mirrored before it is shown: that of TIFF, which Exif takes over. [Exif]

use super::rgba8::Interleaved;
use crate::limits::reserved;
use crate::{Picture, PictureError};

/// One of the eight orientations, from 1, in which pixels are stored as they are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Orientation(u16);

/// The tag of the orientation, and the type of its value: a 16-bit number.
const TAG: u16 = 0x0112;
const SHORT: u16 = 3;

impl Orientation {
    /// The orientation of this number; upright for those that do not exist.
    pub(super) fn of(number: u16) -> Orientation {
        Orientation(if (1..=8).contains(&number) { number } else { 1 })
    }

    /// The orientation that Exif data state; upright if they state none, or cannot be understood.
    pub(super) fn of_exif(data: &[u8]) -> Orientation {
        Orientation::of(stated(data.strip_prefix(b"Exif\0\0").unwrap_or(data)).unwrap_or(1))
    }

    pub(super) fn is_upright(self) -> bool {
        self.0 == 1
    }

    /// The size of the picture as it is shown, and which stored pixel each of its pixels is.
    pub(super) fn turned(self, [width, height]: [usize; 2]) -> ([usize; 2], impl Fn(usize) -> usize) {
        let size = if self.0 >= 5 { [height, width] } else { [width, height] };
        let of = move |pixel: usize| {
            let (x, y) = (pixel % size[0], pixel / size[0]);
            let (column, row) = match self.0 {
                2 => (width - 1 - x, y),
                3 => (width - 1 - x, height - 1 - y),
                4 => (x, height - 1 - y),
                5 => (y, x),
                6 => (y, height - 1 - x),
                7 => (width - 1 - y, height - 1 - x),
                8 => (width - 1 - y, x),
                _ => (x, y),
            };
            row * width + column
        };
        (size, of)
    }

    /// The samples of a picture as it is shown.
    pub(super) fn apply(
        self,
        format: &'static str,
        stored: Interleaved,
    ) -> Result<Interleaved, PictureError> {
        let channels = stored.channels();
        if self.is_upright() || channels == 0 {
            return Ok(stored);
        }
        let ([width, height], of) = self.turned([stored.width, stored.height]);
        let mut samples = reserved(format, stored.samples.len())?;
        for pixel in (0..width * height).map(of) {
            samples.extend_from_slice(&stored.samples[pixel * channels..(pixel + 1) * channels]);
        }
        Ok(Interleaved { width, height, samples, ..stored })
    }

    /// A picture of planes as it is shown.
    pub(super) fn apply_to_planes(
        self,
        format: &'static str,
        stored: Picture,
    ) -> Result<Picture, PictureError> {
        if self.is_upright() {
            return Ok(stored);
        }
        let ([width, height], of) = self.turned([stored.width(), stored.height()]);
        let mut picture = Picture::new(width, height)?;
        for channel in stored.channels() {
            let mut samples = reserved(format, channel.samples.len())?;
            samples.extend((0..width * height).map(|pixel| channel.samples[of(pixel)]));
            picture.push_channel(channel.name.clone(), samples)?;
        }
        (picture.colour_space, picture.alpha) = (stored.colour_space, stored.alpha);
        (picture.metadata, picture.warnings) = (stored.metadata, stored.warnings);
        Ok(picture)
    }
}

/// The number that a TIFF header's first directory gives as orientation.
fn stated(tiff: &[u8]) -> Option<u16> {
    let is_big_endian = match tiff.get(..4)? {
        b"II*\0" => false,
        b"MM\0*" => true,
        _ => return None,
    };
    let word = |at: usize| {
        let two = *tiff.get(at..)?.first_chunk::<2>()?;
        Some(if is_big_endian { u16::from_be_bytes(two) } else { u16::from_le_bytes(two) })
    };
    let [high, low] = if is_big_endian { [4, 6] } else { [6, 4] };
    let directory = usize::from(word(high)?) << 16 | usize::from(word(low)?);
    let entries = usize::from(word(directory)?);
    let entry = (0..entries).map(|i| directory + 2 + 12 * i).find(|&at| word(at) == Some(TAG))?;
    (word(entry + 2)? == SHORT).then(|| word(entry + 8))?
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table of the Exif standard: where row 0 and column 0 of the stored pixels are in the picture. Of the stored
    /// picture `A B / C D / E F`.
    #[test]
    fn each_orientation_puts_the_first_row_and_column_where_the_standard_says() {
        let shown = [
            (1, 2, "ABCDEF"),
            (2, 2, "BADCFE"),
            (3, 2, "FEDCBA"),
            (4, 2, "EFCDAB"),
            (5, 3, "ACEBDF"),
            (6, 3, "ECAFDB"),
            (7, 3, "FDBECA"),
            (8, 3, "BDFACE"),
        ];
        for (number, width, letters) in shown {
            let stored = Interleaved::new(2, 3, b"ABCDEF".to_vec());
            let turned = Orientation::of(number).apply("test", stored).unwrap();
            assert_eq!((turned.width, turned.samples), (width, letters.as_bytes().to_vec()), "{number}");
            let mut planes = Picture::new(2, 3).unwrap();
            planes.push_channel("Y", b"ABCDEF".map(f32::from).to_vec()).unwrap();
            let turned = Orientation::of(number).apply_to_planes("test", planes).unwrap();
            let letters: Vec<f32> = letters.bytes().map(f32::from).collect();
            assert_eq!((turned.width(), turned.channel("Y")), (width, Some(&letters[..])), "{number}");
        }
    }

    #[test]
    fn the_number_is_found_in_either_byte_order_and_damage_is_harmless() {
        let little = b"II*\0\x08\0\0\0\x02\0\x10\x01\x02\0\0\0\0\0\0\0\0\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0";
        let big = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0";
        for (data, number) in [(&little[..], 6), (&big[..], 6), (b"Exif\0\0MM\0*\0\0\0\xff", 1), (b"", 1)] {
            assert_eq!(Orientation::of_exif(data), Orientation::of(number));
            (0..data.len()).for_each(|end| _ = Orientation::of_exif(&data[..end]));
        }
        assert!(Orientation::of(9).is_upright() && Orientation::of(0).is_upright());
    }
}
