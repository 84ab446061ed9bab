//! Rendering many scenes in one process takes no more time than rendering each in a process of its own. This
//! test has a binary of its own too, since it reads the CPU time of all children of its process.
#![cfg(target_os = "linux")]

use assert_cmd::Command;
use std::path::Path;
use tempfile::TempDir;

const SCENES: usize = 6;

/// CPU seconds of all child processes that have ended so far, in hundredths; a wall clock would also measure other
/// processes.
fn children_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap();
    let fields = text.rsplit_once(')').unwrap().1.split_whitespace();
    fields.skip(13).take(2).map(|ticks| ticks.parse::<f64>().unwrap()).sum::<f64>() / 100.0
}

fn render(folder: &Path, scenes: &[String]) -> f64 {
    let before = children_seconds();
    let mut bilux = Command::new(env!("CARGO_BIN_EXE_bilux"));
    bilux.current_dir(folder).args([
        "render",
        "--quiet",
        "--size",
        "64x64",
        "--spp",
        "8",
        "-o",
        "{stem}.png",
    ]);
    bilux.args(scenes).assert().success();
    children_seconds() - before
}

#[test]
fn many_scenes_in_one_process_reach_nine_tenths_of_the_rate_of_each_alone() {
    let folder = TempDir::new().unwrap();
    let scene = "[[model]]\ngenerate = \"cornell\"\nwith = [\"lights\", \"cameras\"]\n";
    let names: Vec<String> = (0..SCENES).map(|i| format!("room{i}.toml")).collect();
    for name in &names {
        std::fs::write(folder.path().join(name), scene).unwrap();
    }
    let alone: f64 = names.iter().map(|name| render(folder.path(), std::slice::from_ref(name))).sum();
    let together = render(folder.path(), &names);
    let rate = alone / together;
    assert!(
        rate >= 0.9,
        "together {together:.2} s of CPU, alone {alone:.2} s: {:.0}% of the rate",
        100.0 * rate
    );
    let same = |i| std::fs::read(folder.path().join(format!("room{i}.png"))).unwrap();
    assert!((1..SCENES).all(|i| same(i) == same(0)), "a scene is not changed by those before it");
}
