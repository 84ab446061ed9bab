//! Nodes as a list, which both encodings fill.

use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;

/// Deeper nodes are refused; real files have about ten levels.
pub(super) const MAX_DEPTH: usize = 64;

/// Encoding of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    Binary { is_big_endian: bool },
}

/// A node.
pub(super) struct Record<'a> {
    pub(super) name: &'a [u8],
    /// Values of the node, as the file has them.
    pub(super) values: &'a [u8],
    /// Offset of the node in the file.
    pub(super) offset: usize,
    /// The index after that of its last descendant.
    pub(super) end: u32,
}

/// The nodes so far, and what they take.
pub(super) struct Builder<'a, 'b> {
    pub(super) records: Vec<Record<'a>>,
    pub(super) budget: &'b mut Budget,
    pub(super) file: &'a str,
}

impl<'a> Builder<'a, '_> {
    pub(super) fn push(
        &mut self,
        name: &'a [u8],
        values: &'a [u8],
        offset: usize,
    ) -> Result<u32, FormatError> {
        self.budget.take::<Record>(1, self.file)?;
        let index = self.records.len() as u32;
        self.records.push(Record { name, values, offset, end: index + 1 });
        Ok(index)
    }

    /// Ends a node: all that came after it are below it.
    pub(super) fn close(&mut self, index: u32) {
        self.records[index as usize].end = self.records.len() as u32;
    }
}
