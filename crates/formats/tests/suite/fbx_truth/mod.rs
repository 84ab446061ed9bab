//! FBX files of ufbx's test data, against the OBJ files beside them that other programs exported from the same scenes.
//!
//! The data are not ours. `BILUX_UFBX=FOLDER/data cargo test -p bilux-formats --test suite fbx_truth -- --nocapture` compares, and prints a
//! table; without the variable there is nothing to do.

mod obj;
mod refined;
mod settings;
mod skins;

use crate::witness::files_below;
use bilux_formats::{ReadOptions, read};
use bilux_math::glam::DVec4;
use bilux_math::{DMat4, DVec3};
use bilux_scene::SceneBuilder;
use obj::{Corner, Truth, truth};
use settings::{start, to_file};
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;
use std::path::PathBuf;

fn corners(scene: &SceneBuilder, to_file: &DMat4, truth: &Truth) -> Vec<Corner> {
    let mut corners = Vec::new();
    let is_named = |name: &str| truth.names.iter().any(|named| named == name);
    for object in scene.objects.iter().filter(|object| truth.names.is_empty() || is_named(&object.name)) {
        let mesh = &object.mesh;
        let transform = object.motion.at(0.0);
        let matrix = *to_file * DMat4::from_translation(scene.origin) * transform.matrix().as_dmat4();
        for &i in mesh.triangles.iter().flatten() {
            let i = i as usize;
            let n = mesh.normals.get(i).map(|n| {
                let world = transform.normal(*n).as_dvec3();
                to_file.transform_vector3(world).normalize_or_zero()
            });
            let uv = mesh.uvs.get(i).map(|uv| [f64::from(uv.x), f64::from(uv.y)]);
            corners.push(Corner { p: matrix.transform_point3(mesh.positions[i].as_dvec3()), n, uv });
        }
    }
    corners
}

/// Finds corners near a position.
struct Grid<'c> {
    cells: HashMap<[i64; 3], Vec<&'c Corner>>,
    size: f64,
}

impl<'c> Grid<'c> {
    fn new(corners: &'c [Corner], size: f64) -> Grid<'c> {
        let mut grid = Grid { cells: HashMap::new(), size };
        for corner in corners {
            let cell = grid.cell(corner.p);
            grid.cells.entry(cell).or_default().push(corner);
        }
        grid
    }

    fn cell(&self, p: DVec3) -> [i64; 3] {
        p.to_array().map(|x| (x / self.size).floor() as i64)
    }

    fn near(&self, p: DVec3) -> impl Iterator<Item = &&'c Corner> {
        let [x, y, z] = self.cell(p);
        (0..27).flat_map(move |i| {
            self.cells.get(&[x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1]).into_iter().flatten()
        })
    }
}

/// The number of corners with the same position, of those also with the same uv, and of those also with the same normal.
fn found(of: &[Corner], among: &[Corner], truth: &Truth) -> [usize; 3] {
    let grid = Grid::new(among, truth.tolerance.max(1e-9) * 2.0);
    let mut found = [0; 3];
    for corner in of {
        let mut best = 0;
        for other in grid.near(corner.p) {
            if corner.p.distance(other.p) > truth.tolerance {
                continue;
            }
            let same_n =
                truth.ignores_normals || corner.n.zip(other.n).is_none_or(|(a, b)| a.distance(b) < 5e-3);
            let same_uv = truth.ignores_uvs
                || corner
                    .uv
                    .zip(other.uv)
                    .is_none_or(|(a, b)| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()) < 2e-3);
            best = best.max(1 + usize::from(same_uv) + usize::from(same_n && same_uv));
        }
        found.iter_mut().take(best).for_each(|count| *count += 1);
    }
    found
}

/// A file of truth: what it is of, and at which frame.
fn subject(stem: &str, all: &BTreeMap<String, Vec<PathBuf>>) -> Option<(Vec<PathBuf>, Option<f64>)> {
    if stem.contains("lefthanded") {
        return None;
    }
    if let Some(files) = all.get(stem) {
        return Some((files.clone(), None));
    }
    let (base, frame) = stem.rsplit_once('_')?;
    let frame: f64 = frame.parse().ok()?;
    let files = all.get(base).cloned()?;
    Some((files, Some(frame)))
}

#[test]
fn meshes_are_where_other_programs_put_them() {
    let Some(folder) = std::env::var_os("BILUX_UFBX").map(PathBuf::from) else {
        println!("skipped: BILUX_UFBX does not name the folder of ufbx's data");
        return;
    };
    let only = std::env::var("BILUX_UFBX_ONLY").unwrap_or_default();
    let mut all: BTreeMap<String, Vec<PathBuf>> = BTreeMap::new();
    let mut truths = Vec::new();
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        match path.extension().and_then(|e| e.to_str()) {
            Some("fbx") => {
                let parts: Vec<&str> = stem.split('_').collect();
                let version = parts.iter().rposition(|part| part.len() == 4 && part.parse::<u32>().is_ok());
                let Some(version) = version else { continue };
                let mut base = parts[..version].join("_");
                if parts.len() > version + 2 {
                    base += &format!("_{}", parts[version + 2..].join("_"));
                }
                all.entry(base).or_default().push(path);
            }
            Some("obj") => truths.push((stem, path)),
            _ => {}
        }
    }
    truths.sort();
    let (mut equal, mut but_normals, mut same_surface, mut different, mut again, mut refused) =
        (0, 0, 0, 0, 0, 0);
    let mut report = String::new();
    let mut opened = 0;
    for (stem, path) in &truths {
        let Some((mut files, frame)) = subject(stem, &all).filter(|_| stem.contains(&only)) else { continue };
        files.sort();
        let truth = truth(path);
        for file in files {
            let bytes = std::fs::read(&file).unwrap();
            let fps = if stem.starts_with("max") { 30.0 } else { 24.0 };
            // The frames of these are counted from the beginning of their clips in a longer animation.
            let before = [("_spin_", 20.0), ("_deform_", 40.0)];
            let before = before
                .iter()
                .find(|(part, _)| stem.starts_with("maya") && stem.contains(part))
                .map_or(0.0, |b| b.1);
            let time = frame.map_or(0.0, |frame| ((frame + before) / fps - start(&bytes)) as f32);
            let name = file.file_stem().unwrap().to_string_lossy().into_owned();
            let options = ReadOptions { time, max_memory: refined::MEMORY, ..ReadOptions::default() };
            let scene = match read(&file, &options) {
                Ok(scene) => scene,
                Err(error) => {
                    refused += 1;
                    let _ = writeln!(report, "refused    {stem}: {error}");
                    continue;
                }
            };
            opened += 1;
            // In the axes and the unit of the file, or converted as its program did: to centimetres or metres with y up, or with z up.
            let z_up = DMat4::from_cols(DVec4::X, DVec4::Z, -DVec4::Y, DVec4::W);
            let units = [to_file(&bytes), DMat4::from_scale(DVec3::splat(100.0)), DMat4::IDENTITY, z_up];
            let (mut in_ours, mut in_truth, mut ours) = ([0; 3], [0; 3], Vec::new());
            let mut is_same = false;
            let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
            if 3 * triangles > 16 * truth.corners.len() {
                // A level of a subdivision surface, and here its limit.
                let share = refined::share_on(&scene, &units, path, truth.tolerance);
                if share == 1.0 {
                    same_surface += 1;
                } else {
                    different += 1;
                    let _ = writeln!(report, "refined    {stem} {name}: {share:.4}");
                }
                continue;
            }
            for unit in units {
                let here = corners(&scene, &unit, &truth);
                let (there, back) =
                    (found(&truth.corners, &here, &truth), found(&here, &truth.corners, &truth));
                is_same = there.iter().all(|count| *count == truth.corners.len())
                    && (truth.ignores_extra || back.iter().all(|count| *count == here.len()));
                if is_same || in_ours <= there {
                    (in_ours, in_truth, ours) = (there, back, here);
                }
                if is_same {
                    break;
                }
            }
            let [whole, ours_whole] = [truth.corners.len(), ours.len()];
            if is_same {
                equal += 1;
            } else if in_ours[1] == whole && in_truth[1] == ours_whole {
                but_normals += 1;
                let _ = writeln!(report, "normals    {stem} {name}: {in_ours:?} of {whole}");
            } else if truth.moves_skins_again && skins::is_moved_again(&scene, &truth) {
                again += 1;
            } else {
                different += 1;
                let (of, ours) = (truth.corners.len(), ours.len());
                let _ = writeln!(
                    report,
                    "different  {stem} {name}: {in_ours:?} of {of}; back {in_truth:?} of {ours}"
                );
            }
        }
    }
    println!(
        "{report}compared with an OBJ: opened {opened}, refused {refused}, equal {equal}, equal but for normals {but_normals}, \
         refined to the same surface {same_surface}, \
         equal after a skin's node moves it again {again}, different {different}"
    );
}

/// `BILUX_FBX=FOLDER` reads all files below a folder: what opens, and why others are refused.
#[test]
fn files_of_others_open() {
    let Some(folder) = std::env::var_os("BILUX_FBX").map(PathBuf::from) else {
        println!("skipped: BILUX_FBX does not name a folder");
        return;
    };
    let files = files_below(&folder, &["fbx"]);
    let mut refused: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let (mut empty, mut slowest) = (0, (0.0, String::new()));
    for file in &files {
        let start = std::time::Instant::now();
        let name = file.display().to_string();
        match read(file, &ReadOptions::default()) {
            Ok(scene) => empty += usize::from(scene.objects.is_empty()),
            Err(error) => {
                let reason: String = error.to_string().replace(&name, "").chars().take(90).collect();
                refused.entry(reason).or_default().push(name.clone());
            }
        }
        let seconds = start.elapsed().as_secs_f64();
        if seconds > slowest.0 {
            slowest = (seconds, name);
        }
    }
    let count: usize = refused.values().map(Vec::len).sum();
    for (reason, all) in &refused {
        println!("{:5} refused{reason}: {}", all.len(), all[0]);
    }
    println!(
        "{} files: opened {}, of which {empty} without meshes; refused {count}",
        files.len(),
        files.len() - count
    );
    println!("the slowest took {:.2} s: {}", slowest.0, slowest.1);
}
