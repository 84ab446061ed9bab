//! What every structure can be asked.

use crate::counters::{Count, Counters, NoCounters};
use crate::ray::{Hit, Query, Ray};
use bilux_math::Aabb;
use std::cmp::Ordering;
use std::sync::{Mutex, PoisonError};

/// A structure over triangles that answers rays. Made by [`crate::build`]; implemented through [`Traverse`].
///
/// Every implementation gives the same answers, bit for bit.
pub trait Accelerator: Send + Sync {
    /// The nearest hit, ties to the lowest primitive (and before that, to the lowest instance).
    fn closest_hit(&self, ray: &Ray, query: &Query) -> Option<Hit>;
    /// True when anything at all is hit.
    fn any_hit(&self, ray: &Ray, query: &Query) -> bool;
    /// As [`Accelerator::closest_hit`] for each ray, into the place of the same number; rays or places that have
    /// no counterpart are left as they are. The same hits, bit for bit, and often sooner than one by one.
    fn closest_hits(&self, rays: &[Ray], query: &Query, hits: &mut [Option<Hit>]);
    /// As [`Accelerator::any_hit`] for each ray, likewise.
    fn any_hits(&self, rays: &[Ray], query: &Query, hits: &mut [bool]);
    /// As [`Accelerator::closest_hit`], counting what it took.
    fn closest_hit_counted(&self, ray: &Ray, query: &Query, counters: &mut Counters) -> Option<Hit>;
    /// Every hit along the ray that the query keeps, the nearest first, of equals that of the lowest instance and
    /// primitive; each once, whatever the structure had to cut.
    fn all_hits(&self, ray: &Ray, query: &Query) -> Vec<Hit> {
        let found = Mutex::new(Vec::new());
        let note = |hit: &Hit| {
            if query.keeps(hit) {
                found.lock().unwrap_or_else(PoisonError::into_inner).push(hit.with_positive_zeros());
            }
            // Nothing counts, so that the search goes on to the end of the ray.
            false
        };
        self.closest_hit(ray, &Query { filter: Some(&note), ..*query });
        let mut hits = found.into_inner().unwrap_or_else(PoisonError::into_inner);
        hits.sort_unstable_by(|a, b| {
            let primitives = |hit: &Hit| (hit.instance, hit.primitive);
            // Zero of either sign is one distance; what is not a number is never hit.
            a.t.partial_cmp(&b.t).unwrap_or(Ordering::Equal).then(primitives(a).cmp(&primitives(b)))
        });
        hits.dedup();
        hits
    }
    /// As [`Accelerator::any_hit`], counting what it took.
    fn any_hit_counted(&self, ray: &Ray, query: &Query, counters: &mut Counters) -> bool;
    /// The box around everything.
    fn bounds(&self) -> Aabb;
    /// Bytes of the structure, triangles included.
    fn memory_bytes(&self) -> usize;
    /// How the tree has grown.
    fn shape(&self) -> TreeShape;
}

/// What a structure implements: each query once, over any [`Count`].
pub trait Traverse: Send + Sync {
    /// See [`Accelerator::closest_hit`].
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit>;
    /// See [`Accelerator::any_hit`].
    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool;
    /// See [`Accelerator::closest_hits`]; one by one, unless a structure knows better.
    fn closest_each(&self, rays: &[Ray], query: &Query, hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest(ray, query, &mut NoCounters);
        }
    }
    /// See [`Accelerator::any_hits`]; one by one, unless a structure knows better.
    fn any_each(&self, rays: &[Ray], query: &Query, hits: &mut [bool]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.any(ray, query, &mut NoCounters);
        }
    }
    /// See [`Accelerator::bounds`].
    fn bounds(&self) -> Aabb;
    /// See [`Accelerator::memory_bytes`].
    fn memory_bytes(&self) -> usize;
    /// See [`Accelerator::shape`].
    fn shape(&self) -> TreeShape;
}

impl<T: Traverse> Accelerator for T {
    fn closest_hit(&self, ray: &Ray, query: &Query) -> Option<Hit> {
        self.closest(ray, query, &mut NoCounters).map(Hit::with_positive_zeros)
    }
    fn any_hit(&self, ray: &Ray, query: &Query) -> bool {
        self.any(ray, query, &mut NoCounters)
    }
    fn closest_hits(&self, rays: &[Ray], query: &Query, hits: &mut [Option<Hit>]) {
        self.closest_each(rays, query, hits);
        for hit in hits.iter_mut().take(rays.len()).flatten() {
            *hit = hit.with_positive_zeros();
        }
    }
    fn any_hits(&self, rays: &[Ray], query: &Query, hits: &mut [bool]) {
        self.any_each(rays, query, hits);
    }
    fn closest_hit_counted(&self, ray: &Ray, query: &Query, counters: &mut Counters) -> Option<Hit> {
        self.closest(ray, query, counters).map(Hit::with_positive_zeros)
    }
    fn any_hit_counted(&self, ray: &Ray, query: &Query, counters: &mut Counters) -> bool {
        self.any(ray, query, counters)
    }
    fn bounds(&self) -> Aabb {
        Traverse::bounds(self)
    }
    fn memory_bytes(&self) -> usize {
        Traverse::memory_bytes(self)
    }
    fn shape(&self) -> TreeShape {
        Traverse::shape(self)
    }
}

/// How a tree has grown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeShape {
    /// Nodes, leaves included.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// References to triangles, or pieces of them, in all leaves.
    pub references: usize,
    /// Nodes on the longest way from the root to a leaf, both counted; 0 for no tree.
    pub depth: usize,
    /// Sum over the leaves of the nodes on the way to each; over `leaves`, the mean depth.
    pub total_leaf_depth: usize,
    /// `leaf_sizes[n]` leaves hold `n` references; the last entry counts all larger ones too.
    pub leaf_sizes: [usize; 17],
}

impl TreeShape {
    /// Counts a leaf in.
    pub fn add_leaf(&mut self, depth: usize, references: usize) {
        self.nodes += 1;
        self.leaves += 1;
        self.references += references;
        self.depth = self.depth.max(depth);
        self.total_leaf_depth += depth;
        self.leaf_sizes[references.min(16)] += 1;
    }

    /// Mean depth of a leaf over the depth that a perfectly balanced tree would have; 1 is balanced.
    pub fn imbalance(&self) -> f64 {
        if self.leaves == 0 {
            return 1.0;
        }
        let mean = self.total_leaf_depth as f64 / self.leaves as f64;
        mean / (f64::from(self.leaves.ilog2()) + 1.0)
    }
}
