//! Files of others against OpenUSD itself. `BILUX_USD=FOLDER BILUX_USD_PYTHON=INTERPRETER` names a folder of files and a Python with the
//! package `usd-core`; without these, nothing is compared. `BILUX_USD_ONLY=TEXT` takes only files with this in their path.

use crate::witness::{files_below, said};
use bilux_formats::{ReadOptions, read};
use bilux_math::DVec3;
use bilux_scene::SceneBuilder;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

/// All meshes of prims with one name.
#[derive(Clone, Copy, Debug)]
struct Meshes {
    is_subdivided: bool,
    triangles: usize,
    bounds: [DVec3; 2],
}

/// Little memory: subdivision surfaces are then coarse, which they may be here.
const MEMORY: u64 = 100 << 20;

const NONE: [DVec3; 2] = [DVec3::INFINITY, DVec3::NEG_INFINITY];

fn ours(scene: &SceneBuilder) -> BTreeMap<String, Meshes> {
    let mut all: BTreeMap<String, Meshes> = BTreeMap::new();
    for object in &scene.objects {
        let none = Meshes { is_subdivided: false, triangles: 0, bounds: NONE };
        let meshes = all.entry(object.name.clone()).or_insert(none);
        meshes.triangles += object.mesh.triangles.len();
        let place = object.motion.at(0.0).matrix().as_dmat4();
        for &i in object.mesh.triangles.iter().flatten() {
            let p = place.transform_point3(object.mesh.positions[i as usize].as_dvec3()) + scene.origin;
            meshes.bounds = [meshes.bounds[0].min(p), meshes.bounds[1].max(p)];
        }
    }
    all
}

/// The first difference, if there is one.
fn difference(truth: &BTreeMap<String, Meshes>, ours: &BTreeMap<String, Meshes>) -> Option<String> {
    for (name, there) in truth.iter().filter(|(_, meshes)| meshes.triangles > 0) {
        let Some(here) = ours.get(name) else { return Some(format!("{name} is missing")) };
        let [low, high] = there.bounds;
        let size = (high - low).max_element().max(low.abs().max_element()).max(high.abs().max_element());
        let tolerance = 2e-5 * size.max(1e-9);
        let is_refined = there.is_subdivided && here.triangles != there.triangles;
        // A surface is within the cage that controls it.
        let is_same = match is_refined {
            true => {
                (here.bounds[0] - low).min_element() >= -tolerance
                    && (high - here.bounds[1]).min_element() >= -tolerance
            }
            false => {
                here.bounds[0].distance(low) <= tolerance * 2.0
                    && here.bounds[1].distance(high) <= tolerance * 2.0
            }
        };
        if !is_refined && here.triangles != there.triangles {
            return Some(format!("{name} has {} triangles, not {}", here.triangles, there.triangles));
        }
        if !is_same {
            let all = [here.bounds[0], here.bounds[1], low, high].map(|p| p.as_vec3().to_array());
            return Some(format!(
                "{name} is at {:?} to {:?}, not {:?} to {:?}",
                all[0], all[1], all[2], all[3]
            ));
        }
    }
    None
}

#[test]
fn meshes_are_where_openusd_puts_them() {
    let variables = ["BILUX_USD", "BILUX_USD_PYTHON"].map(std::env::var_os);
    let [Some(folder), Some(python)] = variables else {
        println!(
            "skipped: BILUX_USD does not name a folder of files, or BILUX_USD_PYTHON no Python with usd-core"
        );
        return;
    };
    let only = std::env::var("BILUX_USD_ONLY").unwrap_or_default();
    let mut files = files_below(Path::new(&folder), &["usd", "usda", "usdc", "usdz"]);
    files.retain(|file| file.display().to_string().contains(&only));
    let text = said("usd_truth.py", &files, &python);
    let (mut equal, mut different, mut refused, mut meshes) = (0, 0, 0, 0);
    let mut report = String::new();
    for section in text.split_inclusive('\n').collect::<Vec<_>>().chunk_by(|_, line| line.starts_with('O')) {
        let head: Vec<&str> = section[0].trim_end().split('\t').collect();
        let [kind, seconds, file] = head[..] else { continue };
        if kind == "E" {
            let _ = writeln!(report, "OpenUSD refuses {seconds}: {file}");
            continue;
        }
        let mut truth = BTreeMap::new();
        for line in &section[1..] {
            let words: Vec<&str> = line.trim_end().split('\t').collect();
            let number = |i: usize| words[i].parse::<f64>().unwrap();
            let bounds = [4, 7].map(|i| DVec3::new(number(i), number(i + 1), number(i + 2)));
            let all = Meshes { is_subdivided: words[2] == "1", triangles: words[3].parse().unwrap(), bounds };
            truth.insert(words[1].to_owned(), all);
        }
        meshes += truth.len();
        let options = ReadOptions {
            time: seconds.parse().unwrap(),
            allow_outside: true,
            max_memory: MEMORY,
            ..ReadOptions::default()
        };
        let name = file.strip_prefix(&folder.to_string_lossy()[..]).unwrap_or(file);
        match read(Path::new(file), &options) {
            Err(error) => {
                refused += 1;
                let _ = writeln!(report, "refused    {name}: {error}");
            }
            Ok(scene) => match difference(&truth, &ours(&scene)) {
                None => equal += 1,
                Some(what) => {
                    different += 1;
                    let _ = writeln!(report, "different  {name} at {seconds} s: {what}");
                }
            },
        }
    }
    println!(
        "{report}{} files, some at two times: equal {equal}, different {different}, refused {refused}; names of meshes {meshes}",
        files.len()
    );
}
