//! The statistics that `bilux render --stats` writes.

use super::log::Rendered;
use bilux::transport::Choice;
use serde_json::json;

/// Which set of strategies was chosen, and what was expected of each.
fn choice(choice: &Choice) -> serde_json::Value {
    let candidates = choice.candidates.iter().map(|candidate| {
        json!({
            "name": candidate.name, "error": candidate.error, "lost": candidate.lost, "nanoseconds": candidate.nanoseconds,
        })
    });
    json!({ "chosen": choice.best().name, "candidates": candidates.collect::<Vec<_>>() })
}

/// Everything known about a picture once it is done.
pub fn of(rendered: &Rendered) -> serde_json::Value {
    let Rendered { job, outcome, scene, build_seconds, seconds, .. } = *rendered;
    let (s, c) = (job.settings(), &outcome.rendered.counters);
    let [spp, asked] = rendered.samples();
    let trees: Vec<_> = job
        .scene()
        .geometry()
        .instances()
        .iter()
        .take(1)
        .map(|instance| {
            let shape = instance.accelerator.shape();
            json!({
                "nodes": shape.nodes, "leaves": shape.leaves, "references": shape.references,
                "depth": shape.depth, "imbalance": shape.imbalance(), "leaf_sizes": shape.leaf_sizes,
                "memory_bytes": instance.accelerator.memory_bytes(),
            })
        })
        .collect();
    json!({
        "scene": scene.to_string_lossy(), "integrator": s.integrator.entry.name, "accel": s.accel.name,
        "width": s.width, "height": s.height, "spp": spp, "spp_asked": asked, "seed": s.seed,
        "build_seconds": build_seconds, "seconds": seconds, "rays": c.rays, "node_visits": c.nodes,
        "triangle_tests": c.triangles, "early_outs": c.early_outs,
        "culled_back_faces": c.culled_back_faces, "cancelled": outcome.rendered.cancelled,
        "non_finite_samples": outcome.rendered.film.sample_failures().non_finite,
        "overflows": outcome.rendered.film.sample_failures().overflowed,
        "tree": trees.first(), "reached": outcome.rendered.reached.map(|r| json!({
            "spp": r.spp, "noise": r.noise, "noise_samples_in_mean": r.noise.is_some(), "bias_at_most": r.bias,
        })),
        "choice": outcome.rendered.choice.as_ref().map(choice),
    })
}
