//! Partial renders, merged into one picture: which samples they have together, and which they lack.

pub use crate::output::metadata::ASKED;
use crate::output::metadata::{SETTINGS, SOFTWARE, is_handed_on};
use crate::{Display, Error};
use bilux_pictures::Picture;
use bilux_transport::{Coverage, Film, MergedLayers, Window};
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

/// A message lists at most so many pieces of what is missing.
const LISTED: usize = 4;

/// Merges partial renders, in any order.
#[derive(Default)]
pub struct Merging {
    joined: Option<(Film, Display)>,
    layers: MergedLayers,
    described: BTreeMap<String, String>,
    /// Samples per pixel of the whole picture, as far as the parts know them.
    asked: Option<u32>,
}

impl Merging {
    /// Adds a part.
    ///
    /// # Errors
    /// If it is no partial render, if it is one of another picture, or if another part has the same samples.
    pub fn add(&mut self, part: &Picture) -> Result<(), Error> {
        let film = Film::from_partial(part)?;
        let display = Display::recorded(part)?;
        if let Some((joined, _)) = &mut self.joined {
            joined.merge(&film)?;
        }
        self.layers.add(part, &film);
        self.joined.get_or_insert((film, display));
        self.describe(part);
        Ok(())
    }

    /// Keeps what a part says about the picture. The settings are those of the part that knows of the most samples: a
    /// picture of 64 samples can be continued to 128.
    fn describe(&mut self, part: &Picture) {
        let asked = asked_of(part);
        if asked > self.asked {
            self.asked = asked;
            self.described.remove(SETTINGS);
        }
        for (key, value) in part.metadata.iter().filter(|(key, _)| is_handed_on(key)) {
            // As EXR calls it.
            let key = if key == "software" { SOFTWARE } else { key };
            if key != SETTINGS || asked == self.asked {
                self.described.entry(key.to_owned()).or_insert_with(|| value.clone());
            }
        }
    }

    /// Samples that the parts lack of the picture: those between theirs, and those up to the number that was asked for, for every
    /// pixel.
    pub fn missing(&self) -> Missing {
        let Some((film, _)) = &self.joined else { return Missing::default() };
        let whole = Window::whole(film.width(), film.height());
        let last = film.coverage().pieces().iter().map(|(_, samples)| samples.end).max();
        let all = last.unwrap_or(0).max(self.asked.unwrap_or(0));
        Missing { whole, spp: all, lacks: film.coverage().missing(whole, 0..all) }
    }

    /// True if the parts had layers that cannot be merged.
    pub fn left_out(&self) -> bool {
        self.layers.left_out()
    }

    /// The picture, and how it is to be shown. `with_sums` keeps the layers, and the exact sums, so that it can be merged
    /// again; without them, it is black where there are no samples.
    ///
    /// # Errors
    /// If there is no part, or memory is short.
    pub fn picture(&self, with_sums: bool) -> Result<(Picture, Display), Error> {
        let nothing = || Error::Settings("there is nothing to merge: name partial renders".to_owned());
        let (film, display) = self.joined.as_ref().ok_or_else(nothing)?;
        let mut picture = if with_sums { film.to_partial()? } else { film.to_picture()? };
        if with_sums {
            display.record(&mut picture);
            self.layers.push(&mut picture, film)?;
            if let Some(asked) = self.asked {
                picture.metadata.insert(ASKED.to_owned(), asked.to_string());
            }
        } else {
            self.layers.push_coverage(&mut picture)?;
        }
        picture.metadata.extend(self.described.clone());
        // Fewer samples are not what the settings would make, and neither are more.
        let missing = self.missing();
        if !missing.is_nothing() || self.asked != Some(missing.spp) {
            picture.metadata.remove(SETTINGS);
        }
        Ok((picture, *display))
    }
}

/// Samples per pixel of the picture that a part belongs to; versions that did not record them kept its settings.
fn asked_of(part: &Picture) -> Option<u32> {
    let recorded = part.metadata.get(ASKED).and_then(|text| text.parse().ok());
    let in_settings = || {
        let mut words = part.metadata.get(SETTINGS)?.split(' ');
        words.find_map(|word| word.strip_prefix("spp=")?.parse().ok())
    };
    recorded.or_else(in_settings)
}

/// The samples that parts lack of a picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Missing {
    whole: Window,
    /// Samples per pixel of the whole picture.
    spp: u32,
    lacks: Coverage,
}

impl Missing {
    /// True if the picture is complete.
    pub fn is_nothing(&self) -> bool {
        self.lacks.pieces().is_empty()
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let piece = |(window, samples): &(Window, Range<u32>)| {
            let Range { start, end } = samples;
            let pixels =
                if *window == self.whole { String::new() } else { format!(" of the pixels {window}") };
            format!("samples {start}..{end}{pixels}")
        };
        let pieces = self.lacks.pieces();
        let listed: Vec<String> = pieces.iter().take(LISTED).map(piece).collect();
        write!(f, "{}", listed.join(" and "))?;
        if pieces.len() > LISTED {
            write!(f, " and {} more pieces", pieces.len() - LISTED)?;
        }
        write!(f, ", out of {} for each pixel", self.spp)
    }
}
