//! The engines being measured: our structures and their competitors, behind one trait whose calls take a whole batch.

use super::embree::{Embree, EmbreeEngine, KINDS, Tree};
use super::{Batch, Mode};
use crate::accels::{find, threads};
use bilux::Error;
use bilux::accel::{Accelerator, BuildError, Bvh, Bvh8, CompactBvh8, Hit, Query, Ray, TriangleMesh};
use rayon::ThreadPool;
use std::hint::black_box;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

/// What the rays of a batch found, ray by ray.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Answers {
    /// Closest hits; empty for an any-hit batch.
    pub(super) closest: Vec<Option<Hit>>,
    /// Whether anything was hit; empty for a closest-hit batch.
    pub(super) any: Vec<bool>,
}

impl Answers {
    pub(super) fn fill(&mut self, any: bool, hits: impl Iterator<Item = Option<Hit>>) {
        *self = Answers::default();
        if any {
            self.any = hits.map(|hit| hit.is_some()).collect();
        } else {
            self.closest = hits.collect();
        }
    }

    /// Counts the rays for which one side reports a hit and the other a miss, or which hit different primitives at
    /// distances that differ by more than a ten-thousandth; if answers must be `equal`, all rays with any difference.
    pub(super) fn mismatches(&self, reference: &Answers, equal: bool) -> usize {
        let differ = |(a, b): &(&Option<Hit>, &Option<Hit>)| match (a, b) {
            (Some(a), Some(b)) if !equal => {
                a.primitive != b.primitive && (a.t - b.t).abs() > 1e-4 * a.t.abs().max(b.t.abs())
            }
            (a, b) => a != b,
        };
        let closest = self.closest.iter().zip(&reference.closest).filter(differ).count();
        closest + self.any.iter().zip(&reference.any).filter(|(a, b)| a != b).count()
    }
}

/// A structure over a scene's mesh, and one way of querying it.
pub(super) trait Engine {
    fn mode(&self) -> Mode;
    fn build_seconds(&self) -> f64;
    fn bytes(&self) -> usize;
    /// The seconds that the rays take. Converting them into the engine's own form, and reading the answers out of it,
    /// is not timed.
    fn trace(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64;
}

/// An engine with its name.
pub(super) struct Named {
    pub(super) name: String,
    /// Whether it is one of our own.
    pub(super) ours: bool,
    pub(super) engine: Box<dyn Engine>,
}

/// Builds every engine over a mesh, on one thread: ours, those behind the feature `peers`, and Embree from the given
/// libraries.
pub(super) fn build(
    mesh: &Arc<TriangleMesh>,
    accels: &[String],
    against: &[Rc<Embree>],
) -> Result<Vec<Named>, Error> {
    let alone = threads(1)?;
    let mut engines = Vec::new();
    for name in accels {
        engines.extend(own_engines(name, mesh, &alone)?);
    }
    #[cfg(feature = "peers")]
    engines.extend(super::peers::build(mesh, &alone));
    for embree in against {
        for kind in KINDS {
            let tree = Rc::new(Tree::build(embree, kind, mesh)?);
            for packets in embree.ways() {
                let engine = Box::new(EmbreeEngine { tree: tree.clone(), packets });
                let name = format!("{}{}", kind.name, packets.suffix());
                engines.push(Named { name, ours: false, engine });
            }
        }
    }
    Ok(engines)
}

/// Loads the libraries that `--against NAME=PATH` names.
pub(super) fn load(against: &[(String, PathBuf)]) -> Result<Vec<Rc<Embree>>, Error> {
    let load = |(name, path): &(String, PathBuf)| match name.as_str() {
        "embree" => Embree::load(path),
        other => {
            Err(Error::Settings(format!("there is no engine '{other}' to compare with: write embree=PATH")))
        }
    };
    against.iter().map(load).collect()
}

/// Our structures, ray by ray and, if a structure has a batch kernel, in batches. The structures whose speed matters
/// most are called through their concrete types, so that the query is inlined into the loop.
fn own_engines(name: &str, mesh: &Arc<TriangleMesh>, alone: &ThreadPool) -> Result<Vec<Named>, Error> {
    let failed = |e: BuildError| Error::Settings(e.to_string());
    let (row, options) = find(name)?;
    let begun = Instant::now();
    Ok(match row.entry.name {
        "bvh" => engines_over(name, alone.install(|| Bvh::new(mesh)).into(), begun, &[Mode::Single]),
        "bvh8" => {
            let tree = alone.install(|| Bvh8::new(mesh, &options)).map_err(failed)?;
            engines_over(name, tree.into(), begun, &[Mode::Single, Mode::Batch])
        }
        "bvh8-compact" => {
            let tree = alone.install(|| CompactBvh8::new(mesh, &options)).map_err(failed)?;
            engines_over(name, tree.into(), begun, &[Mode::Single])
        }
        _ => {
            let tree = alone.install(|| (row.build)(mesh.clone(), &options)).map_err(failed)?;
            engines_over(name, Rc::<dyn Accelerator>::from(tree), begun, &[Mode::Single])
        }
    })
}

/// Wraps a tree that has just been built in an engine for each mode.
fn engines_over<A: Accelerator + ?Sized + 'static>(
    name: &str,
    tree: Rc<A>,
    begun: Instant,
    modes: &[Mode],
) -> Vec<Named> {
    let build_seconds = begun.elapsed().as_secs_f64();
    let named = |&mode: &Mode| {
        let engine = Box::new(OwnEngine { tree: tree.clone(), build_seconds, mode });
        Named { name: name.to_owned(), ours: true, engine }
    };
    modes.iter().map(named).collect()
}

/// One of our structures, queried ray by ray or in batches.
struct OwnEngine<A: ?Sized> {
    tree: Rc<A>,
    build_seconds: f64,
    mode: Mode,
}

/// The number of rays in a call that takes a batch.
const BATCH: usize = 4096;

impl<A: Accelerator + ?Sized> Engine for OwnEngine<A> {
    fn mode(&self) -> Mode {
        self.mode
    }

    fn build_seconds(&self) -> f64 {
        self.build_seconds
    }

    fn bytes(&self) -> usize {
        self.tree.memory_bytes()
    }

    fn trace(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64 {
        let (query, found) = (Query::default(), |&hit: &bool| hit.then_some(HIT_WITHOUT_LOCATION));
        match (self.mode, batch.any) {
            (Mode::Single, true) => loop_over(batch, answers, |ray| self.tree.any_hit(ray, &query), found),
            (Mode::Single, false) => {
                loop_over(batch, answers, |ray| self.tree.closest_hit(ray, &query), |&hit| hit)
            }
            (Mode::Batch, true) => {
                let ask = |rays: &[Ray], hits: &mut [bool]| self.tree.any_hits(rays, &query, hits);
                timed(batch, BATCH, answers, ask, found)
            }
            (Mode::Batch, false) => {
                let ask = |rays: &[Ray], hits: &mut [Option<Hit>]| self.tree.closest_hits(rays, &query, hits);
                timed(batch, BATCH, answers, ask, |&hit| hit)
            }
        }
    }
}

/// The hit that stands for any hit, which has no location.
pub(super) const HIT_WITHOUT_LOCATION: Hit = Hit { t: 0.0, u: 0.0, v: 0.0, primitive: 0, instance: 0 };

/// Times `ask` over all rays, one by one.
pub(super) fn loop_over<T: Clone + Default>(
    batch: &Batch,
    answers: Option<&mut Answers>,
    ask: impl Fn(&Ray) -> T,
    hit: impl Fn(&T) -> Option<Hit>,
) -> f64 {
    let each = |rays: &[Ray], found: &mut [T]| {
        for (slot, ray) in found.iter_mut().zip(rays) {
            *slot = ask(ray);
        }
    };
    timed(batch, batch.rays.len(), answers, each, hit)
}

/// Times `ask` over all rays, `size` per call. Answers go into memory that is already allocated, as Embree's do.
#[inline(always)]
fn timed<T: Clone + Default>(
    batch: &Batch,
    size: usize,
    answers: Option<&mut Answers>,
    ask: impl Fn(&[Ray], &mut [T]),
    hit: impl Fn(&T) -> Option<Hit>,
) -> f64 {
    let mut found = vec![T::default(); batch.rays.len()];
    // Memory that was never written costs page faults, which must not count as tracing time.
    found.iter_mut().for_each(|slot| *black_box(slot) = T::default());
    let (size, begun) = (size.max(1), Instant::now());
    for (rays, found) in batch.rays.chunks(size).zip(found.chunks_mut(size)) {
        ask(rays, found);
    }
    let seconds = begun.elapsed().as_secs_f64();
    if let Some(answers) = answers {
        answers.fill(batch.any, found.iter().map(hit));
    }
    black_box(found);
    seconds
}
