//! `cargo xtask instructions`: how many instructions a ray takes, so that kernels do not get slower unnoticed.
//!
//! Seconds depend on the machine and its other users; the instructions that callgrind counts do not. They do depend on
//! the compiler, so the table records which compiler produced it; with another compiler the counts are only printed.

use crate::process::{cargo, output, root, run as run_process, target_folder};
use anyhow::{Context, Result, bail};
use std::fmt::Write;
use std::fs;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Callgrind does not support AVX-512: only `bilux bench rays` measures those kernels.
const WORKS: &[&str] = &[
    "primary-single-avx2",
    "primary-batch-avx2",
    "bounce-single-avx2",
    "bounce-batch-avx2",
    "shadow-single-avx2",
    "shadow-batch-avx2",
    "primary-single-sse4.2",
    "bounce-single-sse4.2",
    "shadow-single-sse4.2",
    "bounce-single-baseline",
    "primary-compact-avx2",
    "bounce-compact-avx2",
    "shadow-compact-avx2",
    "bounce-compact-sse4.2",
    "bounce-compact-baseline",
];
const TABLE: &str = "crates/accel/instructions.tsv";
/// A count above the table by more than this fraction is a slowdown; one below it by more than this is worth a new
/// table.
const TOLERANCE: f64 = 0.03;

/// Counts instructions and compares them with the table; with `--write`, writes the table.
pub(crate) fn run(arguments: &[String]) -> Result<()> {
    if !Command::new("valgrind").arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success()) {
        println!("skipped: there is no valgrind, which counts instructions");
        return Ok(());
    }
    run_process(&mut cargo(&[
        "build",
        "--locked",
        "--release",
        "--package",
        "bilux-accel",
        "--example",
        "counted_work",
    ]))?;
    let counted = count_all()?;
    let compiler = output(Command::new("rustc").arg("--version").current_dir(root()))?.trim().to_owned();
    let path = root().join(TABLE);
    if arguments.iter().any(|argument| argument == "--write") {
        return fs::write(&path, table(&compiler, &counted)).with_context(|| format!("cannot write {TABLE}"));
    }
    let known = fs::read_to_string(&path).with_context(|| format!("cannot read {TABLE}"))?;
    if !known.lines().any(|line| line == compiler) {
        println!("the table is of another compiler than {compiler}, so nothing is compared:");
        print!("{}", table(&compiler, &counted));
        return Ok(());
    }
    let slower = compare(&known, &counted);
    if slower.is_empty() {
        return Ok(());
    }
    bail!("slower than {TABLE}: {}; if that is wanted, `cargo xtask instructions --write`", slower.join(", "))
}

/// Counts every workload, as many at a time as there are cores: the counts do not depend on each other.
fn count_all() -> Result<Vec<(&'static str, f64)>> {
    let next = AtomicUsize::new(0);
    let on_one_core = || {
        let works = std::iter::from_fn(|| WORKS.get(next.fetch_add(1, Ordering::Relaxed)));
        works.map(|work| Ok((*work, count(work)?))).collect::<Result<Vec<_>>>()
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut counted = std::thread::scope(|scope| {
        let all: Vec<_> = (0..cores).map(|_| scope.spawn(on_one_core)).collect();
        let joined =
            all.into_iter().map(|thread| thread.join().unwrap_or_else(|_| bail!("a count panicked")));
        joined.collect::<Result<Vec<_>>>()
    })?
    .concat();
    counted.sort_by_key(|(work, _)| WORKS.iter().position(|known| known == work));
    Ok(counted)
}

/// Instructions per ray.
fn count(work: &str) -> Result<f64> {
    let program = target_folder().join("release").join("examples").join("counted_work");
    let mut valgrind = Command::new("valgrind");
    valgrind
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--toggle-collect=*counted_work*asked*"])
        .arg(program)
        .arg(work);
    let reported = valgrind.output().context("cannot start valgrind")?;
    let (said, log) = (String::from_utf8_lossy(&reported.stdout), String::from_utf8_lossy(&reported.stderr));
    let rays = said.split_whitespace().next().and_then(|word| word.parse::<f64>().ok());
    let instructions = collected(&log);
    match (rays, instructions) {
        (Some(rays), Some(instructions)) if reported.status.success() && rays > 0.0 && instructions > 0.0 => {
            Ok(instructions / rays)
        }
        _ => bail!("{work} could not be counted:\n{said}{log}"),
    }
}

/// Reads the line `Collected : N`.
fn collected(log: &str) -> Option<f64> {
    log.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok())
}

fn table(compiler: &str, counted: &[(&str, f64)]) -> String {
    let mut text = format!("{compiler}\n");
    for (work, count) in counted {
        let _ = writeln!(text, "{work}\t{count:.0}");
    }
    text
}

/// Prints old and new counts, and returns what is slower than before, or has no line in the table.
fn compare(known: &str, counted: &[(&str, f64)]) -> Vec<String> {
    let before =
        |work: &str| known.lines().find_map(|line| line.strip_prefix(work)?.trim().parse::<f64>().ok());
    let mut slower = Vec::new();
    for (work, count) in counted {
        let before = before(work);
        let change = before.map_or(f64::INFINITY, |before| count / before - 1.0);
        let verdict = match change {
            _ if change > TOLERANCE => "SLOWER",
            _ if change < -TOLERANCE => "faster: write a new table",
            _ => "",
        };
        println!(
            "{work:<24} {count:>7.0} instructions a ray, {:>7.0} before  {verdict}",
            before.unwrap_or(0.0)
        );
        if change > TOLERANCE {
            slower.push((*work).to_owned());
        }
    }
    slower
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_read_and_compared() {
        assert_eq!(collected("==1== Events    : Ir\n==1== Collected : 1234567\n"), Some(1_234_567.0));
        assert_eq!(collected("nothing"), None);
        let known = table("rustc 1", &[("a", 1000.0), ("b", 500.0)]);
        assert_eq!(known, "rustc 1\na\t1000\nb\t500\n");
        assert!(compare(&known, &[("a", 1020.0), ("b", 400.0)]).is_empty());
        assert_eq!(compare(&known, &[("a", 1040.0), ("b", 500.0), ("c", 1.0)]), ["a", "c"]);
    }
}
