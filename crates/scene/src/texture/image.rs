//! The texels of images, stored as compactly as in their files.

use super::channel::Channel;
use bilux_math::colour::srgb_decode;
use bilux_math::{Rgb, Vec2};
use std::any::Any;
use std::fmt::Debug;
use std::sync::{Arc, LazyLock};

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
    Formula(Arc<dyn ComputedTexels>),
}

/// Texels that are computed where they are looked up.
pub trait ComputedTexels: Any + Debug + Send + Sync {
    /// The colour at texture coordinates, v upwards.
    fn at(&self, uv: Vec2) -> Rgb;
    /// True when the other ones are computed in the same way.
    fn is_same(&self, other: &dyn ComputedTexels) -> bool;
}

impl PartialEq for dyn ComputedTexels {
    fn eq(&self, other: &dyn ComputedTexels) -> bool {
        self.is_same(other)
    }
}

/// The linear values of sRGB bytes.
static LIGHT: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|i| srgb_decode(i as f32 / 255.0)));

/// Bytes as fractions of 255.
static PLAIN: [f32; 256] = {
    let mut values = [0.0; 256];
    let mut i = 0;
    while i < 256 {
        values[i] = i as f32 / 255.0;
        i += 1;
    }
    values
};

/// Interpolates between four colours, the upper two first.
#[inline(always)]
fn mean_of_four([a, b, c, d]: [Rgb; 4], [x, y]: [f32; 2]) -> Rgb {
    a.lerp(b, x).lerp(c.lerp(d, x), y)
}

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

    /// Interpolates between four texels, given by their indices, the upper two first; or one channel of them, as a grey.
    #[inline]
    pub(super) fn bilinear(
        &self,
        indices: [usize; 4],
        at: [f32; 2],
        channel: Option<Channel>,
        is_data: bool,
    ) -> Rgb {
        let Texels::Bytes(bytes) = &self.texels else {
            return mean_of_four(indices.map(|index| self.texel(index, channel, is_data)), at);
        };
        let [a, b, c, d] = indices;
        Image::blended([bytes[a], bytes[b], bytes[c], bytes[d]], at, channel, is_data)
    }

    /// [`Image::bilinear`] for four texels that were read before.
    #[inline(always)]
    pub(super) fn blended(
        texels: [[u8; 4]; 4],
        at: [f32; 2],
        channel: Option<Channel>,
        is_data: bool,
    ) -> Rgb {
        let decode: &[f32; 256] = if is_data || channel == Some(Channel::A) { &PLAIN } else { &LIGHT };
        let decode = |byte: u8| decode[usize::from(byte)];
        match channel {
            None => {
                let colour = |[r, g, b, _]: [u8; 4]| Rgb::new(decode(r), decode(g), decode(b));
                let [a, b, c, d] = texels;
                mean_of_four([colour(a), colour(b), colour(c), colour(d)], at)
            }
            Some(channel) => {
                let number = |texel: [u8; 4]| decode(texel[channel as usize]);
                let [a, b, c, d] = texels;
                let (a, b, c, d) = (number(a), number(b), number(c), number(d));
                let lerp = |a: f32, b: f32, t: f32| Rgb::grey(a).lerp(Rgb::grey(b), t).r;
                Rgb::grey(lerp(lerp(a, b, at[0]), lerp(c, d, at[0]), at[1]))
            }
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
            Texels::Formula(formula) => self.eval_procedural(&**formula, index, channel),
        }
    }

    /// The texel of a procedural texture; a separate function, to keep look-ups of stored texels small.
    #[cold]
    #[inline(never)]
    fn eval_procedural(&self, formula: &dyn ComputedTexels, index: usize, channel: Option<Channel>) -> Rgb {
        Channel::of(channel, formula.at(centre(index, self.width, self.height)))
    }
}

/// The texture coordinates of the centre of a texel.
pub(super) fn centre(index: usize, width: usize, height: usize) -> Vec2 {
    let (x, y) = ((index % width) as f32 + 0.5, (index / width) as f32 + 0.5);
    Vec2::new(x / width as f32, 1.0 - y / height as f32)
}
