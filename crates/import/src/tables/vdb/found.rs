//! Contents of the tree of a grid, as smoke or as a surface.

use crate::FormatError;
use crate::bytes::budget::Budget;
use crate::bytes::text::whole_file;
use crate::input::reading::Source;
use crate::tables::grids::{Placed, ReadLeaf, Sparse, Volume};
use bilux_scene::Mesh;

/// A tree that has been read, but for the values of its leaves.
pub(super) struct Found<'a> {
    pub(super) sparse: Sparse,
    pub(super) placed: Placed<'a>,
    pub(super) background: f32,
}

impl Found<'_> {
    pub(super) fn volume(
        self,
        source: &Source,
        budget: &mut Budget,
        leaf: &mut ReadLeaf,
    ) -> Result<Volume, FormatError> {
        let volume = self.sparse.into_volume(&self.placed, source, budget, leaf)?;
        let message = || format!("the grid '{}' has no voxels with values", self.placed.name);
        let volume = volume.ok_or_else(|| FormatError::malformed(message(), whole_file(source.name)))?;
        Ok(Volume { background: self.background, ..volume })
    }

    /// The surface of a level set, if it has one.
    pub(super) fn surface(
        self,
        source: &Source,
        budget: &mut Budget,
        leaf: &mut ReadLeaf,
    ) -> Result<Option<Mesh>, FormatError> {
        self.sparse.into_surface(&self.placed, source, budget, leaf)
    }
}
