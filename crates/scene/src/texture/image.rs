//! The texels of pictures, held as compactly as they came.

use super::Channel;
use super::procedural::{Formula, centre};
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use std::sync::LazyLock;

/// A picture, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Texels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` texels.
    pub texels: Texels,
}

/// Texels in rows.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Red, green, blue and alpha, from 0 to 255; colours by the sRGB curve, numbers as they are.
    Bytes(Vec<[u8; 4]>),
    /// Linear light, or numbers.
    Floats {
        /// Red, green and blue.
        colours: Vec<Rgb>,
        /// As many, or none where all is opaque.
        alpha: Vec<f32>,
    },
    /// None at all: what they would be is worked out.
    Formula(Formula),
}

/// What bytes mean as colours.
static LIGHT: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|i| srgb_decode(i as f32 / 255.0)));

impl Image {
    /// True when there is a texel for every place, and any at all.
    #[inline]
    pub fn is_whole(&self) -> bool {
        let have = match &self.texels {
            Texels::Bytes(bytes) => bytes.len(),
            Texels::Floats { colours, .. } => colours.len(),
            Texels::Formula(_) => self.width * self.height,
        };
        have != 0 && have == self.width * self.height
    }

    /// True where texels are held in bytes, which are the same whether they mean colours or numbers.
    pub fn is_bytes(&self) -> bool {
        matches!(self.texels, Texels::Bytes(_))
    }

    /// Bytes that the texels take.
    pub fn size(&self) -> u64 {
        match &self.texels {
            Texels::Bytes(bytes) => size_of_val(&bytes[..]) as u64,
            Texels::Floats { colours, alpha } => (size_of_val(&colours[..]) + size_of_val(&alpha[..])) as u64,
            Texels::Formula(_) => 0,
        }
    }

    /// A texel by its number, or one channel of it as a grey.
    #[inline]
    pub(super) fn texel(&self, index: usize, channel: Option<Channel>, is_data: bool) -> Rgb {
        match &self.texels {
            Texels::Bytes(bytes) => {
                let [r, g, b, a] = bytes[index];
                let plain = |byte: u8| f32::from(byte) / 255.0;
                let decode = |byte: u8| if is_data { plain(byte) } else { LIGHT[usize::from(byte)] };
                match channel {
                    None => Rgb::new(decode(r), decode(g), decode(b)),
                    Some(Channel::R) => Rgb::grey(decode(r)),
                    Some(Channel::G) => Rgb::grey(decode(g)),
                    Some(Channel::B) => Rgb::grey(decode(b)),
                    Some(Channel::A) => Rgb::grey(plain(a)),
                }
            }
            Texels::Floats { alpha, .. } if channel == Some(Channel::A) => {
                Rgb::grey(alpha.get(index).copied().unwrap_or(1.0))
            }
            Texels::Floats { colours, .. } => Channel::of(channel, colours[index]),
            Texels::Formula(formula) => self.worked_out(formula, index, channel),
        }
    }

    /// The same of a formula; apart, so that looking up what is stored stays small.
    #[cold]
    #[inline(never)]
    fn worked_out(&self, formula: &Formula, index: usize, channel: Option<Channel>) -> Rgb {
        Channel::of(channel, formula.at(centre(index, self.width, self.height)))
    }
}
