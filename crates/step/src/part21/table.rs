//! The instances of a file by their numbers.

use super::value::{Piece, Value, Values};
use bilux_import::input::diagnostics::Diagnostics;
use bilux_scene::Span;
use std::collections::HashMap;
use std::sync::Arc;

/// A record: a name and its parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Record {
    pub(super) name: Piece,
    pub(super) first: u32,
    pub(super) count: u32,
}

/// An instance: one record, or several of a complex one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instance {
    pub(super) first: u32,
    pub(super) count: u32,
    /// Offset of the instance in the file.
    pub(super) offset: u32,
}

/// Contents of a file.
pub(crate) struct Table<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) file: Arc<str>,
    pub(super) values: Vec<Value>,
    pub(super) records: Vec<Record>,
    pub(super) header: Vec<Record>,
    pub(super) instances: HashMap<u64, Instance>,
    /// The numbers of the instances in the order of the file.
    pub(super) order: Vec<u64>,
    /// True if the file has its end.
    pub(crate) is_whole: bool,
    /// Faults that were found while the file was read.
    pub(super) faults: Diagnostics,
}

impl<'a> Table<'a> {
    fn values_of(&self, record: &Record) -> Values<'_> {
        Values { bytes: self.bytes, all: &self.values, first: record.first, count: record.count }
    }

    fn records_of(&self, id: u64) -> &[Record] {
        let Some(instance) = self.instances.get(&id) else { return &[] };
        let first = instance.first as usize;
        self.records.get(first..first + instance.count as usize).unwrap_or_default()
    }

    /// The name of an instance's entity, of several the first; empty if there is no such instance.
    pub(crate) fn kind(&self, id: u64) -> &'a [u8] {
        self.records_of(id).first().map_or(&[], |record| record.name.of(self.bytes))
    }

    /// The parameters of an instance's part with this name.
    pub(crate) fn part(&self, id: u64, name: &str) -> Option<Values<'_>> {
        let records = self.records_of(id);
        let found = records.iter().find(|record| record.name.of(self.bytes) == name.as_bytes());
        found.map(|record| self.values_of(record))
    }

    /// True if an instance has a part with this name.
    pub(crate) fn is(&self, id: u64, name: &str) -> bool {
        self.part(id, name).is_some()
    }

    /// The parameters of an instance that is one record.
    pub(crate) fn simple(&self, id: u64) -> Option<Values<'_>> {
        match self.records_of(id) {
            [record] => Some(self.values_of(record)),
            _ => None,
        }
    }

    /// The parameters of all parts of an instance.
    pub(crate) fn parts(&self, id: u64) -> impl Iterator<Item = (&'a [u8], Values<'_>)> {
        self.records_of(id).iter().map(|record| (record.name.of(self.bytes), self.values_of(record)))
    }

    /// All instances that have a part with this name, in the order of the file.
    pub(crate) fn all<'t>(&'t self, name: &'t str) -> impl Iterator<Item = (u64, Values<'t>)> {
        self.order.iter().filter_map(move |&id| Some((id, self.part(id, name)?)))
    }

    /// All instances with the names of their parts, in the order of the file.
    pub(crate) fn ids(&self) -> &[u64] {
        &self.order
    }

    /// A record of the header.
    pub(crate) fn header(&self, name: &str) -> Option<Values<'_>> {
        let found = self.header.iter().find(|record| record.name.of(self.bytes) == name.as_bytes());
        found.map(|record| self.values_of(record))
    }

    /// Place of an instance in the file.
    pub(crate) fn span(&self, id: u64) -> Span {
        let offset = self.instances.get(&id).map_or(0, |instance| instance.offset as usize);
        place(self.bytes, &self.file, offset)
    }

    /// The file's name, for messages.
    pub(crate) fn file(&self) -> Arc<str> {
        self.file.clone()
    }

    pub(crate) fn take_faults(&mut self) -> Diagnostics {
        std::mem::take(&mut self.faults)
    }
}

/// The line and the column of an offset.
pub(super) fn place(bytes: &[u8], file: &Arc<str>, offset: usize) -> Span {
    let before = &bytes[..offset.min(bytes.len())];
    let line = before.iter().filter(|&&byte| byte == b'\n').count() + 1;
    let start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1);
    Span { file: file.clone(), line: line as u32, column: (before.len() - start + 1) as u32 }
}
