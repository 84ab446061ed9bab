//! The wide tree in fewer bytes: box planes quantised to a byte each, in steps of their node, and shared triangle
//! corners.
//!
//! It takes less than half the memory of [`Bvh8`] where triangles share their corners, and rays are slower; the hits
//! are the same, to the bit. `docs/adr/0008-bvh8.md` records what was tried.

mod pack;
#[cfg(test)]
mod tests;

use super::Bvh8;
use super::kernel::{self, Compact, TreeView};
use super::layout::Unit;
use super::shape::shape;
use super::summary::TreeSummary;
use crate::CpuLevel;
use crate::accelerator::{Traverse, TreeShape};
use crate::counters::Count;
use crate::mesh::TriangleMesh;
use crate::ray::{Hit, Query, Ray};
use crate::registry::{AcceleratorEntry, BuildError, BuildOptions};
use bilux_math::{Aabb, registry::Entry};

/// Row of [`crate::ACCELERATORS`].
pub const ENTRY: AcceleratorEntry = AcceleratorEntry {
    entry: Entry {
        name: "bvh8-compact",
        summary: "8-wide BVH with quantised boxes and shared vertices: less than half of the memory, slower rays",
        source: "Ylitie 2017",
        parameters: &[],
    },
    build: |mesh, options| Ok(Box::new(CompactBvh8::new(&mesh, options)?)),
};

/// A wide bounding volume hierarchy, eight children per node, in few bytes. It answers ray queries; for everything
/// else that a tree can do, use [`Bvh8`]. The mesh need not be kept.
#[derive(Clone, Debug)]
pub struct CompactBvh8 {
    units: Vec<Unit>,
    outline: TreeSummary,
    level: CpuLevel,
}

impl CompactBvh8 {
    /// Builds a compact tree. The tree is the same whatever the number of threads.
    ///
    /// # Errors
    /// Returns an error when it, or the wide tree that it is made from, would take more than 8 GiB.
    pub fn new(mesh: &TriangleMesh, options: &BuildOptions) -> Result<CompactBvh8, BuildError> {
        CompactBvh8::pack(&Bvh8::new(mesh, options)?)
    }

    /// Packs an existing wide tree.
    ///
    /// # Errors
    /// Returns an error when it would take more than 8 GiB.
    pub fn pack(wide: &Bvh8) -> Result<CompactBvh8, BuildError> {
        let (units, root) = pack::pack(&wide.units, wide.outline.root)?;
        Ok(CompactBvh8 { units, outline: TreeSummary { root, ..wide.outline }, level: wide.level })
    }

    #[inline(always)]
    fn view(&self) -> Option<TreeView<'_>> {
        TreeView::of(&self.units, &self.outline)
    }
}

impl Traverse for CompactBvh8 {
    #[inline(always)]
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        kernel::closest::<Compact, C>(self.level, self.view()?, ray, query, count)
    }

    #[inline(always)]
    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        count.ray();
        self.view()
            .is_some_and(|view| kernel::any::<Compact, C>(self.level, view, ray, query, count).is_some())
    }

    fn bounds(&self) -> Aabb {
        self.outline.bounds()
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&*self.units)
    }

    fn shape(&self) -> TreeShape {
        shape::<Compact>(self.view())
    }
}
