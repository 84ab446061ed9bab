//! Compressed bytes, as both decoders take them.

/// The compressed bytes end too early, are too many, or are invalid.
pub(super) struct Broken;

/// Bytes that are consumed from the front; reading past the end is an error.
pub(super) struct Bytes<'a>(pub(super) &'a [u8]);

impl<'a> Bytes<'a> {
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], Broken> {
        let (taken, left) = self.0.split_at_checked(count).ok_or(Broken)?;
        self.0 = left;
        Ok(taken)
    }

    pub(super) fn byte(&mut self) -> Result<u8, Broken> {
        Ok(self.take(1)?[0])
    }
}
