//! Any bytes give a scene or an error, within bounded memory, and never a panic.

use bilux_formats::{FormatError, ReadOptions, SCENE_FORMATS, read, read_bytes};
use bilux_scene::SceneBuilder;
use bilux_testing::effort;
use proptest::prelude::*;
use std::path::{Path, PathBuf};

fn formats() -> impl Iterator<Item = &'static str> {
    SCENE_FORMATS.iter().map(|row| row.entry.name)
}

fn corpus(format: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../fuzz/corpus/scene_{format}"));
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.into_iter().map(|path| (path.clone(), std::fs::read(path).unwrap())).collect()
}

/// Reads a scene and, if that succeeds, builds it and computes its bounds; both may fail.
fn survive(format: &str, bytes: &[u8]) -> Option<SceneBuilder> {
    let options = ReadOptions { max_memory: 8 << 20, ..ReadOptions::default() };
    let scene = read_bytes(bytes, format, None, "x", &options).map_err(|e| e.to_string()).ok()?;
    let _ = scene.build(&Default::default(), [0.0, 1.0], 1.0).map(|built| built.bounds());
    Some(scene)
}

#[test]
fn the_corpus_reads_and_its_broken_files_are_refused() {
    for format in formats() {
        let files = corpus(format);
        assert!(files.len() >= 5, "{format}");
        for (path, bytes) in files {
            let broken = path.file_name().unwrap().to_string_lossy().starts_with("broken");
            let read = read_bytes(&bytes, format, None, "x", &ReadOptions::default());
            assert_eq!(read.is_err(), broken, "{}: {:?}", path.display(), read.err().map(|e| e.to_string()));
        }
    }
}

#[test]
fn truncated_files_do_not_panic() {
    for format in formats() {
        for (_, bytes) in corpus(format) {
            // In the short form every length of the head, which most of a reader's questions are about, and then every fifth.
            let head = effort(400, 3000);
            let lengths = (0..head).chain((head..3000).step_by(5)).take_while(|&length| length < bytes.len());
            lengths.for_each(|length| drop(survive(format, &bytes[..length])));
        }
    }
}

/// A way to damage a file.
#[derive(Clone, Debug)]
enum Damage {
    Set(usize, u8),
    Remove(usize, usize),
    Repeat(usize, usize),
    Insert(usize, &'static str),
}

fn damage() -> impl Strategy<Value = Damage> {
    let words = [
        "-",
        "nan",
        "1e39",
        "4294967296",
        "-1",
        "0",
        "/",
        "\n",
        "\r",
        "\"",
        "[",
        "\\\n",
        "\u{0}",
        "99999999999999999999",
    ];
    prop_oneof![
        (any::<usize>(), any::<u8>()).prop_map(|(at, byte)| Damage::Set(at, byte)),
        (any::<usize>(), 1usize..40).prop_map(|(at, n)| Damage::Remove(at, n)),
        (any::<usize>(), 1usize..80).prop_map(|(at, n)| Damage::Repeat(at, n)),
        (any::<usize>(), prop::sample::select(words.to_vec()))
            .prop_map(|(at, word)| Damage::Insert(at, word)),
    ]
}

fn damaged(mut bytes: Vec<u8>, damages: &[Damage]) -> Vec<u8> {
    for damage in damages {
        let length = bytes.len().max(1);
        match *damage {
            Damage::Set(at, byte) => {
                if let Some(slot) = bytes.get_mut(at % length) {
                    *slot = byte;
                }
            }
            Damage::Remove(at, n) => {
                drop(bytes.drain((at % length).min(bytes.len())..(at % length + n).min(bytes.len())))
            }
            Damage::Repeat(at, n) => {
                let piece =
                    bytes[(at % length).min(bytes.len())..(at % length + n).min(bytes.len())].to_vec();
                let at = (at % length).min(bytes.len());
                drop(bytes.splice(at..at, piece));
            }
            Damage::Insert(at, word) => {
                let at = (at % length).min(bytes.len());
                drop(bytes.splice(at..at, word.bytes()));
            }
        }
    }
    bytes
}

/// A triangle with this material library, next to one image.
fn with_materials(library: &[u8]) -> Result<SceneBuilder, FormatError> {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    put("x.mtl", library);
    put("t.ppm", b"P6 2 2 255\n\xff\x80\x00012\x00\x40\x80abc");
    put("x.obj", b"mtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    read(&folder.path().join("x.obj"), &ReadOptions::default())
}

#[test]
fn the_corpus_of_materials_reads_and_its_broken_files_are_reported() {
    for (path, library) in corpus("mtl") {
        let broken = path.file_name().unwrap().to_string_lossy().starts_with("broken");
        let read = with_materials(&library).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let is_placed = read.warnings.iter().any(|warning| warning.at.line > 0);
        assert!(is_placed || !broken, "{}: {}", path.display(), crate::warnings(&read));
        (0..library.len()).for_each(|length| drop(with_materials(&library[..length])));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn arbitrary_bytes_do_not_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for format in formats() {
            survive(format, &bytes);
        }
        survive("", &bytes);
    }

    #[test]
    fn damaged_files_do_not_panic(pick: usize, damages in prop::collection::vec(damage(), 1..6)) {
        for format in formats() {
            let files = corpus(format);
            let (_, bytes) = &files[pick % files.len()];
            survive(format, &damaged(bytes.clone(), &damages));
        }
    }

    #[test]
    fn damaged_materials_do_not_panic(pick: usize, damages in prop::collection::vec(damage(), 0..6)) {
        let files = corpus("mtl");
        let (_, library) = &files[pick % files.len()];
        if let Ok(scene) = with_materials(&damaged(library.clone(), &damages)) {
            prop_assert!(scene.build(&Default::default(), [0.0, 0.0], 1.0).is_ok());
        }
    }

    #[test]
    fn meshes_of_any_numbers_come_back_through_every_format(
        corners in prop::collection::vec(prop::array::uniform8(any::<f32>()), 3..12),
    ) {
        let mut text = String::new();
        for triangle in corners.chunks_exact(3) {
            text.push_str("triangle\n");
            for corner in triangle {
                text.push_str(&corner.map(|x| format!("{x:?}")).join(" "));
                text.push('\n');
            }
        }
        let original = crate::read_text("asc", text).unwrap();
        let folder = tempfile::tempdir().unwrap();
        for file in ["a.asc", "a.obj", "a.ply", "a.toml"] {
            let path = folder.path().join(file);
            bilux_formats::write(&path, &original, &Default::default()).unwrap();
            let back = read(&path, &ReadOptions::default()).unwrap();
            let bits = |s: &SceneBuilder| -> Vec<Vec<u32>> {
                // Different NaNs may have the same text.
                let one_nan = |bits: u32| if f32::from_bits(bits).is_nan() { f32::NAN.to_bits() } else { bits };
                let all = crate::round_trips::corners(&s.objects[0].mesh).into_iter();
                all.map(|corner| corner.into_iter().map(one_nan).collect()).collect()
            };
            prop_assert_eq!(bits(&original), bits(&back), "{}", file);
        }
    }
}
