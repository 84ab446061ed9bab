//! How fast trees are built over teapots, and how large they become.

use crate::{Options, Report, Tell, median, table, timed};
use bilux::Error;
use bilux::accel::{BuildOptions, TriangleMesh};
use bilux::math::Vec3;
use bilux::scene::SceneError;
use serde_json::json;
use std::sync::Arc;

/// Builds every accelerator over every number of teapots.
///
/// # Errors
/// When an accelerator is not known.
pub fn run(options: &Options, tell: Tell) -> Result<Report, Error> {
    let counts = if options.counts.is_empty() { vec![1, 5, 25] } else { options.counts.clone() };
    let all = || bilux::accel::ACCELERATORS.iter().map(|row| row.entry.name.to_owned()).collect();
    let accels: Vec<String> = if options.accels.is_empty() { all() } else { options.accels.clone() };
    let (mut rows, mut cells) = (Vec::new(), Vec::new());
    for &count in &counts {
        let mesh = mesh(count, &options.layout)?;
        for accel in &accels {
            tell(&format!("{accel} over {} triangles", mesh.len()));
            let build = || {
                bilux::accel::build(accel, mesh.clone(), &BuildOptions::default())
                    .map_err(|e| Error::Settings(e.to_string()))
            };
            let mut seconds = Vec::new();
            let mut tree = None;
            for _ in 0..options.repeats.max(1) {
                let (taken, built) = timed(build)?;
                seconds.push(taken);
                tree = Some(built);
            }
            let Some(tree) = tree else { continue };
            let (shape, seconds) = (tree.shape(), median(seconds));
            let bytes = tree.memory_bytes() as f64 / mesh.len() as f64;
            let references = shape.references as f64 / mesh.len() as f64;
            rows.push(json!({
                "accel": accel, "triangles": mesh.len(), "build_seconds": seconds,
                "bytes_per_triangle": bytes, "references_per_triangle": references,
                "nodes": shape.nodes, "leaves": shape.leaves, "depth": shape.depth,
                "imbalance": shape.imbalance(), "leaf_sizes": shape.leaf_sizes,
            }));
            cells.push(vec![
                mesh.len().to_string(),
                accel.clone(),
                format!("{seconds:.4}"),
                format!("{bytes:.0}"),
                format!("{references:.2}"),
                shape.depth.to_string(),
                format!("{:.2}", shape.imbalance()),
            ]);
        }
    }
    let header = ["triangles", "accel", "seconds", "bytes/tri", "refs/tri", "depth", "imbalance"];
    Ok(Report { rows, text: table("Building trees over teapots", &header, &cells), picture: None })
}

/// All triangles of a scene of teapots, in world space, with the objects as groups.
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
