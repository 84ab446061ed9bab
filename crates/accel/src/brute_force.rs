//! No structure at all: a plain loop over every triangle. The ground truth that the other structures are tested
//! against.

use crate::accelerator::{Traverse, TreeShape};
use crate::counters::Count;
use crate::mesh::TriangleMesh;
use crate::ray::{Hit, Query, Ray};
use crate::registry::{AcceleratorEntry, BuildError, BuildOptions};
use crate::triangle::{Nearest, PreparedRay, hits};
use bilux_math::{Aabb, registry::Entry};
use std::sync::Arc;

/// Row of [`crate::ACCELERATORS`].
pub const ENTRY: AcceleratorEntry = AcceleratorEntry {
    entry: Entry {
        name: "brute",
        summary: "a loop over all triangles: the reference, and the paper's baseline",
        source: "",
        parameters: &[],
    },
    build,
};

/// All triangles, in the order given.
#[derive(Debug)]
pub struct BruteForce {
    mesh: Arc<TriangleMesh>,
}

fn build(
    mesh: Arc<TriangleMesh>,
    _options: &BuildOptions,
) -> Result<Box<dyn crate::Accelerator>, BuildError> {
    Ok(Box::new(BruteForce { mesh }))
}

impl Traverse for BruteForce {
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        let ray = PreparedRay::new(ray)?;
        count.triangles(self.mesh.len());
        let mut nearest = Nearest::new(&ray.ray);
        for (index, triangle) in self.mesh.triangles().iter().enumerate() {
            nearest.test(&ray, query, triangle, index as u32);
        }
        nearest.hit()
    }

    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        count.ray();
        let Some(ray) = PreparedRay::new(ray) else { return false };
        let hit = |(index, triangle)| hits(&ray, query, triangle, index as u32);
        let found = self.mesh.triangles().iter().enumerate().position(hit);
        count.triangles(found.map_or(self.mesh.len(), |index| index + 1));
        found.is_some()
    }

    fn bounds(&self) -> Aabb {
        self.mesh.bounds()
    }

    fn memory_bytes(&self) -> usize {
        self.mesh.memory_bytes()
    }

    fn shape(&self) -> TreeShape {
        TreeShape::default()
    }
}
