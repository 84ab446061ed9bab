//! The tree as rays traverse it, whichever rule it was built by.

use super::facing::{Facing, RayView, in_runs};
use super::path::{Path, PlaneCrossing, earlier, later};
use super::plane::{Plane, Space};
use crate::accelerator::{Traverse, TreeShape};
use crate::counters::Count;
use crate::mesh::TriangleMesh;
use crate::ray::{Culling, Hit, Query, Ray};
use crate::registry::BuildError;
use crate::triangle::{Nearest, PreparedRay, hits};
use bilux_math::{Aabb, DVec3, Vec3};
use std::ops::{ControlFlow, Range};

/// A built tree, before it is laid out in memory.
#[derive(Debug)]
pub(super) enum Branch {
    /// Triangles that are tested together.
    Leaf(Vec<u32>),
    /// A plane, the triangles within it, and the children to the left and right of it.
    Fork { plane: Plane, on: Vec<u32>, children: Box<[Branch; 2]> },
}

/// Maximum number of inner nodes on the path from the root to a leaf.
pub(super) const MAX_DEPTH: usize = 48;

/// An inner node pushes at most two entries for later: what lies in its plane, and its far side.
const STACK: usize = 2 * MAX_DEPTH;

/// Binary space partitioning: planes of any orientation, front to back.
#[derive(Debug)]
pub struct BspTree {
    /// In depth-first order: the left child of an inner node follows it.
    nodes: Vec<BspNode>,
    /// Normal and offset of the planes that are not perpendicular to an axis.
    planes: Vec<[f32; 4]>,
    /// The triangles of each leaf, contiguous; a triangle that belongs to several leaves is stored in each.
    references: Vec<Reference>,
    facings: Vec<Facing>,
    bounds: Aabb,
    centre: Vec3,
}

/// Eight bytes: the kind (lowest three bits of `tag`), a number (the other bits), and a payload.
///
/// | kind | number | payload |
/// | --- | --- | --- |
/// | 0, 1, 2: axis plane | right child | the plane's offset, as f32 |
/// | 3: plane | right child | index of the plane |
/// | 4: plane with triangles in it | right child | index of the plane; the next node is a leaf with those |
/// | 5: leaf | number of references | the first reference |
/// | 6: leaf in runs with facings | number of references | the first; the next node's payload is its first facing |
#[derive(Clone, Copy, Debug)]
struct BspNode {
    tag: u32,
    payload: u32,
}

const PLANE: u32 = 3;
const FULL_PLANE: u32 = 4;
const LEAF: u32 = 5;
const FACING_LEAF: u32 = 6;

#[derive(Clone, Copy, Debug)]
struct Reference {
    corners: [[f32; 3]; 3],
    primitive: u32,
}

impl BspNode {
    #[inline(always)]
    fn kind(self) -> u32 {
        self.tag & 7
    }

    #[inline(always)]
    fn number(self) -> u32 {
        self.tag >> 3
    }

    /// # Errors
    /// Returns an error when the numbers do not fit, beyond some hundred million nodes.
    fn new(kind: u32, number: usize, payload: usize) -> Result<BspNode, BuildError> {
        match (u32::try_from(number), u32::try_from(payload)) {
            (Ok(number), Ok(payload)) if number < 1 << 29 => Ok(BspNode { tag: number << 3 | kind, payload }),
            _ => Err(BuildError::TooManyNodes),
        }
    }
}

impl BspTree {
    /// Lays out a built tree. With `with_facings`, leaves store which way their triangles face.
    pub(super) fn new(
        mesh: &TriangleMesh,
        space: &Space,
        root: &Branch,
        with_facings: bool,
    ) -> Result<BspTree, BuildError> {
        let mut tree = BspTree {
            nodes: Vec::new(),
            planes: Vec::new(),
            references: Vec::new(),
            facings: Vec::new(),
            bounds: mesh.bounds(),
            centre: space.centre,
        };
        tree.lay_out(mesh, root, with_facings)?;
        Ok(tree)
    }

    fn lay_out(&mut self, mesh: &TriangleMesh, branch: &Branch, facings: bool) -> Result<(), BuildError> {
        let (plane, on, children) = match branch {
            Branch::Leaf(triangles) => return self.lay_out_leaf(mesh, triangles, facings),
            Branch::Fork { plane, on, children } => (plane, on, children),
        };
        let here = self.nodes.len();
        let (normal, at) = plane.coefficients();
        let (kind, payload) = match plane.axis() {
            Some(axis) if on.is_empty() => (axis as u32, at.to_bits() as usize),
            _ => {
                self.planes.push([normal[0], normal[1], normal[2], at]);
                (if on.is_empty() { PLANE } else { FULL_PLANE }, self.planes.len() - 1)
            }
        };
        self.nodes.push(BspNode::new(kind, 0, payload)?);
        if !on.is_empty() {
            self.lay_out_leaf(mesh, on, facings)?;
        }
        self.lay_out(mesh, &children[0], facings)?;
        self.nodes[here] = BspNode::new(kind, self.nodes.len(), payload)?;
        self.lay_out(mesh, &children[1], facings)
    }

    fn lay_out_leaf(
        &mut self,
        mesh: &TriangleMesh,
        triangles: &[u32],
        facings: bool,
    ) -> Result<(), BuildError> {
        let with_facings = facings && !triangles.is_empty();
        let kind = if with_facings { FACING_LEAF } else { LEAF };
        self.nodes.push(BspNode::new(kind, triangles.len(), self.references.len())?);
        if with_facings {
            self.nodes.push(BspNode::new(LEAF, 0, self.facings.len())?);
            let (order, facings) = in_runs(mesh, triangles);
            self.facings.extend(facings);
            self.refer(mesh, &order);
        } else {
            self.refer(mesh, triangles);
        }
        Ok(())
    }

    fn refer(&mut self, mesh: &TriangleMesh, triangles: &[u32]) {
        let reference =
            |&primitive: &u32| Reference { corners: mesh.triangles()[primitive as usize], primitive };
        self.references.extend(triangles.iter().map(reference));
    }
}

/// A node whose visit is postponed.
#[derive(Clone, Copy, Default)]
struct DeferredNode {
    node: u32,
    from: f32,
    until: f32,
}

impl BspTree {
    /// Takes a ray to every leaf that may hold a hit, nearest first. `visit` returns the distance beyond which hits
    /// no longer count.
    #[inline(always)]
    fn walk<C: Count>(
        &self,
        ray: &PreparedRay,
        query: &Query,
        count: &mut C,
        mut visit: impl FnMut(&[Reference], &mut C) -> ControlFlow<(), f32>,
    ) {
        if self.nodes.is_empty() || self.bounds.is_empty() {
            return;
        }
        let path = Path::new(ray, &self.bounds, self.centre);
        let (low, high) = (self.bounds.min - self.centre, self.bounds.max - self.centre);
        let Some((mut from, mut until)) = path.clip(low, high, ray.ray.t_min, ray.ray.t_max) else { return };
        let view = self.view(ray, query);
        let mut limit = f32::INFINITY;
        let mut stack = [DeferredNode::default(); STACK];
        let mut waiting = 0;
        let mut index = 0;
        loop {
            count.node();
            let node = self.nodes[index];
            let passage = match node.kind() {
                axis @ 0..=2 => path.across(axis as usize, f32::from_bits(node.payload)),
                PLANE | FULL_PLANE => path.through(self.planes[node.payload as usize]),
                _ => {
                    match self.visit_leaf(index, view.as_ref(), count, &mut visit) {
                        ControlFlow::Break(()) => return,
                        ControlFlow::Continue(nearest) if query.early_out => limit = nearest,
                        ControlFlow::Continue(_) => {}
                    }
                    loop {
                        if waiting == 0 {
                            return;
                        }
                        waiting -= 1;
                        let next = stack[waiting];
                        if next.from <= limit {
                            (index, from, until) =
                                (next.node as usize, next.from, earlier(next.until, limit));
                            break;
                        }
                        count.early_out();
                    }
                    continue;
                }
            };
            let PlaneCrossing { flip, near_until, far_from } = passage;
            let left = if node.kind() == FULL_PLANE { self.after_leaf(index + 1) } else { index + 1 };
            let (near, far) =
                if flip == 0 { (left, node.number()) } else { (node.number() as usize, left as u32) };
            if near_until < from {
                index = far as usize;
            } else if far_from > until {
                index = near;
            } else {
                let (between, beyond) = (earlier(until, near_until), later(from, far_from));
                stack[waiting] = DeferredNode { node: far, from: beyond, until };
                waiting += 1;
                if node.kind() == FULL_PLANE {
                    stack[waiting] = DeferredNode { node: index as u32 + 1, from: beyond, until: between };
                    waiting += 1;
                }
                (index, until) = (near, between);
            }
        }
    }

    /// The node after a leaf.
    fn after_leaf(&self, leaf: usize) -> usize {
        if self.nodes[leaf].kind() == FACING_LEAF { leaf + 2 } else { leaf + 1 }
    }

    /// Visits the triangles of a leaf, except for those of which the ray is certain to see only back faces.
    #[inline(always)]
    fn visit_leaf<C: Count>(
        &self,
        leaf: usize,
        view: Option<&RayView>,
        count: &mut C,
        visit: &mut impl FnMut(&[Reference], &mut C) -> ControlFlow<(), f32>,
    ) -> ControlFlow<(), f32> {
        let node = self.nodes[leaf];
        let first = node.payload as usize;
        let references = &self.references[first..first + node.number() as usize];
        match view {
            Some(view) if node.kind() == FACING_LEAF => {
                let facings = self.nodes[leaf + 1].payload as usize;
                self.visit_fronts(references, &self.facings[facings..], view, count, visit)
            }
            _ => visit(references, count),
        }
    }

    /// Visits a leaf run by run.
    fn visit_fronts<C: Count>(
        &self,
        mut references: &[Reference],
        facings: &[Facing],
        view: &RayView,
        count: &mut C,
        visit: &mut impl FnMut(&[Reference], &mut C) -> ControlFlow<(), f32>,
    ) -> ControlFlow<(), f32> {
        let mut nearest = visit(&[], count)?;
        for facing in facings {
            let Some((run, rest)) = references.split_at_checked(facing.count as usize) else { break };
            references = rest;
            if view.sees_backs_only(facing) {
                run.iter().for_each(|_| count.culled_back_face());
            } else {
                nearest = visit(run, count)?;
            }
            if references.is_empty() {
                break;
            }
        }
        ControlFlow::Continue(nearest)
    }

    fn view(&self, ray: &PreparedRay, query: &Query) -> Option<RayView> {
        let asked = query.culling == Culling::Back && query.cull_by_partition;
        (asked && !self.facings.is_empty()).then(|| RayView::new(ray, &self.bounds))
    }
}

impl Traverse for BspTree {
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        let ray = PreparedRay::new(ray)?;
        let mut nearest = Nearest::new(&ray.ray);
        self.walk(&ray, query, count, |references, count| {
            count.triangles(references.len());
            for reference in references {
                nearest.test(&ray, query, &reference.corners, reference.primitive);
            }
            ControlFlow::Continue(nearest.t)
        });
        nearest.hit()
    }

    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        count.ray();
        let Some(ray) = PreparedRay::new(ray) else { return false };
        let mut found = false;
        self.walk(&ray, query, count, |references, count| {
            for reference in references {
                count.triangles(1);
                if hits(&ray, query, &reference.corners, reference.primitive) {
                    found = true;
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(f32::INFINITY)
        });
        found
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
            + size_of_val(self.planes.as_slice())
            + size_of_val(self.references.as_slice())
            + size_of_val(self.facings.as_slice())
    }

    fn shape(&self) -> TreeShape {
        let mut shape = TreeShape::default();
        if !self.nodes.is_empty() {
            self.measure(0, 1, &mut shape);
        }
        shape
    }
}

/// A decoded node.
pub(super) enum Content {
    Leaf(Range<usize>),
    Fork { normal: DVec3, at: f64, on: Option<usize>, left: usize, right: usize },
}

impl BspTree {
    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The triangles of a range of references.
    pub(super) fn primitives(&self, references: Range<usize>) -> impl Iterator<Item = u32> {
        self.references[references].iter().map(|reference| reference.primitive)
    }

    /// Decodes a node.
    pub(super) fn content(&self, index: usize) -> Content {
        let node = self.nodes[index];
        let (number, payload) = (node.number() as usize, node.payload as usize);
        let (normal, at, on) = match node.kind() {
            axis @ 0..=2 => (DVec3::AXES[axis as usize], f32::from_bits(node.payload), None),
            PLANE | FULL_PLANE => {
                let [x, y, z, at] = self.planes[payload];
                (Vec3::new(x, y, z).as_dvec3(), at, (node.kind() == FULL_PLANE).then_some(index + 1))
            }
            _ => return Content::Leaf(payload..payload + number),
        };
        let left = on.map_or(index + 1, |on| self.after_leaf(on));
        Content::Fork { normal, at: f64::from(at), on, left, right: number }
    }

    /// Adds a branch to the statistics. Triangles within a plane count as a leaf of their own.
    fn measure(&self, index: usize, depth: usize, shape: &mut TreeShape) {
        match self.content(index) {
            Content::Leaf(references) => shape.add_leaf(depth, references.len()),
            Content::Fork { on, left, right, .. } => {
                shape.nodes += 1;
                for child in on.into_iter().chain([left, right]) {
                    self.measure(child, depth + 1, shape);
                }
            }
        }
    }
}
