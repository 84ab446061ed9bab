//! The engines being measured: our structures and their competitors.

use super::batch::{Answers, Batch};
use super::embree::{Embree, EmbreeEngine, KINDS, Packets, Tree};
use super::engine::{Engine, HIT_WITHOUT_LOCATION, Mode, Named, loop_over, timed};
use crate::accels::{find, threads};
use bilux::Error;
use bilux::accel::{Accelerator, BuildError, Bvh, Bvh8, CompactBvh8, Hit, Query, Ray, TriangleMesh};
use rayon::ThreadPool;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

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
            for packets in Packets::ways(embree) {
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
