//! OpenUSD as it is written: what comes back, and what other programs rely on.

use crate::round_trips::{assert_same_colours, corners};
use bilux_formats::{ReadOptions, WriteOptions, read, write};
use bilux_math::glam::{Quat, Vec3Swizzles};
use bilux_math::{Motion, MotionKey, Rgb, Transform, Vec2, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::texture::{Channel, Image, Texels, UvTransform, Wrap};
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Texture, Value};
use std::sync::Arc;

/// A quadrilateral with all that vertices can have, except colours.
fn quad() -> Mesh {
    Mesh { name: "quad".into(), ..Mesh::quad(Vec3::new(0.1, 0.2, 0.3), Vec3::X * 1.5, Vec3::Y) }
}

/// Writes a scene to a file of this name and reads it again; also the warnings of the writer.
fn there(scene: &SceneBuilder, name: &str) -> (SceneBuilder, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    let said = write(&path, scene, &WriteOptions::default()).unwrap();
    let back = read(&path, &ReadOptions::default()).unwrap();
    (back, said.into_iter().map(|warning| warning.message).collect())
}

fn text_of(scene: &SceneBuilder) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.usda");
    write(&path, scene, &WriteOptions::default()).unwrap();
    std::fs::read_to_string(path).unwrap()
}

fn dressed(spec: Spec, mesh: Mesh) -> SceneBuilder {
    let mut scene = SceneBuilder::default();
    let material = scene.add_material(spec);
    scene.objects.push(Object::new("a", Arc::new(mesh), material));
    scene
}

#[test]
fn meshes_come_back_to_the_bit() {
    let mut coloured = quad();
    coloured.vertex_kd = (0..4).map(|i| Rgb::new(0.1 * i as f32, 0.5, 1.0)).collect();
    for mesh in [quad(), coloured] {
        let scene = dressed(Spec::new("m", "principled").with("base_color", 1.0), mesh);
        for name in ["a.usda", "a.usd", "a.usdz"] {
            let (back, said) = there(&scene, name);
            assert!(said.is_empty(), "{said:?}");
            assert_eq!(corners(&back.objects[0].mesh), corners(&scene.objects[0].mesh), "{name}");
            assert_same_colours(&back.objects[0].mesh, &scene.objects[0].mesh);
        }
    }
}

/// Readers that find no normals make a surface smooth.
#[test]
fn a_mesh_without_normals_stays_flat() {
    let roof = Mesh {
        positions: [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, -0.3]]
            .map(Vec3::from)
            .into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let (back, _) = there(&dressed(Spec::new("m", "diffuse"), roof), "a.usda");
    let mesh = &back.objects[0].mesh;
    let of = |i: usize| mesh.triangles[i].map(|v| mesh.normals[v as usize]);
    assert_eq!(of(0), [Vec3::Z; 3]);
    assert!(of(1).iter().all(|n| *n == of(1)[0] && *n != Vec3::Z), "{:?}", of(1));
}

#[test]
fn shared_meshes_are_written_once_and_names_are_identifiers() {
    let mut scene = SceneBuilder::default();
    let [a, b] = ["m", "m"].map(|name| scene.add_material(Spec::new(name, "diffuse")));
    let mesh = Arc::new(quad());
    for (i, (name, material)) in [("2 legs", a), ("2 legs", a), ("Tür", b)].into_iter().enumerate() {
        let place = Transform::translate(Vec3::X * i as f32).unwrap();
        scene.objects.push(Object::new(name, mesh.clone(), material).placed(place));
    }
    let text = text_of(&scene);
    assert_eq!(text.matches("point3f[] points").count(), 2, "{text}");
    for part in
        ["def Xform \"_2_legs\"", "def Xform \"_2_legs_2\"", "def Mesh \"T_r\"", "displayName = \"Tür\""]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    let (back, _) = there(&scene, "a.usdz");
    assert!(Arc::ptr_eq(&back.objects[0].mesh, &back.objects[1].mesh));
    let places: Vec<f32> = back.objects.iter().map(|o| o.motion.at(0.0).point(Vec3::ZERO).x).collect();
    assert_eq!(places, [0.0, 1.0, 2.0]);
}

#[test]
fn motion_becomes_samples_of_time() {
    let key = |seconds: f32, degrees: f32| MotionKey {
        time_seconds: seconds,
        translation: Vec3::X * seconds,
        rotation: Quat::from_rotation_y(degrees.to_radians()),
        scale: Vec3::ONE,
    };
    let motion = Motion::from_keys(vec![key(0.0, 0.0), key(2.0, 60.0)]).unwrap();
    let mut scene = dressed(Spec::new("m", "diffuse"), quad());
    scene.objects[0].motion = motion.then(&Motion::still(Transform::translate(Vec3::Y * 3.0).unwrap()));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.usda");
    write(&path, &scene, &WriteOptions::default()).unwrap();
    for time in [0.0, 0.5, 2.0] {
        let back = read(&path, &ReadOptions { time, ..ReadOptions::default() }).unwrap();
        let at = |o: &Object, time: f32| o.motion.at(time).point(Vec3::ONE);
        let off = at(&back.objects[0], 0.0) - at(&scene.objects[0], time);
        // Rotations are read as if they were linear.
        assert!(off.length() < 0.02, "{time}: {off}");
    }
}

/// A stage ends with the last key of all, wherever the object stands in the file.
#[test]
fn the_last_time_code_is_that_of_the_last_key() {
    let until = |seconds: f32| {
        let key = |time_seconds: f32| MotionKey {
            time_seconds,
            translation: Vec3::X * time_seconds,
            rotation: Quat::IDENTITY,
            scale: Vec3::ONE,
        };
        Motion::from_keys(vec![key(0.0), key(seconds)]).unwrap()
    };
    let mut scene = dressed(Spec::new("m", "diffuse"), quad());
    for seconds in [1.0, 3.0, 2.0] {
        let object = scene.objects[0].clone();
        scene.objects.push(Object { motion: until(seconds), ..object });
    }
    let text = text_of(&scene);
    let stated = |key: &str| -> f32 {
        let rest = text.split(&format!("{key} = ")).nth(1).unwrap();
        rest.split_whitespace().next().unwrap().parse().unwrap()
    };
    assert_eq!(stated("endTimeCode") / stated("timeCodesPerSecond"), 3.0);
}

/// Every light with what it sends: in candela, lux and nit as the specification of UsdLux gives them.
#[test]
fn lights_come_back_as_bright_as_they_were() {
    let mut scene = dressed(Spec::new("m", "diffuse"), quad());
    let at = Vec3::new(1.0, 2.0, 3.0);
    let triple = |x, y, z| Value::triple([x, y, z]);
    scene.lights = vec![
        Spec::new("p", "point").with("position", at).with("intensity", triple(8.0, 4.0, 2.0)),
        Spec::new("s", "spot")
            .with("position", at)
            .with("look_at", Vec3::new(1.0, 0.0, 3.0))
            .with("intensity", triple(8.0, 4.0, 2.0))
            .with("angle", 40.0)
            .with("inner_angle", 30.0),
        Spec::new("d", "directional")
            .with("direction", Vec3::NEG_X)
            .with("irradiance", 3.0)
            .with("diameter", 2.0),
        Spec::new("b", "sphere")
            .with("position", at)
            .with("radius", 0.25)
            .with("radiance", triple(1.0, 2.0, 4.0)),
        Spec::new("r", "rect")
            .with("position", at)
            .with("edge_u", Vec3::X * 2.0)
            .with("edge_v", Vec3::Z * 3.0)
            .with("intensity", 12.0)
            .with("sides", "front"),
    ];
    let (back, said) = there(&scene, "a.usda");
    assert!(said.is_empty(), "{said:?}");
    let number = |i: usize, key: &str| back.lights[i].number(key).unwrap();
    let colour = |i: usize, key: &str| back.lights[i].colour(key).unwrap().to_array();
    assert_eq!(colour(0, "intensity"), [8.0, 4.0, 2.0]);
    assert_eq!((back.lights[1].kind.as_str(), colour(1, "intensity")), ("spot", [8.0, 4.0, 2.0]));
    assert!((number(1, "angle") - 40.0).abs() + (number(1, "inner_angle") - 30.0).abs() < 1e-4);
    let axis = back.lights[1].vector("look_at").unwrap() - back.lights[1].vector("position").unwrap();
    assert!((axis.normalize() - Vec3::NEG_Y).length() < 1e-6);
    assert_eq!((colour(2, "irradiance"), number(2, "diameter")), ([3.0; 3], 2.0));
    assert!((back.lights[2].vector("direction").unwrap() - Vec3::NEG_X).length() < 1e-6);
    assert_eq!((colour(3, "radiance"), number(3, "radius")), ([1.0, 2.0, 4.0], 0.25));
    let edges = ["edge_u", "edge_v"].map(|key| back.lights[4].vector(key).unwrap());
    assert!((edges[0].cross(edges[1]) - Vec3::NEG_Y * 6.0).length() < 1e-5, "{edges:?}");
    assert_eq!(colour(4, "radiance"), [2.0; 3]);
    // 1 W/sr is a radiance of 4 W/sr over the area of the sphere, of which it shows a quarter.
    let text = text_of(&scene);
    assert!(text.contains("float inputs:intensity = 32\n        bool inputs:normalize = 1"), "{text}");
}

/// A panel that shines on both sides is a mesh, since lights of USD shine on one.
#[test]
fn a_panel_with_two_sides_is_a_mesh_that_emits() {
    let mut scene = dressed(Spec::new("m", "diffuse"), quad());
    scene.lights.push(Spec::new("r", "rect").with("radiance", 5.0));
    let (back, said) = there(&scene, "a.usda");
    assert!(said.is_empty() && back.lights.is_empty());
    let spec = &back.materials[back.objects[1].material];
    assert_eq!(spec.colour("emission").unwrap(), Rgb::grey(5.0));
    assert_eq!((spec.number("specular_ior"), spec.colour("base_color")), (Some(1.0), Some(Rgb::BLACK)));
}

/// The middle of a map is towards -z here and towards +z in USD; turned to the right by 90 degrees, it is towards +x.
#[test]
fn the_sky_keeps_its_directions() {
    let mut scene = dressed(Spec::new("m", "diffuse"), quad());
    let texels = (0..32 * 16).map(|i| Rgb::new((i % 32) as f32, (i / 32) as f32, 1.0)).collect();
    scene.textures.push(Arc::new(Texture::new("sky", 32, 16, texels, true)));
    let sky = Spec::new("sky", "environment").with("radiance", Value::Texture(0)).with("scale", 2.0);
    scene.lights.push(sky.clone().with("rotation", 90.0));
    let (back, _) = there(&scene, "a.usda");
    let le = |scene: &SceneBuilder, towards: Vec3| {
        let built = bilux_scene::lights::build(&scene.lights[0], &scene.textures).unwrap();
        let bilux_scene::lights::BuiltLight::Light(light) = built else { panic!("no sky") };
        light.le(towards)
    };
    for towards in [Vec3::new(0.9, 0.1, 0.3), Vec3::new(-0.2, 0.3, -0.8), Vec3::new(0.1, -0.7, 0.5)] {
        let (a, b) = (le(&scene, towards), le(&back, towards));
        assert!((a - b).map(f32::abs).max_channel() < 0.02 * a.max_channel(), "{a:?} {b:?}");
    }
    let text = text_of(&SceneBuilder { lights: vec![sky], ..scene });
    // Half a turn about y: the third row is what z becomes.
    let third = text.split("DomeLight").nth(1).unwrap().split("), (").nth(2).unwrap();
    assert!(third.ends_with(", 0, -1, 0"), "{third}");
}

#[test]
fn cameras_keep_their_lens() {
    let mut scene = dressed(Spec::new("m", "diffuse"), quad());
    let spec = Spec::new("main", "perspective")
        .with("position", Vec3::new(1.0, 2.0, 3.0))
        .with("look_at", Vec3::new(1.0, 2.0, -1.0))
        .with("fov", 35.0)
        .with("frame", 1.5)
        .with("principal_x", 0.4)
        .with("aperture", 0.02);
    scene.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
    let (back, said) = there(&scene, "a.usda");
    assert!(said.is_empty(), "{said:?}");
    let spec = &back.cameras[0].spec;
    let wanted = [("fov", 35.0), ("frame", 1.5), ("principal_x", 0.4), ("aperture", 0.02), ("focus", 4.0)];
    for (key, wanted) in wanted {
        let found = spec.number(key).unwrap();
        assert!((found / wanted - 1.0).abs() < 1e-5, "{key}: {found}");
    }
    // Small picture film in tenths of a metre: 24 mm high, and 24 / 2 / tan 17.5° = 38.06 mm of focal length.
    let text = text_of(&scene);
    assert!(
        text.contains("float verticalAperture = 0.24") && text.contains("float focalLength = 0.3805"),
        "{text}"
    );
}

#[test]
fn materials_keep_what_a_preview_surface_has() {
    let mut scene = dressed(
        Spec::new("m", "principled")
            .with("base_color", Value::Texture(0))
            .with("specular_roughness", Value::Texture(1))
            .with("base_metalness", 0.25)
            .with("coat_weight", 0.5)
            .with("coat_roughness", 0.125)
            .with("coat_ior", 1.5)
            .with("emission", Value::triple([1.0, 2.0, 3.0]))
            .with("opacity", Value::Texture(2))
            .with("normal", Value::Texture(3)),
        quad(),
    );
    let bytes = (0u8..16).map(|i| [i * 16, 255 - i, 7, i * 8]).collect();
    let image = Arc::new(Image { width: 4, height: 4, texels: Texels::Bytes(bytes) });
    let of = |is_data| Texture::of("t", image.clone(), is_data);
    let placed = UvTransform::new([0.25, 0.5], 0.5, [2.0, 3.0]);
    scene.textures = vec![
        Arc::new(Texture {
            factor: Rgb::new(0.5, 1.0, 0.25),
            wrap: [Wrap::Mirror, Wrap::Clamp],
            ..of(false)
        }),
        Arc::new(Texture { channel: Some(Channel::G), transform: Some(placed), ..of(true) }),
        Arc::new(Texture { channel: Some(Channel::A), threshold: Some(0.5), ..of(true) }),
        Arc::new(of(true)),
    ];
    let (back, said) = there(&scene, "a.usdz");
    assert!(said.is_empty(), "{said:?}");
    let spec = &back.materials[back.objects[0].material];
    for (key, wanted) in [("base_metalness", 0.25), ("coat_weight", 0.5), ("coat_roughness", 0.125)] {
        assert_eq!(spec.number(key), Some(wanted), "{key}");
    }
    assert_eq!(spec.colour("emission").unwrap().to_array(), [1.0, 2.0, 3.0]);
    for (i, key) in ["base_color", "specular_roughness", "opacity", "normal"].into_iter().enumerate() {
        let Some((Value::Texture(index), _)) = spec.parameters.find(key) else { panic!("{key}") };
        let (a, b) = (&scene.textures[i], &back.textures[*index]);
        for at in [Vec2::new(0.1, 0.3), Vec2::new(1.3, -0.4), Vec2::new(-2.2, 0.7)] {
            let off = (a.at_one(at) - b.at_one(at)).map(f32::abs).max_channel();
            assert!(off < 1e-4, "{key} at {at}: {off}");
        }
    }
}

/// A reflectance of 0.04 at normal incidence, tinted.
#[test]
fn tinted_reflections_have_a_workflow_of_their_own() {
    let tinted = Spec::new("m", "principled").with("specular_color", Value::triple([1.0, 0.5, 0.25]));
    let scene = dressed(tinted, quad());
    assert!(text_of(&scene).contains("color3f inputs:specularColor = (0.04"));
    let (back, said) = there(&scene, "a.usda");
    let spec = &back.materials[0];
    let tint = spec.colour("specular_color").unwrap() - Rgb::new(1.0, 0.5, 0.25);
    assert!(said.is_empty() && tint.map(f32::abs).max_channel() < 1e-6, "{said:?} {tint:?}");
    assert!((spec.number("specular_ior").unwrap() - 1.5).abs() < 1e-5);
}

#[test]
fn glass_is_named() {
    let (back, said) = there(&dressed(Spec::new("g", "dielectric"), quad()), "a.usda");
    assert!(said.iter().any(|line| line.contains("refracts nothing")), "{said:?}");
    // Two surfaces with 4%: 2 × 0.04 / 1.04.
    let opacity = back.materials[0].number("opacity").unwrap();
    assert!((opacity - 0.0769).abs() < 1e-3, "{opacity}");
}

/// [USDZ specification 1.3]: stored, aligned to 64 bytes, the layer first.
#[test]
fn packages_are_as_their_specification_says() {
    let mut scene = dressed(Spec::new("m", "principled").with("base_color", Value::Texture(0)), quad());
    scene.textures.push(Arc::new(Texture::missing("t")));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.usdz");
    write(&path, &scene, &WriteOptions::default()).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing beside it");
    let bytes = std::fs::read(path).unwrap();
    let number =
        |at: usize, n: usize| (0..n).fold(0usize, |sum, i| sum | usize::from(bytes[at + i]) << (8 * i));
    let (mut at, mut names) = (0, Vec::new());
    while bytes[at..].starts_with(b"PK\x03\x04") {
        let (name, start) = (at + 30, at + 30 + number(at + 26, 2) + number(at + 28, 2));
        assert_eq!((number(at + 8, 2), start % 64), (0, 0), "stored and aligned");
        names.push(String::from_utf8_lossy(&bytes[name..name + number(at + 26, 2)]).into_owned());
        at = start + number(at + 18, 4);
    }
    assert_eq!(names, ["a.usda", "a-texture-1.png"]);
    let error =
        write(&folder.path().join("a.usdc"), &scene, &WriteOptions::default()).unwrap_err().to_string();
    assert!(error.contains("usda, usdz") && !error.contains("usdc,"), "{error}");
}

#[test]
fn points_and_lines_keep_their_widths() {
    let strokes = Mesh {
        positions: (0..5).map(|i| Vec3::X * i as f32).collect(),
        points: vec![0, 4],
        lines: vec![[0, 1], [1, 2], [3, 4]],
        ..Mesh::default()
    };
    let mut scene = dressed(Spec::new("default", "phong"), strokes);
    scene.stroke_widths = bilux_scene::StrokeWidths { points: 0.25, lines: 0.125 };
    let text = text_of(&scene);
    assert!(text.contains("int[] curveVertexCounts = [3, 2]"), "{text}");
    assert!(text.contains("float[] widths = [0.25]") && text.contains("float[] widths = [0.125]"), "{text}");
    let (back, _) = there(&scene, "a.usda");
    assert_eq!(back.objects[0].mesh.point_widths, [0.25; 2]);
    let tube = back.objects[1].mesh.bounds().extent();
    assert!((tube.yz().max_element() - 0.125).abs() < 0.02 && tube.x == 4.0, "{tube}");
}

/// As labels of the taxonomy `category`; nearer ones count more than those further up.
#[test]
fn categories_are_labels() {
    let mut scene = dressed(Spec::new("m", "diffuse"), quad());
    scene.objects[0].category = "chair".into();
    let text = text_of(&scene);
    assert!(text.contains("[\"MaterialBindingAPI\", \"SemanticsLabelsAPI:category\"]"), "{text}");
    let (back, said) = there(&scene, "a.usdz");
    assert_eq!((back.objects[0].category.as_str(), said.len()), ("chair", 0));
    let square = "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\npoint3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]";
    let text = format!(
        "#usda 1.0\ndef Xform \"room\" {{\ntoken[] semantics:labels:kind = [\"room\"]\ndef Mesh \"a\" {{\n{square}\n}}\n\
         def Mesh \"b\" {{\ntoken[] semantics:labels:category = [\"table\", \"desk\"]\n{square}\n}}\n}}\n"
    );
    let read = crate::read_text("usd", text).unwrap();
    let of: Vec<&str> = read.objects.iter().map(|object| object.category.as_str()).collect();
    assert_eq!(of, ["room", "table"]);
}

/// Materials may use the brightness of one picture, each by a factor of its own.
#[test]
fn the_brightness_of_a_picture_counts_by_the_factor_of_each_material() {
    let picture = Texture::new("t", 2, 1, vec![Rgb::grey(0.8), Rgb::grey(0.4)], true);
    for factors in [[0.5, 1.0, 0.5], [1.0, 0.25, 0.5]] {
        let mut scene = SceneBuilder::default();
        for factor in factors {
            scene.textures.push(Arc::new(Texture { factor: Rgb::grey(factor), ..picture.clone() }));
            let rough = Value::Texture(scene.textures.len() - 1);
            let material = scene.add_material(Spec::new("m", "principled").with("specular_roughness", rough));
            scene.objects.push(Object::new("a", Arc::new(quad()), material));
        }
        let (back, _) = there(&scene, "a.usda");
        for (object, factor) in back.objects.iter().zip(factors) {
            let spec = &back.materials[object.material];
            let Some((Value::Texture(index), _)) = spec.parameters.find("specular_roughness") else {
                panic!("{spec:?}")
            };
            for (x, wanted) in [(0, 0.8), (1, 0.4)] {
                let found = back.textures[*index].texel(x, 0).r;
                assert!(
                    (found - wanted * factor).abs() < 3e-3,
                    "{factors:?}: {found} for {wanted} times {factor}"
                );
            }
        }
    }
}
