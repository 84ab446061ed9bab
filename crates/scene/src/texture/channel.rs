//! Channels of texels.

use bilux_math::Rgb;

/// A channel of a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha.
    A,
}

impl Channel {
    /// A colour without alpha, or one channel of it as a grey.
    #[inline]
    pub(super) fn of(channel: Option<Channel>, colour: Rgb) -> Rgb {
        match channel {
            None => colour,
            Some(Channel::R) => Rgb::grey(colour.r),
            Some(Channel::G) => Rgb::grey(colour.g),
            Some(Channel::B) => Rgb::grey(colour.b),
            Some(Channel::A) => Rgb::WHITE,
        }
    }
}
