//! The setting for what is behind the scene.

use crate::Error;
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use bilux_scene::{Reader, SceneError};

/// Background: what is visible where the scene has nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// The scene's own background, or whatever lights it.
    Surroundings,
    /// Nothing: the picture gets an alpha channel.
    Transparent,
    /// One colour, put behind the picture after its tone curve, so that it comes out exactly as asked for.
    Colour(Rgb),
}

impl Background {
    /// Parses what users write: `surroundings`, `transparent`, or a colour as a screen shows it: `white`, `grey`,
    /// `black`, `#rrggbb`, or `R,G,B` from 0 to 1. Returns `None` for anything else.
    pub fn parse(text: &str) -> Option<Background> {
        match text {
            "surroundings" => Some(Background::Surroundings),
            "transparent" => Some(Background::Transparent),
            text => Some(Background::Colour(Rgb::from_array(encoded(text)?.map(srgb_decode)))),
        }
    }

    /// True if the picture gets an alpha channel that cuts the scene out of its background.
    pub(crate) fn is_cut_out(self) -> bool {
        self != Background::Surroundings
    }
}

fn encoded(text: &str) -> Option<[f32; 3]> {
    match text {
        "white" => return Some([1.0; 3]),
        "grey" | "gray" => return Some([0.5; 3]),
        "black" => return Some([0.0; 3]),
        _ => {}
    }
    if let Some(digits) = text.strip_prefix('#') {
        let is_hex = digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        let all = u32::from_str_radix(digits, 16).ok().filter(|_| is_hex)?;
        return Some([16, 8, 0].map(|shift| f32::from((all >> shift) as u8) / 255.0));
    }
    let numbers: Vec<f32> = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    <[f32; 3]>::try_from(numbers).ok().filter(|c| c.iter().all(|c| (0.0..=1.0).contains(c)))
}

/// Reads the setting `background`.
pub(super) fn background(reader: &Reader) -> Result<Background, Error> {
    let text = reader.text("background");
    let wrong = || {
        let message = format!(
            "'{text}' is not a background: write transparent, white, #rrggbb, or R,G,B from 0 to 1; for a picture, \
             use --background FILE on the command line"
        );
        SceneError::invalid(message, reader.span("background"))
    };
    let background = Background::parse(&text).ok_or_else(wrong)?;
    if background.is_cut_out() && reader.number("fog") > 0.0 {
        let message =
            "fog fills the picture, and nothing can be cut out of it: leave out --fog or --background";
        return Err(SceneError::invalid(message, reader.span("fog")).into());
    }
    Ok(background)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backgrounds_are_what_screens_show() {
        let colour = |text: &str| match Background::parse(text) {
            Some(Background::Colour(colour)) => colour.to_array(),
            other => panic!("{text}: {other:?}"),
        };
        assert_eq!(colour("white"), [1.0; 3]);
        assert_eq!(colour("#ff0000"), [1.0, 0.0, 0.0]);
        assert_eq!(colour("0, 1,0"), [0.0, 1.0, 0.0]);
        assert!((colour("#808080")[1] - 0.2158).abs() < 1e-3);
        assert_eq!(Background::parse("transparent"), Some(Background::Transparent));
        for wrong in ["", "#fff", "#gggggg", "1,2,3", "1,1", "sky.hdr", "#+12345", "nan,0,0"] {
            assert_eq!(Background::parse(wrong), None, "{wrong}");
        }
    }
}
