//! Third-party glTF files: test models that must open, and broken ones that must be refused or reported.

use crate::shared_files::{files, scenes};
use crate::warnings;
use bilux_formats::{ReadOptions, read};
use bilux_math::Rgb;
use bilux_scene::SceneBuilder;
use bilux_scene::texture::Channel;
use std::path::PathBuf;

/// Every `.gltf` and `.glb` below a folder of the scenes.
fn found(folder: &str) -> Vec<PathBuf> {
    let Some(root) = scenes() else { return Vec::new() };
    let mut all = Vec::new();
    files(&root.join(folder), &mut all);
    all.retain(|path| path.extension().is_some_and(|e| e == "gltf" || e == "glb"));
    all
}

fn triangles(scene: &SceneBuilder) -> usize {
    scene.objects.iter().map(|object| object.mesh.triangles.len()).sum()
}

/// The number of triangles and the largest extent of some models.
const KNOWN: [(&str, usize, f32); 9] = [
    ("glTF-Draco/Box.gltf", 12, 1.0),
    ("BoxMeshopt.glb", 12, 1.0),
    ("Box.glb", 12, 1.0),
    ("BoxInterleaved.glb", 12, 1.0),
    ("SimpleInstancing.glb", 1500, 15.0),
    ("SimpleSparseAccessor.gltf", 12, 6.0),
    ("WaterBottle.gltf", 4510, 0.26),
    ("Suzanne.gltf", 3936, 2.7),
    ("SimpleMorph.gltf", 1, 1.0),
];

#[test]
fn test_models_open_and_build() {
    let mut count = 0;
    for path in found("gltf") {
        let name = path.display().to_string();
        let scene = read(&path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
        count += 1;
        println!("{name}: {}", warnings(&scene));
        assert!(triangles(&scene) > 0, "{name}");
        assert!(!warnings(&scene).contains("checker"), "{name}: {}", warnings(&scene));
        if let Some((_, known, extent)) = KNOWN.iter().find(|(file, ..)| name.ends_with(&format!("/{file}")))
        {
            let found = scene.bounds(0.0).extent().max_element();
            assert_eq!(triangles(&scene), *known, "{name}");
            assert!((found / extent - 1.0).abs() < 0.1, "{name}: {found}");
        }
        if triangles(&scene) < 20_000 {
            let built = scene.build(&Default::default(), [0.0, 0.0], 1.0);
            assert!(built.is_ok(), "{name}: {}", built.err().unwrap());
        }
    }
    assert!(count == 0 || count >= 35, "only {count} files were found");
}

/// Errors of the validator without any visible effect: empty lists, a MIME type, normalised floats.
const HARMLESS: [&str; 4] = [
    "EMPTY_ENTITY",
    "ACCESSOR_NORMALIZED_INVALID",
    "BUFFER_DATA_URI_MIME_TYPE_INVALID",
    // A stride on a view that needs none: its declared use does not affect the image.
    "BUFFER_VIEW_INVALID_BYTE_STRIDE",
];

/// A byte order mark before the JSON, which readers may ignore. [Bray 2017, section 8.1]
const MARKED: [&str; 2] = ["bom.glb", "bom.gltf"];

/// The error codes of a report.
fn errors(report: &serde_json::Value) -> Vec<String> {
    let messages = report["issues"]["messages"].as_array().cloned().unwrap_or_default();
    let errors = messages.iter().filter(|message| message["severity"] == 0);
    errors.filter_map(|message| Some(message["code"].as_str()?.to_owned())).collect()
}

#[test]
fn broken_files_are_refused_or_give_warnings() {
    let options = ReadOptions { max_memory: 64 << 20, ..ReadOptions::default() };
    let (mut broken, mut count) = (0, 0);
    for path in found("broken") {
        let report = std::fs::read_to_string(format!("{}.report.json", path.display())).unwrap_or_default();
        let report = serde_json::from_str(&report).unwrap_or_default();
        let reported: Vec<String> = match read(&path, &options) {
            Ok(scene) => scene.warnings.iter().map(ToString::to_string).collect(),
            Err(error) => vec![error.to_string()],
        };
        println!("{}: {reported:?}", path.display());
        let reported = reported.iter().any(|what| !what.contains("there is nothing to render"));
        let seen = errors(&report).into_iter().find(|code| !HARMLESS.contains(&code.as_str()));
        let seen = seen.filter(|_| !MARKED.iter().any(|name| path.ends_with(name)));
        if let Some(code) = &seen {
            assert!(reported, "{}: {code} is not told", path.display());
        }
        count += 1;
        broken += usize::from(seen.is_some());
    }
    assert!(count == 0 || (count >= 80 && broken >= 45), "{broken} of {count}");
}

/// As glTF requires, the gamma and the profile of an image file are ignored.
#[test]
fn colours_are_srgb_whatever_their_file_says() {
    let Some(root) = scenes() else { return };
    let path = root.join("gltf/TextureEncodingTest/glTF-Binary/TextureEncodingTest.glb");
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return;
    }
    let scene = read(&path, &ReadOptions::default()).unwrap();
    // Without either, with a gamma of 0.2, and with a profile.
    let mut uses: Vec<(bool, Option<Channel>, Rgb)> = Vec::new();
    let mut count = 0;
    for texture in scene.textures.iter().filter(|texture| texture.width() < 64) {
        let found = (texture.is_data, texture.channel, texture.texel(0, 0));
        if !uses.contains(&found) {
            uses.push(found);
        }
        count += 1;
    }
    assert_eq!((uses.len(), count), (3, 12), "colour, metalness and roughness: {uses:?}");
}
