//! Maya's binary files: chunks of a name, a size and so many bytes, high bytes first. Those of `FOR4` count in 32 bits, those of
//! `FOR8` in 64.

use super::around::Around;
use super::file::{CacheFile, Counts};
use bilux_import::FormatError;
use bilux_import::input::reading::Reading;
use bilux_math::Vec3;

/// Longer names of channels are not looked at.
const LONGEST_NAME: u64 = 4096;

/// Gives the samples of a channel to `around`.
pub(super) fn read(
    mut file: CacheFile,
    channel: &str,
    counts: Counts,
    around: &mut Around,
    reading: &mut Reading,
) -> Result<(), FormatError> {
    let mut name = [0; 4];
    file.fill(&mut name)?;
    let is_wide = match &name {
        b"FOR4" => false,
        b"FOR8" => true,
        _ => return Err(file.error("is not a cache of Maya (FOR4 or FOR8)")),
    };
    let mut chunks = Chunks { file, is_wide };
    let (mut start, mut time, mut is_wanted) = (0.0, 0.0, false);
    loop {
        let size = chunks.size()?;
        match &name {
            b"FOR4" | b"FOR8" => {
                // What is in a group comes next.
                chunks.file.skip(4)?;
                time = start;
            }
            b"STIM" => {
                start = chunks.integer(size)?;
                time = start;
            }
            b"TIME" => time = chunks.integer(size)?,
            b"CHNM" => is_wanted = chunks.text(size)? == channel.as_bytes(),
            b"FVCA" if is_wanted && around.wants(time) => {
                let vectors = chunks.vectors(size, counts, |bytes: &[u8; 12]| floats(bytes), reading)?;
                take(around, time, vectors, reading);
            }
            b"DVCA" if is_wanted && around.wants(time) => {
                let vectors = chunks.vectors(size, counts, |bytes: &[u8; 24]| doubles(bytes), reading)?;
                take(around, time, vectors, reading);
            }
            _ => chunks.skip(size)?,
        }
        if around.is_full() || !chunks.next(&mut name)? {
            return Ok(());
        }
    }
}

fn take(around: &mut Around, time: f64, vectors: Vec<Vec3>, reading: &mut Reading) {
    let replaced = around.add(time, vectors);
    reading.budget.release(size_of_val(&replaced[..]) as u64);
}

struct Chunks {
    file: CacheFile,
    is_wide: bool,
}

impl Chunks {
    /// The name of the next chunk; false at the end of the file.
    fn next(&mut self, name: &mut [u8; 4]) -> Result<bool, FormatError> {
        let mut first = [0; 1];
        if self.file.stream.read(&mut first).unwrap_or(0) == 0 {
            return Ok(false);
        }
        let mut rest = [0; 3];
        self.file.fill(&mut rest)?;
        *name = [first[0], rest[0], rest[1], rest[2]];
        Ok(true)
    }

    /// The size of a chunk, which follows its name.
    fn size(&mut self) -> Result<u64, FormatError> {
        if self.is_wide {
            let mut bytes = [0; 12];
            self.file.fill(&mut bytes)?;
            return Ok(u64::from_be_bytes(std::array::from_fn(|i| bytes[4 + i])));
        }
        let mut bytes = [0; 4];
        self.file.fill(&mut bytes)?;
        Ok(u64::from(u32::from_be_bytes(bytes)))
    }

    /// Skips what is left of a chunk up to the next one.
    fn skip(&mut self, size: u64) -> Result<(), FormatError> {
        self.file.skip(size)?;
        self.skip_padding(size)
    }

    /// Skips the bytes between a chunk of this size and the next one.
    fn skip_padding(&mut self, size: u64) -> Result<(), FormatError> {
        let unit = if self.is_wide { 8 } else { 4 };
        self.file.skip((unit - size % unit) % unit)
    }

    fn integer(&mut self, size: u64) -> Result<f64, FormatError> {
        if size != 4 {
            return Err(self.file.error("has a time of a size that is not known: it is damaged"));
        }
        let mut bytes = [0; 4];
        self.file.fill(&mut bytes)?;
        self.skip_padding(size)?;
        Ok(f64::from(i32::from_be_bytes(bytes)))
    }

    fn text(&mut self, size: u64) -> Result<Vec<u8>, FormatError> {
        if size > LONGEST_NAME {
            self.skip(size)?;
            return Ok(Vec::new());
        }
        let mut bytes = vec![0; size as usize];
        self.file.fill(&mut bytes)?;
        self.skip_padding(size)?;
        let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
        bytes.truncate(end);
        Ok(bytes)
    }

    /// Vectors of as many bytes each, of which there have to be as many as the mesh has points or corners.
    fn vectors<const BYTES: usize>(
        &mut self,
        size: u64,
        counts: Counts,
        decode: impl Fn(&[u8; BYTES]) -> Vec3,
        reading: &mut Reading,
    ) -> Result<Vec<Vec3>, FormatError> {
        let Counts { points, corners } = counts;
        let count = [points, corners].into_iter().find(|&count| (count * BYTES) as u64 == size);
        let count = count.ok_or_else(|| {
            let stated = size / BYTES as u64;
            self.file
                .error(&format!("is of {stated} points, and the mesh has {points}: make the cache again"))
        })?;
        let vectors = self.file.vectors(count, decode, reading)?;
        self.skip_padding(size)?;
        Ok(vectors)
    }
}

fn floats(bytes: &[u8; 12]) -> Vec3 {
    let number = |i: usize| f32::from_be_bytes(std::array::from_fn(|byte| bytes[4 * i + byte]));
    Vec3::new(number(0), number(1), number(2))
}

fn doubles(bytes: &[u8; 24]) -> Vec3 {
    let number = |i: usize| f64::from_be_bytes(std::array::from_fn(|byte| bytes[8 * i + byte])) as f32;
    Vec3::new(number(0), number(1), number(2))
}
