//! `cargo xtask build-time`: how long the first build takes, as the first command of the README makes it, and how long a build
//! after one changed line. It prints tables for `docs/performance.md`.
//!
//! All of it happens in a clone in the target folder, with a target folder of its own: nothing here is edited or built anew.

use crate::process::{cpu_time, output, root, run as run_process, target_folder};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// A line that is changed: where, what of it, and to what.
struct Edit {
    place: &'static str,
    file: &'static str,
    before: &'static str,
    after: &'static str,
}

/// One line in each of the places where people work.
const EDITS: &[Edit] = &[
    Edit {
        place: "an integrator",
        file: "crates/transport/src/integrators/occlusion.rs",
        before: "n_shade.dot(Vec3::from(ray.direction)) < 0.0;",
        after: "n_shade.dot(Vec3::from(ray.direction)) < 1e-9;",
    },
    Edit {
        place: "a material",
        file: "crates/scene/src/materials/diffuse.rs",
        before: "(self.reflectance.at(surface.uvs()) * vertex).clamp(0.0, 1.0)",
        after: "(self.reflectance.at(surface.uvs()) * vertex).clamp(0.0, 0.99)",
    },
    Edit {
        place: "a reader",
        file: "crates/meshes/src/off/columns.rs",
        before: "let is_off = takes(b\"OFF\")",
        after: "let is_off = takes(b\"off\")",
    },
    Edit {
        place: "the command line",
        file: "crates/cli/src/arguments/version.rs",
        before: "CPU level {}, sandbox {})",
        after: "level of the CPU {}, sandbox {})",
    },
];

/// Number of crates with a row of their own.
const ROWS: usize = 24;

/// Measures the first build, and a build after each edit, which stay.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    if let [word, ..] = arguments {
        bail!("`cargo xtask build-time` takes no option {word}");
    }
    let folder = target_folder().join("build-time");
    let tree = clone(&folder)?;
    let fetch =
        Command::new(cargo_program()).args(["fetch", "--locked", "--quiet"]).current_dir(&tree).status();
    if !fetch.is_ok_and(|status| status.success()) {
        bail!("cargo cannot download the packages");
    }
    let first = build(&tree, &folder)?;
    let units = units(&folder.join("target/cargo-timings/cargo-timing.html"))?;
    let mut text = "\n| build | wall seconds | CPU seconds |\n| --- | --- | --- |\n".to_owned();
    row(&mut text, "the first", &first);
    for edit in EDITS {
        let path = tree.join(edit.file);
        let before = fs::read_to_string(&path).with_context(|| format!("cannot read {}", edit.file))?;
        fs::write(&path, before.replacen(edit.before, edit.after, 1))?;
        row(&mut text, &format!("after one line of {} ({})", edit.place, edit.file), &build(&tree, &folder)?);
    }
    print!("{text}\n{}", table(&units));
    fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))
}

/// Wall and CPU seconds.
struct Seconds {
    wall: f64,
    cpu: Option<f64>,
}

fn row(text: &mut String, what: &str, Seconds { wall, cpu }: &Seconds) {
    let cpu = cpu.map_or("unknown".to_owned(), |cpu| format!("{cpu:.1}"));
    let _ = writeln!(text, "| {what} | {wall:.1} | {cpu} |");
}

/// Clones what is committed here into an empty folder.
fn clone(folder: &Path) -> Result<PathBuf> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("cannot empty {}", folder.display()))?;
    }
    let tree = folder.join("tree");
    let git = |arguments: &[&str]| output(Command::new("git").args(arguments).current_dir(root()));
    if !git(&["status", "--porcelain"]).context("`build-time` needs git and a checkout")?.is_empty() {
        println!("what is not committed is not measured");
    }
    let mut clone = Command::new("git");
    clone.args(["clone", "--quiet"]).arg(root()).arg(&tree);
    run_process(&mut clone)?;
    Ok(tree)
}

/// Builds what the first command of the README builds.
fn build(tree: &Path, folder: &Path) -> Result<Seconds> {
    let (begun, cpu) = (Instant::now(), cpu_time());
    let mut build = Command::new(cargo_program());
    build.args(["build", "--locked", "--release", "--timings"]).current_dir(tree);
    run_process(build.env("CARGO_TARGET_DIR", folder.join("target")))?;
    let cpu = cpu_time().zip(cpu).map(|(now, then)| now.saturating_sub(then).as_secs_f64());
    Ok(Seconds { wall: begun.elapsed().as_secs_f64(), cpu })
}

fn cargo_program() -> std::ffi::OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

/// The wall seconds of each crate's units, from the page that cargo leaves.
fn units(page: &Path) -> Result<BTreeMap<String, f64>> {
    let text = fs::read_to_string(page).with_context(|| format!("cannot read {}", page.display()))?;
    read_units(&text).with_context(|| format!("{} holds no times", page.display()))
}

fn read_units(page: &str) -> Option<BTreeMap<String, f64>> {
    let (_, data) = page.split_once("const UNIT_DATA = ")?;
    let (data, _) = data.split_once("];")?;
    let units: Value = serde_json::from_str(&format!("{data}]")).ok()?;
    let mut seconds = BTreeMap::new();
    for unit in units.as_array()? {
        *seconds.entry(unit["name"].as_str()?.to_owned()).or_default() += unit["duration"].as_f64()?;
    }
    Some(seconds)
}

fn table(units: &BTreeMap<String, f64>) -> String {
    let mut units: Vec<_> = units.iter().map(|(name, seconds)| (name.as_str(), *seconds)).collect();
    units.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut text = "| crate, in the first build | wall seconds of its units |\n| --- | --- |\n".to_owned();
    for (name, seconds) in units.iter().take(ROWS) {
        let _ = writeln!(text, "| `{name}` | {seconds:.1} |");
    }
    if let Some(others @ [_, ..]) = units.get(ROWS..) {
        let sum: f64 = others.iter().map(|(_, seconds)| seconds).sum();
        let _ = writeln!(text, "| {} others | {sum:.1} |", others.len());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_edit_fits_in_one_place() {
        for edit in EDITS {
            let text = fs::read_to_string(root().join(edit.file)).unwrap();
            assert_eq!(text.matches(edit.before).count(), 1, "{}: {}", edit.file, edit.before);
            assert_ne!(edit.before, edit.after);
        }
    }

    #[test]
    fn the_times_of_crates_are_read() {
        let page = "DURATION = 9;\nconst UNIT_DATA = [\n{\"name\": \"a\", \"duration\": 1.5, \"sections\": [[1, 2]]},\n\
                    {\"name\": \"b\", \"duration\": 4},\n{\"name\": \"a\", \"duration\": 1}\n];\nconst X = [];";
        let units = read_units(page).unwrap();
        assert_eq!(table(&units).lines().skip(2).collect::<Vec<_>>(), ["| `b` | 4.0 |", "| `a` | 2.5 |"]);
        assert_eq!(read_units("no page"), None);
        let many = (0..ROWS + 2).map(|i| (format!("c{i:02}"), 1.0)).collect();
        assert!(table(&many).ends_with("| 2 others | 2.0 |\n"));
    }
}
