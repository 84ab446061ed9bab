//! Films as pictures, and lossless partial films: their sums are stored as integer layers of an EXR.

use crate::film::error::FilmError;
use crate::film::failures::PixelFailures;
use crate::film::limits::{MAX_SAMPLES, SAMPLE_BITS};
use crate::film::window::{Coverage, Window};
use crate::film::{Film, zeroed};
use bilux_pictures::{Crop, Picture};
use std::ops::Range;
use std::str::FromStr;

/// Marks a picture as a partial film, and gives the version of its layout.
const FORMAT: (&str, &str) = ("bilux.film", "1");

/// More pieces than any sane set of parts has; keeps checks of untrusted files short.
const MAX_PIECES: usize = 4096;

/// The names of the sums' planes: the lower and the upper halves of each channel.
const SUMS: [[&str; 2]; 3] =
    [["sum.R.low", "sum.R.high"], ["sum.G.low", "sum.G.high"], ["sum.B.low", "sum.B.high"]];

const SAMPLES: &str = "samples";

/// Names of the same planes for splats, where there are any.
const SPLATS: [[&str; 2]; 3] =
    [["splats.R.low", "splats.R.high"], ["splats.G.low", "splats.G.high"], ["splats.B.low", "splats.B.high"]];

const ITERATIONS: &str = "iterations";

const FAILURE_PLANES: [&str; 4] =
    ["bad.non_finite", "bad.first_non_finite", "bad.overflowed", "bad.first_overflowed"];

impl Film {
    /// The whole film as a linear picture; black where there are no samples.
    ///
    /// # Errors
    /// When there is not enough memory.
    pub fn to_picture(&self) -> Result<Picture, FilmError> {
        Ok(Picture::from_rgb(self.width() as usize, self.height() as usize, self.to_rgb())?)
    }

    /// A part of the film as a linear picture; black outside the film's own window.
    ///
    /// # Errors
    /// When there is not enough memory.
    pub fn window_to_picture(&self, window: Window) -> Result<Picture, FilmError> {
        let pixels =
            (0..window.pixels()).map(|i| window.position(i)).map(|(x, y)| self.pixel(x, y)).collect();
        let mut picture = Picture::from_rgb(window.width as usize, window.height as usize, pixels)?;
        picture.crop = self.place_of(window);
        Ok(picture)
    }

    /// The place of its window, unless that is the whole film.
    pub fn crop(&self) -> Option<Crop> {
        self.place_of(self.window())
    }

    fn place_of(&self, window: Window) -> Option<Crop> {
        let crop = Crop {
            x: window.x as usize,
            y: window.y as usize,
            whole: [self.width() as usize, self.height() as usize],
        };
        (window != Window::whole(self.width(), self.height())).then_some(crop)
    }

    /// The film's window with everything that [`Film::from_partial`] needs to continue from here, to be written as EXR.
    /// Other programs see an ordinary picture.
    ///
    /// # Errors
    /// When there is not enough memory.
    pub fn to_partial(&self) -> Result<Picture, FilmError> {
        let mut picture = self.window_to_picture(self.window())?;
        push_sums(&mut picture, SUMS, &self.sums)?;
        picture.push_integer_plane(SAMPLES, self.counts.clone())?;
        if !self.splats.is_empty() {
            push_sums(&mut picture, SPLATS, &self.splats)?;
            picture.push_integer_plane(ITERATIONS, self.iterations.clone())?;
        }
        if !self.failures.is_empty() {
            for (field, name) in FAILURE_PLANES.into_iter().enumerate() {
                let plane = self.failures.iter().map(|t| t.to_array()[field]).collect();
                picture.push_integer_plane(name, plane)?;
            }
        }
        let mut note = |key: &str, value: String| picture.metadata.insert(key.to_owned(), value);
        note(FORMAT.0, FORMAT.1.to_owned());
        note("bilux.size", format!("{},{}", self.width(), self.height()));
        note("bilux.window", self.window().to_string());
        note("bilux.scale_exponent", self.scale_exponent().to_string());
        note("bilux.fingerprint", self.fingerprint.clone());
        note("bilux.coverage", coverage_text(self.coverage()));
        Ok(picture)
    }

    /// Drops the samples of pixels that its coverage does not state, as a part has to that is merged with others.
    pub fn keep_covered(&mut self) {
        let mut is_covered = vec![false; self.window.pixels()];
        for (window, _) in self.coverage.pieces() {
            let pixels = (0..window.pixels()).map(|i| window.position(i));
            for i in pixels.filter_map(|(x, y)| self.window.index(x, y)) {
                is_covered[i] = true;
            }
        }
        for (i, _) in is_covered.into_iter().enumerate().filter(|(_, is_covered)| !is_covered) {
            (self.sums[i], self.counts[i]) = ([0; 3], 0);
            if let Some(failures) = self.failures.get_mut(i) {
                *failures = PixelFailures::default();
            }
        }
    }

    /// The film that [`Film::to_partial`] was made from.
    ///
    /// # Errors
    /// When the picture is not a partial film, or states impossible values.
    pub fn from_partial(picture: &Picture) -> Result<Film, FilmError> {
        let text = |key: &str| match picture.metadata.get(key) {
            Some(text) => Ok(text.as_str()),
            None => Err(not_a_film(format!("it has no metadata '{key}'"))),
        };
        if text(FORMAT.0)? != FORMAT.1 {
            return Err(not_a_film(format!(
                "it has version '{}', but this program reads '1'",
                text(FORMAT.0)?
            )));
        }
        let [width, height] = numbers(text("bilux.size")?)?;
        let window = window_of(text("bilux.window")?)?;
        let [scale_exponent] = numbers::<i32, 1>(text("bilux.scale_exponent")?)?;
        if (window.width as usize, window.height as usize) != (picture.width(), picture.height()) {
            return Err(not_a_film(format!("its window {window} does not match the picture's size")));
        }
        let mut film = Film::windowed(width, height, window, scale_exponent)?;
        film.fingerprint = text("bilux.fingerprint")?.to_owned();
        film.coverage = coverage_of(text("bilux.coverage")?, &window)?;
        film.read_planes(picture)?;
        Ok(film)
    }

    fn read_planes(&mut self, picture: &Picture) -> Result<(), FilmError> {
        let plane = |name: &str| match picture.integer_plane(name) {
            Some(plane) => Ok(plane),
            None => Err(not_a_film(format!("it has no integer layer '{name}'"))),
        };
        let read_sums = |names: [[&str; 2]; 3], sums: &mut [[i64; 3]]| {
            for (channel, [low, high]) in names.into_iter().enumerate() {
                let halves = plane(low)?.iter().zip(plane(high)?);
                for (sum, (low, high)) in sums.iter_mut().zip(halves) {
                    sum[channel] = (u64::from(*high) << 32 | u64::from(*low)) as i64;
                }
            }
            Ok::<_, FilmError>(())
        };
        read_sums(SUMS, &mut self.sums)?;
        if picture.integer_plane(ITERATIONS).is_some() {
            self.make_room_for_splats()?;
            read_sums(SPLATS, &mut self.splats)?;
            self.iterations.copy_from_slice(plane(ITERATIONS)?);
        }
        self.counts.copy_from_slice(plane(SAMPLES)?);
        self.check_sums()?;
        if picture.integer_plane(FAILURE_PLANES[0]).is_some() {
            let planes = [
                plane(FAILURE_PLANES[0])?,
                plane(FAILURE_PLANES[1])?,
                plane(FAILURE_PLANES[2])?,
                plane(FAILURE_PLANES[3])?,
            ];
            self.failures = zeroed(self.counts.len())?;
            for (i, failures) in self.failures.iter_mut().enumerate() {
                *failures = PixelFailures::from_array(planes.map(|plane| plane[i]));
            }
        }
        Ok(())
    }
}

impl Film {
    /// Refuses sums that no samples can have.
    pub(crate) fn check_sums(&self) -> Result<(), FilmError> {
        let wrong = |what: &str, i: usize| {
            let (x, y) = self.window().position(i);
            Err(not_a_film(format!("its {what} at pixel {x},{y} are invalid")))
        };
        if let Some(i) = self.iterations.iter().position(|&count| count > MAX_SAMPLES) {
            return wrong("iterations", i);
        }
        let is_wrong = |(&count, sums): (&u32, &[i64; 3])| {
            let most = u64::from(count) << SAMPLE_BITS;
            count > MAX_SAMPLES || sums.iter().any(|sum| sum.unsigned_abs() > most)
        };
        match self.counts.iter().zip(&self.sums).position(is_wrong) {
            Some(i) => wrong("sums", i),
            None => Ok(()),
        }
    }
}

fn push_sums(picture: &mut Picture, names: [[&str; 2]; 3], sums: &[[i64; 3]]) -> Result<(), FilmError> {
    let half = |channel: usize, shift: u32| {
        sums.iter().map(|sum| (sum[channel] >> shift) as u32).collect::<Vec<u32>>()
    };
    for (channel, [low, high]) in names.into_iter().enumerate() {
        picture.push_integer_plane(low, half(channel, 0))?;
        picture.push_integer_plane(high, half(channel, 32))?;
    }
    Ok(())
}

impl PixelFailures {
    pub(crate) fn to_array(self) -> [u32; 4] {
        [self.non_finite, self.first_non_finite, self.overflowed, self.first_overflowed]
    }

    pub(crate) fn from_array(
        [non_finite, first_non_finite, overflowed, first_overflowed]: [u32; 4],
    ) -> PixelFailures {
        PixelFailures { non_finite, first_non_finite, overflowed, first_overflowed }
    }
}

/// Formats a coverage, such as `0,0,64,64:0..16;64,0,64,64:0..8`.
pub(crate) fn coverage_text(coverage: &Coverage) -> String {
    let piece =
        |(window, samples): &(Window, Range<u32>)| format!("{window}:{}..{}", samples.start, samples.end);
    coverage.pieces().iter().map(piece).collect::<Vec<_>>().join(";")
}

pub(crate) fn coverage_of(text: &str, within: &Window) -> Result<Coverage, FilmError> {
    let wrong = || not_a_film(format!("its coverage is not in the form that a film writes: '{:.80}'", text));
    let mut coverage = Coverage::default();
    for (i, piece) in text.split(';').filter(|piece| !piece.is_empty()).enumerate() {
        let (window, range) = piece.split_once(':').ok_or_else(wrong)?;
        let (start, end) = range.split_once("..").ok_or_else(wrong)?;
        let (window, samples) = (window_of(window)?, parse(start)?..parse(end)?);
        if i >= MAX_PIECES || !within.contains(&window) || samples.end > MAX_SAMPLES {
            return Err(wrong());
        }
        let mut one = Coverage::default();
        one.insert(window, samples);
        if one.overlap(&coverage).is_some() {
            return Err(wrong());
        }
        coverage.extend(&one);
    }
    Ok(coverage)
}

fn window_of(text: &str) -> Result<Window, FilmError> {
    let [x, y, width, height] = numbers(text)?;
    Ok(Window { x, y, width, height })
}

fn numbers<T: FromStr, const N: usize>(text: &str) -> Result<[T; N], FilmError> {
    let parts: Vec<T> = text.split(',').map(parse).collect::<Result<_, _>>()?;
    parts.try_into().map_err(|_| not_a_film(format!("'{text:.40}' should be {N} numbers")))
}

fn parse<T: FromStr>(text: &str) -> Result<T, FilmError> {
    text.parse().map_err(|_| not_a_film(format!("'{text:.40}' should be a number")))
}

pub(crate) fn not_a_film(what: String) -> FilmError {
    FilmError::NotAFilm { what }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Rgb;
    use bilux_pictures::{Limits, WriteOptions, read_crop_bytes, write_bytes};

    fn film(window: Window) -> Film {
        let mut film = Film::windowed(9, 7, window, 30).unwrap();
        film.fingerprint = "a scene".to_owned();
        for i in 0..window.pixels() {
            let (x, y) = window.position(i);
            film.add(x, y, 0, Rgb::new(x as f32 * 0.1, -0.3, 1.0 / (y + 1) as f32));
        }
        film.cover(window, 0..1);
        film
    }

    #[test]
    fn a_partial_film_comes_back_from_exr_to_the_bit() {
        let mut film = film(Window { x: 2, y: 1, width: 4, height: 3 });
        film.add(3, 2, 1, Rgb::grey(f32::NAN));
        let bytes = write_bytes("exr", &film.to_partial().unwrap(), &WriteOptions::default()).unwrap();
        let read = read_crop_bytes(&bytes, None, &Limits::default()).unwrap();
        let back = Film::from_partial(&read).unwrap();
        assert_eq!(back, film);
        assert_eq!(back.sample_failures(), film.sample_failures());
    }

    #[test]
    fn parts_merge_in_any_order_to_the_whole() {
        let whole = film(Window::whole(9, 7));
        let parts: Vec<Film> = Window::whole(9, 7).tiles(4).into_iter().map(film).collect();
        for rotated in 0..parts.len() {
            let order = parts.iter().cycle().skip(rotated).take(parts.len());
            let merged = order.cloned().reduce(|mut a, b| {
                a.merge(&b).unwrap();
                a
            });
            assert_eq!(merged.unwrap(), whole);
        }
    }

    #[test]
    fn mismatched_parts_are_refused() {
        let left = Window { x: 0, y: 0, width: 5, height: 7 };
        let right = Window { x: 4, y: 0, width: 5, height: 7 };
        let error = film(left).merge(&film(right)).unwrap_err();
        assert!(error.to_string().contains("samples 0..1 of the pixels 4,0,1,7"), "{error}");
        let mut other = film(Window { x: 5, y: 0, width: 4, height: 7 });
        other.fingerprint = "another scene".to_owned();
        assert!(matches!(film(left).merge(&other), Err(FilmError::OtherPicture)));
        let larger = Film::new(10, 7, 30).unwrap();
        assert!(matches!(film(left).merge(&larger), Err(FilmError::OtherSize { .. })));
    }

    #[test]
    fn other_pictures_and_lies_are_refused() {
        let plain = Picture::from_rgb(2, 1, vec![Rgb::WHITE; 2]).unwrap();
        assert!(matches!(Film::from_partial(&plain), Err(FilmError::NotAFilm { .. })));
        let honest = film(Window::whole(9, 7)).to_partial().unwrap();
        for (key, lie) in [
            ("bilux.size", "4294967295,4294967295"),
            ("bilux.size", "9"),
            ("bilux.window", "4294967295,0,9,7"),
            ("bilux.scale_exponent", "x"),
            ("bilux.coverage", "0,0,9,7:0..1;8,6,1,1:0..1"),
            ("bilux.coverage", "0,0,90,7:0..1"),
            ("bilux.film", "2"),
        ] {
            let mut picture = honest.clone();
            picture.metadata.insert(key.to_owned(), lie.to_owned());
            assert!(Film::from_partial(&picture).is_err(), "{key} = {lie}");
        }
    }
}
