//! Reports of `bilux info` about invalid glTF: each rule on a file that violates only that rule.

use crate::warnings;
use bilux_formats::{ReadOptions, read_bytes};
use std::path::Path;

/// The bytes of a buffer as a data URI: three vertices with all attributes, indices, keyframes and a joint's
/// matrix.
fn buffer() -> (usize, String) {
    let floats = |all: &[f32]| all.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let mut identity = [0.0; 16];
    [0, 5, 10, 15].into_iter().for_each(|i| identity[i] = 1.0);
    let parts = [
        floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]),
        floats(&[0., 0., 1., 0., 0., 1., 0., 0., 1.]),
        floats(&[0., 0., 1., 0., 0., 1.]),
        vec![0, 0, 1, 0, 2, 0, 0, 0],
        floats(&[0., 1.]),
        floats(&[0., 0., 0., 1., 1., 1.]),
        vec![0; 12],
        floats(&[1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0.]),
        floats(&identity),
        floats(&[0., 0., 0., 0., 0., 0., 0., 0., 1.]),
        floats(&[0., 0., 0., 1., 0., 0., 0., 1.]),
    ];
    let bytes = parts.concat();
    (bytes.len(), percent(&bytes))
}

fn percent(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("%{byte:02x}")).collect()
}

fn picture() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../fuzz/corpus/picture_png/type2_depth8_interlace0.png");
    percent(&std::fs::read(path).unwrap())
}

/// A file that is valid in all of its parts.
fn sound() -> String {
    let (length, bytes) = buffer();
    let picture = picture();
    format!(
        r#"{{
"asset": {{"version": "2.0"}},
"extensionsUsed": ["KHR_lights_punctual", "KHR_materials_variants", "KHR_materials_clearcoat"],
"extensions": {{
  "KHR_lights_punctual": {{"lights": [{{"type": "spot", "spot": {{"innerConeAngle": 0.1, "outerConeAngle": 0.5}}}}]}},
  "KHR_materials_variants": {{"variants": [{{"name": "red"}}, {{"name": "blue"}}]}}
}},
"scene": 0,
"scenes": [{{"nodes": [0, 1, 2, 3]}}],
"nodes": [
  {{"mesh": 0, "scale": [1, 1, 1], "weights": [0.5]}},
  {{"camera": 0, "rotation": [0, 0, 0, 1], "children": [4]}},
  {{"camera": 1, "extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}},
  {{"mesh": 1, "skin": 0}},
  {{"name": "joint"}}
],
"meshes": [
  {{"primitives": [{{"attributes": {{"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}}, "indices": 3, "material": 0,
    "targets": [{{"POSITION": 9}}],
    "extensions": {{"KHR_materials_variants": {{"mappings": [{{"material": 0, "variants": [0]}}]}}}}}}]}},
  {{"primitives": [{{"attributes": {{"POSITION": 0, "JOINTS_0": 6, "WEIGHTS_0": 7}}}}]}}
],
"materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}, "metallicFactor": 0.5}},
  "extensions": {{"KHR_materials_clearcoat": {{"clearcoatFactor": 0.5}}}}}}],
"textures": [{{"source": 0, "sampler": 0}}],
"samplers": [{{"wrapS": 10497}}],
"images": [{{"uri": "data:image/png,{picture}"}}],
"cameras": [
  {{"type": "perspective", "perspective": {{"yfov": 0.7, "znear": 0.1, "zfar": 10}}}},
  {{"type": "orthographic", "orthographic": {{"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 10}}}}
],
"skins": [{{"joints": [4], "inverseBindMatrices": 8}}],
"animations": [{{"samplers": [{{"input": 4, "output": 5}}, {{"input": 4, "output": 10}}],
  "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "translation"}}}},
    {{"sampler": 1, "target": {{"node": 1, "path": "rotation"}}}}]}}],
"accessors": [
  {{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}},
  {{"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"}},
  {{"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"}},
  {{"bufferView": 3, "componentType": 5123, "count": 3, "type": "SCALAR"}},
  {{"bufferView": 4, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]}},
  {{"bufferView": 5, "componentType": 5126, "count": 2, "type": "VEC3"}},
  {{"bufferView": 6, "componentType": 5121, "count": 3, "type": "VEC4"}},
  {{"bufferView": 7, "componentType": 5126, "count": 3, "type": "VEC4"}},
  {{"bufferView": 8, "componentType": 5126, "count": 1, "type": "MAT4"}},
  {{"bufferView": 9, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 1]}},
  {{"bufferView": 10, "componentType": 5126, "count": 2, "type": "VEC4"}}
],
"bufferViews": [
  {{"buffer": 0, "byteOffset": 0, "byteLength": 36}},
  {{"buffer": 0, "byteOffset": 36, "byteLength": 36}},
  {{"buffer": 0, "byteOffset": 72, "byteLength": 24}},
  {{"buffer": 0, "byteOffset": 96, "byteLength": 8}},
  {{"buffer": 0, "byteOffset": 104, "byteLength": 8}},
  {{"buffer": 0, "byteOffset": 112, "byteLength": 24}},
  {{"buffer": 0, "byteOffset": 136, "byteLength": 12}},
  {{"buffer": 0, "byteOffset": 148, "byteLength": 48}},
  {{"buffer": 0, "byteOffset": 196, "byteLength": 64}},
  {{"buffer": 0, "byteOffset": 260, "byteLength": 36}},
  {{"buffer": 0, "byteOffset": 296, "byteLength": 32}}
],
"buffers": [{{"byteLength": {length}, "uri": "data:application/octet-stream,{bytes}"}}]
}}"#
    )
}

/// All warnings about a text, or its error.
fn reported(text: &str) -> String {
    let options = ReadOptions { validate: true, ..ReadOptions::default() };
    match read_bytes(text.as_bytes(), "gltf", None, "a.gltf", &options) {
        Ok(scene) => {
            let lines = scene.warnings.iter().chain(&scene.notes).map(ToString::to_string);
            lines.collect::<Vec<_>>().join("\n")
        }
        Err(error) => error.to_string(),
    }
}

#[test]
fn valid_files_give_no_reports() {
    assert_eq!(reported(&sound()), "");
}

#[test]
fn a_render_does_not_validate() {
    let text = sound().replace("\"metallicFactor\"", "\"metalicFactor\"");
    let scene = read_bytes(text.as_bytes(), "gltf", None, "a.gltf", &ReadOptions::default()).unwrap();
    assert_eq!(warnings(&scene), "");
    assert!(reported(&text).contains("metalicFactor"));
}

/// The original text, its replacement, and a report that must follow.
const FAULTS: &[(&str, &str, &str)] = include!("gltf_faults.in");

#[test]
fn each_fault_is_reported_where_it_is() {
    let sound = sound();
    let mut wrong = Vec::new();
    for (from, to, expected) in FAULTS {
        assert!(sound.contains(from), "{from}");
        let said = reported(&sound.replacen(from, to, 1));
        if !said.lines().any(|line| line == *expected) {
            wrong.push(format!(
                "{to}\n  wanted: {expected}\n  got:    {}",
                said.replace('\n', "\n          ")
            ));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), FAULTS.len(), wrong.join("\n"));
}

/// Runs on the Khronos validator's own test files if `GLTF_VALIDATOR_TESTS=…/test` names their folder.
#[test]
fn faults_that_the_khronos_validator_knows_are_reported() {
    let Some(folder) = std::env::var_os("GLTF_VALIDATOR_TESTS") else {
        println!("skipped: GLTF_VALIDATOR_TESTS does not name the test folder of the Khronos glTF validator");
        return;
    };
    let mut reports = Vec::new();
    find_reports(Path::new(&folder), &mut reports);
    let options = ReadOptions { validate: true, ..ReadOptions::default() };
    let (mut found, mut all, mut silent) = ([0; 2], [0; 2], Vec::new());
    for report in reports {
        let path = report.to_string_lossy().trim_end_matches(".report.json").to_owned();
        let text: serde_json::Value = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
        let severities = text["issues"]["messages"].as_array().unwrap().iter();
        let Some(severity @ 0..=1) = severities.filter_map(|m| m["severity"].as_u64()).min() else {
            continue;
        };
        let is_reported = match bilux_formats::read(Path::new(&path), &options) {
            Ok(scene) => scene.warnings.iter().any(|w| !w.message.contains("nothing to render")),
            Err(_) => true,
        };
        all[severity as usize] += 1;
        found[severity as usize] += usize::from(is_reported);
        if !is_reported {
            silent.push(path);
        }
    }
    println!("{} of {} files with errors, {} of {} with warnings only", found[0], all[0], found[1], all[1]);
    println!("silent about:\n{}", silent.join("\n"));
    assert!(found[0] + found[1] >= (all[0] + all[1]) * 9 / 10);
}

fn find_reports(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for entry in entries {
        if entry.is_dir() {
            find_reports(&entry, found);
        } else if entry.to_string_lossy().ends_with(".report.json") {
            found.push(entry);
        }
    }
}
