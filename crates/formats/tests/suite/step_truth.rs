//! STEP files of others against Open CASCADE. `BILUX_STEP=FOLDER BILUX_STEP_PYTHON=INTERPRETER` names a folder of files and a Python with
//! the package `cadquery-ocp`; without these, nothing is compared. `BILUX_STEP_ONLY=TEXT` takes only files with this in their path,
//! `BILUX_STEP_SAID=FILE` keeps what Open CASCADE said for the next time, and `BILUX_STEP_SHOWN=FOLDER` gets what was read, as `.glb`.

use crate::witness::{files_below, said};
use bilux_formats::{ReadOptions, WriteOptions, read, write};
use bilux_math::DVec3;
use bilux_scene::SceneBuilder;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// Measures of a scene, in millimetres.
pub(crate) struct Measures {
    pub(crate) area: f64,
    pub(crate) volume: f64,
    pub(crate) bounds: [DVec3; 2],
    /// By colour in linear light, with three digits; none for the default.
    pub(crate) areas: BTreeMap<String, f64>,
    pub(crate) triangles: usize,
}

pub(crate) fn measures(scene: &SceneBuilder) -> Measures {
    let scale = scene.unit * 1000.0;
    let mut found = Measures {
        area: 0.0,
        volume: 0.0,
        bounds: [DVec3::INFINITY, DVec3::NEG_INFINITY],
        areas: BTreeMap::new(),
        triangles: 0,
    };
    for object in &scene.objects {
        let place = object.motion.at(0.0).matrix().as_dmat4();
        let colour = scene.materials[object.material].colour("base_color");
        let colour = colour.map(|rgb| format!("{:.3},{:.3},{:.3}", rgb.r, rgb.g, rgb.b));
        let of_colour = found.areas.entry(colour.unwrap_or_else(|| "-".to_owned())).or_default();
        found.triangles += object.mesh.triangles.len();
        for corners in &object.mesh.triangles {
            let at = |i: u32| place.transform_point3(object.mesh.positions[i as usize].as_dvec3()) * scale;
            let [a, b, c] = corners.map(at);
            let area = 0.5 * (b - a).cross(c - a).length();
            found.area += area;
            *of_colour += area;
            found.volume += a.dot(b.cross(c)) / 6.0;
            for p in [a, b, c] {
                found.bounds = [found.bounds[0].min(p), found.bounds[1].max(p)];
            }
        }
    }
    found
}

/// Differences in the area, the volume and the areas of colours, of more than a hundredth, and in the bounds, of more than half a
/// hundredth of their diagonal.
fn differences(ours: &Measures, truth: &[f64], colours: &str) -> Vec<String> {
    let mut all = Vec::new();
    let [area, volume] = [truth[1], truth[2]];
    let [low, high] = [DVec3::from_slice(&truth[3..6]), DVec3::from_slice(&truth[6..9])];
    let size = (high - low).length();
    if (ours.area / area - 1.0).abs() > 0.01 {
        all.push(format!("area {:.4}", ours.area / area));
    }
    if volume.is_finite() && (ours.volume - volume).abs() > 0.01 * volume.abs() {
        all.push(format!("volume {:.4}", ours.volume / volume));
    }
    let missed = ours.bounds[0].distance(low).max(ours.bounds[1].distance(high));
    if missed.is_nan() || missed > 0.005 * size {
        all.push(format!("bounds {:.4}", missed / size));
    }
    let mut theirs: Vec<(&str, f64)> = Vec::new();
    for part in colours.split(';').filter(|part| !part.is_empty()) {
        let (colour, area) = part.split_once('=').unwrap();
        theirs.push((colour, area.parse().unwrap()));
    }
    for (colour, _) in &theirs {
        let channels = |text: &str| text.split(',').map(|x| x.parse().unwrap_or(-1.0)).collect::<Vec<f64>>();
        let is_same = |other: &str| {
            let (a, b) = (channels(colour), channels(other));
            a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 0.002)
        };
        // Rounding makes one colour of two, or two of one.
        let there: f64 = theirs.iter().filter(|(other, _)| is_same(other)).map(|(_, area)| area).sum();
        let here: f64 = ours.areas.iter().filter(|(other, _)| is_same(other)).map(|(_, area)| area).sum();
        if (here - there).abs() > 0.01 * area {
            all.push(format!("{colour}: {:.4} of the area, not {:.4}", here / area, there / area));
        }
    }
    all
}

#[test]
fn solids_measure_what_open_cascade_says() {
    let variables = ["BILUX_STEP", "BILUX_STEP_PYTHON"].map(std::env::var_os);
    let [Some(folder), Some(python)] = variables else {
        println!(
            "skipped: BILUX_STEP does not name a folder of files, or BILUX_STEP_PYTHON no Python with cadquery-ocp"
        );
        return;
    };
    let only = std::env::var("BILUX_STEP_ONLY").unwrap_or_default();
    let mut files = files_below(Path::new(&folder), &["step", "stp", "p21"]);
    files.retain(|file| file.display().to_string().contains(&only));
    // What Open CASCADE says takes longer than all else, and can be kept.
    let text = match std::env::var_os("BILUX_STEP_SAID") {
        Some(kept) if Path::new(&kept).exists() => std::fs::read_to_string(kept).unwrap(),
        kept => {
            let text = said("step_truth.py", &files, &python);
            kept.into_iter().for_each(|kept| std::fs::write(kept, &text).unwrap());
            text
        }
    };
    let (mut equal, mut different) = (0, 0);
    println!("faces | triangles | area | volume | s | theirs | file");
    for line in text.lines() {
        let parts: Vec<&str> = line.split('\t').collect();
        let (file, is_read) = (parts[parts.len() - 1], parts[0] == "F");
        if !file.contains(&only) {
            continue;
        }
        let start = Instant::now();
        let scene = match read(Path::new(file), &ReadOptions::default()) {
            Ok(scene) => scene,
            Err(error) => {
                println!("refused: {error}");
                different += usize::from(is_read);
                continue;
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        let ours = measures(&scene);
        if let Some(folder) = std::env::var_os("BILUX_STEP_SHOWN") {
            let name = format!("{}.glb", Path::new(file).file_stem().unwrap().display());
            write(&Path::new(&folder).join(name), &scene, &WriteOptions::default()).unwrap();
        }
        let name = file.rsplit('/').next().unwrap_or(file);
        if !is_read {
            println!(
                "- | {} | {:.1} | {:.1} | {seconds:.2} | refused | {name}",
                ours.triangles, ours.area, ours.volume
            );
            continue;
        }
        let truth: Vec<f64> = parts[2..11].iter().map(|number| number.parse().unwrap()).collect();
        let differences = differences(&ours, &truth, parts[11]);
        let (area, volume) = (ours.area / truth[1], ours.volume / truth[2]);
        println!(
            "{} | {} | {area:.4} | {volume:.4} | {seconds:.2} | {} | {name}",
            parts[2], ours.triangles, parts[1]
        );
        for difference in &differences {
            println!("    {difference}");
        }
        for warning in scene.warnings.iter().chain(&scene.notes) {
            println!("    {warning}");
        }
        if differences.is_empty() { equal += 1 } else { different += 1 }
    }
    println!("{equal} files agree, {different} do not");
    assert!(only != String::new() || different * 10 <= equal, "more than one file of ten differs");
}
