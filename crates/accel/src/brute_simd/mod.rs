//! A loop over every triangle, sixteen at a time: the fairest baseline for a tree.

mod kernel;

use crate::CpuLevel;
use crate::accelerator::{Traverse, TreeShape};
use crate::counters::Count;
use crate::mesh::TriangleMesh;
use crate::ray::{Hit, Query, Ray};
use crate::registry::AcceleratorEntry;
use crate::triangle::{Nearest, PreparedRay, hits};
use bilux_math::{Aabb, registry::Entry};
use kernel::{Block, LANES};
use std::sync::Arc;

/// Row of [`crate::ACCELERATORS`].
pub const ENTRY: AcceleratorEntry = AcceleratorEntry {
    entry: Entry {
        name: "brute-simd",
        summary: "a loop over all triangles with SIMD, sixteen at a time: the fastest baseline without a tree",
        source: "",
        parameters: &[],
    },
    build: |mesh, options| Ok(Box::new(BruteSimd::new(mesh, options.cpu_level))),
};

/// All triangles, in blocks of sixteen. The sign stage of the triangle test runs on all lanes of a block at once, in
/// the same order of operations as [`PreparedRay::cross`]; the few triangles that it does not reject go through that
/// test itself. So the answers are those of `brute`, whatever the level.
#[derive(Debug)]
pub struct BruteSimd {
    mesh: Arc<TriangleMesh>,
    blocks: Vec<Block>,
    level: CpuLevel,
}

/// Blocks whose surviving triangles are collected before they are tested.
const BATCH: usize = 32;

impl BruteSimd {
    /// Packs triangles into blocks, for kernels of this level, or of the highest level below it that the machine
    /// supports.
    pub fn new(mesh: Arc<TriangleMesh>, level: CpuLevel) -> BruteSimd {
        let blocks = mesh.triangles().chunks(LANES).map(Block::new).collect();
        BruteSimd { mesh, blocks, level: level.available() }
    }

    /// Calls `visit` with every triangle that the sign stage lets through, in order, until `visit` returns false.
    #[inline(always)]
    fn survivors(&self, ray: &PreparedRay, mut visit: impl FnMut(&[[f32; 3]; 3], u32) -> bool) {
        let mut masks = [0u16; BATCH];
        for (batch, blocks) in self.blocks.chunks(BATCH).enumerate() {
            kernel::sign_stage(self.level, blocks, ray, &mut masks);
            for (block, &mask) in masks[..blocks.len()].iter().enumerate() {
                let mut left = mask;
                while left != 0 {
                    let index = (batch * BATCH + block) * LANES + left.trailing_zeros() as usize;
                    left &= left - 1;
                    // Lanes beyond the last triangle are empty.
                    let Some(triangle) = self.mesh.triangles().get(index) else { break };
                    if !visit(triangle, index as u32) {
                        return;
                    }
                }
            }
        }
    }
}

impl Traverse for BruteSimd {
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        let ray = PreparedRay::new(ray)?;
        count.triangles(self.mesh.len());
        let mut nearest = Nearest::new(&ray.ray);
        self.survivors(&ray, |triangle, index| {
            nearest.test(&ray, query, triangle, index);
            true
        });
        nearest.hit()
    }

    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        count.ray();
        let Some(ray) = PreparedRay::new(ray) else { return false };
        let (mut found, mut tested) = (false, self.mesh.len());
        self.survivors(&ray, |triangle, index| {
            found = hits(&ray, query, triangle, index);
            if found {
                tested = index as usize + 1;
            }
            !found
        });
        count.triangles(tested);
        found
    }

    fn bounds(&self) -> Aabb {
        self.mesh.bounds()
    }

    fn memory_bytes(&self) -> usize {
        self.mesh.memory_bytes() + size_of_val(self.blocks.as_slice())
    }

    fn shape(&self) -> TreeShape {
        TreeShape::default()
    }
}
