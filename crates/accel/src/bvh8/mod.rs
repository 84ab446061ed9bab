//! A bounding volume hierarchy eight children wide: the fast one.
//!
//! Nodes hold eight boxes, axis by axis, so that one instruction looks at all of them; leaves hold
//! triangles four by four, for the same reason. What was tried stands in `docs/adr/0008-bvh8.md`.

mod build;
mod kernel;
mod layout;
mod ray;

use crate::accelerator::{Traverse, TreeShape};
use crate::counters::Count;
use crate::cpu_level::CpuLevel;
use crate::mesh::TriangleMesh;
use crate::ray::{Hit, Query, Ray};
use crate::registry::{AcceleratorEntry, BuildError, BuildOptions};
use bilux_math::{Aabb, Vec3, registry::Entry};
use kernel::View;
use layout::{Ref, Unit};
use ray::WideRay;

/// Row of [`crate::ACCELERATORS`].
pub const ENTRY: AcceleratorEntry = AcceleratorEntry {
    entry: Entry {
        name: "bvh8",
        summary: "boxes in boxes, eight by eight, all eight looked at in one instruction: the fastest",
        source: "Wald 2008, Ylitie 2017",
        parameters: &[],
    },
    build: |mesh, options| Ok(Box::new(Bvh8::new(&mesh, options)?)),
};

/// Boxes around boxes around triangles, eight by eight.
#[derive(Clone, Debug)]
pub struct Bvh8 {
    units: Vec<Unit>,
    root: Ref,
    bounds: Aabb,
    level: CpuLevel,
}

impl Bvh8 {
    /// Builds one. The same tree whatever the number of threads.
    ///
    /// # Errors
    /// When it would take more than 8 GiB.
    pub fn new(mesh: &TriangleMesh, options: &BuildOptions) -> Result<Bvh8, BuildError> {
        let built = build::build(mesh)?;
        let [min, max] = built.planes.map(Vec3::from);
        let (units, root, level) = (built.units, built.root, options.cpu_level.available());
        Ok(Bvh8 { units, root, bounds: Aabb { min, max }, level })
    }

    #[inline(always)]
    fn view(&self) -> Option<View<'_>> {
        (!self.units.is_empty()).then_some(View { units: &self.units, root: self.root })
    }
}

impl Traverse for Bvh8 {
    #[inline]
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        let (view, ray) = (self.view()?, WideRay::new(ray, &self.bounds)?);
        kernel::closest(self.level, view, &ray, query, count)
    }

    #[inline]
    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        count.ray();
        let (Some(view), Some(ray)) = (self.view(), WideRay::new(ray, &self.bounds)) else { return false };
        kernel::any(self.level, view, &ray, query, count)
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.units.as_slice())
    }

    fn shape(&self) -> TreeShape {
        let mut shape = TreeShape::default();
        let mut stack = if self.units.is_empty() { Vec::new() } else { vec![(self.root, 1)] };
        while let Some((reference, depth)) = stack.pop() {
            if reference.is_node() {
                shape.nodes += 1;
                let children = layout::children(&self.units[reference.unit()..]);
                stack.extend(children.map(|(_, child)| (child, depth + 1)));
            } else {
                shape.add_leaf(depth, reference.blocks() * layout::LANES);
            }
        }
        shape
    }
}
