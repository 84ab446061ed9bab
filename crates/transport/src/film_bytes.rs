//! Films as plain bytes, to be sent between processes: faster than an EXR, and for nobody else to read.

use crate::error::FilmError;
use crate::failures::PixelFailures;
use crate::film::{Film, zeroed};
use crate::partial::{coverage_of, coverage_text, not_a_film};
use crate::window::Window;

/// What the bytes begin with, and the version of their form.
const MAGIC: &[u8; 12] = b"bilux film 1";

/// The maximum length of the texts in a film, in bytes.
const MAX_TEXT: usize = 1 << 20;

impl Film {
    /// All of the film as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let pixels = self.window().pixels();
        let mut bytes = Vec::with_capacity(64 + pixels * 56);
        bytes.extend_from_slice(MAGIC);
        let Window { x, y, width, height } = self.window();
        let has = [!self.splats.is_empty(), !self.failures.is_empty()].map(u32::from);
        let numbers = [self.width(), self.height(), x, y, width, height, has[0], has[1]];
        numbers.iter().for_each(|number| bytes.extend_from_slice(&number.to_le_bytes()));
        bytes.extend_from_slice(&self.scale_exponent().to_le_bytes());
        for text in [self.fingerprint.clone(), coverage_text(self.coverage())] {
            bytes.extend_from_slice(&(text.len() as u32).to_le_bytes());
            bytes.extend_from_slice(text.as_bytes());
        }
        let sums = |bytes: &mut Vec<u8>, sums: &[[i64; 3]]| {
            sums.iter().for_each(|sum| bytes.extend_from_slice(sum.map(i64::to_le_bytes).as_flattened()));
        };
        let counts = |bytes: &mut Vec<u8>, counts: &[u32]| {
            counts.iter().for_each(|count| bytes.extend_from_slice(&count.to_le_bytes()));
        };
        sums(&mut bytes, &self.sums);
        counts(&mut bytes, &self.counts);
        sums(&mut bytes, &self.splats);
        counts(&mut bytes, &self.iterations);
        self.failures.iter().for_each(|failures| counts(&mut bytes, &failures.to_array()));
        bytes
    }

    /// The film of these bytes.
    ///
    /// # Errors
    /// When they are not those of a film, or state impossible values.
    pub fn from_bytes(bytes: &[u8]) -> Result<Film, FilmError> {
        let mut rest = Rest(bytes);
        if rest.take(MAGIC.len())? != MAGIC {
            return Err(not_a_film("its bytes do not begin as those of this version of Bilux do".to_owned()));
        }
        let [width, height, x, y, columns, rows, has_splats, has_failures] = rest.numbers()?;
        let [scale_exponent] = rest.numbers()?;
        let (fingerprint, coverage) = (rest.text()?, rest.text()?);
        let window = Window { x, y, width: columns, height: rows };
        let pixels = window.pixels();
        let bytes_each = 28 * (1 + usize::from(has_splats != 0)) + 16 * usize::from(has_failures != 0);
        if pixels.checked_mul(bytes_each) != Some(rest.0.len()) || has_splats.max(has_failures) > 1 {
            return Err(not_a_film(format!("{} bytes are not the pixels of {window}", rest.0.len())));
        }
        let mut film = Film::windowed(width, height, window, scale_exponent as i32)?;
        if film.scale_exponent() != scale_exponent as i32 {
            return Err(not_a_film(format!("its scale {} is invalid", scale_exponent as i32)));
        }
        film.fingerprint = fingerprint;
        film.coverage = coverage_of(&coverage, &window)?;
        if coverage_text(film.coverage()) != coverage {
            return Err(not_a_film(format!(
                "its coverage '{coverage:.80}' is not in the form that a film writes"
            )));
        }
        rest.sums(&mut film.sums)?;
        rest.counts(&mut film.counts)?;
        if has_splats == 1 {
            film.make_room_for_splats()?;
            rest.sums(&mut film.splats)?;
            rest.counts(&mut film.iterations)?;
        }
        if has_failures == 1 {
            film.failures = zeroed(pixels)?;
            for failures in &mut film.failures {
                *failures = PixelFailures::from_array(rest.numbers()?);
            }
        }
        film.check_sums()?;
        Ok(film)
    }
}

/// Bytes that are still to be read.
struct Rest<'a>(&'a [u8]);

impl<'a> Rest<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], FilmError> {
        let Some((taken, rest)) = self.0.split_at_checked(count) else {
            return Err(not_a_film("its bytes are not complete".to_owned()));
        };
        self.0 = rest;
        Ok(taken)
    }

    fn numbers<const N: usize>(&mut self) -> Result<[u32; N], FilmError> {
        let mut numbers = [0; N];
        self.counts(&mut numbers)?;
        Ok(numbers)
    }

    fn counts(&mut self, counts: &mut [u32]) -> Result<(), FilmError> {
        let (words, _) = self.take(4 * counts.len())?.as_chunks::<4>();
        counts.iter_mut().zip(words).for_each(|(count, word)| *count = u32::from_le_bytes(*word));
        Ok(())
    }

    fn sums(&mut self, sums: &mut [[i64; 3]]) -> Result<(), FilmError> {
        let (words, _) = self.take(24 * sums.len())?.as_chunks::<8>();
        sums.iter_mut().flatten().zip(words).for_each(|(sum, word)| *sum = i64::from_le_bytes(*word));
        Ok(())
    }

    fn text(&mut self) -> Result<String, FilmError> {
        let [length] = self.numbers()?;
        let text = self.take((length as usize).min(MAX_TEXT))?;
        let text = std::str::from_utf8(text).map_err(|_| not_a_film("its text is not UTF-8".to_owned()))?;
        Ok(text.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux_math::Rgb;
    use bilux_math::hash::hash_words;

    fn film() -> Film {
        let window = Window { x: 1, y: 2, width: 3, height: 2 };
        let mut film = Film::windowed(5, 7, window, 20).unwrap();
        film.fingerprint = "a scene".to_owned();
        for (x, y) in (0..window.pixels()).map(|i| window.position(i)) {
            film.add(x, y, 0, Rgb::new(x as f32, -0.5, y as f32));
        }
        film.add(2, 2, 1, Rgb::grey(f32::NAN));
        film.make_room_for_splats().unwrap();
        film.splats[3] = [5, -6, 7];
        film.iterations.fill(2);
        film.cover(window, 0..2);
        film
    }

    #[test]
    fn a_film_comes_back_and_damage_gives_an_error_or_a_film() {
        let film = film();
        let bytes = film.to_bytes();
        assert_eq!(Film::from_bytes(&bytes).unwrap(), film);
        assert!((0..bytes.len()).all(|end| Film::from_bytes(&bytes[..end]).is_err()));
        for round in 0..5000u64 {
            let mut flipped = bytes.clone();
            let random = hash_words([round, 1]) as usize;
            flipped[random % bytes.len()] ^= 1 << (random >> 32 & 7);
            if let Ok(other) = Film::from_bytes(&flipped) {
                assert!(other.to_bytes() == flipped, "round {round}");
            }
        }
    }
}
