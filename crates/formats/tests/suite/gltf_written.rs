//! glTF that Bilux writes: its contents survive a round trip.

use crate::round_trips::corners;
use crate::shared_files::{files, scenes};
use crate::{read_text, warnings};
use bilux_formats::{ReadOptions, WriteOptions, read, write};
use bilux_math::{Motion, MotionKey, Quat, Rgb, Vec2, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::texture::UvPair;
use bilux_scene::{Object, SceneBuilder, Spec, Texture, Value};
use bilux_testing::effort;
use std::path::Path;
use std::sync::Arc;

fn there(scene: &SceneBuilder, path: &Path) -> (SceneBuilder, Vec<String>) {
    let lost = write(path, scene, &WriteOptions::default()).unwrap();
    let back = read(path, &ReadOptions::default()).unwrap();
    (back, lost.into_iter().map(|warning| warning.message).collect())
}

/// The values of a parameter on a grid of texture coordinates.
fn values(scene: &SceneBuilder, value: &Value) -> Vec<f32> {
    match value {
        Value::Texture(index) => {
            let grid = (0..64).map(|i| Vec2::new((i % 8) as f32 + 0.3, (i / 8) as f32 + 0.4) / 8.0);
            grid.flat_map(|uv| {
                let texture = &scene.textures[*index];
                let pair = UvPair([uv; 2]);
                if texture.channel.is_some() {
                    vec![texture.number(pair)]
                } else {
                    texture.at(pair).to_array().to_vec()
                }
            })
            .collect()
        }
        Value::List(list) => list.iter().flat_map(|one| values(scene, one)).collect(),
        Value::Number(x) => vec![*x as f32],
        Value::Integer(i) => vec![*i as f32],
        Value::Bool(b) => vec![f32::from(u8::from(*b))],
        Value::Text(text) => text.bytes().map(f32::from).collect(),
        other => panic!("{other:?}"),
    }
}

/// Parameters that are written in another but equivalent form.
const EQUIVALENT: &[&str] =
    &["specular_roughness_anisotropy", "anisotropy_rotation", "transmission_color", "base_color"];

#[track_caller]
fn assert_same_materials(a: &SceneBuilder, b: &SceneBuilder, what: &str) {
    for (x, y) in a.objects.iter().zip(&b.objects) {
        let (x, y) = (&a.materials[x.material], &b.materials[y.material]);
        for (key, value, _) in &x.parameters.0 {
            if EQUIVALENT.contains(&key.as_str()) && x.parameters.find("transmission_weight").is_some() {
                continue;
            }
            let Some((found, _)) = y.parameters.find(key) else {
                let defaults = ["specular_weight", "specular_color", "normal_scale", "specular_ior"];
                assert!(
                    defaults.contains(&key.as_str()) || EQUIVALENT.contains(&key.as_str()),
                    "{what}: {key} is lost"
                );
                continue;
            };
            let (wanted, found) = (values(a, value), values(b, found));
            let close = |(w, f): (&f32, &f32)| (w - f).abs() <= 0.006 * w.abs().max(1.0);
            let repeated = found.len() != wanted.len();
            assert!(
                repeated || wanted.iter().zip(&found).all(close),
                "{what}: {key}: {value:?}, {wanted:?}, {found:?}"
            );
        }
    }
}

/// Otherwise a dark scene would read back as one that does not state its surroundings.
#[test]
fn lights_without_surroundings_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = read_text("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    scene.environment_unspecified = false;
    scene.lights.push(Spec::new("lamp", "point").with("intensity", 5.0f32));
    let (mut back, _) = there(&scene, &folder.path().join("a.glb"));
    assert!(!back.environment_unspecified);
    back.environment_unspecified = true;
    let (again, _) = there(&back, &folder.path().join("b.glb"));
    assert!(again.environment_unspecified, "a file of others stays as it is");
}

#[test]
fn the_same_scene_is_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let scene =
        read_text("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 3 2 1\n").unwrap();
    let bytes = |name: &str| {
        let path = folder.path().join(name);
        write(&path, &scene, &WriteOptions::default()).unwrap();
        std::fs::read(path).unwrap()
    };
    for i in 0..8 {
        assert_eq!(bytes("a.glb"), bytes(&format!("b{i}.glb")));
    }
}

#[test]
fn test_models_come_back() {
    let Some(root) = scenes() else { return };
    let mut all = Vec::new();
    files(&root.join("gltf"), &mut all);
    let folder = tempfile::tempdir().unwrap();
    let mut count = 0;
    for path in all {
        let Ok(scene) = read(&path, &ReadOptions::default()) else { continue };
        let name = path.display().to_string();
        // Large images take long to compress.
        let texels: usize = scene.textures.iter().map(|texture| texture.width() * texture.height()).sum();
        if texels > effort(300_000, 3_000_000)
            || scene.objects.is_empty()
            || !(name.ends_with(".glb") || name.ends_with(".gltf"))
        {
            continue;
        }
        count += 1;
        let (back, lost) = there(&scene, &folder.path().join("out.glb"));
        println!("{name}: {lost:?}");
        let drawn: Vec<&Object> = scene.objects.iter().filter(|o| !o.mesh.triangles.is_empty()).collect();
        assert_eq!(drawn.len(), back.objects.len(), "{name}");
        for (a, b) in drawn.iter().zip(&back.objects) {
            assert_eq!(a.mesh.triangles.len(), b.mesh.triangles.len(), "{name}");
            let (from, to) = (a.motion.at(0.3), b.motion.at(0.3));
            for (p, q) in a.mesh.triangles.iter().flatten().zip(b.mesh.triangles.iter().flatten()) {
                let (p, q) =
                    (from.point(a.mesh.positions[*p as usize]), to.point(b.mesh.positions[*q as usize]));
                assert!((p - q).length() <= 1e-4 * (1.0 + p.length()), "{name}: {p} {q}");
            }
        }
        assert_same_materials(&scene, &back, &name);
        // Once a material is `principled`, it no longer changes.
        let (again, _) = there(&back, &folder.path().join("again.gltf"));
        for (a, b) in back.objects.iter().zip(&again.objects) {
            let numbers =
                |o: &Object| corners(&o.mesh).concat().into_iter().map(f32::from_bits).collect::<Vec<_>>();
            let (a, b) = (numbers(a), numbers(b));
            let same =
                a.len() == b.len() && a.iter().zip(&b).all(|(x, y)| (x - y).abs() <= 3e-7 * x.abs().max(1.0));
            assert!(same, "{name}: a mesh differs the second time");
        }
        assert_eq!(
            (back.cameras.len(), back.lights.len()),
            (again.cameras.len(), again.lights.len()),
            "{name}"
        );
    }
    assert!(count > 25, "{count}");
}

/// Cameras, lights, materials of every kind, a cut-out texture, and an animated object.
#[test]
fn written_scenes_round_trip() {
    let mut scene = read_text(
        "toml",
        r#"
[camera]
frame = 1.5
position = [1, 2, 5]
look_at = [0, 0.5, 0]
fov = 33
[[light]]
kind = "spot"
position = [2, 4, 1]
intensity = [30, 20, 10]
[[light]]
kind = "directional"
direction = [0, -1, -0.5]
irradiance = 2.5
[[light]]
kind = "rect"
radiance = 7
[[material]]
name = "clay"
kind = "diffuse"
reflectance = [0.5, 0.3, 0.2]
[[material]]
name = "pane"
kind = "dielectric"
thin = true
[[material]]
name = "red glass"
kind = "dielectric"
absorption = [0.1, 2, 3]
eta = 1.6
dispersion = 3
[[material]]
name = "copper"
kind = "conductor"
metal = "copper"
roughness = 0.25
[[model]]
name = "mover"
shape = "sphere"
material = "clay"
[[model.keyframes]]
time = 0
translate = [0, 0, 0]
[[model.keyframes]]
time = 2
translate = [0, 4, 0]
"#,
    )
    .unwrap();
    let texels = (0..16).map(|i| Rgb::new(i as f32 / 15.0, 0.5, 1.0 - i as f32 / 15.0)).collect();
    scene.textures.push(Arc::new(Texture::new("stripes", 4, 4, texels, false)));
    let holes = (0..16).map(|i| Rgb::grey((i % 2) as f32)).collect();
    scene.textures.push(Arc::new(Texture::new("holes", 4, 4, holes, true)));
    let lace = Spec::new("lace", "diffuse")
        .with("reflectance", Value::Texture(0))
        .with("opacity", Value::Texture(1));
    let lace = scene.add_material(lace);
    for (i, material) in [1, 2, 3, lace].into_iter().enumerate() {
        let mesh = shapes::quad(Vec3::new(i as f32 * 2.0, 0.0, 0.0), Vec3::X, Vec3::Y);
        scene.objects.push(Object::new(&format!("part {i}"), Arc::new(mesh), material));
    }
    let folder = tempfile::tempdir().unwrap();
    for file in ["a b.glb", "a b.gltf"] {
        let (back, lost) = there(&scene, &folder.path().join(file));
        assert!(lost.is_empty(), "{lost:?}");
        // The pane is reported to be thin.
        assert!(warnings(&back).lines().all(|line| line.contains("a thin wall")), "{}", warnings(&back));
        // The area light is an object now.
        assert_eq!((back.objects.len(), back.lights.len(), back.cameras.len()), (6, 2, 1));
        let later =
            read(&folder.path().join(file), &ReadOptions { time: 1.0, ..ReadOptions::default() }).unwrap();
        let moved = |scene: &SceneBuilder| scene.objects[0].motion.at(1.0).point(Vec3::ZERO);
        assert!((moved(&scene) - moved(&later)).length() < 1e-5, "{} {}", moved(&scene), moved(&later));
        let spec = |name: &str| back.materials.iter().find(|m| m.name == name).cloned().unwrap_or_default();
        let number =
            |name: &str, key: &str| spec(name).parameters.find(key).map(|(value, _)| values(&back, value));
        assert_eq!(number("clay", "specular_weight"), Some(vec![0.0]));
        assert_eq!(number("pane", "thin_walled"), Some(vec![1.0]));
        assert_eq!(number("red glass", "thin_walled"), Some(vec![0.0]));
        assert_eq!(number("red glass", "specular_ior"), Some(vec![1.6]));
        let parts = ["transmission_dispersion_scale", "transmission_dispersion_abbe_number"];
        let parts = parts.map(|key| number("red glass", key).unwrap()[0]);
        assert_eq!((parts[0], (parts[1] * 3.0).round()), (1.0, 20.0));
        let left = number("red glass", "transmission_color").unwrap();
        assert!((left[1] - 0.1353).abs() < 1e-3, "{left:?}");
        let copper = number("copper", "base_color").unwrap();
        assert!(copper[0] > copper[1] && copper[1] > copper[2], "{copper:?}");
        for (key, texture) in [("opacity", 1), ("base_color", 0)] {
            let (found, wanted) = (number("lace", key).unwrap(), values(&scene, &Value::Texture(texture)));
            let wanted: Vec<f32> =
                if key == "opacity" { wanted.into_iter().step_by(3).collect() } else { wanted };
            assert_eq!(found.len(), wanted.len());
            assert!(
                found.iter().zip(&wanted).all(|(f, w)| (f - w).abs() < 0.006),
                "{key}: {found:?} {wanted:?}"
            );
        }
        let camera = &back.cameras[0].spec;
        let fov = camera.parameters.find("fov").map(|(value, _)| values(&back, value)).unwrap();
        assert!((fov[0] - 33.0).abs() < 1e-3, "{fov:?}");
        let frame = camera.parameters.find("frame").map(|(value, _)| values(&back, value)).unwrap();
        assert!((frame[0] - 1.5).abs() < 1e-6, "all that the picture showed: {frame:?}");
    }
}

/// A glTF file has no image size, but its camera shows as much as it did before.
#[test]
fn a_camera_takes_the_shape_of_its_picture_along() {
    let scene = read_text("toml", "[render]\nsize = \"480x320\"\n[camera]\nfov = 33\n").unwrap();
    let (back, lost) = there(&scene, &tempfile::tempdir().unwrap().path().join("a.glb"));
    assert_eq!(lost.len(), 1, "{lost:?}");
    let frame = back.cameras[0].spec.parameters.find("frame").map(|(value, _)| value.clone());
    assert!(matches!(frame, Some(Value::Number(shape)) if (shape - 1.5).abs() < 1e-6), "{frame:?}");
}

/// A panel emits on one side or both, as it says; a scene that only its surfaces light gets no studio when it is read again.
#[test]
fn panels_keep_their_sides_and_surfaces_that_emit_are_light() {
    let folder = tempfile::tempdir().unwrap();
    let sides = |sides: &str| {
        let scene =
            read_text("toml", format!("[[light]]\nkind = \"rect\"\n{sides}\n[[model]]\nshape = \"quad\"\n"))
                .unwrap();
        let path = folder.path().join("panel.gltf");
        write(&path, &scene, &WriteOptions::default()).unwrap();
        // The model has two sides too.
        std::fs::read_to_string(path).unwrap().matches("\"doubleSided\"").count()
    };
    assert_eq!(["", "sides = \"both\"", "sides = \"front\""].map(sides), [2, 2, 1]);
    let scene = read_text(
        "toml",
        "[[material]]\nname = \"a\"\nkind = \"diffuse\"\nemission = 2\n[[model]]\nshape = \"quad\"\nmaterial = \"a\"\n",
    )
    .unwrap();
    let (back, _) = there(&scene, &folder.path().join("a.glb"));
    assert_eq!((scene.environment_unspecified, back.environment_unspecified), (false, false));
}

/// Times of glTF begin at 0. What moves from before that on is at 0 where it was, and goes on as it did.
#[test]
fn keys_before_the_beginning_leave_the_rest_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let key = |time_seconds: f32, at: [f32; 3], degrees: f32, size: f32| MotionKey {
        time_seconds,
        translation: Vec3::from(at),
        rotation: Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), degrees.to_radians()),
        scale: Vec3::new(size, 1.0, 2.0 * size),
    };
    let crossing = [
        key(-3.0, [9.0, 9.0, 9.0], 300.0, 1.0),
        key(-1.0, [1.0, 2.0, -3.0], 20.0, 1.5),
        key(3.0, [5.0, -2.0, 1.0], 110.0, 0.5),
        key(4.0, [0.0, 1.0, 7.0], 10.0, 2.0),
    ];
    for (name, keys, says) in [
        ("crossing", &crossing[..], true),
        ("over", &crossing[..2], true),
        ("begins", &[key(0.0, [1.0, 2.0, 3.0], 5.0, 1.0), crossing[2]], false),
        ("later", &crossing[2..], false),
    ] {
        let mut scene = SceneBuilder::default();
        let material = scene.add_material(Spec::new("plain", "principled"));
        let motion = Motion::from_keys(keys.to_vec()).unwrap();
        let mesh = Arc::new(shapes::quad(Vec3::ZERO, Vec3::X, Vec3::Y));
        scene.objects.push(Object { motion: motion.clone(), ..Object::new(name, mesh, material) });
        let path = folder.path().join(format!("{name}.gltf"));
        let (_, said) = there(&scene, &path);
        assert_eq!(said.iter().any(|one| one.contains("begin at 0 seconds")), says, "{name}: {said:?}");
        let json: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        let times = json["animations"][0]["samplers"][0]["input"].as_u64().unwrap() as usize;
        assert!(json["accessors"][times]["min"][0].as_f64().unwrap() >= 0.0, "{name}");
        for time in [0.0, 0.75, 2.9, 3.5, 9.0] {
            let back = read(&path, &ReadOptions { time, ..ReadOptions::default() }).unwrap();
            let corner = Vec3::new(0.3, -1.0, 0.7);
            let (wanted, found) =
                (motion.at(time).point(corner), back.objects[0].motion.at(time).point(corner));
            assert!(wanted.distance(found) < 1e-4, "{name} at {time}: {found}, not {wanted}");
        }
    }
}

/// Pictures with all combinations of what is beyond their edges along each axis, and of texels that are blended or not.
#[test]
fn each_picture_keeps_its_own_sampler() {
    use bilux_scene::texture::{Filter, Wrap};
    let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    let mut scene = SceneBuilder::default();
    for filter in [Filter::Linear, Filter::Nearest] {
        for wrap in wraps.into_iter().flat_map(|u| wraps.map(|v| [u, v])) {
            let texels = vec![Rgb::new(0.2, 0.4, 0.8), Rgb::new(0.9, 0.1, 0.3)];
            scene.textures.push(Arc::new(Texture { wrap, filter, ..Texture::new("t", 2, 1, texels, false) }));
            let spec = Spec::new(&format!("{wrap:?} {filter:?}"), "principled");
            let material =
                scene.add_material(spec.with("base_color", Value::Texture(scene.textures.len() - 1)));
            let quad = Arc::new(shapes::quad(Vec3::ZERO, Vec3::X, Vec3::Y));
            scene.objects.push(Object::new("o", quad, material));
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let (back, _) = there(&scene, &folder.path().join("a.glb"));
    assert_eq!(back.objects.len(), 18);
    for object in &back.objects {
        let spec = &back.materials[object.material];
        let Some((Value::Texture(index), _)) = spec.parameters.find("base_color") else { panic!("{spec:?}") };
        let texture = &back.textures[*index];
        assert_eq!(spec.name, format!("{:?} {:?}", texture.wrap, texture.filter));
    }
}
