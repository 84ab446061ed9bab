//! The table of structures. To add one: a file with its `ENTRY`, and a line here.

use crate::accelerator::Accelerator;
use crate::cpu_level::CpuLevel;
use crate::mesh::TriangleMesh;
use crate::{brute_force, brute_simd, bsp, bvh, bvh8, kd_tree};
use bilux_math::registry::Entry;
use std::sync::Arc;

/// Every structure that there is.
pub const ACCELERATORS: &[AcceleratorEntry] = &[
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
    /// Builds one.
    pub build: BuildFn,
}

/// How a structure is built.
pub type BuildFn = fn(Arc<TriangleMesh>, &BuildOptions) -> Result<Box<dyn Accelerator>, BuildError>;

/// Why a structure cannot be built.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// No structure has this name.
    #[error("there is no accelerator '{0}'")]
    UnknownName(String),
    /// The tree would have more nodes than can be numbered.
    #[error("the mesh is too large for this accelerator: its tree has more nodes than can be numbered")]
    TooManyNodes,
}

/// What a builder may be told. Each looks only at what it knows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BuildOptions {
    /// How `bsp` chooses its planes.
    pub bsp_split: BspSplit,
    /// What `bsp` keeps together.
    pub bsp_group: BspGroup,
    /// How much time a builder may take for a better structure.
    pub quality: Quality,
    /// Which instructions kernels may use; the best that the machine has, unless told otherwise.
    pub cpu_level: CpuLevel,
}

/// How much time a builder may take for a better structure. `bvh8` sorts along a curve, weighs cuts by area, or
/// cuts triangles and moves subtrees too; `bsp-sah` weighs planes of any orientation for no partition, small ones, or
/// larger ones too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Quality {
    /// Ready soon.
    Fast,
    /// Between the two.
    #[default]
    Balanced,
    /// Cheapest to ask.
    Best,
}

/// How the paper's tree chooses a partition plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BspSplit {
    /// Through the average position, with the average orientation (the paper, section 3.2).
    #[default]
    Mean,
    /// A polygon's own plane: of a few candidates, the one that cuts fewest others. [Fuchs 1983]
    Fuchs,
}

impl BspSplit {
    /// By the name that `bsp` lists for its parameter `bsp_split`.
    pub fn from_name(name: &str) -> Option<BspSplit> {
        [("mean", BspSplit::Mean), ("fuchs", BspSplit::Fuchs)].into_iter().find_map(named(name))
    }
}

/// What the paper's tree keeps together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum BspGroup {
    /// Single polygons (the paper, section 3.2).
    #[default]
    Polygons,
    /// Whole objects.
    Objects,
}

impl BspGroup {
    /// By the name that `bsp` lists for its parameter `bsp_group`.
    pub fn from_name(name: &str) -> Option<BspGroup> {
        [("polygons", BspGroup::Polygons), ("objects", BspGroup::Objects)].into_iter().find_map(named(name))
    }
}

impl Quality {
    /// By the name that people type.
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
/// When no structure has this name.
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
