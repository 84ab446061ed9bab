//! A bounding volume hierarchy with eight children per node: the fast one.
//!
//! Nodes hold eight boxes, axis by axis, so that one instruction tests all of them; leaves hold triangles in blocks
//! of four, for the same reason. `docs/adr/0008-bvh8.md` records what was tried.

mod build;
mod compact;
mod compact_layout;
mod kernel;
mod layout;
mod mapped;
mod near;
mod overlap;
mod refit;
mod shape;
mod storage;
mod summary;
#[cfg(test)]
mod tests;

use crate::CpuLevel;
use crate::accelerator::{Traverse, TreeShape};
use crate::counters::Count;
use crate::mesh::TriangleMesh;
use crate::ray::{Hit, Primitive, Query, Ray};
use crate::registry::{AcceleratorEntry, BuildError, BuildOptions};
use bilux_math::{Aabb, registry::Entry};
use kernel::{Blocker, TreeView, Units, Wide};
use shape::shape;
use summary::TreeSummary;

/// Rays whose answers are collected before they are handed on.
const RAYS_AT_A_TIME: usize = 64;

pub use compact::{CompactBvh8, ENTRY as COMPACT};
pub use near::NearestPoint;
pub use refit::RefitError;
pub use storage::StorageError;

/// Row of [`crate::ACCELERATORS`].
pub const ENTRY: AcceleratorEntry = AcceleratorEntry {
    entry: Entry {
        name: "bvh8",
        summary: "8-wide bounding volume hierarchy with SIMD traversal: the fastest",
        source: "Wald 2008",
        parameters: &[],
    },
    build: |mesh, options| Ok(Box::new(Bvh8::new(&mesh, options)?)),
};

/// A wide bounding volume hierarchy, with eight children per node.
#[derive(Clone, Debug)]
pub struct Bvh8 {
    units: Units,
    outline: TreeSummary,
    level: CpuLevel,
}

impl Bvh8 {
    /// Builds a hierarchy. The tree is the same whatever the number of threads.
    ///
    /// # Errors
    /// Returns an error when it would take more than 8 GiB.
    pub fn new(mesh: &TriangleMesh, options: &BuildOptions) -> Result<Bvh8, BuildError> {
        let built = build::build(mesh, options.quality)?;
        let outline = TreeSummary::new(built.root, built.planes);
        Ok(Bvh8 { units: Units::from(built.units), outline, level: options.cpu_level.available() })
    }

    #[inline(always)]
    fn view(&self) -> Option<TreeView<'_>> {
        TreeView::of(&self.units, &self.outline)
    }

    /// Answers each ray by what blocks it.
    fn each_blocker<A>(&self, rays: &[Ray], query: &Query, answers: &mut [A], answer: impl Fn(Blocker) -> A) {
        let mut blockers = [None; RAYS_AT_A_TIME];
        for (rays, answers) in rays.chunks(RAYS_AT_A_TIME).zip(answers.chunks_mut(RAYS_AT_A_TIME)) {
            if let Some(view) = self.view() {
                kernel::any_each(self.level, view, rays, query, &mut blockers[..answers.len()]);
            }
            answers.iter_mut().zip(rays).zip(&blockers).for_each(|((it, _), blocker)| *it = answer(*blocker));
        }
    }
}

impl Traverse for Bvh8 {
    #[inline(always)]
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        kernel::closest::<Wide, C>(self.level, self.view()?, ray, query, count)
    }

    #[inline(always)]
    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        count.ray();
        self.view().is_some_and(|view| kernel::any::<Wide, C>(self.level, view, ray, query, count).is_some())
    }

    fn closest_each(&self, rays: &[Ray], query: &Query, hits: &mut [Option<Hit>]) {
        match self.view() {
            Some(view) => kernel::closest_each(self.level, view, rays, query, hits),
            None => hits.iter_mut().zip(rays).for_each(|(hit, _)| *hit = None),
        }
    }

    fn blocker_each(&self, rays: &[Ray], query: &Query, blockers: &mut [Option<Primitive>]) {
        let on = |blocker| Primitive { instance: 0, index: kernel::primitive(blocker) };
        self.each_blocker(rays, query, blockers, |blocker| blocker.map(on));
    }

    fn any_each(&self, rays: &[Ray], query: &Query, hits: &mut [bool]) {
        self.each_blocker(rays, query, hits, |blocker| blocker.is_some());
    }

    fn bounds(&self) -> Aabb {
        self.outline.bounds()
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(&*self.units)
    }

    fn shape(&self) -> TreeShape {
        shape::<Wide>(self.view())
    }
}
