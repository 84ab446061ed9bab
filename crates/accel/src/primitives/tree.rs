//! A bounding volume hierarchy over anything that has bounding boxes and crossings.

use super::Primitives;
use crate::accelerator::{Traverse, TreeShape};
use crate::bvh::tree::Tree;
use crate::counters::Count;
use crate::ray::{Culling, Hit, Query, Ray};
use crate::slab::SlabRay;
use crate::triangle::{Crossing, PreparedRay};
use bilux_math::Aabb;
use std::ops::ControlFlow;

/// A binary bounding volume hierarchy over [`Primitives`].
///
/// It returns the nearest hit, ties to the lowest index: the same hit that a loop over all primitives finds.
#[derive(Clone, Debug)]
pub struct PrimitiveTree<P> {
    primitives: P,
    tree: Tree,
    /// In leaf order.
    order: Vec<u32>,
}

impl<P: Primitives> PrimitiveTree<P> {
    /// Builds a tree. It is the same whatever the number of threads.
    pub fn new(primitives: P) -> PrimitiveTree<P> {
        let len = primitives.len().min(u32::MAX as usize - 1);
        let (tree, order) = Tree::over(len, |index| aabb(primitives.bounds(index)));
        PrimitiveTree { primitives, tree, order }
    }

    /// The primitives that it was built over.
    pub fn primitives(&self) -> &P {
        &self.primitives
    }

    fn slabs(&self, ray: &Ray) -> Option<SlabRay> {
        let pad = PreparedRay::new(ray)?.pad(&self.tree.bounds());
        Some(SlabRay::new(ray.origin, ray.direction, ray.t_min, pad))
    }

    /// The crossings that count, as hits.
    #[inline(always)]
    fn hits(&self, index: u32, ray: &Ray, query: &Query, mut visit: impl FnMut(Hit)) {
        self.primitives.crossings(index, ray, &mut |Crossing { t, u, v, back }| {
            let seen = !(back && query.culling == Culling::Back);
            if t >= ray.t_min && t <= ray.t_max && seen {
                visit(Hit { t, u, v, primitive: index, instance: 0 }.with_positive_zeros());
            }
        });
    }
}

impl<P: Primitives> Traverse for PrimitiveTree<P> {
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        let slabs = self.slabs(ray)?;
        let mut nearest: Option<Hit> = None;
        let mut limit = slabs.limit(ray.t_max);
        self.tree.walk(&slabs, limit, count, |leaf, count| {
            count.triangles(leaf.len());
            for &index in &self.order[leaf] {
                self.hits(index, ray, query, |hit| {
                    let wins = |best: &Hit| hit.t < best.t || (hit.t == best.t && index < best.primitive);
                    if nearest.as_ref().is_none_or(wins) && query.accepts(&hit) {
                        nearest = Some(hit);
                    }
                });
            }
            if let Some(hit) = nearest.filter(|_| query.early_out) {
                limit = slabs.limit(hit.t);
            }
            ControlFlow::Continue(limit)
        });
        nearest
    }

    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        count.ray();
        let Some(slabs) = self.slabs(ray) else { return false };
        self.tree.find(&slabs, slabs.limit(ray.t_max), count, |slot| {
            let mut found = false;
            self.hits(self.order[slot], ray, query, |hit| found = found || query.accepts(&hit));
            found
        })
    }

    fn bounds(&self) -> Aabb {
        self.tree.bounds()
    }

    /// Size of the tree only; the primitives know their own.
    fn memory_bytes(&self) -> usize {
        self.tree.memory_bytes() + size_of_val(self.order.as_slice())
    }

    fn shape(&self) -> TreeShape {
        self.tree.shape()
    }
}

/// The box in the form that the trees use; empty when a corner is not finite.
fn aabb([low, high]: [[f32; 3]; 2]) -> Aabb {
    if low.iter().chain(&high).all(|x| x.is_finite()) {
        Aabb { min: low.into(), max: high.into() }
    } else {
        Aabb::EMPTY
    }
}
