//! Numbers of binary files, little-endian, each checked against the end of the file.

use crate::FormatError;
use crate::bytes::text::whole_file;
use std::sync::Arc;

/// A place in a binary file.
#[derive(Clone, Copy, Debug)]
pub struct Bytes<'a> {
    bytes: &'a [u8],
    at: usize,
    file: &'a Arc<str>,
}

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8], file: &'a Arc<str>) -> Bytes<'a> {
        Bytes { bytes, at: 0, file }
    }

    /// Number of bytes before this place.
    pub fn at(&self) -> usize {
        self.at
    }

    /// Number of bytes that follow.
    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Goes to another place.
    pub fn seek(&mut self, at: u64) -> Result<(), FormatError> {
        match usize::try_from(at) {
            Ok(at) if at <= self.bytes.len() => {
                self.at = at;
                Ok(())
            }
            _ => Err(self.fail(format!(
                "it refers to byte {at}, but has {} bytes: it was cut off, or is damaged",
                self.bytes.len()
            ))),
        }
    }

    /// Bytes from the same place of a file that ends at the byte `end`, at the latest.
    pub fn until(&self, end: u64) -> Bytes<'a> {
        let end = usize::try_from(end).unwrap_or(usize::MAX).clamp(self.at, self.bytes.len());
        Bytes { bytes: &self.bytes[..end], ..*self }
    }

    /// An error about this place.
    pub fn fail(&self, message: impl std::fmt::Display) -> FormatError {
        FormatError::malformed(format!("at byte {}: {message}", self.at), whole_file(self.file))
    }

    /// The next bytes.
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], FormatError> {
        let taken = self.bytes[self.at..].get(..count).ok_or_else(|| {
            self.fail(format!(
                "{count} bytes are expected here, but only {} follow: it was cut off",
                self.left()
            ))
        })?;
        self.at += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], FormatError> {
        let taken = self.take(N)?;
        Ok(std::array::from_fn(|i| taken[i]))
    }

    pub fn u8(&mut self) -> Result<u8, FormatError> {
        self.array().map(u8::from_le_bytes)
    }

    pub fn u16(&mut self) -> Result<u16, FormatError> {
        self.array().map(u16::from_le_bytes)
    }

    pub fn u32(&mut self) -> Result<u32, FormatError> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32, FormatError> {
        self.array().map(i32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Result<u64, FormatError> {
        self.array().map(u64::from_le_bytes)
    }

    pub fn i64(&mut self) -> Result<i64, FormatError> {
        self.array().map(i64::from_le_bytes)
    }

    pub fn f32(&mut self) -> Result<f32, FormatError> {
        self.array().map(f32::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, FormatError> {
        self.array().map(f64::from_le_bytes)
    }

    /// Several numbers.
    pub fn f64s<const N: usize>(&mut self) -> Result<[f64; N], FormatError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Ok(numbers)
    }

    /// Three numbers.
    pub fn i32s(&mut self) -> Result<[i32; 3], FormatError> {
        Ok([self.i32()?, self.i32()?, self.i32()?])
    }

    /// A text after its length.
    pub fn text(&mut self) -> Result<String, FormatError> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }
}
