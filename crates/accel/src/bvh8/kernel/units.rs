//! The units that kernels walk, in memory or in a memory-mapped file.

use crate::bvh8::layout::Unit;
use memmap2::Mmap;
use std::ops::Deref;
use std::sync::Arc;

/// Bytes in front of the units in a file.
pub(in crate::bvh8) const HEADER: usize = 64;

/// Storage for the units of a tree.
#[derive(Clone, Debug)]
pub(in crate::bvh8) struct Units(UnitStorage);

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
    /// Units behind the header of a file, whose length has been checked to be a whole number of them.
    pub(in crate::bvh8) fn mapped(file: Mmap) -> Units {
        Units(UnitStorage::File(Arc::new(file)))
    }

    /// Modifies the units in memory; mapped units are first copied there.
    pub(in crate::bvh8) fn change<T>(&mut self, work: impl FnOnce(&mut [Unit]) -> T) -> T {
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
