//! One scene gives the same picture from every format, by Welch's test over blocks of pixels and seeds.

mod by_hand;

use bilux::formats::{SCENE_FORMATS, SceneFormatEntry, WriteOptions, read, read_bytes, write};
use bilux::math::{Transform, Vec3, colour};
use bilux::prelude::*;
use bilux_testing::effort;
use bilux_testing::verdicts::{Picture, Side};
use bilux_validation::SUITE;
use bilux_validation::statistics::{sidak, welch};
use std::path::Path;

/// A p-value below this means a bug, not chance.
const UNLIKELY: f64 = 1e-4;
const SEEDS: u64 = 6;
/// Blocks of the picture in each direction.
const BLOCKS: usize = 8;

/// A box and a glass ball on a floor under lights of every kind that glTF has, and a panel.
const SCENE: &str = r#"
[camera]
position = [0, 2, 6]
look_at = [0, 0.5, 0]
fov = 40
[[light]]
kind = "point"
position = [2, 4, 2]
intensity = [20, 15, 10]
[[light]]
kind = "spot"
position = [-3, 4, 1]
look_at = [0, 0, 0]
intensity = [30, 30, 60]
angle = 25
inner_angle = 20
[[light]]
kind = "directional"
direction = [0, -3, -1]
irradiance = [0.3, 0.4, 0.3]
[[material]]
name = "matte"
kind = "diffuse"
reflectance = [0.6, 0.5, 0.4]
[[material]]
name = "plastic"
kind = "principled"
base_color = [0.2, 0.4, 0.7]
specular_roughness = 0.4
[[material]]
name = "glass"
kind = "dielectric"
eta = 1.5
absorption = [0.2, 0.1, 0.3]
[[material]]
name = "panel"
kind = "diffuse"
reflectance = 0
emission = [2, 4, 2]
[[model]]
shape = "quad"
u = [8, 0, 0]
v = [0, 0, -8]
material = "matte"
[[model]]
shape = "box"
translate = [1, 0.5, 0.5]
material = "plastic"
[[model]]
shape = "sphere"
radius = 0.75
translate = [-1, 0.75, 0]
material = "glass"
[[model]]
shape = "quad"
translate = [1, 2.5, -1]
material = "panel"
"#;

fn scene() -> SceneBuilder {
    let scene = read_bytes(SCENE.as_bytes(), "toml", None, "scene.toml", &Default::default()).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    scene
}

/// The mean of each block and channel, for each seed.
fn blocks<'a>(scene: &'a SceneBuilder, first_seed: u64) -> Side<'a> {
    Side::new(first_seed..first_seed + SEEDS, |seed| {
        let mut all = Parameters::default();
        for (key, value) in [("size", "48x48"), ("integrator", "path")] {
            all.set(key, value);
        }
        all.set("spp", Value::Integer(effort(10, 24)));
        all.set("seed", Value::Integer(seed as i64));
        let picture = Job::new(scene, &all).unwrap().render(&Quiet).unwrap().picture().unwrap();
        let side = picture.width() / BLOCKS;
        let mut sums = vec![0.0; BLOCKS * BLOCKS * 3];
        let pixels = picture.to_rgb().unwrap();
        for (i, colour) in pixels.iter().enumerate() {
            let (x, y) = (i % picture.width() / side, i / picture.width() / side);
            (0..3).for_each(|c| sums[(y * BLOCKS + x) * 3 + c] += f64::from(colour[c]));
        }
        Picture::new(&pixels, sums)
    })
}

/// The p-value that two scenes look the same: by the record of this case, where their first pictures are as they were.
fn agreement(case: &str, a: &Side, b: &Side) -> f64 {
    SUITE.agreement(case, "least p", [a, b], least_p)
}

/// The p-value that a scene with a planted bug looks the same.
fn difference(a: &Side, b: &Side) -> f64 {
    least_p(a.cells(), b.cells())
}

fn least_p(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let p: Vec<f64> = a.iter().zip(b).filter_map(|(a, b)| welch(a, b)).collect();
    sidak(p.iter().copied().fold(1.0, f64::min), p.len())
}

fn there(scene: &SceneBuilder, folder: &Path, file: &str) -> SceneBuilder {
    let path = folder.join(file);
    write(&path, scene, &WriteOptions::default()).unwrap();
    read(&path, &Default::default()).unwrap()
}

/// Part of the scene that a format holds.
#[derive(Clone, Copy, PartialEq)]
enum Holds {
    /// All of it but what the writer names; without the glass and the soft edge of the spotlight, nothing is lost.
    AllBut(&'static [&'static str]),
    /// Meshes, of which this test compares the shapes.
    Meshes,
}

/// Part that each extension which can be written holds.
const HOLDS: &[(&str, Holds)] = &[
    ("glb", Holds::AllBut(&[])),
    ("gltf", Holds::AllBut(&[])),
    ("pbrt", Holds::AllBut(&[])),
    ("toml", Holds::AllBut(&[])),
    ("usd", Holds::AllBut(GLASS_IN_USD)),
    ("usda", Holds::AllBut(GLASS_IN_USD)),
    ("usdz", Holds::AllBut(GLASS_IN_USD)),
    ("xml", Holds::AllBut(&["the edge of a spotlight fades linearly in Mitsuba"])),
    ("obj", Holds::Meshes),
    ("ply", Holds::Meshes),
    ("stl", Holds::Meshes),
    ("off", Holds::Meshes),
    ("asc", Holds::Meshes),
    ("3mf", Holds::Meshes),
];
const GLASS_IN_USD: &[&str] = &[
    "USD files cannot store 'transmission_weight' of a principled material: left out",
    "USD files cannot store 'transmission_depth' of a principled material: left out",
    "USD files cannot store 'transmission_color' of a principled material: left out",
    "glass is written as a transparent surface, which refracts nothing",
];

/// The extensions of all formats that can be written, from their table; a new one has to be in [`HOLDS`].
fn written() -> impl Iterator<Item = (String, Holds)> {
    let all = SCENE_FORMATS.iter().filter(|row| row.writes()).flat_map(|row| row.extensions);
    all.map(|extension| {
        let known = HOLDS.iter().find(|(known, _)| known == extension);
        let (_, holds) = known.unwrap_or_else(|| panic!("nothing tests that .{extension} is written"));
        (format!("scene.{extension}"), *holds)
    })
}

#[test]
fn scenes_look_the_same_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let original = scene();
    let mut simple = scene();
    for object in &mut simple.objects {
        if simple.materials[object.material].name == "glass" {
            object.material = 0;
        }
    }
    for light in simple.lights.iter_mut().filter(|light| light.kind == "spot") {
        light.parameters.set("inner_angle", Value::Number(25.0));
    }
    let [ours, ours_simple] = [&original, &simple].map(|scene| blocks(scene, 0));
    for (i, (file, holds)) in written().enumerate() {
        let Holds::AllBut(lost) = holds else { continue };
        let path = folder.path().join(&file);
        let said = |scene: &SceneBuilder| -> Vec<String> {
            write(&path, scene, &WriteOptions::default()).unwrap().into_iter().map(|w| w.message).collect()
        };
        assert_eq!(said(&original), *lost, "{file}");
        if !lost.is_empty() {
            assert_eq!(said(&simple), [""; 0], "{file}");
        }
        let back = read(&path, &Default::default()).unwrap();
        let ours = if lost.is_empty() { &ours } else { &ours_simple };
        let p = agreement(&file, ours, &blocks(&back, 100 * (i as u64 + 1)));
        assert!(p > UNLIKELY, "{file}: p = {p}");
    }
    // A planted bug: a light brighter by a twentieth.
    let mut brighter = original.clone();
    for spec in &mut brighter.lights {
        if spec.kind == "point" {
            spec.parameters.set("intensity", Value::triple([21.0, 15.75, 10.5]));
        }
    }
    let p = difference(&ours, &blocks(&brighter, 900));
    assert!(p < UNLIKELY, "a light brighter by a twentieth passes: p = {p}");
}

/// A scene in metres with y up, from one in millimetres with z up; others stay as they are.
fn in_metres(mut scene: SceneBuilder) -> SceneBuilder {
    if scene.unit == 0.001 {
        let turn = Transform::rotate(Vec3::X, -std::f32::consts::FRAC_PI_2).unwrap();
        let turn = turn.then(&Transform::scale(Vec3::splat(0.001)).unwrap());
        for object in &mut scene.objects {
            object.motion = bilux::math::Motion::still(object.motion.at(0.0).then(&turn));
        }
        (scene.unit, scene.up) = Default::default();
    }
    scene
}

/// Formats of bare meshes, rendered with the same camera and lights, all with one diffuse material.
#[test]
fn bare_meshes_look_the_same_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let dressed = |mut scene: SceneBuilder| {
        let original = self::scene();
        (scene.cameras, scene.lights) = (original.cameras, original.lights);
        for material in &mut scene.materials {
            *material = Spec::new(&material.name, "diffuse").with("reflectance", 0.6f32);
        }
        // These lights are all there is: no studio is added.
        scene.environment_unspecified = false;
        scene.warnings.clear();
        scene
    };
    let ours = dressed(scene());
    let ours = blocks(&ours, 0);
    for (i, (file, holds)) in written().enumerate() {
        if holds != Holds::Meshes && file != "scene.glb" {
            continue;
        }
        let back = dressed(in_metres(there(&scene(), folder.path(), &file)));
        let p = agreement(&file, &ours, &blocks(&back, 100 * (i as u64 + 1)));
        assert!(p > UNLIKELY, "{file}: p = {p}");
    }
}

/// Meshes whose vertices have colours, from formats that store them linear and from those that store them in sRGB.
#[test]
fn coloured_meshes_look_the_same_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let coloured = || {
        let mut scene = scene();
        let plain = scene.add_material(Spec::new("vertices", "phong").with("kd", 1.0f32));
        for object in &mut scene.objects {
            let mesh = std::sync::Arc::make_mut(&mut object.mesh);
            let colour = |p: &bilux::math::Vec3| {
                let more = p.x.fract().abs() * 0.2;
                // Colours that a byte of sRGB holds exactly, as 3MF has them.
                let byte = |x: f32| (colour::srgb_encode(x) * 255.0).round() / 255.0;
                bilux::math::Rgb::new(0.2 + more, 0.4 + more, 0.6 + more).map(byte).map(colour::srgb_decode)
            };
            mesh.vertex_kd = mesh.positions.iter().map(colour).collect();
            object.material = plain;
        }
        scene
    };
    let dressed = |mut scene: SceneBuilder| {
        let original = self::scene();
        (scene.cameras, scene.lights) = (original.cameras, original.lights);
        for material in &mut scene.materials {
            *material = Spec::new(&material.name, "diffuse").with("reflectance", 1.0f32);
        }
        scene.environment_unspecified = false;
        scene.warnings.clear();
        scene
    };
    let ours = dressed(coloured());
    let ours = blocks(&ours, 0);
    let holds = |row: &&SceneFormatEntry| row.writes() && row.capabilities.contains(&"vertex-kd");
    let files = SCENE_FORMATS.iter().filter(holds).map(|row| format!("c.{}", row.extensions[0]));
    for (i, file) in files.chain(["c.toml".to_owned()]).enumerate() {
        let back = dressed(in_metres(there(&coloured(), folder.path(), &file)));
        let p = agreement(&file, &ours, &blocks(&back, 100 * (i as u64 + 1)));
        assert!(p > UNLIKELY, "{file}: p = {p}");
    }
    // A planted bug: colours of sRGB taken for linear ones.
    let mut bright = coloured();
    for object in &mut bright.objects {
        let mesh = std::sync::Arc::make_mut(&mut object.mesh);
        mesh.vertex_kd.iter_mut().for_each(|kd| *kd = kd.map(bilux::math::colour::srgb_encode));
    }
    let bright = dressed(bright);
    let p = difference(&ours, &blocks(&bright, 900));
    assert!(p < UNLIKELY, "colours of sRGB taken for linear ones pass: p = {p}");
}
