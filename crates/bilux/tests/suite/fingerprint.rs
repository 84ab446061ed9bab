//! Whatever changes a sample changes the fingerprint, so that films of two different pictures never merge silently; and
//! whatever changes no sample keeps it, so that films of one picture do merge.

use bilux::checkpoint::Identity;
use bilux::fingerprint::fingerprint;
use bilux::math::glam::Vec4;
use bilux::math::motion::{Motion, MotionKey};
use bilux::math::registry::{Parameter, ParameterKind};
use bilux::math::{Rgb, Transform, Vec2, Vec3};
use bilux::prelude::*;
use bilux::scene::cameras::CameraSpec;
use bilux::scene::texture::{Channel, Filter, Texture, UvTransform, Wrap};
use bilux::settings::{Effect, ROWS, SettingRow};
use bilux::transport::integrators::INTEGRATORS;
use std::collections::HashMap;
use std::sync::Arc;

/// A triangle, a point and a line with everything that a mesh can have.
pub(crate) fn full_mesh() -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z; 3],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
        uvs2: vec![Vec2::ONE; 3],
        tangents: vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 3],
        vertex_kd: vec![Rgb::WHITE; 3],
        vertex_ks: vec![Rgb::BLACK; 3],
        vertex_opacity: vec![0.75; 3],
        opacity_threshold: Some(0.25),
        point_widths: vec![0.75; 3],
        triangles: vec![[0, 1, 2]],
        points: vec![1],
        lines: vec![[0, 1]],
        ..Mesh::default()
    }
}

/// A triangle with everything that a mesh can have, a light, two cameras of which one moves, and an image texture.
fn scene() -> SceneBuilder {
    let mut scene = SceneBuilder::default();
    let texels = (0..16).map(|i| Rgb::grey(i as f32 / 15.0)).collect();
    scene.textures.push(Arc::new(Texture::new("", 4, 4, texels, false)));
    scene.add_material(Spec::new("paint", "diffuse").with("reflectance", Value::Texture(0)));
    scene.add_material(Spec::new("tin", "mirror").with("reflectance", 0.5f32));
    scene.objects.push(Object::new("sail", Arc::new(full_mesh()), 0));
    scene.lights.push(Spec::new("lamp", "point").with("position", Vec3::Z).with("intensity", 2.0f32));
    let camera = |name: &str| Spec::new(name, "perspective").with("position", Vec3::Z * 3.0);
    let mut moves = Parameters::default();
    moves.set("position", Vec3::Z * 4.0);
    scene.cameras.push(CameraSpec { spec: camera("a"), keyframes: vec![(1.0, moves)] });
    scene.cameras.push(CameraSpec { spec: camera("b"), keyframes: Vec::new() });
    scene
}

fn mesh_of(scene: &mut SceneBuilder) -> &mut Mesh {
    Arc::make_mut(&mut scene.objects[0].mesh)
}

fn texture_of(scene: &mut SceneBuilder) -> &mut Texture {
    Arc::make_mut(&mut scene.textures[0])
}

fn key(time_seconds: f32, x: f32) -> MotionKey {
    let (rotation, scale) = (bilux::math::Quat::IDENTITY, Vec3::ONE);
    MotionKey { time_seconds, translation: Vec3::X * x, rotation, scale }
}

type Change = (&'static str, fn(&mut SceneBuilder));

/// Every part of a scene, each changed a little.
const CHANGES: &[Change] = &[
    ("a position", |s| mesh_of(s).positions[1].x = 1.5),
    ("a normal", |s| mesh_of(s).normals[1].x = 0.5),
    ("a texture coordinate", |s| mesh_of(s).uvs[1].x = 0.5),
    ("one of the second set", |s| mesh_of(s).uvs2[1].x = 0.5),
    ("a tangent", |s| mesh_of(s).tangents[1].y = 0.5),
    ("a tangent's hand", |s| mesh_of(s).tangents[1].w = -1.0),
    ("a vertex's diffuse colour", |s| mesh_of(s).vertex_kd[1].r = 0.5),
    ("a vertex's specular colour", |s| mesh_of(s).vertex_ks[1].r = 0.5),
    ("whether that tints what it emits", |s| mesh_of(s).emission_by_kd = true),
    ("a vertex's opacity", |s| mesh_of(s).vertex_opacity[1] = 0.5),
    ("the threshold of that", |s| mesh_of(s).opacity_threshold = None),
    ("a point's width", |s| mesh_of(s).point_widths[1] = 0.5),
    ("the order of corners", |s| mesh_of(s).triangles[0] = [0, 2, 1]),
    ("one triangle more", |s| mesh_of(s).triangles.push([0, 2, 1])),
    ("a point", |s| mesh_of(s).points.push(1)),
    ("a line", |s| mesh_of(s).lines.push([0, 1])),
    ("an object's material", |s| s.objects[0].material = 1),
    ("an object's place", |s| {
        s.objects[0].motion =
            Motion::still(Transform::from_matrix(bilux::math::DMat4::from_rotation_x(0.5)).unwrap());
    }),
    ("a movement", |s| s.objects[0].motion = Motion::from_keys(vec![key(0.0, 0.0), key(1.0, 2.0)]).unwrap()),
    ("its end", |s| s.objects[0].motion = Motion::from_keys(vec![key(0.0, 0.0), key(1.0, 3.0)]).unwrap()),
    ("its time", |s| s.objects[0].motion = Motion::from_keys(vec![key(0.0, 0.0), key(2.0, 2.0)]).unwrap()),
    ("one object more", |s| s.objects.push(s.objects[0].clone())),
    ("a texel", |s| {
        let texels = (0..16).map(|i| Rgb::grey(if i == 7 { 0.0 } else { i as f32 / 15.0 })).collect();
        *texture_of(s) = Texture::new("", 4, 4, texels, false);
    }),
    ("the picture's shape", |s| {
        let texels = (0..16).map(|i| Rgb::grey(i as f32 / 15.0)).collect();
        *texture_of(s) = Texture::new("", 8, 2, texels, false);
    }),
    ("a picture's factor", |s| texture_of(s).factor = Rgb::grey(0.5)),
    ("a picture's channel", |s| texture_of(s).channel = Some(Channel::A)),
    ("a picture's threshold", |s| texture_of(s).threshold = Some(0.5)),
    ("how a picture is blended", |s| texture_of(s).filter = Filter::Nearest),
    ("how it goes on to the right", |s| texture_of(s).wrap[0] = Wrap::Clamp),
    ("how it goes on upwards", |s| texture_of(s).wrap[1] = Wrap::Clamp),
    ("where it lies", |s| texture_of(s).transform = Some(UvTransform::new([0.5, 0.0], 0.0, [1.0; 2]))),
    ("by which set it is looked up", |s| texture_of(s).second_uv = true),
    ("a material's kind", |s| s.materials[0].kind = "phong".to_owned()),
    ("a material's parameter", |s| s.materials[1].parameters.set("reflectance", 0.25f32)),
    ("one parameter more", |s| s.materials[1].parameters.set("gloss", 0.25f32)),
    ("one parameter fewer", |s| s.materials[0].parameters.0.clear()),
    ("a light's kind", |s| s.lights[0].kind = "spot".to_owned()),
    ("a light's parameter", |s| s.lights[0].parameters.set("intensity", 3.0f32)),
    ("one light fewer", |s| s.lights.clear()),
    ("a camera's kind", |s| s.cameras[0].spec.kind = "orthographic".to_owned()),
    ("a camera's parameter", |s| s.cameras[0].spec.parameters.set("fov", 30.0f32)),
    ("a camera's movement", |s| s.cameras[0].keyframes[0].1.set("position", Vec3::Z * 5.0)),
    ("the time of that", |s| s.cameras[0].keyframes[0].0 = 2.0),
    ("which camera is the first", |s| s.cameras.swap(0, 1)),
];

#[test]
fn every_change_of_a_scene_changes_the_fingerprint() {
    let settings = Settings::resolve(&Parameters::default()).unwrap();
    let mut seen = HashMap::from([(fingerprint(&scene(), &settings), "nothing")]);
    for (what, change) in CHANGES {
        let mut changed = scene();
        change(&mut changed);
        if let Some(other) = seen.insert(fingerprint(&changed, &settings), what) {
            panic!("{what} and {other} have one fingerprint");
        }
    }
    // Names, and where something was written, are not part of the picture.
    let mut renamed = scene();
    mesh_of(&mut renamed).name = "canvas".to_owned();
    renamed.objects[0].name = "jib".to_owned();
    assert_eq!(seen[&fingerprint(&renamed, &settings)], "nothing");
}

/// Values of the settings that take any text, and of the ground, which `auto` makes a shadow for a model alone. None is the
/// default.
const VALUES: &[(&str, &str)] = &[
    ("integrator", "path"),
    ("accel", "brute"),
    ("size", "9x8"),
    ("camera", "b"),
    ("eye", "0.5,1,4"),
    ("look_at", "0,0.5,0"),
    ("ground", "none"),
    ("orbit", "40,10"),
    ("filter", "tent"),
    ("background", "transparent"),
    ("tonemap", "aces"),
];

/// A value of a setting that is not its default.
fn another(parameter: &Parameter) -> Value {
    match VALUES.iter().find(|(key, _)| *key == parameter.name) {
        Some((key, text)) => {
            assert_ne!(*text, parameter.default, "{key}");
            Value::from(*text)
        }
        None if matches!(parameter.kind, ParameterKind::Text) => {
            panic!("give another value of '{}' here", parameter.name)
        }
        None => other(parameter),
    }
}

/// For studio settings the scene has no camera and no light of its own.
fn job_with(key: &str, value: Option<Value>) -> Job {
    let mut scene = scene();
    if ["ground", "orbit", "up", "front", "focal", "background"].contains(&key) {
        scene.cameras.clear();
        scene.lights.clear();
    }
    let mut settings = Parameters::default();
    settings.set("size", "8x8");
    // Fog would otherwise choose another depth.
    settings.set("max_depth", Value::Integer(5));
    if let Some(value) = value {
        settings.set(key, value);
    }
    Job::new(&scene, &settings).unwrap_or_else(|error| panic!("{key}: {error}"))
}

/// Fingerprints, checkpoints and sessions read what the effects of the rows say that they read.
#[test]
fn every_setting_has_the_effect_that_its_row_says() {
    let mut seen = HashMap::new();
    for row in ROWS {
        let key = row.parameter.name;
        let [plain, changed] = [None, Some(another(&row.parameter))].map(|value| job_with(key, value));
        let is_other_picture = plain.fingerprint() != changed.fingerprint();
        assert_eq!(is_other_picture, matches!(row.effect, Effect::Samples | Effect::Scene), "{key}");
        // The changed settings alone, with the scene as it was.
        let of_setting = fingerprint(plain.completed_scene(), changed.settings());
        assert_eq!(of_setting != plain.fingerprint(), row.effect == Effect::Samples, "{key} itself");
        if is_other_picture && let Some(other) = seen.insert(changed.fingerprint().to_owned(), key) {
            panic!("{key} and {other} have one fingerprint");
        }
        // Checkpoints keep a list of their own, which names what differs.
        let differences = Identity::of(&plain).differences(&Identity::of(&changed));
        let is_of_setting = |name: &String| !name.starts_with("the scene");
        assert_eq!(!differences.is_empty(), is_other_picture, "{key} in a checkpoint: {differences:?}");
        assert_eq!(
            differences.iter().any(is_of_setting),
            row.effect == Effect::Samples,
            "{key} in a checkpoint: {differences:?}"
        );
        // Samples of a session are kept unless the scene is another one, or is built anew.
        let keeps = matches!(row.effect, Effect::Count | Effect::Frames | Effect::Display | Effect::Work);
        assert_eq!(changed.settings().takes_samples_of(plain.settings()), keeps, "{key} in a session");
    }
}

/// Samples are the same bit for bit whatever a setting says that has another effect.
#[test]
fn settings_that_keep_the_samples_keep_them() {
    let mut scene = bilux::generate(&Spec::new("", "cornell")).unwrap();
    let ball = Mesh::sphere(Vec3::new(0.0, 0.3, 0.0), 0.2, 12);
    scene.objects.push(Object::new("ball", Arc::new(ball), 0));
    let wanted = [Effect::Frames, Effect::Display, Effect::Work, Effect::Building];
    // The options of the paper's tree do something in it, and where faces are culled.
    for base in [&[("accel", "auto")][..], &[("accel", "bsp"), ("culling", "back")]] {
        let film = |row: Option<&SettingRow>| {
            let mut settings = Parameters::default();
            settings.set("integrator", "path");
            base.iter().for_each(|(key, value)| settings.set(key, *value));
            if let Some(row) = row {
                settings.set(row.parameter.name, another(&row.parameter));
            }
            let job = Job::new(&scene, JobRequest::from(&settings).size(12, 10).spp(2)).unwrap();
            job.render(&Quiet).unwrap().rendered.film
        };
        let plain = film(None);
        for row in ROWS.iter().filter(|row| wanted.contains(&row.effect)) {
            assert!(film(Some(row)) == plain, "{} with {base:?}", row.parameter.name);
        }
    }
}

/// A value that is not the parameter's default.
fn other(parameter: &Parameter) -> Value {
    match parameter.kind {
        ParameterKind::Bool => Value::Bool(parameter.default != "true"),
        ParameterKind::Integer { min, .. } if parameter.default == (min + 1).to_string() => {
            Value::Integer(min + 2)
        }
        ParameterKind::Integer { min, .. } => Value::Integer(min + 1),
        ParameterKind::Number { min, max } => {
            let least = min.max(-1.0);
            Value::Number(0.3 * least + 0.7 * least.max(max.min(least + 1.0)))
        }
        ParameterKind::Choice(words) => {
            Value::Text(words.iter().find(|word| **word != parameter.default).unwrap().to_string())
        }
        kind => panic!("{}: a parameter of the kind {kind:?}", parameter.name),
    }
}

#[test]
fn integrators_and_their_parameters_change_the_fingerprint() {
    let scene = scene();
    let mut seen = HashMap::new();
    for row in INTEGRATORS {
        let mut settings = Parameters::default();
        settings.set("integrator", row.entry.name);
        let mut look = |settings: &Parameters, what: String| {
            let found = fingerprint(&scene, &Settings::resolve(settings).unwrap());
            if let Some(other) = seen.insert(found, what.clone()) {
                panic!("{what} and {other} have one fingerprint");
            }
        };
        look(&settings, row.entry.name.to_owned());
        for parameter in row.entry.parameters {
            let mut settings = settings.clone();
            settings.set(parameter.name, other(parameter));
            look(&settings, format!("{}: {}", row.entry.name, parameter.name));
        }
    }
}

#[test]
fn films_of_two_integrators_or_two_materials_do_not_join() {
    let film = |scene: &SceneBuilder, integrator: &str, samples: std::ops::Range<u32>| {
        let mut settings = Parameters::default();
        settings.set("size", "4x4");
        settings.set("spp", Value::Integer(4));
        settings.set("integrator", integrator);
        let job = Job::new(scene, JobRequest::from(&settings).samples(samples)).unwrap();
        job.render(&Quiet).unwrap().rendered.film
    };
    let mut dull = scene();
    dull.materials[0].parameters.set("reflectance", 0.2f32);
    let first = film(&scene(), "path", 0..2);
    for other in [film(&scene(), "bdpt", 2..4), film(&dull, "path", 2..4)] {
        let error = first.clone().merge(&other).unwrap_err().to_string();
        assert!(
            error.contains("fingerprint") || error.contains("picture") || error.contains("scene"),
            "{error}"
        );
    }
    first.clone().merge(&film(&scene(), "path", 2..4)).unwrap();
}

/// A job that moves on to another frame is another picture, whether or not its fingerprint was asked for before.
#[test]
fn each_frame_of_an_animation_has_the_fingerprint_of_its_time() {
    let mut user = Parameters::default();
    user.set("size", "4x4");
    let job = Job::new(&scene(), &user).unwrap();
    let mut all = Vec::new();
    for time in [0.0, 0.5, 1.0] {
        let moved = job.at_time(time);
        let mut at = user.clone();
        at.set("time", time);
        assert_eq!(moved.fingerprint(), Job::new(&scene(), &at).unwrap().fingerprint(), "at {time} s");
        all.push(moved.fingerprint().to_owned());
    }
    assert!(all[0] != all[1] && all[1] != all[2], "{all:?}");
}
