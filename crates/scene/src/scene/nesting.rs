//! Which of the media that overlap exists.

use crate::materials::Material;
use crate::placed::Placed;
use bilux_math::Aabb;
use std::cmp::Reverse;
use std::sync::Arc;

/// How many media a path may be in at a time.
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
    bounds: Aabb,
    /// The edges of its bounds.
    size: f32,
}

impl Nesting {
    /// The order follows the priorities. Of equal ones that of the innermost wins, by what bounds lie within which at time 0: fire exists in the
    /// fog around it, in whatever order a file names them. Where that decides nothing, the first wins. All this is the same from both ends
    /// of a path.
    pub(super) fn of(objects: &[Placed], materials: &[Arc<dyn Material>]) -> Nesting {
        let mut nested: Vec<Nested> = Vec::new();
        for (index, object) in objects.iter().enumerate() {
            if let Some(medium) = materials[object.material as usize].nested() {
                let bounds = object.motion.at(0.0).bounds(&object.mesh.bounds());
                let size = bounds.extent().element_sum();
                nested.push(Nested { index, priority: medium.priority, bounds, size });
            }
        }
        if nested.is_empty() {
            return Nesting::default();
        }
        nested.sort_by(|a, b| b.size.total_cmp(&a.size));
        let containers = &nested[..nested.len().min(MAX_CONTAINERS)];
        let mut too_deep = None;
        let mut order: Vec<(u32, usize, Reverse<usize>)> = Vec::with_capacity(nested.len());
        for one in &nested {
            let (mut around, mut of_its_priority) = (0, 0);
            for other in containers.iter().filter(|other| other.holds(one)) {
                around += 1;
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
        Nesting { ranks, too_deep }
    }
}

impl Nested {
    /// Whether the bounds of another, smaller one lie within these.
    fn holds(&self, other: &Nested) -> bool {
        let (outer, inner) = (&self.bounds, &other.bounds);
        self.size > other.size && outer.contains(inner.min) && outer.contains(inner.max)
    }
}
