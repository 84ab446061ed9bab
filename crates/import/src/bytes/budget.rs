//! Memory that a reader may still use.

use crate::FormatError;

/// Counts the memory that a reader holds against its limit.
#[derive(Clone, Debug)]
pub struct Budget {
    limit: u64,
    spent: u64,
}

impl Budget {
    pub fn new(limit: u64) -> Budget {
        Budget { limit, spent: 0 }
    }

    /// The remaining memory, in bytes.
    pub fn left(&self) -> u64 {
        self.limit - self.spent
    }

    /// Takes the memory of `count` decoded elements. Lists grow by doubling, so each element counts twice.
    #[inline]
    pub fn take<T>(&mut self, count: usize, file: &str) -> Result<(), FormatError> {
        self.take_bytes(2 * count as u64 * size_of::<T>() as u64, file)
    }

    /// Takes this many bytes.
    #[inline]
    pub fn take_bytes(&mut self, bytes: u64, file: &str) -> Result<(), FormatError> {
        match self.spent.checked_add(bytes).filter(|&spent| spent <= self.limit) {
            Some(spent) => {
                self.spent = spent;
                Ok(())
            }
            None => Err(FormatError::TooLarge {
                file: file.to_owned(),
                limit: self.limit,
                asked: self.spent.saturating_add(bytes),
            }),
        }
    }

    /// Takes bytes that had been taken before, within the same limit.
    pub fn take_again(&mut self, bytes: u64) {
        self.spent = self.spent.saturating_add(bytes).min(self.limit);
    }

    /// The bytes taken so far.
    pub fn spent(&self) -> u64 {
        self.spent
    }

    /// Returns bytes that are no longer held.
    pub fn release(&mut self, bytes: u64) {
        self.spent = self.spent.saturating_sub(bytes);
    }
}
