//! Trees in memory-mapped files.
#![allow(unsafe_code)] // Mapping; the block says why it is sound.

use super::Bvh8;
use super::kernel::{HEADER, Units};
use super::storage::{Header, StorageError};
use memmap2::Mmap;
use std::fs::File;
use std::path::Path;

impl Bvh8 {
    /// Maps a saved tree from its file: nothing is copied, so several processes can share it, and pages that are not
    /// in use can leave memory. The whole file is read once, to check it.
    ///
    /// # Errors
    /// Returns an error when the file cannot be read, is not what [`Bvh8::save`] wrote, or the machine is not
    /// little-endian.
    ///
    /// # Safety
    /// The file must not be modified or truncated while the tree or a clone of it lives.
    pub unsafe fn map(path: impl AsRef<Path>) -> Result<Bvh8, StorageError> {
        if cfg!(target_endian = "big") {
            return Err(StorageError::Damaged(
                "trees can be memory-mapped only on little-endian machines: load the \
                                              tree instead",
            ));
        }
        let file = File::open(path)?;
        // SAFETY: the caller promises that the file does not change.
        let map = unsafe { Mmap::map(&file) }?;
        let header = map.first_chunk::<HEADER>().ok_or(StorageError::NotATree)?;
        let header = Header::read(header)?;
        if map.len() as u64 != header.bytes() {
            return Err(StorageError::Length { expected: header.bytes(), found: map.len() as u64 });
        }
        Bvh8::trust(&header, Units::mapped(map))
    }
}
