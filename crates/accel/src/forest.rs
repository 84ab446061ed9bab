//! Several trees over the triangles of one mesh, which answer as one tree over all of them would: when some triangles
//! move, the others keep their tree.
//!
//! The triangles of each tree are in the order of the mesh, so that ties go to the same triangle in both.

use crate::accelerator::{Accelerator, Traverse, TreeShape};
use crate::bvh::tree::Tree;
use crate::counters::{Count, NoCounters};
use crate::instancing::uncounted_ray;
use crate::ray::{Filter, Hit, Primitive, Query, Ray};
use crate::slab::SlabRay;
use crate::triangle::PreparedRay;
use bilux_math::Aabb;
use std::ops::{ControlFlow, Range};
use std::sync::Arc;

/// Trees over parts of one mesh, in the mesh's space. It answers as one tree over the whole mesh, bit for bit.
pub struct Forest {
    parts: Vec<Part>,
    top: Tree,
    /// The parts in the order of the top's leaves.
    order: Vec<u32>,
}

/// A tree, and the ranges of the mesh's triangles that it was built over: in ascending order, and numbered in the tree
/// one after the other.
pub type PartialTree = (Arc<dyn Accelerator>, Vec<Range<u32>>);

/// A tree, and which triangles of the mesh it has.
struct Part {
    tree: Arc<dyn Accelerator>,
    runs: Vec<Run>,
}

/// Triangles that follow each other in a tree as in the mesh.
struct Run {
    /// The first of them in the tree.
    own: u32,
    /// And in the mesh.
    whole: u32,
    len: u32,
}

impl Forest {
    /// Joins trees.
    pub fn new(trees: Vec<PartialTree>) -> Forest {
        let parts: Vec<Part> = trees.into_iter().map(|(tree, ranges)| Part::new(tree, &ranges)).collect();
        let (top, order) = Tree::over(parts.len(), |part| parts[part as usize].tree.bounds());
        Forest { parts, top, order }
    }

    /// The number of trees.
    pub fn len(&self) -> usize {
        self.parts.len()
    }

    /// True when there are no trees.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// The ray as the boxes of the trees see it; `None` when it can hit nothing.
    fn slabs(&self, ray: &Ray) -> Option<SlabRay> {
        let pad = PreparedRay::new(ray)?.pad(&self.top.bounds());
        Some(SlabRay::new(ray.origin, ray.direction, ray.t_min, pad))
    }

    /// The rays that may hit each tree, by their indices.
    fn share_out(&self, rays: &[Ray]) -> Vec<Vec<u32>> {
        let mut shares = vec![Vec::new(); self.parts.len()];
        for (i, ray) in rays.iter().enumerate() {
            let Some(slabs) = self.slabs(ray) else { continue };
            let limit = slabs.limit(ray.t_max);
            self.top.walk(&slabs, limit, &mut NoCounters, |leaf, _| {
                self.order[leaf].iter().for_each(|&part| shares[part as usize].push(i as u32));
                ControlFlow::Continue(limit)
            });
        }
        shares
    }
}

impl Part {
    fn new(tree: Arc<dyn Accelerator>, ranges: &[Range<u32>]) -> Part {
        let (mut runs, mut own): (Vec<Run>, u32) = (Vec::new(), 0);
        for range in ranges.iter().filter(|range| !range.is_empty()) {
            let len = range.end - range.start;
            match runs.last_mut() {
                Some(last) if last.whole + last.len == range.start => last.len += len,
                _ => runs.push(Run { own, whole: range.start, len }),
            }
            own += len;
        }
        Part { tree, runs }
    }

    /// A triangle of the tree as one of the mesh.
    fn index_in_whole(&self, index: u32) -> u32 {
        let run = &self.runs[self.runs.partition_point(|run| run.own <= index).saturating_sub(1)];
        index - run.own + run.whole
    }

    /// A hit in the tree as one in the mesh.
    fn in_whole(&self, hit: &Hit) -> Hit {
        Hit { primitive: self.index_in_whole(hit.primitive), ..*hit }
    }

    /// A primitive of the mesh as one of the tree; none if it is in another tree.
    fn own(&self, primitive: Primitive) -> Primitive {
        let before = self.runs.partition_point(|run| run.whole <= primitive.index);
        let run = before.checked_sub(1).map(|i| &self.runs[i]);
        match run.filter(|run| primitive.instance == 0 && primitive.index - run.whole < run.len) {
            Some(run) => Primitive { instance: 0, index: primitive.index - run.whole + run.own },
            None => Primitive::NONE,
        }
    }

    /// The ray for the tree.
    fn ray(&self, ray: &Ray, t_max: f32) -> Ray {
        Ray { exclude: self.own(ray.exclude), t_max, ..*ray }
    }

    /// Calls `ask` with the query for the tree.
    fn query<T>(&self, query: &Query, ask: impl FnOnce(&Query) -> T) -> T {
        let Some(filter) = query.filter else { return ask(query) };
        let accepts = |hit: &Hit| filter(&self.in_whole(hit));
        let accepts: Filter = &accepts;
        ask(&Query { filter: Some(accepts), ..*query })
    }
}

/// The nearer of two hits; among equal ones the lower triangle.
fn nearer(a: Option<Hit>, b: Hit) -> Option<Hit> {
    let wins = |a: &Hit| b.t < a.t || (b.t == a.t && b.primitive < a.primitive);
    if a.as_ref().is_none_or(wins) { Some(b) } else { a }
}

impl Traverse for Forest {
    fn closest<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> Option<Hit> {
        count.ray();
        let slabs = self.slabs(ray)?;
        let (mut nearest, mut t_max) = (None, ray.t_max);
        self.top.walk(&slabs, slabs.limit(t_max), count, |leaf, count| {
            for part in self.order[leaf].iter().map(|&part| &self.parts[part as usize]) {
                let own = part.ray(ray, t_max);
                let hit = part.query(query, |query| match count.counters() {
                    Some(counters) => {
                        uncounted_ray(counters, |c| part.tree.closest_hit_counted(&own, query, c))
                    }
                    None => part.tree.closest_hit(&own, query),
                });
                let Some(hit) = hit else { continue };
                nearest = nearer(nearest, part.in_whole(&hit));
                if query.early_out {
                    t_max = hit.t;
                }
            }
            ControlFlow::Continue(slabs.limit(t_max))
        });
        nearest
    }

    fn any<C: Count>(&self, ray: &Ray, query: &Query, count: &mut C) -> bool {
        count.ray();
        let Some(slabs) = self.slabs(ray) else { return false };
        let (limit, mut found) = (slabs.limit(ray.t_max), false);
        self.top.walk(&slabs, limit, count, |leaf, count| {
            found = self.order[leaf].iter().map(|&part| &self.parts[part as usize]).any(|part| {
                let own = part.ray(ray, ray.t_max);
                part.query(query, |query| match count.counters() {
                    Some(counters) => uncounted_ray(counters, |c| part.tree.any_hit_counted(&own, query, c)),
                    None => part.tree.any_hit(&own, query),
                })
            });
            if found { ControlFlow::Break(()) } else { ControlFlow::Continue(limit) }
        });
        found
    }

    fn closest_each(&self, rays: &[Ray], query: &Query, hits: &mut [Option<Hit>]) {
        let rays = &rays[..rays.len().min(hits.len())];
        hits[..rays.len()].fill(None);
        for (part, share) in self.parts.iter().zip(self.share_out(rays)) {
            let t_max = |i: u32| hits[i as usize].filter(|_| query.early_out).map(|hit| hit.t);
            let own = |&i: &u32| part.ray(&rays[i as usize], t_max(i).unwrap_or(rays[i as usize].t_max));
            let own: Vec<Ray> = share.iter().map(own).collect();
            let mut found = vec![None; own.len()];
            part.query(query, |query| part.tree.closest_hits(&own, query, &mut found));
            for (i, hit) in share.iter().zip(found) {
                let best = &mut hits[*i as usize];
                *best = hit.map_or(*best, |hit| nearer(*best, part.in_whole(&hit)));
            }
        }
    }

    fn any_each(&self, rays: &[Ray], query: &Query, hits: &mut [bool]) {
        let mut blockers = vec![None; rays.len().min(hits.len())];
        self.blocker_each(rays, query, &mut blockers);
        hits.iter_mut().zip(blockers).for_each(|(hit, blocker)| *hit = blocker.is_some());
    }

    fn blocker_each(&self, rays: &[Ray], query: &Query, blockers: &mut [Option<Primitive>]) {
        let rays = &rays[..rays.len().min(blockers.len())];
        blockers[..rays.len()].fill(None);
        for (part, mut share) in self.parts.iter().zip(self.share_out(rays)) {
            share.retain(|&i| blockers[i as usize].is_none());
            let own: Vec<Ray> =
                share.iter().map(|&i| part.ray(&rays[i as usize], rays[i as usize].t_max)).collect();
            let mut found = vec![None; own.len()];
            part.query(query, |query| part.tree.blockers(&own, query, &mut found));
            for (i, found) in share.iter().zip(found) {
                let in_whole = |own: Primitive| Primitive { index: part.index_in_whole(own.index), ..own };
                blockers[*i as usize] = found.map(in_whole);
            }
        }
    }

    fn bounds(&self) -> Aabb {
        self.top.bounds()
    }

    fn memory_bytes(&self) -> usize {
        let part = |part: &Part| part.tree.memory_bytes() + size_of_val(part.runs.as_slice());
        self.parts.iter().map(part).sum::<usize>() + self.top.memory_bytes()
    }

    /// The sums over all trees; the depth is that of the deepest.
    fn shape(&self) -> TreeShape {
        let mut all = TreeShape::default();
        for shape in self.parts.iter().map(|part| part.tree.shape()) {
            all.nodes += shape.nodes;
            all.leaves += shape.leaves;
            all.references += shape.references;
            all.depth = all.depth.max(shape.depth);
            all.total_leaf_depth += shape.total_leaf_depth;
            all.leaf_sizes.iter_mut().zip(shape.leaf_sizes).for_each(|(sum, leaves)| *sum += leaves);
        }
        all
    }
}
