//! Limits on the memory that an untrusted file may make us use.

use crate::PictureError;

/// Bounds that every reader checks before it allocates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Maximum number of bytes that one picture may take while it is decoded: the planes together with the decoder's
    /// own buffers, and (separately) the file's bytes.
    pub max_bytes: u64,
}

impl Default for Limits {
    /// 4 GiB, enough for 16,384 × 16,384 pixels of RGB.
    fn default() -> Limits {
        Limits { max_bytes: 4 << 30 }
    }
}

impl Limits {
    /// Creates limits with this many bytes.
    pub const fn new(max_bytes: u64) -> Limits {
        Limits { max_bytes }
    }

    /// Rejects a picture whose size is zero, or which would exceed the limit at `bytes_per_pixel`; returns the number
    /// of pixels.
    pub(crate) fn check(
        &self,
        format: &'static str,
        width: u64,
        height: u64,
        bytes_per_pixel: u64,
    ) -> Result<usize, PictureError> {
        if width == 0 || height == 0 {
            let what = format!("the header says {width} x {height} pixels, so there is no picture in it");
            return Err(PictureError::invalid(format, what));
        }
        let pixels = width.checked_mul(height);
        let needed = pixels.and_then(|pixels| pixels.checked_mul(bytes_per_pixel)).unwrap_or(u64::MAX);
        match pixels.and_then(|pixels| usize::try_from(pixels).ok()) {
            Some(pixels) if needed <= self.max_bytes && width.max(height) <= MAX_SIDE => Ok(pixels),
            _ => Err(PictureError::TooLarge { format, width, height, needed, limit: self.max_bytes }),
        }
    }
}

/// The maximum side length of a picture: what the coordinates of all our formats can hold.
pub(crate) const MAX_SIDE: u64 = i32::MAX as u64 / 2;

/// A zeroed buffer, or an error if the machine has no memory for it.
pub(crate) fn zeroed<T: Clone + Default>(format: &'static str, count: usize) -> Result<Vec<T>, PictureError> {
    let mut buffer = reserved(format, count)?;
    buffer.resize(count, T::default());
    Ok(buffer)
}

/// An empty buffer with capacity for `count`, or an error if the machine has no memory for it.
pub(crate) fn reserved<T>(format: &'static str, count: usize) -> Result<Vec<T>, PictureError> {
    let mut buffer = Vec::new();
    let bytes = count as u64 * size_of::<T>() as u64;
    buffer.try_reserve_exact(count).map_err(|_| PictureError::OutOfMemory { format, bytes })?;
    Ok(buffer)
}
