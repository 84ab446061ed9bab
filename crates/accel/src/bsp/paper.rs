//! The paper's tree, over polygons or over whole objects.
//!
//! Its planes lie where the polygons of the partition lie and face as they face. Nothing in such a rule guarantees
//! that a plane separates anything: on a smooth surface, the mean plane is nearly the tangent plane and cuts most of
//! what is left. A plane makes progress when each side keeps at most nine tenths and at most a quarter is cut. Where
//! the rule's plane makes no progress, the builder takes the plane through the mean position, perpendicular to the
//! axis along which positions vary most (whatever it cuts), and makes a leaf where that leaves more than nine tenths
//! on a side. Growth also ends
//! - at few enough polygons (`LEAF`), or one object;
//! - at a depth of `MAX_DEPTH` planes;
//! - by `GROWTH`: a polygon that a plane cuts is referenced from both sides. No path down the tree may multiply
//!   references by more than this, so there are never more than this many per polygon.
//!
//! With [`BspSplit::Fuchs`] the polygons within a plane stay with it, as in a BSP tree for drawing, and are visited
//! between its two sides.

use super::partition::{Item, Objects, Partition, Polygons};
use super::pieces::Parts;
use super::plane::{Plane, Space};
use super::tree::{Branch, BspTree, MAX_DEPTH};
use crate::mesh::TriangleMesh;
use crate::registry::{AcceleratorEntry, BspGroup, BspSplit, BuildError, BuildOptions};
use bilux_math::DVec3;
use bilux_math::parallel::join;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use std::sync::Arc;

/// Row of [`crate::ACCELERATORS`].
pub const ENTRY: AcceleratorEntry = AcceleratorEntry {
    entry: Entry {
        name: "bsp",
        summary: "the paper's BSP tree: planes through the polygons' mean position, with their mean orientation",
        source: "Fuchs 1980",
        parameters: PARAMETERS,
    },
    build,
};

const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "bsp_split",
        summary: "how planes are chosen: by the polygons' mean position and orientation (mean), or the polygon's \
                  plane that splits the fewest others (fuchs)",
        unit: "",
        kind: ParameterKind::Choice(&["mean", "fuchs"]),
        default: "mean",
    },
    Parameter {
        name: "bsp_group",
        summary: "whether to partition polygons or whole objects",
        unit: "",
        kind: ParameterKind::Choice(&["polygons", "objects"]),
        default: "polygons",
    },
];

/// Maximum number of references per polygon.
pub const GROWTH: f64 = 4.0;

/// Maximum fraction of a partition that may stay together.
const PROGRESS: f64 = 0.9;

/// Maximum fraction of a partition that the rule's plane may cut.
const CUT: f64 = 0.25;

/// Polygons whose planes are tried [Fuchs 1983].
const CANDIDATES: usize = 5;

/// A mean of unit vectors shorter than this is rounding error, not an orientation.
const DISORIENTED: f64 = 1.0 / 1024.0;

/// Partitions with more references than this are built on two threads.
const PARALLEL: usize = 4096;

fn build(mesh: Arc<TriangleMesh>, options: &BuildOptions) -> Result<Box<dyn crate::Accelerator>, BuildError> {
    Ok(Box::new(BspTree::paper(&mesh, options.bsp_split, options.bsp_group)?))
}

impl BspTree {
    /// The paper's tree over a mesh.
    ///
    /// # Errors
    /// Returns an error when the tree has more nodes than can be numbered.
    pub fn paper(mesh: &TriangleMesh, split: BspSplit, group: BspGroup) -> Result<BspTree, BuildError> {
        let space = Space::new(&mesh.bounds());
        let root = match group {
            BspGroup::Polygons => grow(Polygons::of_mesh(mesh, &space), split, GROWTH, 0),
            BspGroup::Objects => grow(Objects::of_mesh(mesh, &space), split, GROWTH, 0),
        };
        BspTree::new(mesh, &space, &root, true)
    }
}

/// Grows the tree of a partition whose references may still be multiplied by `growth`.
fn grow<P: Partition>(partition: P, split: BspSplit, growth: f64, depth: usize) -> Branch {
    if partition.is_small() || depth == MAX_DEPTH {
        return Branch::Leaf(partition.into_triangles());
    }
    let before = partition.references();
    let Some((plane, parts)) = part(&partition, split) else {
        return Branch::Leaf(partition.into_triangles());
    };
    let after = parts.left.references() + parts.on.references() + parts.right.references();
    let growth = growth * before as f64 / after as f64;
    if growth < 1.0 {
        return Branch::Leaf(partition.into_triangles());
    }
    drop(partition);
    let Parts { left, on, right } = parts;
    let grow_left = || grow(left, split, growth, depth + 1);
    let grow_right = || grow(right, split, growth, depth + 1);
    let (left, right) =
        if before > PARALLEL { join(grow_left, grow_right) } else { (grow_left(), grow_right()) };
    Branch::Fork { plane, on: on.into_triangles(), children: Box::new([left, right]) }
}

/// Splits a partition by the rule's plane or, when that makes no progress, by the plane of widest spread.
fn part<P: Partition>(partition: &P, split: BspSplit) -> Option<(Plane, Parts<P>)> {
    let items = partition.items();
    let ruled = match split {
        BspSplit::Mean => mean_plane(&items),
        BspSplit::Fuchs => own_plane(&items, partition),
    };
    // No better plane than that of the widest spread is known, so that one may cut as much as it must.
    let tries = [(ruled, CUT), (spread_plane(&items), 1.0)];
    tries.into_iter().find_map(|(plane, may_cut)| {
        let plane = plane?;
        let mut parts = partition.split(&plane);
        if split == BspSplit::Mean {
            // The rule did not choose polygons for lying in the plane, so those that do may go to either side.
            let on = std::mem::replace(&mut parts.on, partition.none());
            if parts.left.len() < parts.right.len() { parts.left.join(on) } else { parts.right.join(on) }
        }
        let all = partition.len();
        let cut = parts.left.len() + parts.on.len() + parts.right.len() - all;
        let most = parts.left.len().max(parts.right.len());
        let progress = most as f64 <= PROGRESS * all as f64 && cut as f64 <= may_cut * all as f64;
        progress.then_some((plane, parts))
    })
}

/// Through the mean position, with the mean orientation; `None` when orientations cancel out.
fn mean_plane(items: &[Item]) -> Option<Plane> {
    let orientation = mean(items.iter().map(|item| item.orientation));
    let oriented = orientation.length() > DISORIENTED;
    oriented.then(|| Plane::through(mean(items.iter().map(|item| item.position)), orientation))?
}

/// Of a few items' own planes, the one that cuts the fewest others; among those, the one that splits them most
/// evenly; among those, the first.
fn own_plane<P: Partition>(items: &[Item], partition: &P) -> Option<Plane> {
    let candidates = CANDIDATES.min(items.len());
    let plane = |candidate: usize| {
        let Item { position, orientation } = items[(2 * candidate + 1) * items.len() / (2 * candidates)];
        Plane::through(position, orientation)
    };
    (0..candidates).filter_map(plane).min_by_key(|plane| {
        let [left, right, both] = partition.sides(plane);
        (both, left.max(right))
    })
}

/// Through the mean position, perpendicular to the axis along which positions vary most.
fn spread_plane(items: &[Item]) -> Option<Plane> {
    let middle = mean(items.iter().map(|item| item.position));
    let variance = mean(items.iter().map(|item| (item.position - middle) * (item.position - middle)));
    (variance.max_element() > 0.0).then(|| {
        let axis = variance.max_position();
        Plane::perpendicular(axis, middle[axis])
    })
}

fn mean(vectors: impl ExactSizeIterator<Item = DVec3>) -> DVec3 {
    let count = vectors.len() as f64;
    vectors.sum::<DVec3>() / count
}
