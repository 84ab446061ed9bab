//! The texels of images, stored as compactly as in their files.

use super::Channel;
use super::procedural::{Formula, centre};
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use std::sync::LazyLock;

/// An image, with row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Texels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// `width * height` texels.
    pub texels: Texels,
}

/// Texels in rows.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Red, green, blue and alpha, from 0 to 255; colours are sRGB-encoded, numbers are linear.
    Bytes(Vec<[u8; 4]>),
    /// Linear light, or numbers.
    Floats {
        /// Red, green and blue.
        colours: Vec<Rgb>,
        /// As many alpha values as colours, or none if all texels are opaque.
        alpha: Vec<f32>,
    },
    /// No stored texels: a procedural texture computes them.
    Formula(Formula),
}

/// The linear values of sRGB bytes.
static LIGHT: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|i| srgb_decode(i as f32 / 255.0)));

impl Image {
    /// True when it has the full number of texels, and at least one.
    #[inline]
    pub fn is_whole(&self) -> bool {
        let have = match &self.texels {
            Texels::Bytes(bytes) => bytes.len(),
            Texels::Floats { colours, .. } => colours.len(),
            Texels::Formula(_) => self.width * self.height,
        };
        have != 0 && have == self.width * self.height
    }

    /// True if texels are stored as bytes, which are the same for colours and for numbers.
    pub fn is_bytes(&self) -> bool {
        matches!(self.texels, Texels::Bytes(_))
    }

    /// The size of the texels in bytes.
    pub fn size(&self) -> u64 {
        match &self.texels {
            Texels::Bytes(bytes) => size_of_val(&bytes[..]) as u64,
            Texels::Floats { colours, alpha } => (size_of_val(&colours[..]) + size_of_val(&alpha[..])) as u64,
            Texels::Formula(_) => 0,
        }
    }

    /// A texel by its index, or one channel of it as a grey.
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
            Texels::Formula(formula) => self.eval_procedural(formula, index, channel),
        }
    }

    /// The texel of a procedural texture; a separate function, to keep look-ups of stored texels small.
    #[cold]
    #[inline(never)]
    fn eval_procedural(&self, formula: &Formula, index: usize, channel: Option<Channel>) -> Rgb {
        Channel::of(channel, formula.at(centre(index, self.width, self.height)))
    }
}
