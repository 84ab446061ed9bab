//! Films as plain bytes, to be sent between processes: faster than an EXR, and for nobody else to read.

use crate::film::bytes::{Rest, put_counts, put_sums, put_text};
use crate::film::error::FilmError;
use crate::film::failures::PixelFailures;
use crate::film::partial::{coverage_of, coverage_text, not_a_film};
use crate::film::window::Window;
use crate::film::{Film, zeroed};

/// First bytes of a film, with the version of their form.
const MAGIC: &[u8; 12] = b"bilux film 1";

impl Film {
    /// All of the film as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let pixels = self.window().pixels();
        let mut bytes = Vec::with_capacity(64 + pixels * 56);
        bytes.extend_from_slice(MAGIC);
        let Window { x, y, width, height } = self.window();
        let has = [!self.splats.is_empty(), !self.failures.is_empty()].map(u32::from);
        let numbers = [self.width(), self.height(), x, y, width, height, has[0], has[1]];
        put_counts(&mut bytes, &numbers);
        bytes.extend_from_slice(&self.scale_exponent().to_le_bytes());
        put_text(&mut bytes, &self.fingerprint);
        put_text(&mut bytes, &coverage_text(self.coverage()));
        put_sums(&mut bytes, &self.sums);
        put_counts(&mut bytes, &self.counts);
        put_sums(&mut bytes, &self.splats);
        put_counts(&mut bytes, &self.iterations);
        self.failures.iter().for_each(|failures| put_counts(&mut bytes, &failures.to_array()));
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
