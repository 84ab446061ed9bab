//! Numbers as bytes, little endian, and back.

use crate::film::error::FilmError;

/// The maximum length of a text, in bytes.
const MAX_TEXT: usize = 1 << 20;

/// Appends whole numbers.
pub(crate) fn put_counts(bytes: &mut Vec<u8>, counts: &[u32]) {
    counts.iter().for_each(|count| bytes.extend_from_slice(&count.to_le_bytes()));
}

/// Appends sums of three channels.
pub(crate) fn put_sums(bytes: &mut Vec<u8>, sums: &[[i64; 3]]) {
    sums.iter().for_each(|sum| bytes.extend_from_slice(sum.map(i64::to_le_bytes).as_flattened()));
}

/// Appends numbers, bit for bit.
pub(crate) fn put_floats(bytes: &mut Vec<u8>, floats: &[f32]) {
    floats.iter().for_each(|float| bytes.extend_from_slice(&float.to_le_bytes()));
}

/// Appends a text with its length.
pub(crate) fn put_text(bytes: &mut Vec<u8>, text: &str) {
    bytes.extend_from_slice(&(text.len() as u32).to_le_bytes());
    bytes.extend_from_slice(text.as_bytes());
}

/// Bytes that are still to be read.
pub(crate) struct Rest<'a>(pub(crate) &'a [u8]);

impl<'a> Rest<'a> {
    pub(crate) fn take(&mut self, count: usize) -> Result<&'a [u8], FilmError> {
        let Some((taken, rest)) = self.0.split_at_checked(count) else {
            return Err(damaged("its bytes are not complete"));
        };
        self.0 = rest;
        Ok(taken)
    }

    pub(crate) fn numbers<const N: usize>(&mut self) -> Result<[u32; N], FilmError> {
        let mut numbers = [0; N];
        self.counts(&mut numbers)?;
        Ok(numbers)
    }

    pub(crate) fn counts(&mut self, counts: &mut [u32]) -> Result<(), FilmError> {
        let (words, _) = self.take(4 * counts.len())?.as_chunks::<4>();
        counts.iter_mut().zip(words).for_each(|(count, word)| *count = u32::from_le_bytes(*word));
        Ok(())
    }

    pub(crate) fn sums(&mut self, sums: &mut [[i64; 3]]) -> Result<(), FilmError> {
        let (words, _) = self.take(24 * sums.len())?.as_chunks::<8>();
        sums.iter_mut().flatten().zip(words).for_each(|(sum, word)| *sum = i64::from_le_bytes(*word));
        Ok(())
    }

    /// This many numbers; room for them is made only if they are there.
    pub(crate) fn floats(&mut self, count: usize) -> Result<Vec<f32>, FilmError> {
        let bytes = count.checked_mul(4).ok_or_else(|| damaged("its bytes are not complete"))?;
        let (words, _) = self.take(bytes)?.as_chunks::<4>();
        Ok(words.iter().map(|word| f32::from_le_bytes(*word)).collect())
    }

    pub(crate) fn text(&mut self) -> Result<String, FilmError> {
        let [length] = self.numbers()?;
        let text = self.take((length as usize).min(MAX_TEXT))?;
        let text = std::str::from_utf8(text).map_err(|_| damaged("its text is not UTF-8"))?;
        Ok(text.to_owned())
    }
}

fn damaged(what: &str) -> FilmError {
    FilmError::NotAFilm { what: what.to_owned() }
}
