//! The units that the paper's tree partitions: polygons, or whole objects.

use super::facing::orientation;
use super::pieces::{Parts, Pieces};
use super::plane::{Plane, Side, Space};
use crate::mesh::TriangleMesh;
use bilux_math::DVec3;

/// Maximum number of polygons in a leaf that could still be split.
pub(super) const LEAF: usize = 4;

/// Position and orientation of a polygon or an object, which the rules inspect.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) position: DVec3,
    /// Unit length, or zero for something without area.
    pub(super) orientation: DVec3,
}

/// A set of polygons or objects inside one cell.
pub(super) trait Partition: Sized + Send {
    /// Number of items.
    fn len(&self) -> usize;
    /// Number of triangles that the items hold.
    fn references(&self) -> usize;
    /// True when it is not worth splitting.
    fn is_small(&self) -> bool;
    /// Each item, as the rules see it.
    fn items(&self) -> Vec<Item>;
    /// Numbers of items that reach to the left of a plane, to the right, and to both.
    fn sides(&self, plane: &Plane) -> [usize; 3];
    /// Distributes the items over the sides of a plane.
    fn split(&self, plane: &Plane) -> Parts<Self>;
    /// An empty partition.
    fn none(&self) -> Self;
    /// Adds another's items to this one.
    fn join(&mut self, other: Self);
    /// All its triangles.
    fn into_triangles(self) -> Vec<u32>;
}

/// Counts the sides on which items lie.
fn count_sides(sides: impl Iterator<Item = Side>) -> [usize; 3] {
    sides.fold([0; 3], |[left, right, both], side| match side {
        Side::Left => [left + 1, right, both],
        Side::Right => [left, right + 1, both],
        Side::Both => [left + 1, right + 1, both + 1],
        Side::On => [left, right, both],
    })
}

/// Single polygons, cut at the planes.
pub(super) struct Polygons<'a> {
    mesh: &'a TriangleMesh,
    tolerance: f64,
    pieces: Pieces,
}

impl<'a> Polygons<'a> {
    pub(super) fn of_mesh(mesh: &'a TriangleMesh, space: &Space) -> Polygons<'a> {
        Polygons { mesh, tolerance: space.tolerance, pieces: Pieces::of_mesh(mesh, space) }
    }

    fn with(&self, pieces: Pieces) -> Polygons<'a> {
        Polygons { mesh: self.mesh, tolerance: self.tolerance, pieces }
    }
}

impl Partition for Polygons<'_> {
    fn len(&self) -> usize {
        self.pieces.len()
    }

    fn references(&self) -> usize {
        self.pieces.len()
    }

    fn is_small(&self) -> bool {
        self.pieces.len() <= LEAF
    }

    fn items(&self) -> Vec<Item> {
        let item = |(points, &triangle): (&[DVec3], &u32)| Item {
            position: points.iter().sum::<DVec3>() / points.len() as f64,
            orientation: orientation(&self.mesh.triangles()[triangle as usize]).unwrap_or_default(),
        };
        self.pieces.iter().zip(self.pieces.triangles()).map(item).collect()
    }

    fn sides(&self, plane: &Plane) -> [usize; 3] {
        count_sides(self.pieces.iter().map(|points| plane.side(points, self.tolerance)))
    }

    fn split(&self, plane: &Plane) -> Parts<Self> {
        let Parts { left, on, right } = self.pieces.split(plane, self.tolerance);
        Parts { left: self.with(left), on: self.with(on), right: self.with(right) }
    }

    fn none(&self) -> Self {
        self.with(Pieces::default())
    }

    fn join(&mut self, other: Self) {
        self.pieces.append(&other.pieces);
    }

    fn into_triangles(self) -> Vec<u32> {
        self.pieces.into_triangles()
    }
}

/// Whole objects, never cut: each is on every side that it reaches into.
pub(super) struct Objects {
    tolerance: f64,
    all: std::sync::Arc<[Object]>,
    members: Vec<u32>,
}

struct Object {
    item: Item,
    points: Vec<DVec3>,
    triangles: Vec<u32>,
}

impl Objects {
    pub(super) fn of_mesh(mesh: &TriangleMesh, space: &Space) -> Objects {
        let object = |group: &std::ops::Range<u32>| {
            let finite =
                |&index: &u32| mesh.triangles()[index as usize].iter().flatten().all(|c| c.is_finite());
            let triangles: Vec<u32> = group.clone().filter(finite).collect();
            let corners = |&index: &u32| mesh.triangles()[index as usize].map(|vertex| space.local(vertex));
            let points: Vec<DVec3> = triangles.iter().flat_map(corners).collect();
            let facing = |&index: &u32| orientation(&mesh.triangles()[index as usize]);
            let item = Item {
                position: points.iter().sum::<DVec3>() / points.len() as f64,
                orientation: triangles.iter().filter_map(facing).sum::<DVec3>().normalize_or_zero(),
            };
            Object { item, points, triangles }
        };
        let all: std::sync::Arc<[Object]> =
            mesh.groups().iter().map(object).filter(|object| !object.triangles.is_empty()).collect();
        let members = (0..all.len() as u32).collect();
        Objects { tolerance: space.tolerance, all, members }
    }

    fn with(&self, members: Vec<u32>) -> Objects {
        Objects { tolerance: self.tolerance, all: self.all.clone(), members }
    }

    fn objects(&self) -> impl Iterator<Item = &Object> {
        self.members.iter().map(|&member| &self.all[member as usize])
    }
}

impl Partition for Objects {
    fn len(&self) -> usize {
        self.members.len()
    }

    fn references(&self) -> usize {
        self.objects().map(|object| object.triangles.len()).sum()
    }

    fn is_small(&self) -> bool {
        self.members.len() <= 1
    }

    fn items(&self) -> Vec<Item> {
        self.objects().map(|object| object.item).collect()
    }

    fn sides(&self, plane: &Plane) -> [usize; 3] {
        count_sides(self.objects().map(|object| plane.side(&object.points, self.tolerance)))
    }

    fn split(&self, plane: &Plane) -> Parts<Self> {
        let mut parts = Parts { left: self.none(), on: self.none(), right: self.none() };
        for (&member, object) in self.members.iter().zip(self.objects()) {
            let side = plane.side(&object.points, self.tolerance);
            if side == Side::On {
                parts.on.members.push(member);
            }
            if matches!(side, Side::Left | Side::Both) {
                parts.left.members.push(member);
            }
            if matches!(side, Side::Right | Side::Both) {
                parts.right.members.push(member);
            }
        }
        parts
    }

    fn none(&self) -> Self {
        self.with(Vec::new())
    }

    fn join(&mut self, other: Self) {
        self.members.extend(other.members);
    }

    fn into_triangles(self) -> Vec<u32> {
        self.objects().flat_map(|object| object.triangles.iter().copied()).collect()
    }
}
