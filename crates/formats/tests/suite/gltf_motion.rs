//! Animation, skins and morph targets of glTF, compared with hand-made poses.

use crate::{read_text, warnings};
use bilux_formats::{ReadOptions, read_bytes};
use bilux_math::Vec3;
use bilux_scene::SceneBuilder;

/// A document under construction: accessors of floats in one buffer.
#[derive(Default)]
pub(crate) struct Parts {
    bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Parts {
    /// Adds an accessor of floats and returns its index.
    pub(crate) fn floats(&mut self, kind: &str, width: usize, numbers: &[f32]) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.add(kind, 5126, numbers.len() / width, &bytes)
    }

    pub(crate) fn add(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let (view, start) = (self.views.len(), self.bytes.len());
        self.bytes.extend(bytes);
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{}}}"#, bytes.len()));
        self.accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":{component},"count":{count},"type":"{kind}"}}"#
        ));
        self.accessors.len() - 1
    }

    pub(crate) fn document(&self, rest: &str) -> String {
        let uri: String = self.bytes.iter().map(|b| format!("%{b:02x}")).collect();
        format!(
            r#"{{"asset":{{"version":"2.0"}},"accessors":[{}],"bufferViews":[{}],
            "buffers":[{{"byteLength":{},"uri":"data:,{uri}"}}],{rest}}}"#,
            self.accessors.join(","),
            self.views.join(","),
            self.bytes.len()
        )
    }
}

fn at(text: &str, options: &ReadOptions) -> SceneBuilder {
    read_bytes(text.as_bytes(), "gltf", None, "scene.gltf", options).unwrap_or_else(|e| panic!("{text}: {e}"))
}

fn at_time(text: &str, time: f32) -> SceneBuilder {
    at(text, &ReadOptions { time, ..ReadOptions::default() })
}

fn near(a: Vec3, b: [f32; 3]) -> bool {
    (a - Vec3::from(b)).length() < 1e-5
}

const TRIANGLE: [f32; 9] = [0., 0., 0., 1., 0., 0., 0., 1., 0.];

/// A triangle below a parent node; both are animated.
fn moving() -> String {
    let mut parts = Parts::default();
    parts.floats("VEC3", 3, &TRIANGLE);
    let times = parts.floats("SCALAR", 1, &[1.0, 3.0]);
    let moves = parts.floats("VEC3", 3, &[0., 0., 0., 4., 0., 0.]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = parts.floats("VEC4", 4, &[0., 0., 0., 1., 0., 0., half, half]);
    let grows = parts.floats("VEC3", 3, &[1., 1., 1., 3., 3., 3.]);
    parts.document(&format!(
        r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"children":[1]}},{{"mesh":0,"translation":[0,0,7]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "animations":[{{"name":"walk","channels":[
            {{"sampler":0,"target":{{"node":0,"path":"translation"}}}},
            {{"sampler":1,"target":{{"node":1,"path":"rotation"}}}},
            {{"sampler":2,"target":{{"node":1,"path":"scale"}}}}],
        "samplers":[{{"input":{times},"output":{moves}}},{{"input":{times},"output":{turns}}},
            {{"input":{times},"output":{grows},"interpolation":"STEP"}}]}},
        {{"name":"jump","channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}}],
        "samplers":[{{"input":{times},"output":{grows}}}]}}]"#
    ))
}

#[test]
fn nodes_follow_the_animation() {
    let place = |time: f32, p: Vec3| at_time(&moving(), time).objects[0].motion.at(0.0).point(p);
    assert!(near(place(0.0, Vec3::X), [1.0, 0.0, 7.0]), "before the first key");
    // Halfway along the translation and the quarter turn; the scale is still that of the first key.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    assert!(near(place(2.0, Vec3::X), [2.0 + half, half, 7.0]), "{}", place(2.0, Vec3::X));
    assert!(near(place(9.0, Vec3::X), [4.0, 3.0, 7.0]), "behind the last key");
    let scene = at_time(&moving(), 2.0);
    let animations = &scene.inventory.animations;
    assert_eq!((&*animations[0].name, animations[0].seconds, animations[0].plays), ("walk", 3.0, true));
    assert!(!animations[1].plays);
    let [note] = &scene.notes[..] else { panic!("{:?}", scene.notes) };
    assert!(note.to_string().contains("#/animations/1: an animation is not played"), "{note}");
    assert_eq!(warnings(&scene), "", "a file with several animations is in order");
    assert!(scene.movement.is_none());
    let options = ReadOptions { time: 2.0, whole_movement: true, ..ReadOptions::default() };
    let movement = at(&moving(), &options).movement.expect("cameras that are made up hold all of it");
    let [first, last] = [0, 8].map(|i| movement.objects[i].motion.at(0.0).point(Vec3::X));
    assert!(near(first, [1.0, 0.0, 7.0]) && near(last, [4.0, 3.0, 7.0]), "{first} {last}");
}

#[test]
fn animations_are_chosen_by_name_or_number() {
    for name in ["jump", "1"] {
        let options = ReadOptions { time: 2.0, animation: Some(name.to_owned()), ..ReadOptions::default() };
        let scene = at(&moving(), &options);
        assert!(near(scene.objects[0].motion.at(0.0).point(Vec3::ZERO), [2.0, 2.0, 9.0]));
    }
    let options = ReadOptions { animation: Some("wolk".to_owned()), ..ReadOptions::default() };
    let error =
        read_bytes(moving().as_bytes(), "gltf", None, "scene.gltf", &options).unwrap_err().to_string();
    assert!(error.contains("no animation 'wolk'") && error.contains("did you mean walk"), "{error}");
}

#[test]
fn faulty_animations_are_left_out_with_a_warning() {
    let cases = [
        ("[1.0, 3.0]", [3.0, 1.0], "the times of an animation must be numbers that increase"),
        ("NaN", [1.0, f32::NAN], "the times of an animation must be numbers that increase"),
    ];
    for (name, times, part) in cases {
        let mut parts = Parts::default();
        parts.floats("VEC3", 3, &TRIANGLE);
        let times = parts.floats("SCALAR", 1, &times);
        let moves = parts.floats("VEC3", 3, &[0., 0., 0., 4., 0., 0.]);
        let text = parts.document(&format!(
            r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"translation":[0,0,7]}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}}],
            "samplers":[{{"input":{times},"output":{moves}}}]}}]"#
        ));
        let scene = at_time(&text, 2.0);
        assert!(near(scene.objects[0].motion.at(0.0).point(Vec3::ZERO), [0., 0., 7.]));
        assert!(warnings(&scene).contains(part), "{name}: {}", warnings(&scene));
    }
}

/// A strip of two triangles along y whose upper end follows a joint at (0, 1, 0) that rotates a quarter turn about
/// z.
fn bent(normals: bool) -> String {
    let mut parts = Parts::default();
    let positions = parts.floats("VEC3", 3, &[0., 0., 0., 1., 1., 0., 0., 2., 0.]);
    let joints = parts.add("VEC4", 5121, 3, &[0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0]);
    let weights = parts.floats("VEC4", 4, &[1., 0., 0., 0., 0.5, 0.5, 0., 0., 1., 0., 0., 0.]);
    let identity = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];
    let mut below = identity;
    below[13] = -1.0;
    let bind = parts.floats("MAT4", 16, &[identity, below].concat());
    let times = parts.floats("SCALAR", 1, &[0.0, 1.0]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = parts.floats("VEC4", 4, &[0., 0., 0., 1., 0., 0., half, half]);
    let normal = parts.floats("VEC3", 3, &[1., 0., 0., 1., 0., 0., 1., 0., 0.]);
    let normal = if normals { format!(r#","NORMAL":{normal}"#) } else { String::new() };
    parts.document(&format!(
        r#""scenes":[{{"nodes":[0,1]}}],
        "nodes":[{{"mesh":0,"skin":0,"translation":[100,100,100]}},{{"children":[2]}},{{"translation":[0,1,0]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{positions},"JOINTS_0":{joints},"WEIGHTS_0":{weights}{normal}}}}}]}}],
        "skins":[{{"name":"arm","joints":[1,2],"inverseBindMatrices":{bind}}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":2,"path":"rotation"}}}}],
        "samplers":[{{"input":{times},"output":{turns}}}]}}]"#
    ))
}

#[test]
fn skins_bend_meshes_and_the_place_of_their_node_does_not_matter() {
    let rest = at_time(&bent(false), 0.0);
    assert!(rest.objects[0].motion.at(0.0).is_identity());
    assert_eq!(rest.inventory.skins, ["arm"]);
    assert!(near(rest.objects[0].mesh.positions[1], [1., 1., 0.]));
    let scene = at_time(&bent(true), 1.0);
    let mesh = &scene.objects[0].mesh;
    assert!(near(mesh.positions[0], [0., 0., 0.]));
    // Half at (1, 1, 0), half rotated about (0, 1, 0) to (0, 2, 0).
    assert!(near(mesh.positions[1], [0.5, 1.5, 0.]), "{}", mesh.positions[1]);
    assert!(near(mesh.positions[2], [-1., 1., 0.]), "{}", mesh.positions[2]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    assert!(near(mesh.normals[0], [1., 0., 0.]) && near(mesh.normals[2], [0., 1., 0.]));
    assert!(near(mesh.normals[1].normalize(), [half, half, 0.]), "{}", mesh.normals[1]);
    assert_eq!(warnings(&scene), "");
}

#[test]
fn broken_skins_are_refused_or_give_warnings() {
    let text = bent(false);
    let too_few = text.replace(r#""joints":[1,2]"#, r#""joints":[1]"#);
    let error = read_text("gltf", &too_few).unwrap_err().to_string();
    assert!(error.contains("vertex 1 refers to joint 1, but there are only 1"), "{error}");
    let many = text.replace(r#""joints":[1,2]"#, r#""joints":[1,2,2]"#);
    let error = read_text("gltf", &many).unwrap_err().to_string();
    assert!(error.contains("there must be a matrix for each of the 3 joints, not 2"), "{error}");
    let apart = text.replace(r#"{"nodes":[0,1]}"#, r#"{"nodes":[0]}"#);
    assert!(warnings(&read_text("gltf", &apart).unwrap()).contains("a joint is not in the scene"));
}

#[test]
fn morph_targets_are_weighed_along_splines() {
    let mut parts = Parts::default();
    parts.floats("VEC3", 3, &TRIANGLE);
    parts.floats("VEC3", 3, &[0., 0., 1., 0., 0., 1., 0., 0., 1.]);
    parts.floats("VEC3", 3, &[0., 8., 0., 0., 8., 0., 0., 8., 0.]);
    let times = parts.floats("SCALAR", 1, &[0.0, 2.0]);
    // Two weights; each key has its in-tangents, its values and its out-tangents.
    let keys = [[0., 0., 0., 1., 1., 0.], [0., 0., 1., 0., 0., 0.]].concat();
    let weights = parts.floats("SCALAR", 1, &keys);
    let text = parts.document(&format!(
        r#""scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"targets":[{{"POSITION":1}},{{"POSITION":2}}]}}],"weights":[0,0]}}],
        "animations":[{{"channels":[{{"sampler":0,"target":{{"node":0,"path":"weights"}}}}],
        "samplers":[{{"input":{times},"output":{weights},"interpolation":"CUBICSPLINE"}}]}}]"#
    ));
    // First weight at 1 s: 1/2 · 1 + 2 · 1/8 · 1 = 3/4; second: 1/2.
    let scene = at_time(&text, 1.0);
    assert!(
        near(scene.objects[0].mesh.positions[0], [0., 4., 0.75]),
        "{}",
        scene.objects[0].mesh.positions[0]
    );
    let scene = at_time(&text, 0.0);
    assert!(near(scene.objects[0].mesh.positions[1], [1., 8., 0.]));
}
