//! The tree as kernels see it.

use crate::bvh8::layout::Unit;
use crate::bvh8::summary::TreeSummary;

/// The tree to traverse. The root is a node or a leaf of `units`, and so is everything that it refers to.
#[derive(Clone, Copy)]
pub(in crate::bvh8) struct TreeView<'a> {
    pub(in crate::bvh8) units: &'a [Unit],
    pub(in crate::bvh8) outline: &'a TreeSummary,
}

impl<'a> TreeView<'a> {
    /// `None` for a tree without triangles.
    #[inline(always)]
    pub(in crate::bvh8) fn of(units: &'a [Unit], outline: &'a TreeSummary) -> Option<TreeView<'a>> {
        (!units.is_empty()).then_some(TreeView { units, outline })
    }
}
