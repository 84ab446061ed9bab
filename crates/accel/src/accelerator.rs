//! The queries that every acceleration structure answers.

use crate::counters::{Count, Counters, NoCounters};
use crate::ray::{Hit, Primitive, Query, Ray};
use bilux_math::Aabb;
use std::cmp::Ordering;
use std::sync::{Mutex, PoisonError};

/// A structure over triangles that answers ray queries. Made by [`crate::build`]; implemented through [`Traverse`].
///
/// Every implementation gives the same answers, bit for bit.
pub trait Accelerator: Send + Sync {
    /// The nearest hit. Ties go to the lowest instance, then to the lowest primitive.
    fn closest_hit(&self, ray: &Ray, query: &Query) -> Option<Hit>;
    /// True when anything at all is hit.
    fn any_hit(&self, ray: &Ray, query: &Query) -> bool;
    /// As [`Accelerator::closest_hit`] for a batch: the hit of `rays[i]` goes to `hits[i]`; where one slice is
    /// longer, its extra elements are left as they are. The hits are the same, bit for bit, and often found sooner
    /// than one by one.
    fn closest_hits(&self, rays: &[Ray], query: &Query, hits: &mut [Option<Hit>]);
    /// As [`Accelerator::any_hit`] for a batch, likewise.
    fn any_hits(&self, rays: &[Ray], query: &Query, hits: &mut [bool]);
    /// As [`Accelerator::any_hits`], and says what was hit: a triangle that counts, which need not be the nearest, nor
    /// the same one in every structure.
    fn blockers(&self, rays: &[Ray], query: &Query, blockers: &mut [Option<Primitive>]);
    /// As [`Accelerator::closest_hit`], and counts the work.
    fn closest_hit_counted(&self, ray: &Ray, query: &Query, counters: &mut Counters) -> Option<Hit>;
    /// Every hit along the ray that the query keeps, nearest first, ties by lowest instance and then lowest
    /// primitive. Each hit is listed once, however the structure splits its triangles.
    fn all_hits(&self, ray: &Ray, query: &Query) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.all_hits_into(ray, query, &mut hits);
        hits
    }
    /// As [`Accelerator::all_hits`], into a vector, whose elements are replaced: for many rays, one vector will do.
    fn all_hits_into(&self, ray: &Ray, query: &Query, hits: &mut Vec<Hit>) {
        hits.clear();
        let found = Mutex::new(&mut *hits);
        let note = |hit: &Hit| {
            if query.accepts(hit) {
                found.lock().unwrap_or_else(PoisonError::into_inner).push(*hit);
            }
            // Never accept a hit, so that the search goes on to the end of the ray.
            false
        };
        self.closest_hit(ray, &Query { filter: Some(&note), ..*query });
        hits.sort_unstable_by(|a, b| {
            let primitives = |hit: &Hit| (hit.instance, hit.primitive);
            // Zeros of either sign are the same distance; a NaN distance is never a hit.
            a.t.partial_cmp(&b.t).unwrap_or(Ordering::Equal).then(primitives(a).cmp(&primitives(b)))
        });
        hits.dedup();
    }
    /// As [`Accelerator::any_hit`], and counts the work.
    fn any_hit_counted(&self, ray: &Ray, query: &Query, counters: &mut Counters) -> bool;
    /// The bounding box of everything.
    fn bounds(&self) -> Aabb;
    /// Size of the structure in bytes, triangles included.
    fn memory_bytes(&self) -> usize;
    /// Statistics of the tree.
    fn shape(&self) -> TreeShape;
}

/// Queries of a structure, each implemented once, generic over a [`Count`].
pub trait Traverse: Send + Sync {
    /// See [`Accelerator::closest_hit`]. No number of a hit is a negative zero.
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit>;
    /// See [`Accelerator::any_hit`].
    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool;
    /// See [`Accelerator::closest_hits`]; traces the rays one by one unless a structure overrides it.
    fn closest_each(&self, rays: &[Ray], query: &Query, hits: &mut [Option<Hit>]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.closest(ray, query, &mut NoCounters);
        }
    }
    /// See [`Accelerator::any_hits`]; traces the rays one by one unless a structure overrides it.
    fn any_each(&self, rays: &[Ray], query: &Query, hits: &mut [bool]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.any(ray, query, &mut NoCounters);
        }
    }
    /// See [`Accelerator::blockers`]; traces the rays one by one unless a structure overrides it.
    fn blocker_each(&self, rays: &[Ray], query: &Query, blockers: &mut [Option<Primitive>]) {
        for (ray, blocker) in rays.iter().zip(blockers) {
            *blocker = self.closest(ray, query, &mut NoCounters).map(|hit| hit.primitive());
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
        self.closest(ray, query, &mut NoCounters)
    }
    fn any_hit(&self, ray: &Ray, query: &Query) -> bool {
        self.any(ray, query, &mut NoCounters)
    }
    fn closest_hits(&self, rays: &[Ray], query: &Query, hits: &mut [Option<Hit>]) {
        self.closest_each(rays, query, hits);
    }
    fn any_hits(&self, rays: &[Ray], query: &Query, hits: &mut [bool]) {
        self.any_each(rays, query, hits);
    }
    fn blockers(&self, rays: &[Ray], query: &Query, blockers: &mut [Option<Primitive>]) {
        self.blocker_each(rays, query, blockers);
    }
    fn closest_hit_counted(&self, ray: &Ray, query: &Query, counters: &mut Counters) -> Option<Hit> {
        self.closest(ray, query, counters)
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

/// Statistics of a tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeShape {
    /// Nodes, leaves included.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// References to triangles, or pieces of them, in all leaves.
    pub references: usize,
    /// Nodes on the longest path from the root to a leaf, both ends counted; 0 if there is no tree.
    pub depth: usize,
    /// Sum over the leaves of the nodes on the path to each; divided by `leaves`, the mean depth.
    pub total_leaf_depth: usize,
    /// `leaf_sizes[n]` leaves hold `n` references; the last entry counts all larger ones too.
    pub leaf_sizes: [usize; 17],
}

impl TreeShape {
    /// Adds a leaf to the statistics.
    pub fn add_leaf(&mut self, depth: usize, references: usize) {
        self.nodes += 1;
        self.leaves += 1;
        self.references += references;
        self.depth = self.depth.max(depth);
        self.total_leaf_depth += depth;
        self.leaf_sizes[references.min(16)] += 1;
    }

    /// Mean leaf depth divided by the depth of a perfectly balanced tree; 1 is balanced.
    pub fn imbalance(&self) -> f64 {
        if self.leaves == 0 {
            return 1.0;
        }
        let mean = self.total_leaf_depth as f64 / self.leaves as f64;
        mean / (f64::from(self.leaves.ilog2()) + 1.0)
    }
}
