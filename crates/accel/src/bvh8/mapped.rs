//! Units in memory, or in a memory-mapped file.
#![allow(unsafe_code)] // Mapping, and reading mapped bytes as units; each block says why it is sound.

use super::Bvh8;
use super::layout::Unit;
use super::storage::{HEADER, Header, StorageError};
use memmap2::Mmap;
use std::fs::File;
use std::ops::Deref;
use std::path::Path;
use std::sync::Arc;

/// Storage for the units of a tree.
#[derive(Clone, Debug)]
pub(super) struct Units(UnitStorage);

#[derive(Clone, Debug)]
enum UnitStorage {
    Memory(Vec<Unit>),
    /// From byte [`HEADER`] on; the length has been checked to be a whole number of units.
    File(Arc<Mmap>),
}

impl From<Vec<Unit>> for Units {
    fn from(units: Vec<Unit>) -> Units {
        Units(UnitStorage::Memory(units))
    }
}

impl Units {
    /// Modifies the units in memory; mapped units are first copied there.
    pub(super) fn change<T>(&mut self, work: impl FnOnce(&mut [Unit]) -> T) -> T {
        let mut units = match std::mem::replace(&mut self.0, UnitStorage::Memory(Vec::new())) {
            UnitStorage::Memory(units) => units,
            mapped @ UnitStorage::File(_) => Units(mapped).to_vec(),
        };
        let result = work(&mut units);
        self.0 = UnitStorage::Memory(units);
        result
    }
}

impl Deref for Units {
    type Target = [Unit];

    #[inline(always)]
    fn deref(&self) -> &[Unit] {
        match &self.0 {
            UnitStorage::Memory(units) => units,
            UnitStorage::File(map) => {
                let bytes = &map[HEADER..];
                // SAFETY: a map begins at a page, so byte 64 is aligned as units are; every bit pattern is a valid
                // unit, and only whole units are counted.
                unsafe { std::slice::from_raw_parts(bytes.as_ptr().cast(), bytes.len() / size_of::<Unit>()) }
            }
        }
    }
}

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
        Bvh8::trust(&header, Units(UnitStorage::File(Arc::new(map))))
    }
}
