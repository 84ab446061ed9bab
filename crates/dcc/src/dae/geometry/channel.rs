//! Values of one kind at corners: normals, texture coordinates or colours, perhaps from several sources.

use crate::dae::data::Table;
use crate::dae::document::Document;
use crate::dae::element::Element;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::meshes::polygon_mesh::{Layer, Mapping};
use roxmltree::NodeId;
use std::collections::HashMap;

/// The values of all sources of a kind, and the index of each corner's value.
pub(super) struct Channel<T> {
    values: Vec<T>,
    indices: Vec<i32>,
    /// Range of the values of each source.
    ranges: HashMap<NodeId, Range>,
}

/// Place of a range's index among the indices of a vertex, and the values that this index counts.
#[derive(Clone, Copy)]
pub(super) struct Range {
    pub(super) offset: usize,
    first: usize,
    len: usize,
}

impl Range {
    /// The place of a value among those of all sources; `None` beyond the end.
    #[inline]
    pub(super) fn place(self, vertex: &[i32]) -> Option<u32> {
        let index = usize::try_from(*vertex.get(self.offset)?).ok()?;
        (index < self.len).then(|| (self.first + index) as u32)
    }
}

impl<T: Copy> Channel<T> {
    pub(super) fn new() -> Channel<T> {
        Channel { values: Vec::new(), indices: Vec::new(), ranges: HashMap::new() }
    }

    /// The range of a source, whose values are added if they are new.
    pub(super) fn range(
        &mut self,
        source: Element,
        offset: usize,
        value: impl Fn(&[f32]) -> T,
        document: &Document,
        budget: &mut Budget,
    ) -> Result<Range, FormatError> {
        if let Some(range) = self.ranges.get(&source.key()) {
            return Ok(Range { offset, ..*range });
        }
        let table = Table::<f32>::read(source, document, budget)?;
        budget.take::<T>(table.len, source.file())?;
        let range = Range { offset, first: self.values.len(), len: table.len };
        self.values.extend(table.rows().map(value));
        self.ranges.insert(source.key(), range);
        Ok(range)
    }

    /// Adds the value of a corner, or none.
    #[inline]
    pub(super) fn push(&mut self, range: Option<Range>, vertex: &[i32]) {
        self.indices.push(range.and_then(|range| range.place(vertex)).map_or(-1, |place| place as i32));
    }

    /// All values so far.
    pub(super) fn values(&self) -> &[T] {
        &self.values
    }

    /// The values of all sources.
    pub(super) fn into_values(self) -> Vec<T> {
        self.values
    }

    /// The values as a layer by corner.
    pub(super) fn into_layer(self) -> Layer<T> {
        if self.values.is_empty() {
            return Layer::default();
        }
        Layer::indexed(self.values, self.indices, Mapping::ByCorner)
    }
}
