//! Settings that prepare the finished picture for a display, kept in the metadata of its parts: merged, they give the file that
//! one render gives.

use crate::Error;
use bilux_math::Rgb;
use bilux_pictures::{ColourSpace, Picture, ToneMapEntry, WriteOptions, auto_exposure, tone_map};
use std::str::FromStr;

const EXPOSURE: &str = "bilux.display.exposure";
const AUTO_EXPOSURE: &str = "bilux.display.auto_exposure";
const TONE_MAP: &str = "bilux.display.tonemap";
const BEHIND: &str = "bilux.display.background";
const ENCODED: &str = "bilux.display.encoded";

/// Settings that prepare a picture for a display.
#[derive(Clone, Copy, Debug)]
pub struct Display {
    /// Exposure in stops.
    pub exposure: f32,
    /// Whether the picture is also exposed automatically.
    pub auto_exposure: bool,
    /// The tone curve.
    pub tone_map: &'static ToneMapEntry,
    /// The colour behind transparent pixels.
    pub behind: Option<Rgb>,
    /// Whether the picture's values are shown as they are.
    pub encoded: bool,
}

impl Default for Display {
    fn default() -> Display {
        let WriteOptions { exposure, tone_map, behind, .. } = WriteOptions::default();
        Display { exposure, auto_exposure: false, tone_map, behind, encoded: false }
    }
}

impl Display {
    /// Keeps it in the metadata of a picture that can be merged.
    pub fn record(&self, picture: &mut Picture) {
        let mut note = |key: &str, value: String| picture.metadata.insert(key.to_owned(), value);
        note(EXPOSURE, self.exposure.to_string());
        note(AUTO_EXPOSURE, self.auto_exposure.to_string());
        note(TONE_MAP, self.tone_map.entry.name.to_owned());
        if let Some(colour) = self.behind {
            note(BEHIND, colour.to_array().map(|value| value.to_string()).join(","));
        }
        note(ENCODED, self.encoded.to_string());
    }

    /// Settings that [`Display::record`] has kept; without them, the usual ones.
    ///
    /// # Errors
    /// If a value makes no sense.
    pub fn recorded(part: &Picture) -> Result<Display, Error> {
        let curve = part.metadata.get(TONE_MAP).map(|name| tone_map(name)).transpose()?;
        let usual = Display::default();
        Ok(Display {
            exposure: value(part, EXPOSURE)?.unwrap_or(usual.exposure),
            auto_exposure: value(part, AUTO_EXPOSURE)?.unwrap_or(false),
            tone_map: curve.unwrap_or(usual.tone_map),
            behind: part.metadata.get(BEHIND).map(|text| colour(text)).transpose()?,
            encoded: value(part, ENCODED)?.unwrap_or(false),
        })
    }

    /// The exposure of this picture, in stops.
    pub fn exposure_of(&self, picture: &Picture) -> f32 {
        self.exposure + if self.auto_exposure { auto_exposure(picture) } else { 0.0 }
    }

    /// The options for writing a picture, which is marked as encoded if it is.
    pub fn options(&self, picture: &mut Picture) -> WriteOptions {
        if self.encoded {
            picture.colour_space = ColourSpace::Srgb;
        }
        let exposure = self.exposure_of(picture);
        WriteOptions { exposure, tone_map: self.tone_map, behind: self.behind, ..WriteOptions::default() }
    }
}

fn value<T: FromStr>(part: &Picture, key: &str) -> Result<Option<T>, Error> {
    let Some(text) = part.metadata.get(key) else { return Ok(None) };
    text.parse().map(Some).map_err(|_| senseless(key, text))
}

fn colour(text: &str) -> Result<Rgb, Error> {
    let values: Vec<f32> = text.split(',').filter_map(|part| part.parse().ok()).collect();
    match values[..] {
        [r, g, b] => Ok(Rgb::new(r, g, b)),
        _ => Err(senseless(BEHIND, text)),
    }
}

fn senseless(key: &str, text: &str) -> Error {
    Error::Settings(format!("its metadata '{key}' is '{text}', which makes no sense: render this part again"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recorded(notes: &[(&str, &str)]) -> Result<Display, Error> {
        let mut part = Picture::new(1, 1).expect("one pixel is not too large");
        part.metadata.extend(notes.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())));
        Display::recorded(&part)
    }

    #[test]
    fn what_is_recorded_is_read_again() {
        let all = [(EXPOSURE, "-0.3"), (TONE_MAP, "agx"), (BEHIND, "0.1,0.2,1"), (ENCODED, "true")];
        let display = recorded(&all).expect("all values make sense");
        let mut again = Picture::new(1, 1).expect("one pixel is not too large");
        display.record(&mut again);
        for (key, value) in all {
            assert_eq!(again.metadata[key], value);
        }
        assert_eq!(display.options(&mut again).exposure, -0.3);
        assert_eq!(again.colour_space, ColourSpace::Srgb);
    }

    #[test]
    fn parts_without_it_are_written_as_usual_and_broken_ones_are_refused() {
        let usual = recorded(&[]).expect("nothing is wrong with nothing");
        assert_eq!(
            (usual.exposure, usual.tone_map.entry.name),
            (0.0, WriteOptions::default().tone_map.entry.name)
        );
        for (key, value) in [(EXPOSURE, "bright"), (AUTO_EXPOSURE, "2"), (BEHIND, "1,2"), (TONE_MAP, "agxx")]
        {
            assert!(recorded(&[(key, value)]).is_err(), "{key} = {value}");
        }
    }
}
