//! The native scene file.

use crate::{read_text, refusal, warnings};
use bilux_formats::{FormatError, ReadOptions, SHAPES, WriteOptions, read, toml_schema, write};
use bilux_gallery::GENERATORS;
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::transcendental::sin_cos;
use bilux_math::{Rgb, Transform, Vec2, Vec3};
use bilux_scene::media::Grid;
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Value};
use std::path::Path;
use std::sync::Arc;

/// Reads the first of these files in a folder of their own.
fn read_files(files: &[(&str, &str)]) -> Result<SceneBuilder, FormatError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    read(&folder.path().join(files[0].0), &ReadOptions::default())
}

#[track_caller]
fn file_refusal(files: &[(&str, &str)]) -> String {
    read_files(files).expect_err("this should be refused").to_string()
}

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl paint\nf 1 2 3\nusemtl wood\nf 1 2 3\n";

const SCENE: &str = r#"
[render]
integrator = "whitted"
size = [640, 480]
spp = 4

[camera]
position = [0, 1, 5]
fov = 35.5

[[light]]
kind = "point"
name = "lamp"
position = [2, 3, 4]
intensity = [10, 9, 8]

[[material]]
name = "glass"
kind = "dielectric"
eta = 1.33

[[model]]
shape = "sphere"
radius = 0.5
material = "glass"
translate = [0, 1, 0]

[[model]]
name = "ground"
shape = "floor"
"#;

#[test]
fn a_whole_scene() {
    let scene = read_text("toml", SCENE).unwrap();
    assert_eq!(warnings(&scene), "");
    let (value, at) = scene.settings.find("integrator").unwrap();
    assert_eq!((value, at.line, at.column), (&Value::from("whitted"), 3, 1));
    assert_eq!(scene.cameras[0].spec.kind, "perspective");
    assert_eq!((scene.lights[0].name.as_str(), scene.lights[0].kind.as_str()), ("lamp", "point"));
    let [ball, ground] = &scene.objects[..] else { panic!() };
    assert_eq!(scene.materials[ball.material].name, "glass");
    assert_eq!(scene.materials[ground.material].name, "default");
    assert_eq!((ball.name.as_str(), ground.name.as_str()), ("sphere", "ground"));
    let bounds = ball.motion.at(0.0).bounds(&ball.mesh.bounds());
    assert_eq!((bounds.min.y, bounds.max.y), (0.5, 1.5));
    assert!(scene.build(&Default::default(), [0.0, 0.0], 1.0).is_ok());
}

#[test]
fn models_from_files_keep_replace_or_rename_their_materials() {
    let main = r#"
        [[material]]
        name = "gold"
        kind = "mirror"
        [[model]]
        file = "parts/a.obj"
        instance = true
        [[model]]
        file = "parts/a.obj"
        material = "gold"
        [[model]]
        name = "third"
        file = "parts/a.obj"
        materials = { wood = "gold" }
    "#;
    let scene = read_files(&[("main.toml", main), ("parts/a.obj", OBJ)]).unwrap();
    let used: Vec<&str> = scene.objects.iter().map(|o| &*scene.materials[o.material].name).collect();
    assert_eq!(used, ["paint", "wood", "gold", "gold", "paint", "gold"]);
    assert_eq!(scene.materials.len(), 3, "the file's materials are here once");
    assert!(std::sync::Arc::ptr_eq(&scene.objects[0].mesh, &scene.objects[2].mesh));
    assert!(scene.objects[0].instanced && !scene.objects[2].instanced);
    assert_eq!(scene.objects[5].name, "third/a");
    assert_eq!(scene.warnings.len(), 2, "warnings of a file come once: {}", warnings(&scene));
}

#[test]
fn generated_scenes_bring_materials_and_on_request_the_rest() {
    for row in GENERATORS {
        let name = row.entry.name;
        let scene = read_text("toml", format!("[[model]]\ngenerate = \"{name}\"\n")).unwrap();
        assert!(!scene.objects.is_empty() && scene.lights.is_empty() && scene.cameras.is_empty(), "{name}");
    }
    let scene =
        read_text("toml", "[[model]]\ngenerate = \"teapots\"\ncount = 4\nwith = [\"lights\", \"cameras\"]\n")
            .unwrap();
    assert_eq!(scene.objects.len(), 5);
    assert!(!scene.lights.is_empty() && scene.cameras.len() == 1);
}

#[test]
fn no_parameter_has_the_name_of_a_key_of_models() {
    let keys = [
        "file",
        "shape",
        "generate",
        "name",
        "material",
        "materials",
        "instance",
        "with",
        "translate",
        "rotate",
        "scale",
        "matrix",
        "keyframes",
    ];
    let entries = GENERATORS.iter().map(|r| &r.entry).chain(SHAPES.iter().map(|r| &r.entry));
    for entry in entries {
        assert!(entry.parameters.iter().all(|p| !keys.contains(&p.name)), "{}", entry.name);
    }
}

/// The position of the point (1, 2, 3) of a placed model at a time.
fn placed(place: &str, time: f32) -> Vec3 {
    let scene = read_text("toml", format!("[[model]]\nshape = \"box\"\n{place}\n")).unwrap();
    scene.objects[0].motion.at(time).point(Vec3::new(1.0, 2.0, 3.0))
}

#[track_caller]
fn assert_near(a: Vec3, b: Vec3) {
    assert!((a - b).length() < 1e-5, "{a} is not {b}");
}

#[test]
fn places_scale_then_rotate_then_translate() {
    assert_near(placed("translate = [10, 0, 0]\nscale = 2", 0.0), Vec3::new(12.0, 4.0, 6.0));
    assert_near(placed("rotate = [90, 0, 0]", 0.0), Vec3::new(1.0, -3.0, 2.0));
    assert_near(placed("rotate = [90, 0, 90]", 0.0), Vec3::new(3.0, 1.0, 2.0));
    assert_near(
        placed("rotate = { axis = [0, 5, 0], degrees = 90 }\nscale = [1, 1, -1]", 0.0),
        Vec3::new(-3.0, 2.0, -1.0),
    );
    assert_near(placed("rotate = { quaternion = [0, 0, 1, 0] }", 0.0), Vec3::new(-1.0, -2.0, 3.0));
    assert_near(
        placed("matrix = [[0, 1, 0, 7], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]", 0.0),
        Vec3::new(9.0, 1.0, 3.0),
    );
    assert_near(
        placed("matrix = [1, 0, 0, 7, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]", 0.0),
        Vec3::new(8.0, 2.0, 3.0),
    );
}

#[test]
fn a_whole_turn_between_two_keyframes_is_one() {
    let spin = "keyframes = [{ time = 0 }, { time = 4, rotate = [0, 360, 0], translate = [8, 0, 0] }]";
    for (time, expected) in [
        (0.0, Vec3::new(1.0, 2.0, 3.0)),
        (1.0, Vec3::new(2.0 + 3.0, 2.0, -1.0)),
        (2.0, Vec3::new(4.0 - 1.0, 2.0, -3.0)),
        (3.0, Vec3::new(6.0 - 3.0, 2.0, 1.0)),
        (9.0, Vec3::new(9.0, 2.0, 3.0)),
    ] {
        assert_near(placed(spin, time), expected);
    }
    // It grows meanwhile, evenly.
    let grows = "keyframes = [{ time = 0 }, { time = 4, rotate = [0, 360, 0], scale = [3, 1, 5] }]";
    assert_near(placed(grows, 1.0), Vec3::new(2.0 * 3.0, 2.0, -1.5));
    assert_near(placed(grows, 2.0), Vec3::new(-2.0, 2.0, -9.0));
    let axis = "keyframes = [{ time = 0, rotate = { axis = [0, 1, 0], degrees = 0 } }, { time = 2, rotate = { axis = [0, 1, 0], degrees = 180 } }]";
    assert_near(placed(axis, 1.0), Vec3::new(3.0, 2.0, -1.0));
}

#[test]
fn scenes_in_scenes_are_moved_as_one() {
    let inner = "[[model]]\nshape = \"box\"\ntranslate = [1, 0, 0]\n";
    let outer = |place: &str| format!("[[model]]\nfile = \"inner.toml\"\n{place}\n");
    let place = |text: &str, time| {
        let scene = read_files(&[("main.toml", &outer(text)), ("inner.toml", inner)]).unwrap();
        scene.objects[0].motion.at(time).bounds(&scene.objects[0].mesh.bounds()).centre()
    };
    assert_near(place("rotate = [0, 0, 90]", 0.0), Vec3::Y);
    assert_near(
        place("keyframes = [{ time = 0 }, { time = 1, translate = [0, 0, 5] }]", 1.0),
        Vec3::new(1.0, 0.0, 5.0),
    );
    // It stands on a turntable that turns by 90 degrees: an arc of radius 1, not its chord.
    let (sin, cos) = sin_cos(30f32.to_radians());
    let turntable = "keyframes = [{ time = 0 }, { time = 1, rotate = [0, 0, 90] }]";
    assert_near(place(turntable, 1.0 / 3.0), Vec3::new(cos, sin, 0.0));
}

#[test]
fn what_moves_within_what_moves_is_interpolated_first_and_placed_then() {
    // An arm that swings by 90 degrees about its end at x = 2, on a table that turns by 180 degrees meanwhile, in a room
    // that is squeezed to a half across y.
    let arm = "[[model]]\nshape = \"box\"\nname = \"arm\"\nkeyframes = [{ time = 0 }, { time = 1, rotate = [0, 0, 90] }]\n";
    let table = "[[model]]\nfile = \"arm.toml\"\nkeyframes = [{ time = 0, translate = [2, 0, 0] }, { time = 1, translate = [2, 0, 0], scale = 3 }]\n";
    let room = "[[model]]\nfile = \"table.toml\"\nkeyframes = [{ time = 0 }, { time = 1, rotate = { axis = [0, 0, 1], degrees = 170 } }]\n";
    let main = "[[model]]\nfile = \"room.toml\"\nscale = [1, 0.5, 1]\n";
    let files = [("main.toml", main), ("room.toml", room), ("table.toml", table), ("arm.toml", arm)];
    let scene = read_files(&files).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let back = there_and_back(&scene, folder.path());
    assert!(back.objects[0].name.contains("arm"), "{}", back.objects[0].name);
    for time in [0.0f32, 0.25, 0.4, 1.0] {
        let (up, along) = sin_cos((90.0 * time).to_radians());
        let grown = 1.0 + 2.0 * time;
        let p = Vec3::new(2.0 + grown * along, grown * up, 0.0);
        let (sin, cos) = sin_cos((170.0 * time).to_radians());
        let expected = Vec3::new(cos * p.x - sin * p.y, 0.5 * (sin * p.x + cos * p.y), 0.0);
        for scene in [&scene, &back] {
            assert_near(scene.objects[0].motion.at(time).point(Vec3::X), expected);
        }
    }
    // glTF files have a node for each, and are read at one time.
    let path = folder.path().join("nested.glb");
    write(&path, &scene, &WriteOptions::default()).unwrap();
    for time in [0.25, 1.0] {
        let read = read(&path, &ReadOptions { time, ..ReadOptions::default() }).unwrap();
        let [ours, theirs] = [&scene, &read].map(|scene| scene.objects[0].motion.at(time).point(Vec3::ONE));
        assert!(ours.abs_diff_eq(theirs, 1e-4), "{time}: {ours} {theirs}");
    }
}

#[test]
fn includes_come_once_and_the_including_file_has_the_last_word() {
    let main = "include = [\"a.toml\", \"sub/b.toml\"]\n[render]\nspp = 9\n[[model]]\nshape = \"box\"\nmaterial = \"red\"\n";
    let scene = read_files(&[
        ("main.toml", main),
        ("a.toml", "[render]\nspp = 1\nseed = 3\n[[material]]\nname = \"red\"\nkind = \"diffuse\"\nreflectance = [1, 0, 0]\n"),
        ("sub/b.toml", "include = [\"../a.toml\"]\n[[model]]\nfile = \"t.obj\"\nmaterial = \"red\"\n"),
        ("sub/t.obj", OBJ),
    ])
    .unwrap();
    assert_eq!(scene.settings.find("spp").unwrap().0, &Value::Integer(9));
    assert_eq!(scene.settings.find("seed").unwrap().0, &Value::Integer(3));
    assert_eq!(scene.objects.len(), 3);
}

#[test]
fn cycles_are_refused() {
    let message = file_refusal(&[("a.toml", "include = [\"b.toml\"]"), ("b.toml", "include = [\"a.toml\"]")]);
    assert!(message.contains("b.toml:1:12") && message.contains("includes itself"), "{message}");
    let message = file_refusal(&[
        ("a.toml", "[[model]]\nfile = \"b.toml\""),
        ("b.toml", "[[model]]\nfile = \"a.toml\""),
    ]);
    assert!(message.contains("b.toml:2:8") && message.contains("contains itself"), "{message}");
    // Each level doubles the objects: 2^12 of them are a scene, and 2^60 exceed the memory limit.
    let chain = |depth: usize| {
        let mut files: Vec<(String, String)> = (0..depth)
            .map(|i| {
                (
                    format!("{i}.toml"),
                    format!("[[model]]\nfile = \"{n}.toml\"\n[[model]]\nfile = \"{n}.toml\"\n", n = i + 1),
                )
            })
            .collect();
        files.push((format!("{depth}.toml"), "[[model]]\nshape = \"quad\"".to_owned()));
        let files: Vec<(&str, &str)> = files.iter().map(|(a, b)| (&**a, &**b)).collect();
        read_files(&files).map(|scene| scene.objects.len())
    };
    assert_eq!(chain(12).unwrap(), 4096);
    assert!(chain(60).is_err());
}

#[test]
fn nothing_outside_the_folder_is_opened() {
    let outer = tempfile::tempdir().unwrap();
    std::fs::create_dir(outer.path().join("inner")).unwrap();
    std::fs::write(outer.path().join("t.obj"), OBJ).unwrap();
    let path = outer.path().join("inner/main.toml");
    std::fs::write(&path, "[[model]]\nfile = \"../t.obj\"\n").unwrap();
    let message = read(&path, &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("main.toml:2:8") && message.contains("outside the scene's folder"), "{message}");
    assert!(read(&path, &ReadOptions { allow_outside: true, ..Default::default() }).is_ok());
}

#[test]
fn errors_state_the_location_and_the_nearest_name() {
    let cases = [
        (
            "[[modle]]\nshape = \"box\"\n",
            "scene.toml:1:3: there is no key 'modle' of a scene; did you mean 'model'?",
        ),
        (
            "[[model]]\nshape = \"box\"\nmaterail = \"x\"\n",
            "scene.toml:3:1: there is no key 'materail' of a model made of 'box'; did you mean 'material'?",
        ),
        ("[[model]]\nshape = \"boks\"\n", "scene.toml:2:9: there is no shape 'boks'; did you mean 'box'?"),
        (
            "[[model]]\ngenerate = \"teapod\"\n",
            "scene.toml:2:12: there is no built-in scene 'teapod'; did you mean 'teapot'?",
        ),
        ("[[model]]\nshape = \"box\"\nmaterial = \"x\"\n", "scene.toml:3:12: there is no material 'x'"),
        ("[[model]]\nname = \"x\"\n", "scene.toml:1:1: one of file, shape or generate"),
        (
            "[[model]]\nshape = \"sphere\"\nradius = -1\n",
            "scene.toml:3:1: sphere.radius is -1, but must be a number from",
        ),
        (
            "[[model]]\nshape = \"box\"\nscale = 0\n",
            "scene.toml:1:1: this transform is not valid: no scale may be 0",
        ),
        (
            "[[model]]\nshape = \"box\"\ntranslate = [1, 2]\n",
            "scene.toml:3:13: translate is a list of 2, but must be three numbers",
        ),
        ("[[model]]\nshape = \"box\"\nmatrix = 1\n", "scene.toml:3:10: matrix is 1, but must be four rows"),
        (
            "[[model]]\nshape = \"box\"\nmatrix = [1, 1, 1, 1]\nscale = 2\n",
            "scene.toml:3:10: 'matrix' cannot be combined with translate",
        ),
        ("[[model]]\nshape = \"box\"\nkeyframes = [{ time = 1 }, { time = 1 }]\n", "times must increase"),
        (
            "[[model]]\nshape = \"box\"\nkeyframes = [{ scale = 1 }]\n",
            "scene.toml:3:14: time (of the keyframe, in seconds) is missing: add it",
        ),
        (
            "[[model]]\nshape = \"box\"\nkeyframes = [{ time = 0 }, { time = 1, rotate = [1e30, 0, 0] }]\n",
            "add keyframes in between",
        ),
        ("[[material]]\nkind = \"phong\"\n", "scene.toml:1:1: name (what models call the material)"),
        (
            "[[material]]\nname = \"a\"\n",
            "scene.toml:1:1: kind (of the material: phong, diffuse, translucent, mirror, conductor, dielectric, interface, principled, mix)",
        ),
        ("[[material]]\nname = \"a\"\nkind = \"glas\"\n", "scene.toml:3:8: there is no material 'glas'"),
        (
            "[[material]]\nname = \"a\"\nkind = \"phong\"\nexponnent = 3\n",
            "scene.toml:4:1: there is no key 'exponnent' of the material 'phong'; did you mean 'exponent'?",
        ),
        (
            "[[material]]\nname = \"a\"\nkind = \"phong\"\nkd = 2\n",
            "scene.toml:4:1: phong.kd is 2, but must be a colour",
        ),
        (
            "[[material]]\nname = \"a\"\nkind = \"phong\"\n[[material]]\nname = \"a\"\nkind = \"phong\"\n",
            "scene.toml:4:1: there is already a material 'a', at scene.toml:1:1",
        ),
        (
            "[[light]]\nkind = \"point\"\npostion = [1, 1, 1]\n",
            "scene.toml:3:1: there is no key 'postion' of the light 'point'; did you mean 'position'?",
        ),
        (
            "[camera]\nkeyframes = [{ time = 0, fow = 3 }]\n",
            "scene.toml:2:26: there is no key 'fow' of a camera's keyframe; did you mean 'fov'?",
        ),
        ("[camera]\nposition = 2020-01-01\n", "scene.toml:2:12: scenes do not use dates"),
        ("[render]\nspp = { a = 1 }\n", "scene.toml:2:7: spp is a table"),
        ("[render\n", "scene.toml:1:8: this is not valid TOML"),
        ("a = \"\u{0}\"", "this is not valid TOML"),
        ("include = \"x.toml\"\n", "scene.toml:1:11: include is \"x.toml\", but must be a list of files"),
        ("model = 3\n", "scene.toml:1:9: model is 3, but must be a table"),
    ];
    for (text, part) in cases {
        let message = refusal("toml", text);
        assert!(message.contains(part), "{text:?}: {message}");
    }
    let message =
        bilux_formats::read_bytes(b"a = '\xff'", "toml", None, "x", &ReadOptions::default()).unwrap_err();
    assert!(message.to_string().starts_with("x:1:6: a TOML file must be UTF-8"), "{message}");
    let message = file_refusal(&[("a.toml", "[[model]]\nfile = \"none.obj\"\n")]);
    assert!(message.contains("a.toml:2:8: there is no file 'none.obj' in"), "{message}");
}

#[test]
fn textures_are_read_and_missing_ones_are_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let picture = bilux_pictures::Picture::from_rgb(1, 1, vec![Rgb::new(0.0, 1.0, 0.0)]).unwrap();
    bilux_pictures::write(folder.path().join("t.png"), &picture, &Default::default()).unwrap();
    let path = folder.path().join("main.toml");
    let material = |file: &str| {
        format!("[[material]]\nname = \"m\"\nkind = \"diffuse\"\nreflectance = {{ texture = \"{file}\" }}\n")
    };
    std::fs::write(&path, material("t.png")).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(scene.materials[0].parameters.find("reflectance").unwrap().0, &Value::Texture(0));
    assert_eq!(scene.textures[0].texel(0, 0), Rgb::new(0.0, 1.0, 0.0));
    std::fs::write(&path, material("no.png")).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert!(
        warnings(&scene)
            .contains("main.toml:4:27: a texture is replaced by a magenta checker: there is no file"),
        "{}",
        warnings(&scene)
    );
    assert_eq!(scene.textures[0].texel(0, 0), Rgb::new(1.0, 0.0, 1.0));
    assert!(read(&path, &ReadOptions { strict: true, ..Default::default() }).is_err());
}

#[test]
fn picture_placements_round_trip() {
    let folder = tempfile::tempdir().unwrap();
    let texels = (0..6).map(|i| Rgb::grey(i as f32 / 5.0)).collect();
    let picture = bilux_pictures::Picture::from_rgb(3, 2, texels).unwrap();
    bilux_pictures::write(folder.path().join("t.png"), &picture, &Default::default()).unwrap();
    let read_with = |says: &str| {
        let path = folder.path().join("main.toml");
        let text = format!(
            "[[material]]\nname = \"m\"\nkind = \"diffuse\"\nreflectance = {{ texture = \"t.png\"{says} }}\nopacity = {{ \
             texture = \"t.png\", channel = \"g\"{says} }}\n[[model]]\nshape = \"sphere\"\nmaterial = \"m\"\n"
        );
        std::fs::write(&path, text).unwrap();
        read(&path, &ReadOptions::default())
    };
    let turned = ", u_scale = 1.5, v_scale = -2, turn = 30, u_offset = 0.125, v_offset = 0.4";
    for says in [
        "",
        turned,
        ", wrap_u = \"mirror\", wrap_v = \"clamp\"",
        ", filter = \"nearest\"",
        ", threshold = 0.5",
    ] {
        let scene = read_with(says).unwrap();
        let path = folder.path().join("back.toml");
        let reported = bilux_formats::write(&path, &scene, &Default::default()).unwrap();
        assert!(reported.is_empty(), "{says}: {reported:?}");
        let back = read(&path, &ReadOptions::default()).unwrap();
        for (one, other) in scene.textures.iter().zip(&back.textures) {
            for i in 0..100 {
                let uv = Vec2::new(i as f32 * 0.137 - 5.0, i as f32 * 0.071 - 3.0);
                let off = one.at(uv).g - other.at(uv).g;
                assert!(off.abs() < 1e-4, "{says} at {uv}: {off}");
            }
        }
    }
    let plain = read_with("").unwrap();
    let lies = read_with(turned).unwrap();
    // A quarter of the way along u, with v = 0: scaled, rotated by 30 degrees, shifted.
    let (c, s) = (0.75f32.sqrt(), 0.5);
    let moved = Vec2::new(0.375 * c + 0.125, 0.375 * s + 0.4);
    let found = lies.textures[0].at(Vec2::new(0.25, 0.0)).g - plain.textures[0].at(moved).g;
    assert!(found.abs() < 1e-5, "{found}");
    let refused = |says: &str| read_with(says).unwrap_err().to_string();
    assert!(refused(", wrap_u = \"repaet\"").contains("repeat"), "{}", refused(", wrap_u = \"repaet\""));
    assert!(refused(", uscale = 2").contains("u_scale"), "{}", refused(", uscale = 2"));
    assert!(refused(", uv_set = 3").contains("uv_set"), "{}", refused(", uv_set = 3"));
}

#[test]
fn glass_has_a_name_or_numbers_and_not_both() {
    for (lines, wanted) in [
        ("glass = \"bk7\"\neta = 1.4", "'glass' and 'eta' both define the material"),
        ("glass = \"bk7\"\ndispersion = 1", "'glass' and 'dispersion' both define"),
        ("glass = \"bk8\"", "did you mean 'bk7'?"),
    ] {
        let glass = format!(
            "[[material]]\nname = \"m\"\nkind = \"dielectric\"\n{lines}\n[[model]]\nshape = \"sphere\"\nmaterial = \"m\"\n"
        );
        let reported = match read_text("toml", &glass) {
            Ok(scene) => scene.build(&Default::default(), [0.0, 0.0], 1.0).map(drop).unwrap_err().to_string(),
            Err(error) => error.to_string(),
        };
        assert!(reported.contains(wanted), "{lines}: {reported}");
    }
}

#[test]
fn textures_of_numbers_are_read_as_they_are_and_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut picture = bilux_pictures::Picture::from_rgb(1, 1, vec![Rgb::new(0.2, 0.4, 0.6)]).unwrap();
    picture.colour_space = bilux_pictures::ColourSpace::Srgb;
    bilux_pictures::write(folder.path().join("t.png"), &picture, &Default::default()).unwrap();
    let path = folder.path().join("main.toml");
    let write_material = |lines: &str| {
        let text = format!(
            "[[material]]\nname = \"m\"\nkind = \"dielectric\"\n{lines}\n[[model]]\nshape = \"box\"\n"
        );
        std::fs::write(&path, text).unwrap();
    };
    write_material(
        "roughness = { texture = \"t.png\" }\nanisotropy = { texture = \"t.png\", channel = \"g\" }\ntint = { texture = \"t.png\" }",
    );
    let scene = read(&path, &ReadOptions::default()).unwrap();
    let texels: Vec<(Rgb, bool)> = scene.textures.iter().map(|t| (t.texel(0, 0), t.is_data)).collect();
    assert_eq!(texels[..2], [(Rgb::new(0.2, 0.4, 0.6), true), (Rgb::grey(0.4), true)]);
    // Colours are still decoded.
    assert!((texels[2].0.g - 0.1329).abs() < 1e-3 && !texels[2].1, "{texels:?}");
    scene.build(&Default::default(), [0.0, 0.0], 1.0).unwrap();
    let back = there_and_back(&scene, folder.path());
    assert!(back.textures[0].texels().eq(scene.textures[0].texels()));
    assert!((back.textures[2].texel(0, 0).g - texels[2].0.g).abs() < 1e-6);
    for (lines, wanted) in [
        ("eta = { texture = \"t.png\" }", "eta is a texture, but must be a number from 0.1 to 10"),
        ("tint = { texture = \"t.png\", channel = \"r\" }", "channel"),
        ("roughness = { texture = \"t.png\", channel = \"red\" }", "there is no channel 'red'"),
        ("roughness = 2", "must be a number from 0 to 1, or { texture = \"FILE\" }"),
    ] {
        write_material(lines);
        let message = read(&path, &ReadOptions::default()).unwrap_err().to_string();
        assert!(message.contains(wanted), "{lines}: {message}");
    }
}

fn there_and_back(scene: &SceneBuilder, folder: &Path) -> SceneBuilder {
    // No scene is written over a file that it was read from.
    let path = folder.join(format!("out-{}.toml", std::fs::read_dir(folder).unwrap().count()));
    assert_eq!(write(&path, scene, &WriteOptions::default()).unwrap(), []);
    read(&path, &ReadOptions::default()).unwrap()
}

#[test]
fn whole_scenes_come_back() {
    let folder = tempfile::tempdir().unwrap();
    let moving = "[[model]]\nshape = \"box\"\nscale = [1, 2, 3]\nkeyframes = [{ time = 0 }, { time = 1, rotate = [10, 20, 30] }]\n[[model]]\nshape = \"box\"\nrotate = [1, 2, 3]\ninstance = true\n[[camera.keyframes]]\ntime = 2.5\nfov = 30\n";
    let generated = "[[model]]\ngenerate = \"teapots\"\ncount = 2\nper_vertex = true\nmoving = true\nwith = [\"lights\", \"cameras\"]\n";
    for text in [SCENE, moving, generated] {
        let scene = read_text("toml", text).unwrap();
        let back = there_and_back(&scene, folder.path());
        let again = there_and_back(&back, folder.path());
        for other in [&back, &again] {
            let values = |p: &bilux_scene::Parameters| {
                p.0.iter().map(|(k, v, _)| (k.clone(), format!("{v:?}"))).collect::<Vec<_>>()
            };
            assert_eq!(values(&scene.settings), values(&other.settings));
            let specs = |all: &[bilux_scene::Spec]| {
                all.iter().map(|s| (s.name.clone(), s.kind.clone(), s.parameters.0.len())).collect::<Vec<_>>()
            };
            assert_eq!(specs(&scene.materials), specs(&other.materials));
            assert_eq!(specs(&scene.lights), specs(&other.lights));
            assert_eq!(scene.cameras.len(), other.cameras.len());
            assert_eq!(scene.objects.len(), other.objects.len());
            for (a, b) in scene.objects.iter().zip(&other.objects) {
                assert_eq!((&a.name, a.material, a.instanced), (&b.name, b.material, b.instanced));
                assert!(crate::round_trips::corners(&a.mesh) == crate::round_trips::corners(&b.mesh));
                for time in [0.0, 0.3, 1.0, 5.0] {
                    let (p, q) = (a.motion.at(time).point(Vec3::ONE), b.motion.at(time).point(Vec3::ONE));
                    assert!((p - q).length() <= 1e-6 * p.length(), "{p} {q}");
                }
            }
        }
        assert_eq!(back.textures.len(), again.textures.len());
    }
}

#[test]
fn missing_files_and_folders_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let missing = read(&folder.path().join("none.obj"), &ReadOptions::default()).unwrap_err().to_string();
    assert!(missing.contains("none.obj: cannot open it"), "{missing}");
    let message = read(folder.path(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("this is a folder: name a scene file in it"), "{message}");
    std::fs::create_dir(folder.path().join("t.obj")).unwrap();
    let message = file_refusal(&[("a.toml", "[[model]]\nfile = \".\"\n")]);
    assert!(message.contains("there is no file '.'"), "{message}");
    let unknown = folder.path().join("scene.objj");
    std::fs::write(&unknown, "hello").unwrap();
    let message = read(&unknown, &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("did you mean 'obj'?"), "{message}");
    std::fs::write(&unknown, OBJ).unwrap();
    assert!(read(&unknown, &ReadOptions::default()).is_ok(), "the bytes tell what the extension does not");
}

#[test]
fn many_settings_and_names_are_no_burden() {
    let many: String = (0..2000).map(|i| format!("k{i} = 1\n")).collect();
    assert!(refusal("toml", format!("[render]\n{many}")).contains("more than 1000 settings"));
    let library: String = (0..20_000).map(|i| format!("newmtl m\nNs {i}\n")).collect();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.mtl"), library).unwrap();
    std::fs::write(folder.path().join("m.obj"), format!("mtllib m.mtl\n{OBJ}")).unwrap();
    let scene = read(&folder.path().join("m.obj"), &ReadOptions::default()).unwrap();
    write(&folder.path().join("n.obj"), &scene, &WriteOptions::default()).unwrap();
    let back = read(&folder.path().join("n.obj"), &ReadOptions::default()).unwrap();
    assert_eq!(back.materials.len(), scene.materials.len());
}

#[test]
fn the_schema_knows_what_the_reader_knows() {
    let spp = Parameter {
        name: "spp",
        summary: "samples",
        unit: "",
        kind: ParameterKind::Integer { min: 1, max: 9 },
        default: "4",
    };
    let schema = toml_schema(&[spp]);
    let text = schema.to_string();
    assert_eq!(schema["properties"]["render"]["properties"]["spp"]["maximum"], 9);
    assert_eq!(schema["properties"]["render"]["properties"]["spp"]["default"], 4);
    for word in [
        "dielectric",
        "perspective",
        "environment",
        "sphere",
        "teapots",
        "keyframes",
        "exponent",
        "quaternion",
    ] {
        assert!(text.contains(&format!("\"{word}\"")), "{word}");
    }
    let keys: Vec<&String> = schema["properties"].as_object().unwrap().keys().collect();
    assert_eq!(
        keys,
        ["include", "base", "render", "camera", "light", "material", "model", "replace", "change"]
    );
}

#[test]
fn the_examples_of_the_manual_are_scenes() {
    // Read when it runs, so that another text of the page builds nothing anew.
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/formats/scene-toml.md");
    let page = std::fs::read_to_string(page).unwrap();
    let examples: Vec<&str> = page
        .split("```toml\n")
        .skip(1)
        .filter_map(|rest| rest.split_once("```").map(|(text, _)| text))
        .collect();
    assert!(examples.len() >= 2);
    let folder = tempfile::tempdir().unwrap();
    let picture = bilux_pictures::Picture::from_rgb(1, 1, vec![Rgb::WHITE]).unwrap();
    bilux_pictures::write(folder.path().join("tiles.png"), &picture, &Default::default()).unwrap();
    std::fs::write(folder.path().join("pot.obj"), OBJ.replace("usemtl", "#")).unwrap();
    let car = OBJ.replacen("usemtl paint", "mtllib car.mtl\nusemtl Paint.001", 1).replace("usemtl wood", "#");
    std::fs::write(folder.path().join("car.obj"), car).unwrap();
    std::fs::write(folder.path().join("car.mtl"), "newmtl Paint.001\nKd 1 0 0\n").unwrap();
    std::fs::write(folder.path().join("lights.toml"), "[[light]]\nkind = \"point\"\n").unwrap();
    for example in examples {
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, example).unwrap();
        let scene = read(&path, &ReadOptions { strict: true, ..Default::default() }).unwrap();
        assert!(scene.build(&Default::default(), [0.0, 1.0], 1.0).is_ok());
    }
}

#[test]
fn materials_are_mixed_by_name_in_any_order() {
    let mix = "[[material]]\nname = \"m\"\nkind = \"mix\"\na = \"matte\"\nb = \"metal\"\namount = 0.3\n";
    let parts = "[[material]]\nname = \"matte\"\nkind = \"diffuse\"\n\
                 [[material]]\nname = \"metal\"\nkind = \"conductor\"\nmetal = \"gold\"\n";
    let model = "[[model]]\nshape = \"quad\"\nmaterial = \"m\"\n";
    let built = |text: &str| {
        let scene = read_text("toml", text)?;
        scene.build(&Default::default(), [0.0, 0.0], 1.0).map(|_| scene).map_err(FormatError::from)
    };
    let scene = built(&format!("{mix}{parts}{model}")).unwrap();
    let part = |key: &str| scene.materials[0].parameters.find(key).unwrap().0.clone();
    assert_eq!((part("a"), part("b")), (Value::Material(1), Value::Material(2)));
    let refusal = |text: &str| built(text).err().unwrap().to_string();
    let misspelt = refusal(&format!("{mix}{}", parts.replace("\"metal\"\nkind", "\"metall\"\nkind")));
    assert!(misspelt.contains("there is no material 'metal'; did you mean 'metall'?"), "{misspelt}");
    let itself = refusal(&format!("{}{parts}", mix.replace("\"matte\"", "\"m\"")));
    assert!(itself.contains("or contain themselves"), "{itself}");
    let phongs =
        parts.replace("\"diffuse\"", "\"phong\"").replace("\"conductor\"\nmetal = \"gold\"", "\"phong\"");
    let many = refusal(&format!("{mix}{phongs}"));
    assert!(many.contains("have 6 lobes together"), "{many}");
    let glowing = parts.replace("\"diffuse\"", "\"diffuse\"\nemission = 1");
    let glows = refusal(&format!("{mix}{glowing}"));
    assert!(glows.contains("'a' emits light"), "{glows}");
}

/// A grid in a scene that is written and read again has the same numbers in the same place.
#[test]
fn grids_are_written_beside_the_scene() {
    let turned = Transform::rotate(Vec3::new(1.0, 2.0, 3.0), 0.7).unwrap();
    let turned = turned.then(&Transform::translate(Vec3::new(0.5, -4.0, 2.0)).unwrap());
    for factor in [1.0, 1e9] {
        let values: Vec<f32> = (0..60).map(|i| (i % 7) as f32 * factor).collect();
        let grid = Arc::new(Grid::dense("smoke", [3, 4, 5], &turned, &values).unwrap());
        let mut scene = SceneBuilder::default();
        let spec = Spec::new("smoke", "interface").with("scattering", 2.0f32);
        let smoke = scene.add_material(spec.with("density", grid.clone()).with("temperature", grid.clone()));
        scene.objects.push(Object::new("box", Arc::new(Mesh::quad(Vec3::ZERO, Vec3::X, Vec3::Y)), smoke));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        write(&path, &scene, &WriteOptions::default()).unwrap();
        let files = std::fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(files, 3, "the scene, its meshes and one grid");
        let back = read(&path, &ReadOptions::default()).unwrap();
        for key in ["density", "temperature"] {
            let Some((Value::Grid(found), _)) = back.materials[0].parameters.find(key) else {
                panic!("{key}")
            };
            assert_eq!(found.stored().voxels, grid.stored().voxels);
            assert_eq!((found.size(), found.to_object()), (grid.size(), grid.to_object()));
        }
    }
}

/// A file name where a texture may be: the message says how one is written, for colours, numbers and normals alike.
#[test]
fn a_bare_file_name_says_how_textures_are_written() {
    for (kind, key, name) in [
        ("diffuse", "reflectance", "wood.png"),
        ("principled", "specular_roughness", "maps/rough.EXR"),
        ("principled", "normal", "bumps.jpg"),
    ] {
        let text = format!("[[material]]\nname = \"a\"\nkind = \"{kind}\"\n{key} = \"{name}\"\n");
        let message = refusal("toml", &text);
        assert!(message.contains(&format!("{key} = {{ texture = \"{name}\" }}")), "{message}");
        assert!(message.contains(":4:"), "{message}");
    }
}
