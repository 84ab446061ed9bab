//! The numbers in a document's buffers, and what reading them costs.

use crate::document::accessor::Accessor;
use crate::document::json::JsonNode;
use crate::document::json_document::Document;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_scene::Span;

/// Reads a document's data within the memory that is left, and notes what is odd about them.
pub(crate) struct DataReader<'d, 'r> {
    pub(crate) document: &'d Document<'d>,
    pub(crate) budget: &'r mut Budget,
    pub(crate) diagnostics: &'r mut Diagnostics,
}

impl<'d, 'r> DataReader<'d, 'r> {
    pub(crate) fn new(
        document: &'d Document<'d>,
        budget: &'r mut Budget,
        diagnostics: &'r mut Diagnostics,
    ) -> DataReader<'d, 'r> {
        DataReader { document, budget, diagnostics }
    }

    /// The accessor that `index` names.
    pub(crate) fn accessor(&mut self, index: JsonNode<'d>) -> Result<Accessor<'d>, FormatError> {
        Accessor::named(self.document, index, self.budget)
    }

    /// The elements of an attribute, one for each vertex if there are `count` of them.
    pub(crate) fn attribute<const N: usize>(
        &mut self,
        index: JsonNode<'d>,
        count: Option<usize>,
    ) -> Result<Vec<[f32; N]>, FormatError> {
        let accessor = self.accessor(index)?;
        check_count(index, &accessor, count)?;
        accessor.floats(self.budget)
    }

    /// Takes memory for what is made of the data.
    pub(crate) fn take_bytes(&mut self, bytes: u64) -> Result<(), FormatError> {
        self.budget.take_bytes(bytes, self.document.file())
    }

    pub(crate) fn note(&mut self, what: &str, at: impl FnOnce() -> Span) {
        self.diagnostics.note(what, at);
    }
}

/// Refuses an attribute that does not have one element for each vertex.
pub(crate) fn check_count(
    index: JsonNode,
    accessor: &Accessor,
    count: Option<usize>,
) -> Result<(), FormatError> {
    match count {
        Some(count) if count != accessor.count => Err(index.error(format!(
            "this attribute has {} elements for {count} vertices: the numbers must be equal",
            accessor.count
        ))),
        _ => Ok(()),
    }
}
