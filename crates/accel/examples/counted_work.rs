//! Deterministic workloads for counting instructions: each does the same in every run.
//!
//! ```text
//! cargo xtask instructions        # counts all of them and compares with crates/accel/instructions.tsv
//! counted_work primary-single-avx2
//! ```
//! A workload is a class of rays (`primary`, `bounce`, `shadow`), a kind of query (`single`, `batch`, or `compact`,
//! which is `single` on the compact layout) and a CPU level. Only the function `asked` is counted. Prints the number
//! of rays and of hits.
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

use bilux_accel::{
    Accelerator, BuildOptions, Bvh8, CompactBvh8, CpuLevel, Primitive, Query, Ray, TriangleMesh,
};
use bilux_math::hash::{hash_words, unit_f32};
use bilux_math::transcendental::{cos, sin};
use std::error::Error;

/// Rays along a side of the image.
const SIDE: usize = 64;
const LIGHT: [f32; 3] = [3.0, 8.0, -2.0];

fn main() -> Result<(), Box<dyn Error>> {
    let work = std::env::args().nth(1).ok_or("which work?")?;
    let [class, mode, level] = work.split('-').collect::<Vec<_>>()[..] else {
        return Err("CLASS-MODE-LEVEL".into());
    };
    let cpu_level = CpuLevel::ALL.into_iter().find(|known| known.name() == level).ok_or("no such level")?;
    let tree = Bvh8::new(&hills(), &BuildOptions { cpu_level, ..BuildOptions::default() })?;
    let rays = match class {
        "primary" => primary(),
        "bounce" => onwards(&tree, |p, i| (p, scattered(i))),
        "shadow" => onwards(&tree, |p, _| (p, std::array::from_fn(|k| LIGHT[k] - p[k]))),
        _ => return Err("no such class of rays".into()),
    };
    let hits = match (class, mode) {
        ("shadow", "batch") => {
            let mut hits = vec![false; rays.len()];
            asked(|| tree.any_hits(&rays, &Query::default(), &mut hits));
            hits.into_iter().filter(|hit| *hit).count()
        }
        (_, "compact") => compact(&CompactBvh8::pack(&tree)?, &rays, class),
        ("shadow", _) => asked(|| rays.iter().filter(|ray| tree.any_hit(ray, &Query::default())).count()),
        (_, "batch") => {
            let mut hits = vec![None; rays.len()];
            asked(|| tree.closest_hits(&rays, &Query::default(), &mut hits));
            hits.into_iter().flatten().count()
        }
        _ => asked(|| rays.iter().filter_map(|ray| tree.closest_hit(ray, &Query::default())).count()),
    };
    println!("{} {hits}", rays.len());
    Ok(())
}

/// The number of rays that hit something in a compact tree.
#[inline(never)]
fn compact(tree: &CompactBvh8, rays: &[Ray], class: &str) -> usize {
    if class == "shadow" {
        asked(|| rays.iter().filter(|ray| tree.any_hit(ray, &Query::default())).count())
    } else {
        asked(|| rays.iter().filter_map(|ray| tree.closest_hit(ray, &Query::default())).count())
    }
}

/// The work that is counted.
#[inline(never)]
fn asked<R>(work: impl FnOnce() -> R) -> R {
    work()
}

fn hills() -> TriangleMesh {
    let n = 100;
    let at = |i: usize, j: usize| {
        let (x, z) = (i as f32 * 0.1 - 5.0, j as f32 * 0.1 - 5.0);
        [x, sin(1.7 * x) * cos(2.3 * z) + 0.2 * sin(9.0 * x + 7.0 * z), z]
    };
    let cell = |cell: usize| {
        let (i, j) = (cell / n, cell % n);
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    TriangleMesh::from_corners((0..n * n).flat_map(cell).collect()).unwrap_or_default()
}

/// Rays from a camera, in tiles of 4 by 4.
fn primary() -> Vec<Ray> {
    let ray = |i: usize| {
        let (tile, within) = (i / 16, i % 16);
        let (x, y) = (tile % (SIDE / 4) * 4 + within % 4, tile / (SIDE / 4) * 4 + within / 4);
        let place = |k: usize| (k as f32 + 0.5) / SIDE as f32 - 0.5;
        Ray::new([0.0, 4.0, -7.0], [place(x), -0.6 - place(y), 1.0])
    };
    (0..SIDE * SIDE).map(ray).collect()
}

/// Rays that continue from where the primary rays arrive, slightly above the surface.
fn onwards(tree: &Bvh8, next: impl Fn([f32; 3], u64) -> ([f32; 3], [f32; 3])) -> Vec<Ray> {
    let arrive =
        |ray: &Ray| tree.closest_hit(ray, &Query::default()).map(|hit| (ray.at(hit.t), hit.primitive()));
    let leave = |(i, ([x, y, z], exclude)): (u64, ([f32; 3], Primitive))| {
        let (origin, direction) = next([x, y + 1e-3, z], i);
        Ray { exclude, t_max: 1.0e3, ..Ray::new(origin, direction) }
    };
    (0..).zip(primary().iter().filter_map(arrive)).map(leave).collect()
}

fn scattered(i: u64) -> [f32; 3] {
    let unit = |k: u64| unit_f32(hash_words([i, k]) as u32);
    [unit(0) * 2.0 - 1.0, unit(1), unit(2) * 2.0 - 1.0]
}
