//! Units in memory, or in a file that is mapped into it.
#![allow(unsafe_code)] // Mapping, and reading mapped bytes as units; each block says why it is sound.

use super::Bvh8;
use super::layout::Unit;
use super::storage::{HEADER, Header, StorageError};
use memmap2::Mmap;
use std::fs::File;
use std::ops::Deref;
use std::path::Path;
use std::sync::Arc;

/// Where the units of a tree lie.
#[derive(Clone, Debug)]
pub(super) struct Units(UnitStorage);

#[derive(Clone, Debug)]
enum UnitStorage {
    Memory(Vec<Unit>),
    /// From byte [`HEADER`] on; the length was found to be a whole number of units.
    File(Arc<Mmap>),
}

impl From<Vec<Unit>> for Units {
    fn from(units: Vec<Unit>) -> Units {
        Units(UnitStorage::Memory(units))
    }
}

impl Units {
    /// Changes units: those in memory, or a copy there of what is mapped.
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
                // SAFETY: a map begins at a page, so that byte 64 is aligned as units are; every pattern of bits is
                // a unit, and only whole ones are counted.
                unsafe { std::slice::from_raw_parts(bytes.as_ptr().cast(), bytes.len() / size_of::<Unit>()) }
            }
        }
    }
}

impl Bvh8 {
    /// A tree that was saved, as it lies in its file: nothing is copied, so that several processes share it and what is
    /// not asked for leaves memory again. All of it is read once, to be checked.
    ///
    /// # Errors
    /// When it cannot be read, or is not what [`Bvh8::save`] wrote; on machines that are not little-endian.
    ///
    /// # Safety
    /// Nobody may change or cut off the file while the tree or a clone of it lives.
    pub unsafe fn map(path: impl AsRef<Path>) -> Result<Bvh8, StorageError> {
        if cfg!(target_endian = "big") {
            return Err(StorageError::Damaged("only little-endian machines can map trees: load it"));
        }
        let file = File::open(path)?;
        // SAFETY: the caller promises that the file stays as it is.
        let map = unsafe { Mmap::map(&file) }?;
        let header = map.first_chunk::<HEADER>().ok_or(StorageError::NotATree)?;
        let header = Header::read(header)?;
        if map.len() as u64 != header.bytes() {
            return Err(StorageError::Length { expected: header.bytes(), found: map.len() as u64 });
        }
        Bvh8::trust(&header, Units(UnitStorage::File(Arc::new(map))))
    }
}
