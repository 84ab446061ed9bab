//! Colours of vertices and faces in files: one rule for all readers and writers. See
//! `docs/adr/0043-vertex-colours.md`.
//!
//! Formats that do not say what their colours mean (OBJ, PLY, OFF, STL, XYZ, LAS) hold them as displays show them, in
//! sRGB; what stands for white follows from the type of the numbers and from the greatest number of the whole file.

use bilux_math::Rgb;
use bilux_math::colour::{srgb_decode, srgb_encode};
use bilux_math::parallel::for_each;

/// The type of the numbers that colours are stored as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stored {
    /// Bytes: 255 is white.
    Bytes,
    /// Larger integers: 65535 is white, or 255 if no number is greater.
    Integers,
    /// Text or floats: 1 is white, or 255 or 65535 if some number is greater.
    Numbers,
}

/// The greatest number of a file's colours so far. Only that of the whole file tells what white is: early rows may be
/// darker than later ones.
#[derive(Clone, Copy, Debug, Default)]
pub struct Greatest(f32);

/// A number this far above white is still white: colours that were computed may have been rounded up.
const ROUNDED: f32 = 1.01;

impl Greatest {
    /// The greatest of some colours.
    pub fn of(colours: &[Rgb]) -> Greatest {
        let mut greatest = Greatest::default();
        colours.iter().for_each(|colour| greatest.see(*colour));
        greatest
    }

    /// Takes a stored colour into account; numbers that are not finite say nothing.
    #[inline]
    pub fn see(&mut self, stored: Rgb) {
        for c in stored.to_array() {
            if c > self.0 && c.is_finite() {
                self.0 = c;
            }
        }
    }

    /// True if all colours are black.
    pub fn is_zero(self) -> bool {
        self.0 == 0.0
    }

    /// The number that stands for white.
    pub fn white(self, stored: Stored) -> f32 {
        let reaches = |white: f32| self.0 <= white * ROUNDED;
        match stored {
            Stored::Bytes => 255.0,
            Stored::Numbers if reaches(1.0) => 1.0,
            _ if reaches(255.0) => 255.0,
            _ => 65535.0,
        }
    }
}

/// The reflectance of a stored colour.
#[inline]
pub fn decoded(stored: Rgb, white: f32) -> Rgb {
    stored.map(|c| srgb_decode(within_unit(c / white)))
}

/// A stored colour that is white whatever stands for white: of vertices without a colour where others have one.
pub const UNCOLOURED: Rgb = Rgb::grey(f32::INFINITY);

/// Replaces stored colours by the reflectances that they mean.
pub fn decode(colours: &mut [Rgb], stored: Stored) {
    if stored == Stored::Bytes {
        let table: [f32; 256] = std::array::from_fn(|byte| srgb_decode(byte as f32 / 255.0));
        // The conversion of a float to a byte saturates.
        colours.iter_mut().for_each(|colour| *colour = colour.map(|c| table[usize::from(c as u8)]));
        return;
    }
    let white = Greatest::of(colours).white(stored);
    let decode = |some: &mut [Rgb]| some.iter_mut().for_each(|colour| *colour = decoded(*colour, white));
    for_each(colours.chunks_mut(1 << 14), decode);
}

/// The numbers that a reflectance is stored as, from 0 to 1.
pub fn encoded(colour: Rgb) -> [f32; 3] {
    colour.map(|c| srgb_encode(within_unit(c))).to_array()
}

/// The bytes that a reflectance is stored as, if they mean exactly that.
pub fn as_bytes(colour: Rgb) -> Option<[u8; 3]> {
    let bytes = encoded(colour).map(|c| (c * 255.0).round() as u8);
    (decoded(Rgb::from_array(bytes.map(f32::from)), 255.0) == colour).then_some(bytes)
}

/// From 0 to 1; 0 for NaN.
fn within_unit(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_follows_from_the_type_and_from_the_greatest_number_of_all() {
        let white =
            |c: f32, stored| Greatest::of(&[Rgb::grey(0.5), Rgb::new(0.1, c, f32::NAN)]).white(stored);
        for (greatest, numbers, integers) in [
            (0.4, 1.0, 255.0),
            (1.0, 1.0, 255.0),
            (1.000_001, 1.0, 255.0),
            (128.0, 255.0, 255.0),
            (255.0, 255.0, 255.0),
            (256.0, 255.0, 255.0),
            (4000.0, 65535.0, 65535.0),
            (f32::INFINITY, 1.0, 255.0),
        ] {
            assert_eq!(white(greatest, Stored::Numbers), numbers, "{greatest}");
            assert_eq!(white(greatest, Stored::Integers), integers, "{greatest}");
            assert_eq!(white(greatest, Stored::Bytes), 255.0);
        }
    }

    #[test]
    fn every_byte_comes_back_and_what_is_no_colour_is_black_or_white() {
        for byte in 0..=255u8 {
            let colour = decoded(Rgb::grey(f32::from(byte)), 255.0);
            assert_eq!(as_bytes(colour), Some([byte; 3]));
            assert!((encoded(colour)[0] - f32::from(byte) / 255.0).abs() < 1e-6);
        }
        let mut all = [UNCOLOURED, Rgb::new(0.0, 51.0, 255.0), Rgb::grey(-7.0)];
        let wanted = [Rgb::WHITE, Rgb::new(0.0, srgb_decode(0.2), 1.0), Rgb::BLACK];
        decode(&mut all, Stored::Numbers);
        assert_eq!(all, wanted);
        let mut all = [UNCOLOURED, Rgb::new(0.0, 51.0, 255.0), Rgb::grey(-7.0)];
        decode(&mut all, Stored::Bytes);
        assert_eq!(all, wanted);
        assert_eq!(decoded(Rgb::new(f32::NAN, -1.0, 7.0), 1.0), Rgb::new(0.0, 0.0, 1.0));
        assert_eq!(as_bytes(Rgb::grey(0.4321)), None);
    }
}
