//! Time to build trees over teapots, and the size of these trees.

use crate::accels::{find, threads};
use crate::{Options, ProgressFn, Report, median, table, timed};
use bilux::Error;
use bilux::accel::{ACCELERATORS, Accelerator, TriangleMesh};
use bilux::math::Vec3;
use bilux::scene::SceneError;
use rayon::ThreadPool;
use serde_json::{Value, json};
use std::sync::Arc;

/// Builds every accelerator over every number of teapots, on one thread and on all.
///
/// # Errors
/// If an accelerator is unknown.
pub fn run(options: &Options, progress: ProgressFn) -> Result<Report, Error> {
    let counts = if options.counts.is_empty() { vec![1, 5, 25] } else { options.counts.clone() };
    let all = || {
        let names = ACCELERATORS.iter().map(|row| row.entry.name.to_owned());
        names.chain(["bvh8-fast".to_owned(), "bvh8-best".to_owned()]).collect()
    };
    let accels: Vec<String> = if options.accels.is_empty() { all() } else { options.accels.clone() };
    let pools = [threads(1)?, threads(0)?];
    let (mut rows, mut cells) = (Vec::new(), Vec::new());
    for &count in &counts {
        let mesh = mesh(count, &options.layout)?;
        for accel in &accels {
            progress(&format!("{accel} over {} triangles", mesh.len()));
            let Some((seconds, tree)) = one(accel, &mesh, options.repeats, &pools)? else { continue };
            rows.push(json(accel, mesh.len(), seconds, &*tree, &pools));
            let shape = tree.shape();
            cells.push(vec![
                mesh.len().to_string(),
                accel.clone(),
                format!("{:.4}", seconds[0]),
                format!("{:.4}", seconds[1]),
                format!("{:.0}", tree.memory_bytes() as f64 / mesh.len() as f64),
                format!("{:.2}", shape.references as f64 / mesh.len() as f64),
                shape.depth.to_string(),
                format!("{:.2}", shape.imbalance()),
            ]);
        }
    }
    let all = format!("on {}", pools[1].current_num_threads());
    let header = ["triangles", "accel", "seconds", &all, "bytes/tri", "refs/tri", "depth", "imbalance"];
    let title = "Building trees over teapots: seconds on one thread, and on all";
    Ok(Report { rows, text: table(title, &header, &cells), ..Report::default() })
}

/// Returns the median seconds on one thread and on all, measured in turns, and the tree.
#[allow(clippy::type_complexity, reason = "said above")]
fn one(
    accel: &str,
    mesh: &Arc<TriangleMesh>,
    repeats: u32,
    pools: &[ThreadPool; 2],
) -> Result<Option<([f64; 2], Box<dyn Accelerator>)>, Error> {
    let (row, options) = find(accel)?;
    let build = || (row.build)(mesh.clone(), &options).map_err(|e| Error::Settings(format!("{accel}: {e}")));
    let mut seconds = [Vec::new(), Vec::new()];
    let mut tree: Option<Box<dyn Accelerator>> = None;
    for _ in 0..repeats.max(1) {
        for (pool, seconds) in pools.iter().zip(&mut seconds) {
            // Dropping the previous tree is not timed.
            drop(tree.take());
            let (taken, built) = pool.install(|| timed(build))?;
            seconds.push(taken);
            tree = Some(built);
        }
    }
    Ok(tree.map(|tree| (seconds.map(median), tree)))
}

fn json(
    accel: &str,
    triangles: usize,
    seconds: [f64; 2],
    tree: &dyn Accelerator,
    pools: &[ThreadPool; 2],
) -> Value {
    let shape = tree.shape();
    json!({
        "accel": accel, "triangles": triangles, "build_seconds": seconds[0],
        "build_seconds_on_all": seconds[1], "threads": pools[1].current_num_threads(),
        "bytes_per_triangle": tree.memory_bytes() as f64 / triangles as f64,
        "references_per_triangle": shape.references as f64 / triangles as f64,
        "nodes": shape.nodes, "leaves": shape.leaves, "depth": shape.depth,
        "imbalance": shape.imbalance(), "leaf_sizes": shape.leaf_sizes,
    })
}

/// All triangles of a scene of teapots, in world space, grouped by object.
pub(crate) fn mesh(count: u32, layout: &str) -> Result<Arc<TriangleMesh>, Error> {
    let scene = crate::teapots::scene(count, layout)?;
    let (mut corners, mut groups) = (Vec::new(), Vec::new());
    for object in &scene.objects {
        let to_world = object.motion.at(0.0);
        let corner = |i: u32| -> Vec3 { to_world.point(object.mesh.positions[i as usize]) };
        let first = corners.len() as u32;
        corners.extend(object.mesh.triangles.iter().map(|t| t.map(|i| corner(i).to_array())));
        groups.push(first..corners.len() as u32);
    }
    let mesh = TriangleMesh::from_corners(corners)
        .and_then(|mesh| mesh.with_groups(groups))
        .map_err(|e| SceneError::invalid(e.to_string(), &Default::default()))?;
    Ok(Arc::new(mesh))
}
