//! Shared by the tests of all structures: nasty meshes, nasty rays, and the comparison.
#![allow(dead_code, unreachable_pub)] // Each test uses a part of it.

pub mod closed;
pub mod fuzzed;
pub mod meshes;
pub mod rays;

use bilux_accel::ray::Filter;
use bilux_accel::registry::{BspGroup, BspSplit, Quality};
use bilux_accel::{
    ACCELERATORS, Accelerator, BuildOptions, Counters, CpuLevel, Culling, Hit, Primitive, Query, Ray,
    TriangleMesh, build,
};
use bilux_math::hash::{hash_words, unit_f32};
use std::sync::Arc;

/// Random numbers that depend on their index only.
pub struct Numbers(u64, u64);

impl Numbers {
    pub fn new(seed: u64) -> Numbers {
        Numbers(seed, 0)
    }
    pub fn word(&mut self) -> u64 {
        self.1 += 1;
        hash_words([self.0, self.1])
    }
    pub fn below(&mut self, end: usize) -> usize {
        (self.word() % end.max(1) as u64) as usize
    }
    /// In `0..1`.
    pub fn unit(&mut self) -> f32 {
        unit_f32(self.word() as u32)
    }
    /// In `-1..1`, each component.
    pub fn vector(&mut self) -> [f32; 3] {
        std::array::from_fn(|_| self.unit() * 2.0 - 1.0)
    }
}

/// True when a ray hits the blocker that a structure names, and it names one exactly where there is a hit.
pub fn is_blocker(
    tree: &dyn Accelerator,
    ray: &Ray,
    query: &Query,
    (blocker, truth): (Option<Primitive>, Option<Hit>),
) -> bool {
    let is_hit = |blocker: Primitive| {
        let only: Filter =
            &|hit: &Hit| hit.primitive() == blocker && query.filter.is_none_or(|keeps| keeps(hit));
        tree.closest_hit(ray, &Query { filter: Some(only), ..*query }).is_some()
    };
    blocker.is_some() == truth.is_some() && blocker.is_none_or(is_hit)
}

/// Every structure in every configuration that it can be built in, with a name for messages. A structure that is
/// added to the table is tested without a line here; one with options gets a line of its own.
pub fn variants() -> Vec<(String, &'static str, BuildOptions)> {
    let plain = BuildOptions::default();
    let mut all = Vec::new();
    for row in ACCELERATORS {
        let name = row.entry.name;
        let options: Vec<(&str, BuildOptions)> = match name {
            "bsp" => vec![
                ("mean", plain.clone()),
                ("fuchs", BuildOptions { bsp_split: BspSplit::Fuchs, ..plain.clone() }),
                ("objects", BuildOptions { bsp_group: BspGroup::Objects, ..plain.clone() }),
            ],
            "bsp-sah" => [Quality::Fast, Quality::Balanced, Quality::Best]
                .map(|quality| ("quality", BuildOptions { quality, ..plain.clone() }))
                .to_vec(),
            "brute-simd" => levels()
                .map(|cpu_level| (cpu_level.name(), BuildOptions { cpu_level, ..plain.clone() }))
                .collect(),
            "bvh8" | "bvh8-compact" => levels()
                .flat_map(|cpu_level| {
                    [("fast", Quality::Fast), ("balanced", Quality::Balanced), ("best", Quality::Best)]
                        .map(|(name, quality)| (name, BuildOptions { cpu_level, quality, ..plain.clone() }))
                })
                .collect(),
            _ => vec![("", plain.clone())],
        };
        all.extend(options.into_iter().map(|(suffix, options)| {
            (format!("{name} {suffix} {}", options.cpu_level.name()), name, options)
        }));
    }
    all
}

/// The levels that the machine supports.
fn levels() -> impl Iterator<Item = CpuLevel> {
    CpuLevel::ALL.into_iter().filter(|&level| level <= CpuLevel::detect())
}

pub fn build_variant(name: &str, options: &BuildOptions, mesh: &Arc<TriangleMesh>) -> Arc<dyn Accelerator> {
    Arc::from(build(name, Arc::clone(mesh), options).expect("a registered structure builds"))
}

/// A ray on which two structures disagree.
#[derive(Debug)]
pub struct Difference {
    pub ray: Ray,
    pub query: Query<'static>,
    pub truth: Option<Hit>,
    pub answer: Option<Hit>,
}

pub fn bits(hit: Option<Hit>) -> Option<[u32; 5]> {
    hit.map(|h| [h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.primitive, h.instance])
}

/// A filter that cuts holes into triangles, and cuts out whole triangles.
pub const SIEVE: Filter<'static> = &|hit| hit.primitive % 3 != 1 && hit.u < 0.6;

/// The queries made for each ray.
pub fn queries() -> [Query<'static>; 6] {
    let plain = Query::default();
    [
        plain,
        Query { culling: Culling::Back, ..plain },
        Query { early_out: false, ..plain },
        Query { culling: Culling::Back, cull_by_partition: false, ..plain },
        Query { filter: Some(SIEVE), ..plain },
        Query { filter: Some(SIEVE), culling: Culling::Back, ..plain },
    ]
}

/// Rays that start or end exactly at a hit or next to it, or that exclude its primitive.
fn rays_ending_at_hit(ray: &Ray, hit: &Hit) -> [Ray; 5] {
    [
        Ray { t_max: hit.t, ..*ray },
        Ray { t_max: hit.t.next_down(), ..*ray },
        Ray { t_min: hit.t, ..*ray },
        Ray { t_min: hit.t.next_up(), ..*ray },
        Ray { exclude: Primitive { instance: hit.instance, index: hit.primitive }, ..*ray },
    ]
}

/// The ground-truth answers, for [`differences`].
pub struct Truth {
    /// Each with the number of its query.
    cases: Vec<(Ray, usize, Option<Hit>)>,
}

impl Truth {
    pub fn new(truth: &dyn Accelerator, rays: &[Ray]) -> Truth {
        let mut cases = Vec::new();
        for ray in rays {
            let first = truth.closest_hit(ray, &Query::default());
            for (number, query) in queries().iter().enumerate() {
                cases.push((*ray, number, truth.closest_hit(ray, query)));
            }
            for sharp in first.iter().flat_map(|hit| rays_ending_at_hit(ray, hit)) {
                cases.push((sharp, 0, truth.closest_hit(&sharp, &queries()[0])));
            }
        }
        Truth { cases }
    }

    pub fn hits(&self) -> usize {
        self.cases.iter().filter(|(.., hit)| hit.is_some()).count()
    }

    /// Rays on which a structure disagrees in batches: all rays that share a query at once, a few, and none.
    fn differences_in_batches(&self, other: &dyn Accelerator) -> Vec<Difference> {
        let mut found = Vec::new();
        for (number, query) in queries().into_iter().enumerate() {
            let cases: Vec<_> = self.cases.iter().filter(|case| case.1 == number).collect();
            let rays: Vec<Ray> = cases.iter().map(|case| case.0).collect();
            let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
            let few = rays.len().min(3);
            other.closest_hits(&rays[..few], &query, &mut hits[..few]);
            other.closest_hits(&rays[few..], &query, &mut hits[few..]);
            other.closest_hits(&[], &query, &mut hits);
            other.any_hits(&rays, &query, &mut any);
            let mut blockers = vec![None; rays.len()];
            other.blockers(&rays, &query, &mut blockers);
            for (i, &&(ray, _, truth)) in cases.iter().enumerate() {
                let answer = hits[i];
                let is_same = bits(answer) == bits(truth) && any[i] == truth.is_some();
                if !is_same || !is_blocker(other, &ray, &query, (blockers[i], truth)) {
                    found.push(Difference { ray, query, truth, answer });
                }
            }
        }
        found
    }

    /// The rays on which a structure disagrees: on the closest hit, on whether there is any hit, or with counting on.
    pub fn differences(&self, other: &dyn Accelerator) -> Vec<Difference> {
        let mut found = Vec::new();
        for (ray, number, truth) in &self.cases {
            let query = &queries()[*number];
            let mut counters = Counters::default();
            let answer = other.closest_hit(ray, query);
            let same = bits(answer) == bits(*truth)
                && other.any_hit(ray, query) == truth.is_some()
                && bits(other.closest_hit_counted(ray, query, &mut counters)) == bits(*truth)
                && other.any_hit_counted(ray, query, &mut counters) == truth.is_some()
                && counters.rays == 2;
            if !same {
                found.push(Difference { ray: *ray, query: *query, truth: *truth, answer });
            }
        }
        found.extend(self.differences_in_batches(other));
        found
    }
}
