//! The tree that makes rays cheapest: planes of any orientation, evaluated by the surface-area heuristic [Ize 2008].
//!
//! A random ray that crosses a convex cell crosses a convex part of it with a probability equal to the ratio of their
//! surface areas. So a plane costs a ray one step plus, weighted by these probabilities, the triangles on either
//! side. The builder takes the cheapest plane, or makes a leaf where that is cheaper.
//! - High in the tree, where cells are boxes, only planes perpendicular to the axes are evaluated, all of them in one
//!   sweep: other planes do not pay there, and are expensive to find.
//! - Near the leaves ([`Quality`] decides how near) ten planes of every triangle are evaluated: its own, three
//!   through its edges perpendicular to it, and the six of the bounding box of what remains of it in the cell.
//!
//! Planes perpendicular to an axis are cheaper, and are stored, traversed and costed as such.

use super::cell::Cell;
use super::choice::{AXIS_STEP, Choice};
use super::pieces::{Parts, Pieces};
use super::plane::{Plane, Side, Space};
use super::sweep;
use super::tree::{Branch, BspTree, MAX_DEPTH};
use crate::mesh::TriangleMesh;
use crate::registry::{AcceleratorEntry, BuildError, BuildOptions, Quality};
use bilux_math::parallel::join;
use bilux_math::{DVec3, registry::Entry};
use std::sync::Arc;

/// Row of [`crate::ACCELERATORS`].
pub const ENTRY: AcceleratorEntry = AcceleratorEntry {
    entry: Entry {
        name: "bsp-sah",
        summary: "BSP tree with planes of any orientation, chosen by the surface-area heuristic",
        source: "Ize 2008",
        parameters: &[],
    },
    build,
};

/// Maximum number of references per triangle. No path down the tree may multiply references by more.
pub const GROWTH: f64 = 8.0;

/// Maximum inner nodes above a leaf, beyond twice those of a balanced tree of triangles. Around a vertex that many
/// triangles share, a plane pays off at every scale, without end.
const DEPTH: usize = 8;

/// The cost of any other plane, in triangle tests.
const STEP: f64 = 0.8;

/// Partitions with more references than this are built on two threads.
const PARALLEL: usize = 1024;

fn build(mesh: Arc<TriangleMesh>, options: &BuildOptions) -> Result<Box<dyn crate::Accelerator>, BuildError> {
    Ok(Box::new(BspTree::sah(&mesh, options.quality)?))
}

impl BspTree {
    /// The tree that makes rays cheapest.
    ///
    /// # Errors
    /// Returns an error when the tree has more nodes than can be numbered.
    pub fn sah(mesh: &TriangleMesh, quality: Quality) -> Result<BspTree, BuildError> {
        let space = Space::new(&mesh.bounds());
        let few = match quality {
            Quality::Fast => 0,
            Quality::Balanced => 16,
            Quality::Best => 64,
        };
        let pieces = Pieces::of_mesh(mesh, &space);
        let deepest = (DEPTH + 2 * pieces.len().max(1).ilog2() as usize).min(MAX_DEPTH);
        let grower = Grower { mesh, space, few, deepest };
        let margin = DVec3::splat(space.tolerance);
        let bounds = mesh.bounds();
        let low = bounds.min.as_dvec3() - space.centre.as_dvec3() - margin;
        let high = bounds.max.as_dvec3() - space.centre.as_dvec3() + margin;
        let root = grower.grow(pieces, PartitionCell::Box(low, high), GROWTH, 0);
        BspTree::new(mesh, &space, &root, false)
    }
}

/// The cell that a partition occupies.
enum PartitionCell {
    /// The box between two corners.
    Box(DVec3, DVec3),
    /// A box cut by planes that are not axis-aligned.
    Polyhedron(Cell),
}

struct Grower<'a> {
    mesh: &'a TriangleMesh,
    space: Space,
    /// In partitions of at most this many references, all planes are evaluated; in larger ones where the sweep finds
    /// no plane, those of half as many triangles.
    few: usize,
    /// Maximum number of inner nodes above a leaf.
    deepest: usize,
}

impl Grower<'_> {
    fn grow(&self, pieces: Pieces, cell: PartitionCell, growth: f64, depth: usize) -> Branch {
        let choice = if depth < self.deepest { self.choose(&pieces, &cell, growth) } else { None };
        let Some(Choice { plane, on_left, .. }) = choice else {
            return Branch::Leaf(pieces.into_triangles());
        };
        let before = pieces.len();
        let Parts { mut left, on, mut right } = pieces.split(&plane, self.space.tolerance);
        drop(pieces);
        if on_left {
            left.append(&on)
        } else {
            right.append(&on)
        }
        let growth = growth * before as f64 / (left.len() + right.len()) as f64;
        let [left_cell, right_cell] = cell.split(&plane, self.space.tolerance);
        let grow_left = || self.grow(left, left_cell, growth, depth + 1);
        let grow_right = || self.grow(right, right_cell, growth, depth + 1);
        let (left, right) =
            if before > PARALLEL { join(grow_left, grow_right) } else { (grow_left(), grow_right()) };
        Branch::Fork { plane, on: Vec::new(), children: Box::new([left, right]) }
    }

    /// The cheapest plane; `None` where a leaf is cheaper.
    fn choose(&self, pieces: &Pieces, cell: &PartitionCell, growth: f64) -> Option<Choice> {
        let leaf = pieces.len() as f64;
        let most = (leaf * growth) as usize;
        if pieces.is_empty() {
            return None;
        }
        if let (PartitionCell::Box(low, high), true) = (cell, pieces.len() > self.few) {
            let best = sweep::cheapest(pieces, *low, *high, self.space.tolerance, most);
            if best.is_some_and(|best| best.cost < leaf) {
                return best;
            }
        }
        let cell = cell.cell();
        let mut best = None;
        let mut cost = leaf;
        let samples = if pieces.len() > self.few { self.few / 2 } else { pieces.len() };
        for sample in 0..samples {
            for plane in self.planes(pieces, sample * pieces.len() / samples).into_iter().flatten() {
                if let Some(choice) = self.weigh(plane, pieces, &cell, cost, most) {
                    cost = choice.cost;
                    best = Some(choice);
                }
            }
        }
        best
    }

    /// The candidate planes of one piece.
    fn planes(&self, pieces: &Pieces, piece: usize) -> [Option<Plane>; 10] {
        let triangle = self.mesh.triangles()[pieces.triangles()[piece] as usize];
        let [a, b, c] = triangle.map(|vertex| self.space.local(vertex));
        let normal = (b - a).cross(c - a);
        let points = pieces.points(piece);
        let low = points.iter().fold(DVec3::INFINITY, |low, &p| low.min(p));
        let high = points.iter().fold(DVec3::NEG_INFINITY, |high, &p| high.max(p));
        [
            Plane::through(a, normal),
            Plane::through(a, (b - a).cross(normal)),
            Plane::through(b, (c - b).cross(normal)),
            Plane::through(c, (a - c).cross(normal)),
            Some(Plane::perpendicular(0, low.x)),
            Some(Plane::perpendicular(1, low.y)),
            Some(Plane::perpendicular(2, low.z)),
            Some(Plane::perpendicular(0, high.x)),
            Some(Plane::perpendicular(1, high.y)),
            Some(Plane::perpendicular(2, high.z)),
        ]
    }

    /// The cost of a plane, if it is less than `limit` and the plane leaves at most `most` references.
    fn weigh(&self, plane: Plane, pieces: &Pieces, cell: &Cell, limit: f64, most: usize) -> Option<Choice> {
        let (mut left, mut right, mut on) = (0, 0, 0);
        for points in pieces.iter() {
            match plane.side(points, self.space.tolerance) {
                Side::Left => left += 1,
                Side::Right => right += 1,
                Side::On => on += 1,
                Side::Both => (left, right) = (left + 1, right + 1),
            }
        }
        let step = if plane.axis().is_some() { AXIS_STEP } else { STEP };
        // The surface areas of the parts sum to at least the whole's: no plane is cheaper than this.
        if left + right + on > most || step + left.min(right) as f64 >= limit {
            return None;
        }
        let choice =
            Choice::new(plane, step, cell.areas(&plane).map(|a| a / cell.area()), [left, right, on])?;
        (choice.cost < limit).then_some(choice)
    }
}

impl PartitionCell {
    fn cell(&self) -> Cell {
        match self {
            PartitionCell::Box(low, high) => Cell::of_box(*low, *high),
            PartitionCell::Polyhedron(cell) => cell.clone(),
        }
    }

    fn split(&self, plane: &Plane, tolerance: f64) -> [PartitionCell; 2] {
        if let (PartitionCell::Box(low, high), Some(axis)) = (self, plane.axis()) {
            let at = f64::from(plane.coefficients().1);
            let (mut middle_low, mut middle_high) = (*low, *high);
            middle_low[axis] = low[axis].max(at - tolerance);
            middle_high[axis] = high[axis].min(at + tolerance);
            return [PartitionCell::Box(*low, middle_high), PartitionCell::Box(middle_low, *high)];
        }
        self.cell().split(plane, tolerance).map(PartitionCell::Polyhedron)
    }
}
