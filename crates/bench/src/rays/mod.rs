//! Rays per second: our structures and their competitors on the same scenes, with the same rays, in turns.
//!
//! There are five classes of rays: `primary` (closest, from the camera, Morton order in tiles of 16²), `ao` (any,
//! short), `bounce` (closest, diffuse, in pixel order), `bounce2` (closest, from where those hit, shuffled) and
//! `shadow` (any, to an area light). Everything runs on one thread. Every engine traces a class once per round, in an
//! order that rotates from round to round, and the medians are reported. Hits are compared with those of `bvh`.

mod batch;
mod best;
mod classes;
mod embree;
mod engine;
mod engines;
pub mod files;
mod options;
#[cfg(feature = "peers")]
mod peers;
mod report;
mod scenes;

use crate::accels::find;
use crate::{ProgressFn, Report, median};
use batch::Answers;
pub use batch::Batch;
pub use best::{Best, Champion};
use bilux::Error;
use bilux::accel::registry::AUTO;
use bilux::accel::{Bvh, Query};
use engine::Named;
pub use options::Options;
use report::Row;
use scenes::TestMesh;
use std::path::Path;

/// Runs the benchmark.
///
/// # Errors
/// If a file cannot be read or written, a name is unknown, or nothing in a scene is visible.
pub fn run(options: &Options, progress: ProgressFn) -> Result<Report, Error> {
    let rows = measured(options, progress)?;
    Ok(Report {
        rows: rows.iter().map(Row::json).collect(),
        text: report::text(&rows, options) + &report::curve(&rows) + &best::text(&rows),
        ..Report::default()
    })
}

/// Runs the benchmark, and compares our best mode with Embree's for each class and scene.
///
/// # Errors
/// As [`run`].
pub fn against_embree(options: &Options, progress: ProgressFn) -> Result<Vec<Best>, Error> {
    Ok(best::best(&measured(options, progress)?))
}

/// Whether a library is an Embree that can be compared with.
pub fn is_embree(library: &Path) -> bool {
    embree::Embree::load(library).is_ok()
}

/// A row for each scene, class and engine.
fn measured(options: &Options, progress: ProgressFn) -> Result<Vec<Row>, Error> {
    let against = engines::load(&options.against)?;
    let mut accels = options.accels.clone();
    if accels.is_empty() {
        accels = vec!["bvh".to_owned(), AUTO.to_owned()];
        accels.dedup();
    }
    accels.iter().try_for_each(|name| find(name).map(|_| ()))?;
    let mut rows = Vec::new();
    for source in scenes::sources(options)? {
        progress(&format!("{}: rays", source.name()));
        let (test_mesh, batches) = source.load(options)?;
        if let Some(folder) = &options.dump {
            files::dump(folder, &test_mesh.name, &test_mesh.mesh, &batches)?;
        }
        progress(&format!("{}: trees over {} triangles", test_mesh.name, test_mesh.mesh.len()));
        let built = engines::build(&test_mesh.mesh, &accels, &against)?;
        measure(&test_mesh, &batches, &built, options, progress, &mut rows)?;
    }
    Ok(rows)
}

/// Measures one scene: every class with every engine.
fn measure(
    test_mesh: &TestMesh,
    batches: &[Batch],
    built: &[Named],
    options: &Options,
    progress: ProgressFn,
    rows: &mut Vec<Row>,
) -> Result<(), Error> {
    let reference = Bvh::new(&test_mesh.mesh);
    for batch in batches {
        progress(&format!("{}: {} by {} engines", test_mesh.name, batch.class, built.len()));
        let truth = truth(&reference, batch);
        if let Some(path) = &options.hits {
            files::write_hits(path, &truth)?;
        }
        let mut seconds = vec![Vec::new(); built.len()];
        let mut mismatches = vec![0; built.len()];
        for round in 0..options.rounds.max(1) as usize {
            for k in 0..built.len() {
                let k = (k + round) % built.len();
                let mut answers = (round == 0).then(Answers::default);
                seconds[k].push(built[k].engine.trace(batch, answers.as_mut()));
                if let Some(answers) = answers {
                    mismatches[k] = answers.mismatches(&truth, built[k].ours);
                }
            }
        }
        for ((named, seconds), mismatches) in built.iter().zip(seconds).zip(mismatches) {
            rows.push(Row {
                scene: test_mesh.name.clone(),
                triangles: test_mesh.mesh.len(),
                class: batch.class.clone(),
                engine: named.name.clone(),
                ours: named.ours,
                mode: named.engine.mode(),
                mrays: batch.rays.len() as f64 / median(seconds) * 1e-6,
                build_seconds: named.engine.build_seconds(),
                bytes_per_triangle: named.engine.bytes() as f64 / test_mesh.mesh.len().max(1) as f64,
                mismatches,
            });
        }
    }
    Ok(())
}

/// The answers of `bvh`.
fn truth(reference: &Bvh, batch: &Batch) -> Answers {
    use bilux::accel::Accelerator;
    let (query, mut truth) = (Query::default(), Answers::default());
    if batch.any {
        truth.any = batch.rays.iter().map(|ray| reference.any_hit(ray, &query)).collect();
    } else {
        truth.closest = batch.rays.iter().map(|ray| reference.closest_hit(ray, &query)).collect();
    }
    truth
}
