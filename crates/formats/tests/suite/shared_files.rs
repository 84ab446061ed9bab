//! Every real file that comes with the project can be read, or is refused with the right message.

use bilux_formats::{ReadOptions, read};
use std::path::{Path, PathBuf};

/// Files that must be refused, with a part of the message.
const REFUSED: &[(&str, &str)] = &[("asc/teapot.bpt", "not a scene format")];

/// Files that accompany others.
const COMPANIONS: &[&str] = &["mtl", "png", "jpg"];

pub(crate) fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() { files(&path, found) } else { found.push(path) }
    }
}

/// The folder of scenes, or `None` with a message that says so.
pub(crate) fn scenes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: there is no folder {}", folder.display());
    None
}

#[test]
fn every_file_reads_or_is_refused_for_its_reason() {
    let Some(root) = scenes() else { return };
    let mut all = Vec::new();
    for kind in ["asc", "obj", "ply", "stl"] {
        files(&root.join(kind), &mut all);
    }
    let mut read_count = 0;
    for path in all {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        if extension.is_some_and(|e| COMPANIONS.contains(&&*e)) {
            continue;
        }
        let name = path.strip_prefix(&root).unwrap().to_string_lossy().into_owned();
        let expected = REFUSED.iter().find(|(file, _)| *file == name);
        match (read(&path, &ReadOptions::default()), expected) {
            (Ok(scene), None) => {
                read_count += 1;
                let built = scene.build(&Default::default(), [0.0, 0.0], 1.0);
                assert!(built.is_ok(), "{name}: {}", built.err().unwrap());
                println!("{name}: {} objects; {}", scene.objects.len(), crate::warnings(&scene));
            }
            (Err(error), Some((_, part))) => assert!(error.to_string().contains(part), "{name}: {error}"),
            (Ok(_), Some((_, part))) => panic!("{name} was read, but should be refused: {part}"),
            (Err(error), None) => panic!("{name} was refused: {error}"),
        }
    }
    assert!(read_count >= 65, "only {read_count} files were found");
}

#[test]
fn strict_reading_refuses_what_would_be_a_warning() {
    let Some(root) = scenes() else { return };
    let strict = ReadOptions { strict: true, ..ReadOptions::default() };
    let error = read(&root.join("obj/tinyobj/issue-92.obj"), &strict).unwrap_err().to_string();
    assert!(error.contains("issue-92.mtl:5:1") && error.contains("tmp.png"), "{error}");
    assert!(read(&root.join("asc/teapot_cr.asc"), &strict).is_ok());
}
