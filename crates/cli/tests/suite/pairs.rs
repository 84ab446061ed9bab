//! Options of `bilux render` that are given together: every pair of them works, or is refused as a wrong command line, which says why.

use bilux_testing::effort;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Options that are no fields of a job for `bilux worker`, which runs these pairs.
const OTHERS: [&str; 15] = [
    "output",
    "allow-outside",
    "help",
    "json",
    "preview",
    "progress",
    "quiet",
    "replay",
    "strict",
    "verbose",
    "watch",
    "resume",
    // It takes a second.
    "fast",
    // They are about standard streams.
    "input-format",
    "output-format",
];

/// Every other option, with a value that works on its own.
fn values() -> Vec<(&'static str, Value)> {
    vec![
        ("accel", json!("bvh")),
        ("animation", json!("move")),
        ("aov", json!(["depth"])),
        ("at", json!(0.25)),
        ("background", json!("behind.ppm")),
        ("bits", json!("16")),
        ("bsp-group", json!("objects")),
        ("bsp-split", json!("fuchs")),
        ("build", json!("fast")),
        ("camera", json!("0")),
        ("change", json!(["material:0:kd=0.5"])),
        ("checkpoint", json!("off")),
        ("crop", json!([1, 1, 4, 4])),
        ("define", json!("a=1")),
        ("denoise", json!("builtin")),
        ("env", json!("sky/sky.pfm")),
        ("exposure", json!(1)),
        ("eye", json!([0, 0.5, 3])),
        ("focal", json!(40)),
        ("fog", json!(9)),
        ("frames", json!("0-1")),
        ("front", json!("z")),
        ("glass", json!("thin")),
        ("ground", json!("shadow")),
        ("integrator", json!("bdpt")),
        ("intrinsics", json!("eyes/camera.yaml")),
        ("labels", json!(true)),
        ("layer", json!("main")),
        ("lengths", json!("0,1,3")),
        ("light-radius", json!("0.1")),
        ("look-at", json!([0, 0, 0.1])),
        ("max-depth", json!(3)),
        ("max-memory", json!("500M")),
        ("noise", json!(0.5)),
        ("orbit", json!([20, 10])),
        ("preset", json!("clay")),
        ("quality", json!(80)),
        ("samples", json!("0..1")),
        ("sandbox", json!(true)),
        ("seed", json!(7)),
        ("set", json!({ "fps": 12 })),
        ("shadow-rule", json!("paper")),
        ("size", json!([9, 7])),
        ("specular", json!("reflect")),
        ("spp", json!(1)),
        ("stats", json!("stats.json")),
        ("subdivide", json!("loop")),
        ("threads", json!(1)),
        ("time-limit", json!(0.05)),
        ("timeout", json!(30)),
        ("tonemap", json!("agx")),
        ("turntable", json!(2)),
        ("up", json!("y")),
        ("variant", json!("red")),
        ("zoom", json!(1.5)),
    ]
}

/// Options that this scene has nothing for, or that need another file than a PNG: they are refused on their own.
const REFUSED: [&str; 7] = ["animation", "define", "layer", "quality", "samples", "variant", "preset"];

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    fs::write(path.join("card.obj"), "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n").unwrap();
    fs::write(path.join("behind.ppm"), b"P6 2 1 255\n\x20\x40\x80\x80\x40\x20").unwrap();
    fs::create_dir(path.join("sky")).unwrap();
    fs::write(path.join("sky/sky.pfm"), b"PF\n1 1\n-1\n\0\0\x80\x3f\0\0\x80\x3f\0\0\0\x40").unwrap();
    fs::create_dir(path.join("eyes")).unwrap();
    let camera = "image_width: 8\nimage_height: 6\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [8, 0, 3.5, 0, 8, 2.5, 0, 0, 1]\n\
                  distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0, 0, 0, 0, 0]\n";
    fs::write(path.join("eyes/camera.yaml"), camera).unwrap();
    folder
}

/// The results of jobs with these fields.
fn results(path: &Path, jobs: &[Vec<(&str, Value)>]) -> Vec<Value> {
    let mut worker = Command::new(env!("CARGO_BIN_EXE_bilux"));
    worker.current_dir(path).args(["worker", "--max-memory", "1G"]);
    let mut worker =
        worker.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut input = worker.stdin.take().unwrap();
    let lines: Vec<String> = jobs.iter().enumerate().map(|(number, fields)| line(number, fields)).collect();
    let writing =
        std::thread::spawn(move || lines.iter().for_each(|line| writeln!(input, "{line}").unwrap()));
    let said = BufReader::new(worker.stdout.take().unwrap()).lines();
    let results = said.map(|line| serde_json::from_str(&line.unwrap()).unwrap()).collect();
    writing.join().unwrap();
    assert!(worker.wait().unwrap().success());
    results
}

fn line(number: usize, fields: &[(&str, Value)]) -> String {
    let mut job = json!({ "id": number, "scene": "card.obj", "output": "out.png", "size": [8, 6], "integrator": "path" });
    let is_given = |name: &str| fields.iter().any(|(field, _)| *field == name);
    if !is_given("noise") && !is_given("time-limit") {
        job["spp"] = json!(1);
    }
    if is_given("frames") || is_given("turntable") {
        job["output"] = json!("out-{frame}.png");
    }
    fields.iter().for_each(|(name, value)| job[*name] = value.clone());
    job.to_string()
}

#[test]
fn every_option_works_with_every_other_or_says_why_not() {
    let help = Command::new(env!("CARGO_BIN_EXE_bilux")).args(["render", "--help"]).output().unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let known: BTreeSet<&str> = help
        .lines()
        .filter_map(|line| {
            let (_, rest) = line.trim_start().starts_with('-').then(|| line.split_once("--"))??;
            rest.split(|c: char| !c.is_ascii_alphanumeric() && c != '-').next()
        })
        .collect();
    let values = values();
    let table: BTreeSet<&str> = values.iter().map(|(name, _)| *name).chain(OTHERS).collect();
    assert!(known.is_subset(&table), "say what these do together: {:?}", known.difference(&table));
    let folder = folder();
    let alone: Vec<Vec<_>> = values.iter().map(|value| vec![value.clone()]).collect();
    let mut wrong = Vec::new();
    for (result, (name, _)) in results(folder.path(), &alone).iter().zip(&values) {
        if (result["status"] == 0) == REFUSED.contains(name) {
            wrong.push(format!("--{name}: {result}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // All with a sandbox, which takes files away; and of all others some, in turn.
    let works: Vec<_> = values.iter().filter(|(name, _)| !REFUSED.contains(name)).collect();
    let step = effort(14, 1);
    let mut pairs = Vec::new();
    for (i, one) in works.iter().enumerate() {
        for (j, other) in works.iter().enumerate().skip(i + 1) {
            if one.0 == "sandbox" || other.0 == "sandbox" || (i + 3 * j) % step == 0 {
                pairs.push(vec![(*one).clone(), (*other).clone()]);
            }
        }
    }
    for (result, pair) in results(folder.path(), &pairs).iter().zip(&pairs) {
        let names = format!("--{} --{}", pair[0].0, pair[1].0);
        let status = result["status"].as_i64().unwrap();
        let error = result["error"].as_str().unwrap_or_default();
        let is_sandboxed = pair.iter().any(|(name, _)| *name == "sandbox");
        let is_refused = status == 2 && error.len() > 10;
        // A sandbox has whatever the options name.
        if !(status == 0 && error.is_empty() || is_refused && !is_sandboxed) {
            wrong.push(format!("{names}: {result}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
