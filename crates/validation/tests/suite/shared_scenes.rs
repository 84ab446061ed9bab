//! Every scene that people gave us in the formats that we read is rendered, or refused with an explanation.
// Tests report what they skip.
#![allow(clippy::print_stdout)]

use bilux::prelude::*;
use std::path::{Path, PathBuf};

/// Files that contain nothing visible, or are broken: these and no others are refused. Clouds of points and lines are
/// rendered.
const REFUSED: &[&str] = &[];

fn shared() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    folder.is_dir().then_some(folder)
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

#[test]
fn every_shared_scene_is_rendered_or_refused_in_words() {
    let Some(shared) = shared() else {
        println!("skipped: there is no folder ../shared/scenes");
        return;
    };
    let mut all = Vec::new();
    for kind in ["asc", "obj", "ply", "stl"] {
        files(&shared.join(kind), &mut all);
    }
    all.sort();
    let extensions = ["asc", "obj", "ply", "stl"];
    let known = |p: &PathBuf| {
        let extension = p.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        extensions.contains(&extension.as_str())
    };
    let mut rendered = 0;
    for path in all.iter().filter(|p| known(p)) {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let result = picture_of(path);
        match &result {
            Ok(picture) => {
                let pixels = picture.to_rgb().unwrap();
                assert!(pixels.iter().all(|p| p.is_finite()), "{name}");
                assert!(pixels.iter().any(|p| *p != pixels[0]), "{name}: nothing is seen");
                rendered += 1;
            }
            Err(error) => assert!(error.to_string().len() > 20, "{name}: {error}"),
        }
        let refused = REFUSED.contains(&name.as_str());
        assert_eq!(result.is_err(), refused, "{name}: {:?}", result.err().map(|e| e.to_string()));
    }
    println!("{rendered} scenes rendered");
    assert!(rendered > 60, "{rendered}");
}

fn picture_of(path: &Path) -> Result<Picture, Error> {
    let scene = bilux::load(path, &Default::default())?;
    let mut settings = Parameters::default();
    for (key, value) in [("integrator", "whitted"), ("size", "24x24")] {
        settings.set(key, value);
    }
    Job::new(&scene, &settings)?.render(&Quiet)?.picture()
}
