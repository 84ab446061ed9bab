//! `cargo xtask cpu-levels`: the same pictures, byte for byte, whichever CPU level the compiler targets.
//!
//! Each level is a build of its own, so this takes minutes and is not part of `cargo xtask test`.

use crate::process::{cargo, output, run as run_process, target_folder};
use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A level of the x86-64 instruction set, and how to detect whether this machine has it.
struct Level {
    name: &'static str,
    runs_here: fn() -> bool,
}

#[cfg(target_arch = "x86_64")]
const LEVELS: &[Level] = &[
    Level { name: "x86-64", runs_here: || true },
    Level { name: "x86-64-v2", runs_here: || is_x86_feature_detected!("sse4.2") },
    Level {
        name: "x86-64-v3",
        runs_here: || is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
    },
    Level {
        name: "x86-64-v4",
        runs_here: || is_x86_feature_detected!("avx512vl") && is_x86_feature_detected!("avx512dq"),
    },
];

#[cfg(not(target_arch = "x86_64"))]
const LEVELS: &[Level] = &[];

/// A picture that every build renders: its name, and the arguments of `bilux`.
struct Picture {
    name: &'static str,
    scene: &'static [&'static str],
    render: &'static [&'static str],
}

/// Every integrator and every accelerator at least once.
const PICTURES: &[Picture] = &[
    Picture { name: "cast", scene: TEAPOTS, render: &["-i", "cast", "--accel", "brute"] },
    Picture { name: "whitted", scene: TEAPOTS, render: &["-i", "whitted", "--accel", "bsp-sah"] },
    Picture { name: "cook", scene: TEAPOTS, render: &["-i", "cook", "--accel", "kd"] },
    Picture { name: "path-kd", scene: CORNELL, render: &["-i", "path", "--accel", "kd"] },
    Picture { name: "path-bvh", scene: CORNELL, render: &["-i", "path", "--accel", "bvh"] },
    Picture { name: "path-bsp", scene: CORNELL, render: &["-i", "path", "--accel", "bsp"] },
    Picture { name: "path-bvh8", scene: CORNELL, render: &["-i", "path", "--accel", "bvh8"] },
    Picture { name: "path-compact", scene: CORNELL, render: &["-i", "path", "--accel", "bvh8-compact"] },
    Picture { name: "occlusion", scene: CORNELL, render: &["-i", "occlusion"] },
    Picture { name: "light", scene: CORNELL, render: &["-i", "light"] },
    Picture { name: "bdpt", scene: CORNELL, render: &["-i", "bdpt"] },
    Picture { name: "sppm", scene: CORNELL, render: &["-i", "sppm"] },
    Picture { name: "vcm", scene: CORNELL, render: &["-i", "vcm"] },
    Picture { name: "auto", scene: CORNELL, render: &["-i", "auto"] },
    Picture { name: "cast-simd", scene: TEAPOTS, render: &["-i", "cast", "--accel", "brute-simd"] },
];

const TEAPOTS: &[&str] = &["teapots", "--count", "2"];
const CORNELL: &[&str] = &["cornell-spheres", "--set", "level=3"];
const ALL: &[&str] = &["--size", "96x96", "--spp", "4", "--quiet"];

/// Builds every level that this machine can run, and compares what each one renders.
pub(crate) fn run(_: &[String]) -> Result<()> {
    let (able, unable): (Vec<_>, Vec<_>) = LEVELS.iter().partition(|level| (level.runs_here)());
    for level in unable {
        println!("skipped: this machine cannot run {}", level.name);
    }
    if able.len() < 2 {
        bail!("this machine has fewer than two levels to compare");
    }
    let mut columns = Vec::new();
    for level in &able {
        println!("==> {}", level.name);
        let folder = target_folder().join("cpu-levels").join(level.name);
        let binary = build(level.name, &folder)?;
        columns.push(
            PICTURES.iter().map(|picture| draw(picture, &binary, &folder)).collect::<Result<Vec<_>>>()?,
        );
    }
    report(&able, &columns)
}

fn build(level: &str, folder: &Path) -> Result<PathBuf> {
    let mut command = cargo(&["build", "--locked", "--release", "--package", "bilux-cli"]);
    command.env("RUSTFLAGS", format!("-Ctarget-cpu={level}")).env("CARGO_TARGET_DIR", folder);
    run_process(&mut command)?;
    Ok(folder.join("release").join("bilux"))
}

/// The SHA-256 of one picture as an OpenEXR file, so that every bit of every float counts.
fn draw(picture: &Picture, binary: &Path, folder: &Path) -> Result<String> {
    let (scene, file) = (folder.join("scene.toml"), folder.join(format!("{}.exr", picture.name)));
    output(Command::new(binary).arg("generate").args(picture.scene).arg("-o").arg(&scene))?;
    let mut render = Command::new(binary);
    render.arg("render").arg(&scene).args(picture.render).args(ALL).arg("-o").arg(&file);
    output(&mut render)?;
    let bytes = fs::read(&file).with_context(|| format!("cannot read {}", file.display()))?;
    Ok(Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Prints what differs; `columns` has one hash per picture for each level.
fn report(levels: &[&Level], columns: &[Vec<String>]) -> Result<()> {
    let mut different = 0;
    for (row, picture) in PICTURES.iter().enumerate() {
        let hashes: Vec<_> = columns.iter().map(|column| &column[row]).collect();
        let equal = hashes.iter().all(|hash| *hash == hashes[0]);
        println!("{:<10} {:.16}  {}", picture.name, hashes[0], if equal { "equal" } else { "DIFFERENT" });
        if !equal {
            different += 1;
            for (level, hash) in levels.iter().zip(hashes) {
                println!("    {:<10} {hash}", level.name);
            }
        }
    }
    match different {
        0 => Ok(()),
        _ => bail!("{different} of {} pictures depend on the CPU level", PICTURES.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planted_difference_is_found() {
        let levels: Vec<_> = LEVELS.iter().take(2).collect();
        let same = vec!["aa".to_owned(); PICTURES.len()];
        assert!(report(&levels, &[same.clone(), same.clone()]).is_ok());
        let mut other = same.clone();
        other[3] = "bb".to_owned();
        let error = report(&levels, &[same, other]).map_err(|error| error.to_string());
        assert_eq!(error, Err(format!("1 of {} pictures depend on the CPU level", PICTURES.len())));
    }
}
