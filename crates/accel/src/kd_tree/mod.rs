//! A kd-tree: space divided by axis-aligned planes, triangles clipped to the cells.

mod build;
mod clip;
mod split;
mod tree;

use crate::accelerator::{Traverse, TreeShape};
use crate::counters::Count;
use crate::mesh::TriangleMesh;
use crate::ray::{Hit, Query, Ray};
use crate::registry::{AcceleratorEntry, BuildError};
use crate::slab::SlabRay;
use crate::triangle::{Nearest, PreparedRay, hits};
use bilux_math::{Aabb, registry::Entry};
use std::ops::ControlFlow;
use tree::Tree;

/// Row of [`crate::ACCELERATORS`].
pub const ENTRY: AcceleratorEntry = AcceleratorEntry {
    entry: Entry {
        name: "kd",
        summary: "k-d tree built with the surface-area heuristic: few triangle tests, slower to build",
        source: "Wald 2006",
        parameters: &[],
    },
    build: |mesh, _options| Ok(Box::new(KdTree::new(&mesh)?)),
};

/// A kd-tree by the surface-area heuristic over clipped triangles ("perfect splits") [Wald 2006].
#[derive(Clone, Debug)]
pub struct KdTree {
    tree: Tree,
    /// The triangles that leaves refer to, in the order of first reference.
    triangles: Vec<KdTriangle>,
    bounds: Aabb,
}

/// A triangle next to its index in the mesh.
#[derive(Clone, Copy, Debug)]
struct KdTriangle {
    corners: [[f32; 3]; 3],
    primitive: u32,
}

impl KdTree {
    /// Builds a kd-tree. The tree is the same whatever the number of threads.
    ///
    /// # Errors
    /// Returns an error when the tree would have more nodes or references than can be numbered.
    pub fn new(mesh: &TriangleMesh) -> Result<KdTree, BuildError> {
        let (mut tree, corners) = (build::build(mesh)?, mesh.triangles());
        let (mut triangles, mut places) = (Vec::new(), vec![u32::MAX; mesh.len()]);
        for reference in &mut tree.references {
            let primitive = *reference;
            let place = &mut places[primitive as usize];
            if *place == u32::MAX {
                *place = triangles.len() as u32;
                triangles.push(KdTriangle { corners: corners[primitive as usize], primitive });
            }
            *reference = *place;
        }
        triangles.shrink_to_fit();
        Ok(KdTree { tree, triangles, bounds: mesh.bounds() })
    }

    fn prepare(&self, ray: &Ray) -> Option<(PreparedRay, SlabRay)> {
        let prepared = PreparedRay::new(ray)?;
        let slabs = SlabRay::new(ray.origin, ray.direction, ray.t_min, prepared.pad(&self.bounds));
        Some((prepared, slabs))
    }
}

impl Traverse for KdTree {
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        let (ray, slabs) = self.prepare(ray)?;
        let mut nearest = Nearest::new(&ray.ray);
        let mut limit = slabs.limit(nearest.t);
        self.tree.walk(&slabs, &self.bounds, limit, count, |references, count| {
            count.triangles(references.len());
            let before = nearest.t;
            for &place in references {
                let triangle = &self.triangles[place as usize];
                nearest.test(&ray, query, &triangle.corners, triangle.primitive);
            }
            if query.early_out && nearest.t < before {
                limit = slabs.limit(nearest.t);
            }
            ControlFlow::Continue(limit)
        });
        nearest.hit()
    }

    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        count.ray();
        let Some((ray, slabs)) = self.prepare(ray) else { return false };
        let limit = slabs.limit(ray.ray.t_max);
        let mut found = false;
        self.tree.walk(&slabs, &self.bounds, limit, count, |references, count| {
            for &place in references {
                count.triangles(1);
                let triangle = &self.triangles[place as usize];
                if hits(&ray, query, &triangle.corners, triangle.primitive) {
                    found = true;
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(limit)
        });
        found
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn memory_bytes(&self) -> usize {
        self.tree.memory_bytes() + size_of_val(self.triangles.as_slice())
    }

    fn shape(&self) -> TreeShape {
        self.tree.shape()
    }
}
