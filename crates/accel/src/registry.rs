//! The table of structures. To add a structure, add a file with its `ENTRY`, and a line here.

use crate::CpuLevel;
use crate::accelerator::Accelerator;
use crate::mesh::TriangleMesh;
use crate::{brute_force, brute_simd, bsp, bvh, bvh8, kd_tree};
use bilux_math::registry::Entry;
use std::sync::Arc;

/// Every available structure.
pub static ACCELERATORS: &[AcceleratorEntry] = &[
    brute_force::ENTRY,
    brute_simd::ENTRY,
    bsp::paper::ENTRY,
    bsp::sah::ENTRY,
    kd_tree::ENTRY,
    bvh::ENTRY,
    bvh8::ENTRY,
    bvh8::COMPACT,
];

/// The structure that `auto` stands for: the fastest.
pub const AUTO: &str = "bvh8";

/// One structure.
#[derive(Clone, Copy, Debug)]
pub struct AcceleratorEntry {
    /// Name, summary, source and parameters.
    pub entry: Entry,
    /// Builds the structure.
    pub build: BuildFn,
}

/// Type of the function that builds a structure.
pub type BuildFn = fn(Arc<TriangleMesh>, &BuildOptions) -> Result<Box<dyn Accelerator>, BuildError>;

/// Why a structure cannot be built.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// No structure has this name.
    #[error("there is no accelerator '{0}'")]
    UnknownName(String),
    /// The tree would have more nodes than can be numbered.
    #[error("the mesh is too large for this accelerator: its tree has more nodes than an index can address")]
    TooManyNodes,
}

/// Options for builders. Each builder uses only those that it knows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BuildOptions {
    /// Rule by which `bsp` chooses its planes.
    pub bsp_split: BspSplit,
    /// Whether `bsp` keeps objects together.
    pub bsp_group: BspGroup,
    /// Time that a builder may spend on a better structure.
    pub quality: Quality,
    /// The instruction set that kernels may use; by default, the best that the machine supports.
    pub cpu_level: CpuLevel,
}

/// Time that a builder may spend on a better structure. From lowest to highest, `bvh8` sorts along a
/// space-filling curve, splits by the surface-area heuristic, or also cuts triangles and moves subtrees; `bsp-sah`
/// evaluates planes of any orientation for no partition, for small ones, or for larger ones too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Quality {
    /// Fastest to build.
    Fast,
    /// Between the two.
    #[default]
    Balanced,
    /// Fastest to query.
    Best,
}

/// Rule by which the paper's tree chooses a partition plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BspSplit {
    /// Through the average position, with the average orientation (the paper, section 3.2).
    #[default]
    Mean,
    /// A polygon's own plane: of a few candidates, the one that cuts the fewest others. [Fuchs 1983]
    Fuchs,
}

impl BspSplit {
    /// The option with the name that `bsp` lists for its parameter `bsp_split`.
    pub fn from_name(name: &str) -> Option<BspSplit> {
        [("mean", BspSplit::Mean), ("fuchs", BspSplit::Fuchs)].into_iter().find_map(named(name))
    }
}

/// The units that the paper's tree keeps together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BspGroup {
    /// Single polygons (the paper, section 3.2).
    #[default]
    Polygons,
    /// Whole objects.
    Objects,
}

impl BspGroup {
    /// The option with the name that `bsp` lists for its parameter `bsp_group`.
    pub fn from_name(name: &str) -> Option<BspGroup> {
        [("polygons", BspGroup::Polygons), ("objects", BspGroup::Objects)].into_iter().find_map(named(name))
    }
}

impl Quality {
    /// The option with the name used in settings.
    pub fn from_name(name: &str) -> Option<Quality> {
        let all = [("fast", Quality::Fast), ("balanced", Quality::Balanced), ("best", Quality::Best)];
        all.into_iter().find_map(named(name))
    }
}

fn named<T>(name: &str) -> impl Fn((&str, T)) -> Option<T> {
    move |(candidate, value)| (candidate == name).then_some(value)
}

/// Builds the structure of this name (`auto` is the fastest) over a mesh.
///
/// # Errors
/// Returns an error when no structure has this name.
pub fn build(
    name: &str,
    mesh: Arc<TriangleMesh>,
    options: &BuildOptions,
) -> Result<Box<dyn Accelerator>, BuildError> {
    let name = if name == "auto" { AUTO } else { name };
    match ACCELERATORS.iter().find(|row| row.entry.name == name) {
        Some(row) => (row.build)(mesh, options),
        None => Err(BuildError::UnknownName(name.to_owned())),
    }
}
