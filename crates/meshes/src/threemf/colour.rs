//! Colours of 3MF: `#RRGGBB` or `#RRGGBBAA`, in sRGB. [3MF Core 1.3, 5.1.1]

use super::xml::Element;
use bilux_import::FormatError;
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;

/// A colour in linear light, and its opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Colour {
    pub(super) rgb: Rgb,
    pub(super) alpha: f32,
}

impl Colour {
    pub(super) const WHITE: Colour = Colour { rgb: Rgb::WHITE, alpha: 1.0 };

    /// The colour of a text such as `#80FF00`.
    pub(super) fn parse(text: &str) -> Option<Colour> {
        let digits = text.trim_ascii().strip_prefix('#')?;
        if !matches!(digits.len(), 6 | 8) || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
            return None;
        }
        let all = u32::from_str_radix(digits, 16).ok()?;
        let [r, g, b, alpha] = if digits.len() == 8 { all } else { all << 8 | 0xff }.to_be_bytes();
        let channel = |byte: u8| srgb_decode(f32::from(byte) / 255.0);
        let rgb = Rgb::new(channel(r), channel(g), channel(b));
        Some(Colour { rgb, alpha: f32::from(alpha) / 255.0 })
    }
}

impl Element<'_> {
    /// A colour, if the attribute is there.
    pub(super) fn colour(&self, name: &str) -> Result<Option<Colour>, FormatError> {
        let Some(text) = self.get(name) else { return Ok(None) };
        Colour::parse(text).map(Some).ok_or_else(|| self.wrong(name, text, "a colour such as #80FF00"))
    }

    pub(super) fn need_colour(&self, name: &str) -> Result<Colour, FormatError> {
        self.need(name)?;
        self.colour(name).map(|colour| colour.unwrap_or(Colour::WHITE))
    }
}
