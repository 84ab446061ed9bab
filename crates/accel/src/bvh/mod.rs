//! A binary bounding volume hierarchy: scalar, and the reference that the wide ones are tested against.

mod build;
pub(crate) mod tree;

use crate::accelerator::{Traverse, TreeShape};
use crate::counters::Count;
use crate::mesh::TriangleMesh;
use crate::ray::{Hit, Query, Ray};
use crate::registry::AcceleratorEntry;
use crate::slab::SlabRay;
use crate::triangle::{Nearest, PreparedRay, hits};
use bilux_math::{Aabb, registry::Entry};
use std::ops::ControlFlow;
use tree::Tree;

/// Row of [`crate::ACCELERATORS`].
pub const ENTRY: AcceleratorEntry = AcceleratorEntry {
    entry: Entry {
        name: "bvh",
        summary: "binary bounding volume hierarchy: fast to build, scalar traversal",
        source: "Wald 2007",
        parameters: &[],
    },
    build: |mesh, _options| Ok(Box::new(Bvh::new(&mesh))),
};

/// A hierarchy of bounding boxes around triangles, built by the binned surface-area heuristic [Wald 2007].
#[derive(Clone, Debug)]
pub struct Bvh {
    tree: Tree,
    /// In leaf order.
    triangles: Vec<LeafTriangle>,
    /// Number of triangles in the mesh, including those that are not finite.
    mesh_len: usize,
}

/// A triangle next to its index, so that a test touches one place in memory.
#[derive(Clone, Copy, Debug)]
struct LeafTriangle {
    corners: [[f32; 3]; 3],
    primitive: u32,
}

impl Bvh {
    /// Builds a hierarchy. The tree is the same whatever the number of threads.
    pub fn new(mesh: &TriangleMesh) -> Bvh {
        let (tree, order) = Tree::over(mesh.len(), |index| mesh.triangle_bounds(index));
        let corners = mesh.triangles();
        let triangles = order
            .into_iter()
            .map(|primitive| LeafTriangle { corners: corners[primitive as usize], primitive })
            .collect();
        Bvh { tree, triangles, mesh_len: mesh.len() }
    }

    /// Refits the boxes to vertices that have moved and keeps the topology. This is faster than building, and the
    /// tree stays good while the motion is small. Returns false, and changes nothing, when the number of triangles
    /// differs or other triangles are finite: in that case, rebuild.
    #[must_use]
    pub fn refit(&mut self, mesh: &TriangleMesh) -> bool {
        let is_finite = |index: u32| !mesh.triangle_bounds(index).is_empty();
        let same = mesh.len() == self.mesh_len
            && self.triangles.iter().all(|triangle| is_finite(triangle.primitive))
            && (0..mesh.len() as u32).filter(|&index| is_finite(index)).count() == self.triangles.len();
        if same {
            for triangle in &mut self.triangles {
                triangle.corners = mesh.triangles()[triangle.primitive as usize];
            }
            let triangles = &self.triangles;
            self.tree.refit(|slot| mesh.triangle_bounds(triangles[slot].primitive));
        }
        same
    }

    fn prepare(&self, ray: &Ray) -> Option<(PreparedRay, SlabRay)> {
        let prepared = PreparedRay::new(ray)?;
        let pad = prepared.pad(&self.tree.bounds());
        Some((prepared, SlabRay::new(ray.origin, ray.direction, ray.t_min, pad)))
    }
}

impl Traverse for Bvh {
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        let (ray, slabs) = self.prepare(ray)?;
        let mut nearest = Nearest::new(&ray.ray);
        let mut limit = slabs.limit(nearest.t);
        self.tree.walk(&slabs, limit, count, |leaf, count| {
            count.triangles(leaf.len());
            let before = nearest.t;
            for triangle in &self.triangles[leaf] {
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
        self.tree.find(&slabs, slabs.limit(ray.ray.t_max), count, |slot| {
            let triangle = &self.triangles[slot];
            hits(&ray, query, &triangle.corners, triangle.primitive)
        })
    }

    fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }

    fn memory_bytes(&self) -> usize {
        self.tree.memory_bytes() + size_of_val(self.triangles.as_slice())
    }

    fn shape(&self) -> TreeShape {
        self.tree.shape()
    }
}
