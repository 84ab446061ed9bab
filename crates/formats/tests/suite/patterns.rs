//! Procedural textures in native files and in pbrt files, and as images in formats without them.

use crate::{read_text, refusal, warnings};
use bilux_formats::{ReadOptions, WriteOptions, read, write};
use bilux_math::{Rgb, Vec2};
use bilux_scene::{SceneBuilder, Texture, Value};
use std::path::Path;
use std::sync::Arc;

fn material(lines: &str) -> String {
    format!(
        "[[material]]\nname = \"m\"\nkind = \"diffuse\"\n{lines}\n[[model]]\nshape = \"box\"\nmaterial = \"m\"\n"
    )
}

/// The texture of the only material.
fn texture(scene: &SceneBuilder, key: &str) -> Arc<Texture> {
    match scene.materials[scene.objects[0].material].parameters.find(key) {
        Some((Value::Texture(index), _)) => scene.textures[*index].clone(),
        other => panic!("{other:?}"),
    }
}

/// Positions all over the texture, none of them on an edge.
fn places() -> impl Iterator<Item = Vec2> {
    (0..400).map(|i| Vec2::new((i % 20) as f32 * 0.0973 - 0.41, (i / 20) as f32 * 0.0871 - 0.32))
}

const ALL: &str = r#"reflectance = { kind = "mix", a = { kind = "scale", a = { texture = "t.png" }, b = [0.5, 1, 0.25] }, b = { kind = "noise", a = [0.1, 0, 0], b = 0.75, octaves = 3, seed = 9, u_offset = 0.5 }, amount = { kind = "ramp", stops = [[0, 0], [0.25, [1, 1, 1]]], along = "radius", v_scale = 2 } }
roughness = { kind = "checker", a = { texture = "t.png", channel = "g" }, b = 1, u_scale = 3 }"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let texels = vec![Rgb::new(1.0, 0.5, 0.25), Rgb::new(0.0, 0.125, 1.0)];
    let picture = bilux_pictures::Picture::from_rgb(2, 1, texels).unwrap();
    bilux_pictures::write(folder.path().join("t.png"), &picture, &Default::default()).unwrap();
    folder
}

#[test]
fn nested_procedural_textures_round_trip() {
    let folder = folder();
    let path = folder.path().join("s.toml");
    std::fs::write(&path, material(ALL)).unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(warnings(&scene), "");
    let reflectance = texture(&scene, "reflectance");
    // At the centre of the radial ramp, b contributes nothing, and a is the tinted image.
    let a = reflectance.at(Vec2::new(0.5, 0.25));
    let middle = bilux_math::colour::srgb_decode(bilux_math::colour::srgb_encode(0.5));
    assert!((a.g - 0.5 * (middle + 0.125)).abs() < 0.01 && (a.r - 0.25).abs() < 0.01, "{a:?}");
    let roughness = texture(&scene, "roughness");
    assert_eq!(roughness.number(Vec2::new(0.5, 0.01)), 1.0);
    // A nested file holds numbers, like the texture around it: the byte, without a transfer curve.
    let byte = (bilux_math::colour::srgb_encode(0.5) * 255.0).round() / 255.0;
    assert!((roughness.number(Vec2::new(0.25, 0.01)) - byte).abs() < 1e-6);
    scene.build(&Default::default(), [0.0, 0.0], 1.0).unwrap();
    let out = folder.path().join("out.toml");
    assert_eq!(write(&out, &scene, &WriteOptions::default()).unwrap(), []);
    let back = read(&out, &ReadOptions::default()).unwrap();
    for key in ["reflectance", "roughness"] {
        let (before, after) = (texture(&scene, key), texture(&back, key));
        assert!(after.formula().is_some());
        let off = |uv| (before.at(uv) - after.at(uv)).map(f32::abs).max_channel();
        assert!(places().all(|uv| off(uv) < 1e-6), "{key}");
    }
}

/// Other formats scale textures without a formula for that.
#[test]
fn factors_on_procedural_textures_are_written() {
    let folder = folder();
    let mut scene = read_text("toml", material("reflectance = { kind = \"checker\", b = 0.5 }")).unwrap();
    let factor = Rgb::new(0.5, 0.25, 1.0);
    Arc::make_mut(scene.textures.last_mut().unwrap()).factor = factor;
    let out = folder.path().join("out.toml");
    assert_eq!(write(&out, &scene, &WriteOptions::default()).unwrap(), []);
    let (before, back) = (texture(&scene, "reflectance"), read(&out, &ReadOptions::default()).unwrap());
    let after = texture(&back, "reflectance");
    assert!(after.formula().is_some() && before.at(Vec2::new(0.01, 0.01)) == factor);
    assert!(places().all(|uv| before.at(uv) == after.at(uv)));
}

#[test]
fn faults_have_a_location() {
    for (lines, wanted) in [
        (
            "reflectance = { kind = \"nose\" }",
            "scene.toml:4:24: there is no texture 'nose'; did you mean 'noise'?",
        ),
        (
            "reflectance = { kind = \"noise\", octave = 2 }",
            "scene.toml:4:33: there is no key 'octave' of the texture 'noise'; did you mean 'octaves'?",
        ),
        (
            "reflectance = { kind = \"noise\", octaves = 99 }",
            "noise.octaves is 99, but must be a whole number from 1 to 16",
        ),
        (
            "reflectance = { kind = \"noise\", octaves = { kind = \"checker\" } }",
            "noise.octaves is a texture",
        ),
        ("reflectance = { kind = \"ramp\", stops = [[1, 0], [0, 1]] }", "whose positions never decrease"),
        ("reflectance = { kind = \"ramp\" }", "ramp.stops"),
        ("reflectance = { kind = \"mix\", a = -1 }", "scene.toml:4:31: mix.a is -1"),
        (
            "reflectance = { kind = \"mix\", a = { kind = \"scale\", b = { kind = \"x\" } } }",
            "there is no texture 'x'",
        ),
        ("reflectance = { colour = 1 }", "colour"),
        ("reflectance = {}", "texture (a file), or kind (checker, ramp, noise, mix, scale)"),
    ] {
        let reported = refusal("toml", material(lines));
        assert!(reported.contains(wanted), "{lines}: {reported}");
    }
    // A missing texture inside another one gives a warning, and is visible.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.toml");
    std::fs::write(
        &path,
        material("reflectance = { kind = \"scale\", a = 0.5, b = { texture = \"no.png\" } }"),
    )
    .unwrap();
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert!(warnings(&scene).contains("a texture is replaced by a magenta checker"), "{}", warnings(&scene));
    assert_eq!(texture(&scene, "reflectance").at(Vec2::new(0.05, 0.95)), Rgb::new(0.5, 0.0, 0.5));
}

fn written(scene: &SceneBuilder, folder: &Path, extension: &str) -> (String, SceneBuilder) {
    let path = folder.join(format!("out.{extension}"));
    let reported = write(&path, scene, &WriteOptions::default()).unwrap();
    let reported = reported.into_iter().map(|warning| warning.message + "\n").collect();
    (reported, read(&path, &ReadOptions::default()).unwrap())
}

#[test]
fn formats_without_procedural_textures_get_images() {
    let folder = tempfile::tempdir().unwrap();
    let board =
        "reflectance = { kind = \"checker\", a = [1, 0, 0], b = [0, 0, 1], u_scale = 3, v_offset = 0.5 }";
    let clouds = "reflectance = { kind = \"noise\", octaves = 2 }";
    let is_reported = |reported: &str| reported.contains("cannot store procedural textures");
    for (extension, key) in [("pbrt", "reflectance"), ("glb", "base_color"), ("obj", "kd")] {
        let scene = read_text("toml", material(board)).unwrap();
        let (reported, back) = written(&scene, folder.path(), extension);
        // If textures can have a placement, a checkerboard needs two texels by two; all else is written as many
        // texels.
        assert_eq!(is_reported(&reported), extension == "obj", "{extension}: {reported}");
        let (before, after) = (texture(&scene, "reflectance"), texture(&back, key));
        if extension != "obj" {
            let off = |uv| (before.at(uv) - after.at(uv)).map(f32::abs).max_channel();
            assert!(places().all(|uv| off(uv) < 1e-5), "{extension}");
        }
        let scene = read_text("toml", material(clouds)).unwrap();
        let (reported, back) = written(&scene, folder.path(), extension);
        assert!(
            is_reported(&reported)
                && reported.contains("'noise' is written as a repeating picture of 1024 x 1024"),
            "{reported}"
        );
        let (before, after) = (texture(&scene, "reflectance"), texture(&back, key));
        let within = places().filter(|uv| uv.min_element() > 0.01 && uv.max_element() < 0.99);
        let off = |uv| (before.at(uv) - after.at(uv)).map(f32::abs).max_channel();
        assert!(within.map(off).fold(0.0, f32::max) < 0.02, "{extension}");
    }
    // A checkerboard next to another texture needs many texels too, since both may have to share one image.
    let two = format!("{board}\nroughness = {{ kind = \"checker\" }}");
    let (reported, _) = written(&read_text("toml", material(&two)).unwrap(), folder.path(), "glb");
    assert!(is_reported(&reported), "{reported}");
    // Formats without textures do not warn about them.
    let (reported, _) = written(&read_text("toml", material(clouds)).unwrap(), folder.path(), "ply");
    assert!(!is_reported(&reported), "{reported}");
}

#[test]
fn pbrt_textures_become_procedural_textures() {
    let of = |lines: &str| {
        let text = format!(
            "WorldBegin\n{lines}\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nShape \"disk\"\n"
        );
        let scene = read_text("pbrt", text).unwrap();
        assert_eq!(warnings(&scene), "", "{lines}");
        texture(&scene, "reflectance")
    };
    let checker = r#"Texture "c" "spectrum" "checkerboard" "float uscale" 4 "float vdelta" .5 "rgb tex1" [.5 0 0] "rgb tex2" [0 0 .5]"#;
    let board = of(&checker.replace("\"c\"", "\"t\""));
    assert_eq!(board.formula().unwrap().spec().kind, "checker");
    for uv in places() {
        let is_first = ((4.0 * uv.x).floor() + (uv.y + 0.5).floor()).rem_euclid(2.0) == 0.0;
        let wanted = if is_first { Rgb::new(0.5, 0.0, 0.0) } else { Rgb::new(0.0, 0.0, 0.5) };
        assert_eq!(board.at(uv), wanted, "{uv}");
    }
    let mixed = of(&format!(
        "{checker}\nTexture \"t\" \"spectrum\" \"mix\" \"texture tex1\" \"c\" \"rgb tex2\" [1 1 1] \"float amount\" .25"
    ));
    assert_eq!(mixed.formula().unwrap().spec().kind, "mix");
    assert_eq!(mixed.at(Vec2::new(0.1, 0.1)), board.at(Vec2::new(0.1, 0.1)) * 0.75 + Rgb::grey(0.25));
    let product = of(&format!(
        "{checker}\nTexture \"t\" \"spectrum\" \"scale\" \"texture tex1\" \"c\" \"texture tex2\" \"c\""
    ));
    assert_eq!(product.formula().unwrap().spec().kind, "scale");
    // Doubled thirty-one times: baking avoids 2³¹ evaluations.
    let mut lines = checker.replace("\"c\"", "\"t0\"");
    for i in 1..31 {
        let part = format!("\"texture tex1\" \"t{}\" \"texture tex2\" \"t{}\"", i - 1, i - 1);
        lines.push_str(&format!("\nTexture \"t{i}\" \"spectrum\" \"mix\" {part}"));
    }
    let doubled = of(&lines.replace("\"t30\"", "\"t\""));
    assert!((doubled.at(Vec2::new(0.1, 0.1)) - Rgb::new(0.5, 0.0, 0.0)).max_channel() < 1e-3);
}

#[test]
fn every_scene_that_we_ship_is_read_without_a_warning() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let scene = read(&path, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(warnings(&scene), "", "{}", path.display());
            count += 1;
        }
    }
    assert!(count > 5);
}
