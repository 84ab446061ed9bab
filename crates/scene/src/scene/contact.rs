//! Which glass touches other glass: faces that lie on each other are one surface, between what is on both sides.

use crate::geometry::placed::Placed;
use crate::materials::Material;
use bilux_math::hash::mix64;
use bilux_math::{Aabb, Transform, Vec3};
use std::sync::Arc;

/// Faces lie on each other if they are no further apart than this part of the largest coordinate: a few roundings.
const NEAR: f32 = 8.0 * f32::EPSILON;

/// And if the cosine of the angle between them is at least this.
const PARALLEL: f32 = 0.999;

/// A face, by its corners.
type Face = [Vec3; 3];

/// An object whose surface has a medium behind it.
struct Body {
    object: usize,
    bounds: Aabb,
    takes_part: bool,
    /// Whether it is known to touch another.
    touches: bool,
}

/// For each object without a priority whether its surface [touches](Material::in_contact) that of another medium, at time 0; none at all
/// where there are none.
pub(super) fn touching(objects: &[Placed], materials: &[Arc<dyn Material>]) -> Vec<bool> {
    let body = |(object, placed): (usize, &Placed)| {
        let material = &materials[placed.material as usize];
        material.in_contact()?;
        let bounds = placed.motion.at(0.0).bounds(&placed.mesh.bounds());
        let near = Vec3::splat(near(&bounds));
        let bounds = Aabb { min: bounds.min - near, max: bounds.max + near };
        let takes_part = material.nested().is_some();
        (!bounds.is_empty()).then_some(Body { object, bounds, takes_part, touches: false })
    };
    let mut bodies: Vec<Body> = objects.iter().enumerate().filter_map(body).collect();
    if bodies.iter().all(|body| body.takes_part) {
        return Vec::new();
    }
    bodies.sort_by(|a, b| a.bounds.min.x.total_cmp(&b.bounds.min.x));
    for first in 0..bodies.len() {
        let end = bodies[first].bounds.max.x;
        for second in first + 1..bodies.len() {
            let [a, b] = [&bodies[first], &bodies[second]];
            if b.bounds.min.x > end {
                break;
            }
            let is_known = |body: &Body| body.touches || body.takes_part;
            if (is_known(a) && is_known(b)) || !touch(objects, a, b) {
                continue;
            }
            bodies[first].touches = true;
            bodies[second].touches = true;
        }
    }
    let mut found = vec![false; objects.len()];
    bodies.iter().filter(|body| body.touches).for_each(|body| found[body.object] = true);
    found
}

fn near(bounds: &Aabb) -> f32 {
    NEAR * bounds.min.abs().max(bounds.max.abs()).max_element()
}

fn touch(objects: &[Placed], a: &Body, b: &Body) -> bool {
    let common = a.bounds.intersection(b.bounds);
    if common.is_empty() {
        return false;
    }
    let near = near(&common);
    let [a, b] = [a, b].map(|body| faces_in(&objects[body.object], &common));
    let cells = Cells::of(&b, near);
    a.iter().any(|face| cells.around(face, near).any(|other| lie_on_each_other(face, &b[other], near)))
}

fn bounds_of(face: &Face, near: f32) -> Aabb {
    let bounds = Aabb::of_points(*face);
    Aabb { min: bounds.min - near, max: bounds.max + near }
}

/// The faces of an object that reach into a box, in the world.
fn faces_in(placed: &Placed, common: &Aabb) -> Vec<Face> {
    let (mesh, to_world): (_, Transform) = (&placed.mesh, placed.motion.at(0.0));
    let corners = mesh.triangles.iter().map(|t| t.map(|i| to_world.point(mesh.positions[i as usize])));
    corners.filter(|face| !Aabb::of_points(*face).intersection(*common).is_empty()).collect()
}

/// Faces by the cells of a lattice that their bounds reach.
struct Cells {
    side: f32,
    /// The hash of a cell and a face there, in order.
    faces: Vec<(u64, u32)>,
    /// Faces that reach many cells.
    large: Vec<u32>,
}

/// A face that reaches more cells is compared with all.
const MANY: usize = 64;

impl Cells {
    fn of(faces: &[Face], near: f32) -> Cells {
        let size = |face: &Face| bounds_of(face, 0.0).extent().max_element();
        let mean = faces.iter().map(size).sum::<f32>() / faces.len().max(1) as f32;
        let mut cells =
            Cells { side: mean.max(near).max(f32::MIN_POSITIVE), faces: Vec::new(), large: Vec::new() };
        for (index, face) in (0..).zip(faces) {
            match cells.reached(face, near) {
                Some(reached) => cells.faces.extend(reached.into_iter().map(|cell| (cell, index))),
                None => cells.large.push(index),
            }
        }
        cells.faces.sort_unstable();
        cells
    }

    /// The hashes of the cells that a face reaches; `None` where these are many.
    fn reached(&self, face: &Face, near: f32) -> Option<Vec<u64>> {
        let bounds = bounds_of(face, near);
        let [low, high] =
            [bounds.min, bounds.max].map(|p| (p / self.side).floor().to_array().map(|c| c as i64));
        let count = |axis: usize| (high[axis] - low[axis]).unsigned_abs() as usize + 1;
        if (0..3).map(count).try_fold(1, usize::checked_mul).is_none_or(|count| count > MANY) {
            return None;
        }
        let mut reached = Vec::new();
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    reached.push([x, y, z].iter().fold(0, |hash, c| mix64(hash ^ *c as u64)));
                }
            }
        }
        Some(reached)
    }

    /// Faces in the cells that a face reaches.
    fn around(&self, face: &Face, near: f32) -> impl Iterator<Item = usize> {
        let reached = self.reached(face, near);
        let all = if reached.is_none() { &self.faces[..] } else { &[] };
        let in_cell = |cell: u64| {
            let from = self.faces.partition_point(|(other, _)| *other < cell);
            self.faces[from..].iter().take_while(move |(other, _)| *other == cell)
        };
        let some = reached.into_iter().flatten().flat_map(in_cell).chain(all).map(|(_, face)| *face);
        some.chain(self.large.iter().copied()).map(|face| face as usize)
    }
}

/// Whether two faces are in one plane and overlap there.
fn lie_on_each_other(a: &Face, b: &Face, near: f32) -> bool {
    let normal = |face: &Face| (face[1] - face[0]).cross(face[2] - face[0]).try_normalize();
    let (Some(n), Some(m)) = (normal(a), normal(b)) else { return false };
    if n.dot(m).abs() < PARALLEL || b.iter().any(|p| n.dot(*p - a[0]).abs() > near) {
        return false;
    }
    // Within the plane no side of either has the other beyond it.
    let is_beyond = |face: &Face, other: &Face| {
        (0..3).any(|i| {
            let (from, to, opposite) = (face[i], face[(i + 1) % 3], face[(i + 2) % 3]);
            let outwards = n.cross(to - from);
            let inner = outwards.dot(opposite - from);
            let outwards = outwards * -inner.signum();
            // Faces that only share a side do not lie on each other.
            other.iter().all(|p| outwards.dot(*p - from) >= -1e-3 * inner.abs())
        })
    };
    !is_beyond(a, b) && !is_beyond(b, a)
}
