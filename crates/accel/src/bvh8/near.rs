//! Finds the point of a mesh that is nearest to a given point.

use super::Bvh8;
use super::layout::{self, BLOCK_UNITS, Planes, Ref, Unit, WIDTH};
use bilux_math::glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A point of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestPoint {
    /// Distance from the given point.
    pub distance: f32,
    /// Position of the nearest point.
    pub point: [f32; 3],
    /// Barycentric weight of the triangle's second vertex, 0..=1.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex, 0..=1.
    pub v: f32,
    /// Index of the triangle within its mesh.
    pub primitive: u32,
}

impl Bvh8 {
    /// The point of the mesh that is nearest to `point`, ties to the lowest primitive. Returns `None` where
    /// everything is farther away than `within` (which may be infinite), and for points that are not finite.
    ///
    /// Computed in f64. To find out on which side of a closed mesh the point lies, call
    /// [`crate::Accelerator::all_hits`] with any ray from it, and count the hits.
    pub fn nearest_point(&self, point: [f32; 3], within: f32) -> Option<NearestPoint> {
        let at = DVec3::from(point.map(f64::from));
        // Written so that a NaN reach finds nothing.
        if self.units.is_empty() || !at.is_finite() || within.is_nan() || within < 0.0 {
            return None;
        }
        let mut best = Best { squared: f64::from(within) * f64::from(within), at: None };
        // Subtrees, nearest first: the bits of non-negative distances sort like the distances.
        let mut waiting = BinaryHeap::from([Reverse((0, self.outline.root.0))]);
        while let Some(Reverse((squared, reference))) = waiting.pop() {
            let reference = Ref(reference);
            if f64::from_bits(squared) > best.squared {
                break;
            }
            if reference.is_node() {
                for (planes, child) in layout::children(&self.units[reference.unit()..]) {
                    let squared = to_box(at, &planes);
                    if squared <= best.squared {
                        waiting.push(Reverse((squared.to_bits(), child.0)));
                    }
                }
            } else {
                for block in self.units[reference.leaf_units()].chunks_exact(BLOCK_UNITS) {
                    for (corners, primitive) in layout::triangles(block) {
                        best.update(at, corners.map(|p| DVec3::from(p.map(f64::from))), primitive);
                    }
                }
            }
        }
        best.found()
    }

    /// The distance from `point` to the nearest point of the mesh, or `within` where that is less: what [`Bvh8::nearest_point`] finds, in
    /// less time if little is near. Points that are not finite are far from everything.
    pub fn clearance(&self, point: [f32; 3], within: f32) -> f32 {
        let at = DVec3::from(point.map(f64::from));
        if self.units.is_empty() || !at.is_finite() {
            return within;
        }
        let squared = self.nearer(self.outline.root, point, f64::from(within) * f64::from(within));
        (squared.sqrt() as f32).min(within)
    }

    /// The squared distance to the nearest triangle of a subtree, or `squared` where that is less.
    fn nearer(&self, reference: Ref, point: [f32; 3], mut squared: f64) -> f64 {
        if reference.is_node() {
            let node = &self.units[reference.unit()..];
            for (child, to_box) in to_boxes(point, node).into_iter().enumerate() {
                let child = Ref(node[6].0[child]);
                if f64::from(to_box) < squared && child != Ref::EMPTY {
                    squared = self.nearer(child, point, squared);
                }
            }
            return squared;
        }
        let at = DVec3::from(point.map(f64::from));
        for block in self.units[reference.leaf_units()].chunks_exact(BLOCK_UNITS) {
            for (corners, _) in layout::triangles(block) {
                let (_, nearest) = nearest_of_triangle(at, corners.map(|p| DVec3::from(p.map(f64::from))));
                squared = squared.min(at.distance_squared(nearest));
            }
        }
        squared
    }
}

/// The squared distances to the boxes of a node's children, less what rounding adds; infinite for slots without a child.
#[inline(always)]
fn to_boxes(point: [f32; 3], node: &[Unit]) -> [f32; WIDTH] {
    let mut squares = [0.0; WIDTH];
    for (axis, &x) in point.iter().enumerate() {
        let [low, high] = [&node[axis].0, &node[3 + axis].0];
        for (square, (low, high)) in squares.iter_mut().zip(low.iter().zip(high)) {
            let apart = (f32::from_bits(*low) - x).max(x - f32::from_bits(*high)).max(0.0) * (1.0 - 1e-6);
            *square += apart * apart;
        }
    }
    squares
}

/// The squared distance to a box, never more than that to anything in it as computed below.
fn to_box(at: DVec3, [low, high]: &Planes) -> f64 {
    let [low, high] = [low, high].map(|p| DVec3::from(p.map(f64::from)));
    at.distance_squared(at.clamp(low, high)) * (1.0 - 1e-12)
}

struct Best {
    squared: f64,
    at: Option<([f64; 2], DVec3, u32)>,
}

impl Best {
    fn update(&mut self, at: DVec3, triangle: [DVec3; 3], primitive: u32) {
        let (weights, point) = nearest_of_triangle(at, triangle);
        let squared = at.distance_squared(point);
        let lower = self.at.is_none_or(|(.., best)| primitive < best);
        if squared < self.squared || (squared == self.squared && lower) {
            (self.squared, self.at) = (squared, Some((weights, point, primitive)));
        }
    }

    fn found(self) -> Option<NearestPoint> {
        let ([u, v], point, primitive) = self.at?;
        let distance = self.squared.sqrt() as f32;
        Some(NearestPoint {
            distance,
            point: point.as_vec3().to_array(),
            u: u as f32,
            v: v as f32,
            primitive,
        })
    }
}

/// The nearest point of a triangle, degenerate or not, and the weights of its second and third vertex.
fn nearest_of_triangle(at: DVec3, [a, b, c]: [DVec3; 3]) -> ([f64; 2], DVec3) {
    let (ab, ac, ap) = (b - a, c - a, at - a);
    let normal = ab.cross(ac);
    let area = normal.length_squared();
    let (u, v) = (ap.cross(ac).dot(normal) / area, ab.cross(ap).dot(normal) / area);
    if area > 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
        return ([u, v], a + ab * u + ac * v);
    }
    let on_edge = |from: DVec3, to: DVec3| {
        let (along, length) = ((at - from).dot(to - from), (to - from).length_squared());
        let w = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
        (w, from + (to - from) * w)
    };
    let ((p, on_ab), (q, on_ac), (r, on_bc)) = (on_edge(a, b), on_edge(a, c), on_edge(b, c));
    let candidates = [([p, 0.0], on_ab), ([0.0, q], on_ac), ([1.0 - r, r], on_bc)];
    let nearer = |x: ([f64; 2], DVec3), y: ([f64; 2], DVec3)| {
        if at.distance_squared(y.1) < at.distance_squared(x.1) { y } else { x }
    };
    nearer(nearer(candidates[0], candidates[1]), candidates[2])
}
