//! Which of the media that overlap exists.

use super::contact::touching;
use super::open_boundaries::OpenBoundaries;
use crate::geometry::placed::Placed;
use crate::materials::Material;
use bilux_math::{Aabb, Vec3};
use std::cmp::Reverse;
use std::sync::Arc;

/// Maximum number of media that a path may be in at a time.
pub const MAX_NESTED: usize = 8;

/// So many objects, the largest, are taken into account as what may be around others.
const MAX_CONTAINERS: usize = 2048;

/// The order of the media that have a priority.
#[derive(Default)]
pub(super) struct Nesting {
    /// A number for each object: of media that overlap, the one with the highest exists. It is 0 where the material takes no part in
    /// that. None at all where that is so for all.
    pub(super) ranks: Vec<u32>,
    /// The object that lies within more others than a path may be in, and how many these are.
    pub(super) too_deep: Option<(usize, usize)>,
}

/// An object whose medium has a priority.
struct Nested {
    index: usize,
    priority: u32,
    /// Bounds of the object; of everything for what is open, which has none of its own.
    bounds: Aabb,
    /// The edges of its bounds.
    size: f32,
    /// Cubic metres: what fills its bounds is around what touches them.
    volume: f64,
}

/// Bounds that are so much of their size off are the same.
const ROUNDING: f32 = 1e-6;

/// The bounds of what is open.
const EVERYTHING: Aabb = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };

impl Nesting {
    /// The order follows the priorities. Of equal ones that of the innermost wins, by what bounds lie within which at time 0: fire exists in the
    /// fog around it, in whatever order a file names them. Where that decides nothing, the first wins. All this is the same from both ends
    /// of a path.
    pub(super) fn of(objects: &[Placed], materials: &[Arc<dyn Material>], open: &OpenBoundaries) -> Nesting {
        let touching = touching(objects, materials);
        let mut nested: Vec<Nested> = Vec::new();
        for (index, object) in objects.iter().enumerate() {
            let material = &materials[object.material as usize];
            let touches = touching.get(index) == Some(&true);
            let medium = if touches { material.in_contact() } else { material.nested() };
            if let Some(medium) = medium.filter(|_| open.body(index as u32) == index as u32) {
                let of_object = || object.motion.at(0.0).bounds(&object.mesh.bounds());
                let bounds = if open.is_body(index as u32) { EVERYTHING } else { of_object() };
                let size = bounds.extent().element_sum();
                let volume =
                    object.mesh.signed_volume() * f64::from(object.motion.at(0.0).matrix().determinant());
                nested.push(Nested { index, priority: medium.priority, bounds, size, volume: volume.abs() });
            }
        }
        if nested.is_empty() {
            return Nesting::default();
        }
        nested.sort_by(|a, b| b.size.total_cmp(&a.size).then(b.volume.total_cmp(&a.volume)));
        let containers = &nested[..nested.len().min(MAX_CONTAINERS)];
        let mut too_deep = None;
        let mut order: Vec<(u32, usize, Reverse<usize>)> = Vec::with_capacity(nested.len());
        for one in &nested {
            let (mut around, mut of_its_priority) = (0, 0);
            for other in containers.iter().filter(|other| other.holds(one)) {
                around += usize::from(other.size.is_finite());
                of_its_priority += usize::from(other.priority == one.priority);
            }
            if around >= MAX_NESTED {
                too_deep = too_deep.max(Some((one.index, around)));
            }
            order.push((one.priority, of_its_priority, Reverse(one.index)));
        }
        order.sort();
        let mut ranks = vec![0; objects.len()];
        order.iter().zip(1..).for_each(|((.., index), rank)| ranks[index.0] = rank);
        for object in 0..objects.len() {
            ranks[object] = ranks[open.body(object as u32) as usize];
        }
        Nesting { ranks, too_deep }
    }
}

impl Nested {
    /// Whether the bounds of another, smaller one lie within these; of the same bounds, what has more volume is around.
    fn holds(&self, other: &Nested) -> bool {
        let rounding = ROUNDING * other.size;
        let margin = Vec3::splat(rounding);
        let outer = Aabb { min: self.bounds.min - margin, max: self.bounds.max + margin };
        let is_larger = match self.size - other.size {
            difference if difference.abs() <= rounding => self.volume > other.volume,
            difference => difference > 0.0,
        };
        is_larger && outer.contains(other.bounds.min) && outer.contains(other.bounds.max)
    }
}
