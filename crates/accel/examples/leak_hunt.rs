//! Sends many rays from inside closed meshes and counts those that escape. There must be none.
//!
//! ```text
//! cargo run --release -p bilux-accel --example leak_hunt -- [--rays N] [--accel NAME] [--seed N]
//! ```
//! The rays are spread over all meshes; by default there are a hundred million (a thousandth of that for `brute` and
//! its variants, a hundredth for trees of whole objects, and a tenth for a needle). Without a name, every structure is tested. Prints a line of JSON for each mesh and structure, and
//! one for the total; exits with 1 if a ray escaped.
#![expect(clippy::print_stdout, reason = "a program, whose output this is")]

#[path = "../tests/suite/support/mod.rs"]
mod support;

use bilux_accel::registry::BspGroup;
use bilux_accel::{Accelerator, BuildOptions, Query};
use rayon::prelude::*;
use std::error::Error;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;
use support::{build_variant, closed, variants};

struct Arguments {
    rays: u64,
    accelerator: Option<String>,
    seed: u64,
}

impl Arguments {
    fn read() -> Result<Arguments, Box<dyn Error>> {
        let mut read = Arguments { rays: 100_000_000, accelerator: None, seed: 1 };
        let mut arguments = std::env::args().skip(1);
        while let Some(key) = arguments.next() {
            let value = arguments.next().ok_or_else(|| format!("{key} needs a value"))?;
            match key.as_str() {
                "--rays" => read.rays = value.parse()?,
                "--accel" => read.accelerator = Some(value),
                "--seed" => read.seed = value.parse()?,
                _ => {
                    return Err(
                        format!("unknown argument {key}; there are --rays, --accel and --seed").into()
                    );
                }
            }
        }
        Ok(read)
    }
}

/// The first ray that escapes, and the number of rays that do.
fn leaks(structure: &dyn Accelerator, closed: &closed::Closed, seed: u64, rays: u64) -> (Option<u64>, u64) {
    let escapes =
        |&index: &u64| structure.closest_hit(&closed::ray(closed, seed, index), &Query::default()).is_none();
    let join = |a: (Option<u64>, u64), b: (Option<u64>, u64)| (a.0.into_iter().chain(b.0).min(), a.1 + b.1);
    (0..rays).into_par_iter().filter(escapes).map(|index| (Some(index), 1)).reduce(|| (None, 0), join)
}

/// One ray in so many is sent to a structure: slow ones get fewer, and so does a mesh most of whose triangles each ray comes close to.
fn share(name: &str, options: &BuildOptions, mesh: &str) -> u64 {
    match (name, options.bsp_group) {
        (name, _) if name.starts_with("brute") => 1000,
        ("bsp", BspGroup::Objects) => 100,
        _ if mesh == "needle" => 10,
        _ => 1,
    }
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let arguments = Arguments::read()?;
    let meshes = closed::all();
    let chosen = |name: &str| arguments.accelerator.as_deref().is_none_or(|wanted| wanted == name);
    let mut total = (0, 0);
    for (label, name, options) in variants().into_iter().filter(|(_, name, _)| chosen(name)) {
        for closed in meshes {
            let share = share(name, &options, closed.name);
            let rays = (arguments.rays / share).div_ceil(meshes.len() as u64);
            let structure = build_variant(name, &options, &Arc::new(closed.mesh()));
            let start = Instant::now();
            let (first, count) = leaks(structure.as_ref(), closed, arguments.seed, rays);
            let speed = rays as f64 / start.elapsed().as_secs_f64() / 1e6;
            let first = first.map_or("null".to_owned(), |index| index.to_string());
            println!(
                r#"{{"accel": "{label}", "mesh": "{}", "triangles": {}, "rays": {rays}, "leaks": {count}, "first": {first}, "million_rays_per_second": {speed:.2}}}"#,
                closed.name,
                closed.indices.len(),
            );
            total = (total.0 + rays, total.1 + count);
        }
    }
    println!(r#"{{"total_rays": {}, "total_leaks": {}}}"#, total.0, total.1);
    Ok(if total.1 == 0 && total.0 > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
