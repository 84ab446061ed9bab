//! BSP trees that order polygons, after Fuchs, Kedem and Naylor [Fuchs 1980].
//!
//! Each plane is as thick as the ray test is uncertain, so space falls into three regions: in front of it, on it,
//! behind it. Polygons are cut and distributed to every region in which they may have hits; a hit belongs to exactly
//! one of the three, by the computed distance of its point.

use crate::canvas::{Canvas, PixelHit};
use crate::piece::Piece;
use crate::polygon::{Plane, clip, corners};
use crate::result::VisibilityCounts;
use crate::screen::{Screen, Slack};
use crate::splitter::{candidates, fewest_splits};
use bilux_accel::TriangleMesh;
use bilux_math::DVec3;

/// The tree.
#[derive(Debug)]
pub(crate) struct Tree {
    pub(crate) root: Option<Child>,
    pub(crate) nodes: Vec<PartitionNode>,
    pieces: Vec<Piece>,
    tests: Vec<Test>,
    /// Number of triangles that it was built for.
    triangles: usize,
    splits: usize,
    dealt: usize,
}

/// Limits of the work that a triangle may cause (and a small scene altogether) before planes become infinitely thick, so that
/// depth orders the rest: pieces, tests on their outlines, and pieces distributed. All grow quadratically with the
/// number of triangles where all triangles intersect each other, share a corner, or form a ball.
const MAX_PIECES: usize = 16;
const MAX_TESTS: usize = 128;
const MAX_DEALT: usize = 1 << 14;
const ALWAYS: usize = 1 << 19;

/// A thick plane and the pieces on it.
#[derive(Debug)]
pub(crate) struct PartitionNode {
    pub(crate) plane: Plane,
    /// Half the thickness: no hit of a polygon in the plane is farther from it.
    pub(crate) half: f64,
    /// Pieces with hits on the plane; a range of [`Tree::pieces`].
    on: std::ops::Range<u32>,
    pub(crate) front: Option<Child>,
    pub(crate) back: Option<Child>,
    /// Minimum and maximum corner of the bounding box of this node and everything below.
    bounds: [DVec3; 2],
}

/// A child of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    /// A plane.
    PartitionNode(u32),
    /// Something of the caller's that needs no more planes.
    Leaf(u32),
}

#[derive(Clone, Copy, Debug)]
struct Test {
    node: u32,
    region: Region,
    before: Option<u32>,
}

/// The position of a point relative to a thick plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Region {
    /// Beyond half the thickness, on the side that the normal points to.
    Front,
    /// Within the thickness.
    On,
    /// Beyond half the thickness on the other side.
    Back,
}

/// A stop on a walk through the tree.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stop {
    /// About to go below this child; return false to skip it.
    Enter(Child),
    /// At the pieces on a node's plane.
    On(u32),
    /// At a leaf.
    Leaf(u32),
}

/// The end of the order at which a walk begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    /// With what nothing can hide.
    Nearest,
    /// With what can hide nothing.
    Farthest,
}

/// The parts into which a plane splits a set of pieces.
#[derive(Debug, Default)]
pub(crate) struct Sides {
    pub(crate) front: Vec<Piece>,
    pub(crate) back: Vec<Piece>,
}

impl PartitionNode {
    #[inline]
    pub(crate) fn region(&self, distance: f64) -> Region {
        // Neither comparison holds for a NaN distance: everything is on such a plane.
        if distance > self.half {
            Region::Front
        } else if distance < -self.half {
            Region::Back
        } else {
            Region::On
        }
    }
}

/// All finite triangles of a mesh, whole.
pub(crate) fn whole_pieces(mesh: &TriangleMesh) -> Vec<Piece> {
    let triangles = mesh.triangles().iter().enumerate();
    triangles
        .filter_map(|(index, triangle)| {
            Some(Piece { triangle: index as u32, polygon: corners(triangle)?.to_vec(), tests: None })
        })
        .collect()
}

impl Tree {
    /// An empty tree.
    pub(crate) fn new(mesh: &TriangleMesh) -> Tree {
        let (nodes, pieces, tests) = (Vec::new(), Vec::new(), Vec::new());
        Tree { root: None, nodes, pieces, tests, triangles: mesh.len(), splits: 0, dealt: 0 }
    }

    fn is_spent(&self) -> bool {
        self.pieces.len() + self.splits > MAX_PIECES * self.triangles + ALWAYS
            || self.tests.len() > MAX_TESTS * self.triangles + ALWAYS
            || self.dealt > MAX_DEALT * self.triangles + ALWAYS
    }

    /// A tree of the polygons' own planes; of a few candidates, the one that cuts the fewest [Fuchs 1983].
    pub(crate) fn of_own_planes(mesh: &TriangleMesh, slack: &Slack, counts: &mut VisibilityCounts) -> Tree {
        let mut tree = Tree::new(mesh);
        let mut waiting = vec![(SubtreeSlot::Root, whole_pieces(mesh))];
        while let Some((place, pieces)) = waiting.pop() {
            if pieces.is_empty() {
                continue;
            }
            let candidates = candidates(pieces.len(), tree.nodes.len());
            let (plane, thickness) = fewest_splits(&pieces, &candidates, mesh, slack);
            let node = tree.add(place, plane, thickness, slack);
            let sides = tree.distribute(pieces, slack, counts);
            waiting.push((SubtreeSlot::Front(node), sides.front));
            waiting.push((SubtreeSlot::Back(node), sides.back));
        }
        tree.bound();
        counts.pieces += tree.pieces.len() as u64;
        tree
    }

    /// Attaches a child at its slot.
    pub(crate) fn attach(&mut self, place: SubtreeSlot, child: Child) {
        match place {
            SubtreeSlot::Root => self.root = Some(child),
            SubtreeSlot::Front(node) => self.nodes[node as usize].front = Some(child),
            SubtreeSlot::Back(node) => self.nodes[node as usize].back = Some(child),
        }
    }

    /// Adds a node with nothing on it. `thickness` is how far the polygons that define the plane deviate from it.
    pub(crate) fn add(&mut self, place: SubtreeSlot, plane: Plane, thickness: f64, slack: &Slack) -> u32 {
        let index = self.nodes.len() as u32;
        self.attach(place, Child::PartitionNode(index));
        let on = self.pieces.len() as u32..self.pieces.len() as u32;
        let thickness = if self.is_spent() { f64::INFINITY } else { thickness };
        let (half, bounds) = (thickness + 2.0 * slack.radius, [DVec3::INFINITY, DVec3::NEG_INFINITY]);
        self.nodes.push(PartitionNode { plane, half, on, front: None, back: None, bounds });
        index
    }

    /// Distributes pieces over the three regions of the last node.
    pub(crate) fn distribute(
        &mut self,
        pieces: Vec<Piece>,
        slack: &Slack,
        counts: &mut VisibilityCounts,
    ) -> Sides {
        let index = self.nodes.len() as u32 - 1;
        let PartitionNode { plane, half, .. } = self.nodes[index as usize];
        // A hit is at most a radius away from its polygon.
        let (inner, outer) = (half - slack.radius, half + slack.radius);
        let mut sides = Sides::default();
        self.dealt += pieces.len();
        for piece in pieces {
            let range = plane.range(&piece.polygon);
            if range.0 > outer {
                sides.front.push(piece);
                continue;
            }
            if range.1 < -outer {
                sides.back.push(piece);
                continue;
            }
            let is_cut = range.0 < -half && range.1 > half;
            self.splits += usize::from(is_cut);
            counts.splits += u64::from(is_cut);
            let mut part = |region, polygon| Piece {
                triangle: piece.triangle,
                polygon,
                tests: self.test_if_needed(&piece, index, region, range, half, slack.radius),
            };
            if range.1 > inner {
                sides.front.push(part(Region::Front, clip(&piece.polygon, &plane, inner)));
            }
            if range.0 < -inner {
                sides.back.push(part(Region::Back, clip(&piece.polygon, &plane.flipped(), inner)));
            }
            let above = clip(&piece.polygon, &plane, -outer);
            let within = part(Region::On, clip(&above, &plane.flipped(), -outer));
            self.pieces.push(within);
        }
        self.nodes[index as usize].on.end = self.pieces.len() as u32;
        sides
    }

    /// The chain of tests for a part of `piece`: one more than the piece's own, unless the whole piece is so far from
    /// the other regions that its hits are too.
    fn test_if_needed(
        &mut self,
        piece: &Piece,
        node: u32,
        region: Region,
        (low, high): (f64, f64),
        half: f64,
        radius: f64,
    ) -> Option<u32> {
        let clear = match region {
            Region::Front => low > half + radius,
            Region::On => low >= radius - half && high <= half - radius,
            Region::Back => high < -half - radius,
        };
        if clear {
            return piece.tests;
        }
        self.tests.push(Test { node, region, before: piece.tests });
        Some(self.tests.len() as u32 - 1)
    }

    /// Computes every node's bound, bottom up.
    fn bound(&mut self) {
        for index in (0..self.nodes.len()).rev() {
            let node = &self.nodes[index];
            let points = self.pieces_on(index as u32).iter().flat_map(|piece| &piece.polygon);
            let own = points.fold(node.bounds, |[low, high], &p| [low.min(p), high.max(p)]);
            let below = [node.front, node.back].into_iter().flatten();
            let bounds = below.fold(own, |[low, high], child| match child {
                Child::PartitionNode(below) => {
                    let [least, most] = self.nodes[below as usize].bounds;
                    [low.min(least), high.max(most)]
                }
                Child::Leaf(_) => [low, high],
            });
            self.nodes[index].bounds = bounds;
        }
    }

    /// The corners of the bounding box of everything below a child; `None` for leaves.
    pub(crate) fn hull(&self, child: Child) -> Option<[DVec3; 8]> {
        let Child::PartitionNode(node) = child else { return None };
        let bounds = self.nodes[node as usize].bounds;
        let pick = |i: usize, bit: usize| bounds[i >> bit & 1];
        Some(std::array::from_fn(|i| DVec3::new(pick(i, 0).x, pick(i, 1).y, pick(i, 2).z)))
    }

    /// The total number of pieces on planes.
    pub(crate) fn pieces_on_planes(&self) -> usize {
        self.pieces.len()
    }

    /// The pieces on a node's plane.
    pub(crate) fn pieces_on(&self, node: u32) -> &[Piece] {
        let on = &self.nodes[node as usize].on;
        &self.pieces[on.start as usize..on.end as usize]
    }

    /// True when a hit is in the piece's own cell. Along a ray the computed distance from each plane is monotone in
    /// `t`, so that every hit is in exactly one cell, and nearer hits are in nearer cells.
    #[inline]
    pub(crate) fn owns(&self, piece: &Piece, hit: &PixelHit, canvas: &mut Canvas, eye: DVec3) -> bool {
        let mut next = piece.tests;
        if next.is_none() {
            return true;
        }
        let (direction, t) = (canvas.direction(hit.pixel), f64::from(hit.t));
        while let Some(test) = next {
            let Test { node, region, before } = self.tests[test as usize];
            let node = &self.nodes[node as usize];
            canvas.counts.side_tests += 1;
            if node.region(node.plane.side(eye) + t * node.plane.normal.dot(direction)) != region {
                return false;
            }
            next = before;
        }
        true
    }

    /// Walks through the tree in the order that the eye determines.
    pub(crate) fn walk(&self, eye: DVec3, start: Start, mut visit: impl FnMut(Stop) -> bool) {
        let mut waiting: Vec<Stop> = self.root.map(Stop::Enter).into_iter().collect();
        while let Some(stop) = waiting.pop() {
            if !visit(stop) {
                continue;
            }
            match stop {
                Stop::Enter(Child::PartitionNode(index)) => {
                    let node = &self.nodes[index as usize];
                    let (front, on, back) =
                        (node.front.map(Stop::Enter), Some(Stop::On(index)), node.back.map(Stop::Enter));
                    let mut order = match node.region(node.plane.side(eye)) {
                        Region::Front => [front, on, back],
                        Region::Back => [back, on, front],
                        // From within the plane, each ray leaves it on at most one side.
                        Region::On => [on, front, back],
                    };
                    // What is pushed last is popped first.
                    if start == Start::Nearest {
                        order.reverse();
                    }
                    waiting.extend(order.into_iter().flatten());
                }
                Stop::Enter(Child::Leaf(leaf)) => waiting.push(Stop::Leaf(leaf)),
                Stop::On(_) | Stop::Leaf(_) => {}
            }
        }
    }
}

/// The slot of a subtree.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SubtreeSlot {
    /// The root: the whole tree.
    Root,
    /// In front of a node.
    Front(u32),
    /// Behind a node.
    Back(u32),
}

/// Draws a piece's hits in its cell, wherever `wants` accepts the pixel.
#[inline]
pub(crate) fn draw_piece(
    tree: &Tree,
    piece: &Piece,
    screen: &Screen,
    canvas: &mut Canvas,
    wants: impl Fn(&Canvas, usize) -> bool,
    mut write: impl FnMut(&mut Canvas, PixelHit),
) {
    canvas.each_pixel(screen.rect(&piece.polygon), |canvas, pixel| {
        if !wants(canvas, pixel) {
            return;
        }
        let Some(hit) = canvas.hit(pixel, piece.triangle) else { return };
        if tree.owns(piece, &hit, canvas, screen.eye) {
            write(canvas, hit);
        }
    });
}
