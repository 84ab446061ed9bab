//! What is measured: our structures and their rivals, behind one trait whose calls hold a whole batch.

use super::embree::{Asked, Embree, KINDS, Packets, Tree};
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

/// What a batch of rays found, ray by ray.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Answers {
    /// Closest hits; empty for a batch that asks for any.
    pub(super) closest: Vec<Option<Hit>>,
    /// Whether anything was hit; empty for a batch that asks for the closest.
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

    /// Rays of which one says hit and the other miss, or that hit another primitive at a distance that differs
    /// by more than a ten-thousandth; where answers are to be `equal`, all that differ in anything.
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

/// A structure over the mesh of a scene, and one way of asking it.
pub(super) trait Engine {
    fn mode(&self) -> Mode;
    fn build_seconds(&self) -> f64;
    fn bytes(&self) -> usize;
    /// Seconds that the rays take. To bring them into the engine's own form, and to take the answers out of it, is
    /// not counted.
    fn trace(&self, batch: &Batch, answers: Option<&mut Answers>) -> f64;
}

/// An engine by its name.
pub(super) struct Named {
    pub(super) name: String,
    /// One of our own.
    pub(super) ours: bool,
    pub(super) engine: Box<dyn Engine>,
}

/// Builds every engine over a mesh, on one thread: ours, those behind the feature `peers`, and Embree from the
/// libraries given.
pub(super) fn build(
    mesh: &Arc<TriangleMesh>,
    accels: &[String],
    against: &[Rc<Embree>],
) -> Result<Vec<Named>, Error> {
    let alone = threads(1)?;
    let mut engines = Vec::new();
    for name in accels {
        engines.extend(ours(name, mesh, &alone)?);
    }
    #[cfg(feature = "peers")]
    engines.extend(super::peers::build(mesh, &alone));
    for embree in against {
        for kind in KINDS {
            let tree = Rc::new(Tree::build(embree, kind, mesh)?);
            for (packets, suffix) in
                [(Packets::One, ""), (Packets::Sixteen, "/16"), (Packets::Coherent, "/16-coherent")]
            {
                let engine = Box::new(Asked { tree: tree.clone(), packets });
                engines.push(Named { name: format!("{}{suffix}", kind.name), ours: false, engine });
            }
        }
    }
    Ok(engines)
}

/// Loads what `--against NAME=PATH` names.
pub(super) fn load(against: &[(String, PathBuf)]) -> Result<Vec<Rc<Embree>>, Error> {
    let load = |(name, path): &(String, PathBuf)| match name.as_str() {
        "embree" => Embree::load(path),
        other => Err(Error::Settings(format!("there is no peer '{other}' to load: embree is one"))),
    };
    against.iter().map(load).collect()
}

/// Ours, ray by ray and, where a structure has a way of its own for many, in batches. Those that are asked for
/// their speed are called through their own types, so that the query is compiled into the loop.
fn ours(name: &str, mesh: &Arc<TriangleMesh>, alone: &ThreadPool) -> Result<Vec<Named>, Error> {
    let failed = |e: BuildError| Error::Settings(e.to_string());
    let (row, options) = find(name)?;
    let begun = Instant::now();
    Ok(match row.entry.name {
        "bvh" => asked(name, alone.install(|| Bvh::new(mesh)).into(), begun, &[Mode::Single]),
        "bvh8" => {
            let tree = alone.install(|| Bvh8::new(mesh, &options)).map_err(failed)?;
            asked(name, tree.into(), begun, &[Mode::Single, Mode::Batch])
        }
        "bvh8-compact" => {
            let tree = alone.install(|| CompactBvh8::new(mesh, &options)).map_err(failed)?;
            asked(name, tree.into(), begun, &[Mode::Single])
        }
        _ => {
            let tree = alone.install(|| (row.build)(mesh.clone(), &options)).map_err(failed)?;
            asked(name, Rc::<dyn Accelerator>::from(tree), begun, &[Mode::Single])
        }
    })
}

/// A tree that has just been built, asked in some ways.
fn asked<A: Accelerator + ?Sized + 'static>(
    name: &str,
    tree: Rc<A>,
    begun: Instant,
    modes: &[Mode],
) -> Vec<Named> {
    let build_seconds = begun.elapsed().as_secs_f64();
    let named = |&mode: &Mode| {
        let engine = Box::new(Ours { tree: tree.clone(), build_seconds, mode });
        Named { name: name.to_owned(), ours: true, engine }
    };
    modes.iter().map(named).collect()
}

/// One of ours, asked ray by ray or in batches.
struct Ours<A: ?Sized> {
    tree: Rc<A>,
    build_seconds: f64,
    mode: Mode,
}

/// Rays of a call that takes a batch.
const BATCH: usize = 4096;

impl<A: Accelerator + ?Sized> Engine for Ours<A> {
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
        let (query, found) = (Query::default(), |&hit: &bool| hit.then_some(NOWHERE));
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

/// What any hit says of where: nothing.
pub(super) const NOWHERE: Hit = Hit { t: 0.0, u: 0.0, v: 0.0, primitive: 0, instance: 0 };

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

/// Times `ask` over all rays, so many a call. Answers are written into memory that is already there, as Embree's are.
#[inline(always)]
fn timed<T: Clone + Default>(
    batch: &Batch,
    size: usize,
    answers: Option<&mut Answers>,
    ask: impl Fn(&[Ray], &mut [T]),
    hit: impl Fn(&T) -> Option<Hit>,
) -> f64 {
    let mut found = vec![T::default(); batch.rays.len()];
    // Memory that was never written costs page faults, which are nobody's rays.
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
