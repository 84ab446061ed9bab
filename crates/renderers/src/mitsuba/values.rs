//! Numbers and colours as text.

use bilux_import::FormatError;
use bilux_import::appearance::spectra::Spectrum;
use bilux_import::input::names::shortened;
use bilux_math::Rgb;
use bilux_math::colour::srgb_decode;
use bilux_scene::Span;
use std::sync::Arc;

/// A colour or a spectrum as written.
#[derive(Clone, Debug)]
pub(super) enum GivenColour {
    /// One value at all wavelengths.
    Even(f32),
    Rgb(Rgb),
    /// By wavelength.
    Samples(Arc<Spectrum>),
}

/// The parts of a text between commas and spaces.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty())
}

/// A list of numbers between commas or spaces.
pub(super) fn numbers(text: &str, name: &str, at: &Span) -> Result<Vec<f64>, FormatError> {
    words(text).map(|word| number(word, name, at)).collect()
}

/// As many numbers as this; a single one stands for all.
pub(super) fn numbers_of<const N: usize>(text: &str, name: &str, at: &Span) -> Result<[f64; N], FormatError> {
    let list = numbers(text, name, at)?;
    let count = list.len();
    list.try_into().map_err(|_| {
        let message =
            format!("'{}' takes {N} number{}, not {count}", shortened(name), if N == 1 { "" } else { "s" });
        FormatError::malformed(message, at.clone())
    })
}

fn number(word: &str, name: &str, at: &Span) -> Result<f64, FormatError> {
    word.parse().map_err(|_| {
        let message = format!("'{}' must be a number, not '{}'", shortened(name), shortened(word));
        FormatError::malformed(message, at.clone())
    })
}

/// A linear RGB colour: three numbers, one for all, or hexadecimal digits, which are sRGB.
pub(super) fn rgb(text: &str, name: &str, is_curved: bool, at: &Span) -> Result<Rgb, FormatError> {
    let text = text.trim();
    let linear = |c: f32| srgb_decode(c);
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii());
    if let Some(Ok(bits)) = digits.map(|digits| u32::from_str_radix(digits, 16)) {
        let byte = |shift: u32| linear(((bits >> shift) & 255) as f32 / 255.0);
        return Ok(Rgb::new(byte(16), byte(8), byte(0)));
    }
    let colour = match *numbers(text, name, at)?.as_slice() {
        [all] => Rgb::grey(all as f32),
        [r, g, b] => Rgb::new(r as f32, g as f32, b as f32),
        ref list => {
            let message = format!("'{}' takes one number or three, not {}", shortened(name), list.len());
            return Err(FormatError::malformed(message, at.clone()));
        }
    };
    Ok(if is_curved { colour.map(linear) } else { colour })
}

/// A spectrum: a number for all wavelengths, or pairs of a wavelength and a number, as in `400:0.1, 700:0.3`.
pub(super) fn spectrum(text: &str, name: &str, at: &Span) -> Result<GivenColour, FormatError> {
    if !text.contains(':') {
        return match *numbers(text, name, at)?.as_slice() {
            [all] => Ok(GivenColour::Even(all as f32)),
            // Version 0.5 spreads a list of numbers over the visible range, of which three are a colour.
            [r, g, b] => Ok(GivenColour::Rgb(Rgb::new(r as f32, g as f32, b as f32))),
            ref list => {
                let message = format!(
                    "the spectrum '{}' has {} numbers: write pairs such as 400:0.1, 700:0.3",
                    shortened(name),
                    list.len()
                );
                Err(FormatError::malformed(message, at.clone()))
            }
        };
    }
    let pairs = words(text).map(|word| {
        let (nm, value) = word.split_once(':').unwrap_or((word, ""));
        Ok([number(nm, name, at)?, number(value, name, at)?])
    });
    samples(pairs.collect::<Result<_, FormatError>>()?, name, at)
}

/// A spectrum of pairs whose wavelengths increase.
pub(super) fn samples(pairs: Vec<[f64; 2]>, name: &str, at: &Span) -> Result<GivenColour, FormatError> {
    let fail = |message: String| Err(FormatError::malformed(message, at.clone()));
    if pairs.is_empty() || !pairs.as_flattened().iter().all(|x| x.is_finite()) {
        return fail(format!("the spectrum '{}' needs pairs of finite numbers", shortened(name)));
    }
    if let Some(pair) = pairs.windows(2).find(|pair| pair[0][0] >= pair[1][0]) {
        return fail(format!(
            "the wavelengths of the spectrum '{}' must increase, but {} is followed by {}",
            shortened(name),
            pair[0][0],
            pair[1][0]
        ));
    }
    Ok(GivenColour::Samples(Arc::new(Spectrum(pairs))))
}
