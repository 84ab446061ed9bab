//! One scene, written by hand as other programs write it: in the units, axes, colours and angles of each format.

use super::{UNLIKELY, agreement, blocks, difference};
use bilux::formats::read;
use bilux::math::{DVec3, Transform, Vec3};
use bilux::prelude::*;
use bilux::scene::{Axis, Mesh, Object, UpHint};
use bilux_testing::verdicts::Side;
use std::path::Path;
use std::sync::Arc;

/// Texts in a file, each with that for which a reader would take it.
type Mistakes = &'static [(&'static str, &'static str)];

/// The files, with mistakes of readers.
const FILES: &[(&str, &str, Mistakes)] = &[
    (
        "scene.dae",
        include_str!("scene.dae"),
        &[
            ("Z_UP", "Y_UP"),
            ("meter=\"0.01\"", "meter=\"1\""),
            ("0.2 0.8 0.5 1", "0.484529 0.906332 0.735357 1"),
            ("<scale>-1", "<scale>1"),
            ("<yfov>40", "<yfov>20"),
        ],
    ),
    (
        "scene.fbx",
        include_str!("scene.fbx"),
        &[
            ("\"UpAxis\", \"int\", \"Integer\", \"\",2", "\"UpAxis\", \"int\", \"Integer\", \"\",1"),
            (
                "\"UnitScaleFactor\", \"double\", \"Number\", \"\",1",
                "\"UnitScaleFactor\", \"double\", \"Number\", \"\",100",
            ),
            ("0.2,0.8,0.5", "0.484529,0.906332,0.735357"),
            ("-1,1,1", "1,1,1"),
            ("32.969729", "68.055379"),
        ],
    ),
    (
        "scene.usda",
        include_str!("scene.usda"),
        &[
            ("\"Z\"", "\"Y\""),
            ("metersPerUnit = 0.01", "metersPerUnit = 1"),
            (
                "0.033105, 0.603827, 0.214041)\n            float inputs:ior",
                "0.2, 0.8, 0.5)\n            float inputs:ior",
            ),
            ("(-1, 1, 1)", "(1, 1, 1)"),
            ("32.969729", "68.055379"),
        ],
    ),
    (
        "scene.xml",
        include_str!("scene.xml"),
        &[
            ("angle=\"-90\"", "angle=\"0\""),
            ("<rotate y=\"1\" angle=\"30\"/>", "<rotate y=\"1\" angle=\"-30\"/>"),
            ("0.033105 0.603827 0.214041", "0.2 0.8 0.5"),
            ("<scale x=\"-1\"/>", ""),
            ("\"fov\" value=\"40\"", "\"fov\" value=\"20\""),
        ],
    ),
];

/// The scene of the files, by our own means.
fn scene() -> SceneBuilder {
    let text = include_bytes!("scene.toml");
    let mut scene =
        bilux::formats::read_bytes(text, "toml", None, "scene.toml", &Default::default()).unwrap();
    let leaf = scene.materials.iter().position(|spec| spec.name == "leaf").unwrap_or_default();
    let right = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, -1], [1, 0, -1], [0, 1, -1]];
    let wedge = Mesh {
        positions: right.map(|p| Vec3::from(p.map(|x| x as f32)) * Vec3::new(1.0, 1.5, 1.0)).to_vec(),
        triangles: vec![
            [0, 1, 2],
            [3, 5, 4],
            [0, 3, 4],
            [0, 4, 1],
            [0, 2, 5],
            [0, 5, 3],
            [1, 4, 5],
            [1, 5, 2],
        ],
        ..Mesh::default()
    };
    let mesh = Arc::new(wedge);
    let (turn, mirror) =
        (Transform::rotate(Vec3::Y, 30f32.to_radians()), Transform::scale(Vec3::new(-1.0, 1.0, 1.0)));
    for (shape, at) in [(turn, Vec3::new(0.5, 0.0, 1.0)), (mirror, Vec3::X * -0.5)] {
        let place = shape.unwrap().then(&Transform::translate(at).unwrap());
        scene.objects.push(Object::new("wedge", mesh.clone(), leaf).placed(place));
    }
    scene
}

/// The corners of the box around all objects, in metres with y up.
fn extent(scene: &SceneBuilder) -> [DVec3; 2] {
    let bounds = scene.bounds(0.0);
    let unit = if scene.unit > 0.0 { scene.unit } else { 1.0 };
    let turned = |p: Vec3| match scene.up {
        UpHint::Is(Axis::Z) => DVec3::new(f64::from(p.x), f64::from(p.z), -f64::from(p.y)) * unit,
        _ => p.as_dvec3() * unit,
    };
    let [a, b] = [turned(bounds.min), turned(bounds.max)];
    [a.min(b), a.max(b)]
}

fn written(folder: &Path, name: &str, text: &str) -> SceneBuilder {
    let path = folder.join(name);
    std::fs::write(folder.join("wedge.obj"), include_str!("wedge.obj")).unwrap();
    std::fs::write(&path, text).unwrap();
    // Collada and FBX cannot say what is around a scene, and would get our surroundings.
    SceneBuilder { environment_unspecified: false, ..read(&path, &Default::default()).unwrap() }
}

/// `scene.usda` as OpenUSD 26.11 saves it as a crate file: the same scene to the bit.
#[test]
fn a_crate_file_is_the_scene_of_its_text() {
    let folder = tempfile::tempdir().unwrap();
    let text = written(folder.path(), "scene.usda", include_str!("scene.usda"));
    let path = folder.path().join("scene.usdc");
    std::fs::write(&path, include_bytes!("scene.usdc")).unwrap();
    let saved = SceneBuilder { environment_unspecified: false, ..read(&path, &Default::default()).unwrap() };
    assert_eq!(extent(&text), extent(&saved));
    let same = |a: &SceneBuilder, b: &SceneBuilder| blocks(a, 0).cells() == blocks(b, 0).cells();
    assert!(same(&text, &saved), "the same pictures to the bit");
    let mut darker = saved.clone();
    darker.lights.pop();
    assert!(!same(&text, &darker), "without a light");
}

#[test]
fn files_of_other_programs_are_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let original = scene();
    let ours = blocks(&original, 0);
    let differs = |name: &str, text: &str, seed: u64, p: &dyn Fn(&Side, &Side) -> f64| -> Option<String> {
        let there = written(folder.path(), name, text);
        assert!(there.warnings.is_empty(), "{name}: {:?}", there.warnings);
        let [a, b] = [extent(&original), extent(&there)];
        if a[0].distance(b[0]) + a[1].distance(b[1]) > 1e-4 {
            return Some(format!("{b:?} for {a:?}"));
        }
        let p = p(&ours, &blocks(&there, seed));
        (p < UNLIKELY).then(|| format!("p = {p}"))
    };
    for (i, (name, text, mistakes)) in FILES.iter().enumerate() {
        let seed = 1000 * (i as u64 + 1);
        assert_eq!(differs(name, text, seed, &|a, b| agreement(name, a, b)), None, "{name}");
        // Planted bugs: an axis, a unit, a colour space, a mirror image and half of an angle.
        for (right, wrong) in *mistakes {
            assert!(text.contains(right), "{name} has no {right}");
            let text = text.replacen(right, wrong, 1);
            assert!(differs(name, &text, seed, &difference).is_some(), "{name} with {wrong} passes");
        }
    }
}
