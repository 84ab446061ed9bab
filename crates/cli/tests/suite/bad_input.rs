//! The mistakes that newcomers make, and whether the answer says what is wrong, where, and what to do.

use assert_cmd::Command;
use std::path::Path;
use tempfile::TempDir;

const PLAIN: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// Renders a file of this name; returns the exit status and what is printed to standard error.
fn render(folder: &Path, scene: &str, more: &[&str]) -> (i32, String) {
    let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
    let always = ["render", scene, "--spp", "1", "--progress", "none"];
    command.current_dir(folder).args(always).args(more);
    if !more.contains(&"-o") {
        command.args(["-o", "out.png"]);
    }
    if !more.contains(&"--size") {
        command.args(["--size", "8x8"]);
    }
    let output = command.output().unwrap();
    assert!(output.stdout.is_empty());
    (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
}

#[track_caller]
fn assert_reports((code, said): (i32, String), expected: i32, parts: &[&str]) {
    assert_eq!(code, expected, "{said}");
    for part in parts {
        assert_eq!(said.matches(part).count(), 1, "once '{part}' in: {said}");
    }
}

#[test]
fn files_that_are_not_scenes_are_refused_in_one_sentence() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let write = |name: &str, bytes: &[u8]| std::fs::write(path.join(name), bytes).unwrap();
    std::fs::create_dir(path.join("folder.obj")).unwrap();
    write("empty.obj", b"");
    write("cut.obj", b"v 0 0 0\nv 1 0 0\nv 0 1");
    write("cut.asc", b"triangle\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 0 0\n0 1 0 0");
    write("program.asc", &[0x7f, b'E', b'L', b'F', 2, 1, 1, 0, 0, b'\n', b'9', b' ', b'x', b'\n']);
    write("program.obj", &[0x7f, b'E', b'L', b'F', 2, 1, 1, 0, 0]);
    write("index.obj", PLAIN.replace("1 2 3", "1 2 9").as_bytes());
    write("picture.gif", b"GIF89a");
    let refused = |name: &str, parts: &[&str]| assert_reports(render(path, name, &[]), 1, parts);
    refused("none.obj", &["none.obj: cannot open it: No such file or directory"]);
    refused("folder.obj", &["folder.obj: this is a folder: name a scene file in it"]);
    refused("empty.obj", &["empty.obj: the file is empty"]);
    refused("cut.obj", &["cut.obj:3:6: this line has 2 numbers, but needs 3", "cut off"]);
    refused("cut.asc", &["cut.asc:4:1: this vertex has 4 numbers", "cut off"]);
    refused("program.asc", &["program.asc: this is a program, which is not a scene"]);
    refused("program.obj", &["program.obj: this is a program, which is not a scene"]);
    refused("index.obj", &["index.obj:4:1: this face refers to vertex 9, but the file has only 3"]);
    refused("picture.gif", &["picture.gif: this is a GIF picture, not a scene", "convert it to PNG"]);
    assert!(!path.join("out.png").exists());
}

#[test]
fn errors_in_scene_files_report_their_location() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    std::fs::write(path.join("pot.obj"), PLAIN).unwrap();
    std::fs::write(path.join("b.toml"), "include = ['a.toml']\n").unwrap();
    let refused = |text: &str, parts: &[&str]| {
        std::fs::write(path.join("a.toml"), text).unwrap();
        assert_reports(render(path, "a.toml", &[]), 1, parts);
    };
    refused("[camera]\npositon = [0, 0, 5]\n", &["a.toml:2:1: there is no key 'positon' of", "'position'?"]);
    refused("[render]\nintegrator = 'whited'\n", &["a.toml:2:1:", "did you mean 'whitted'?"]);
    refused("[render]\nseed = 'many'\n", &["a.toml:2:1:", "a whole number from 0"]);
    refused("[[model]]\nfile = 'pots.obj'\n", &["a.toml:2:8: there is no file 'pots.obj'", "put it there"]);
    refused("[[model]]\nfile = 'pot.obj'\nmaterial = 'x'\n", &["a.toml:3:12: there is no material 'x'"]);
    refused("include = ['b.toml']\n", &["b.toml:1:12: 'a.toml' includes itself"]);
    refused("[[model]\n", &["a.toml:1:", "this is not valid TOML"]);
    let (code, said) = {
        std::fs::write(path.join("a.toml"), "[[model]]\nfile = 'pot.obj'\n").unwrap();
        render(path, "a.toml", &["--camera", "5"])
    };
    assert_reports((code, said), 2, &["--camera: there is no camera '5': this scene has only camera 0"]);
}

#[test]
fn renderable_oddities_give_a_warning() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let drawn = |name: &str, text: &str, parts: &[&str]| {
        std::fs::write(path.join(name), text).unwrap();
        assert_reports(render(path, name, &[]), 0, parts);
        assert_reports(render(path, name, &["--strict"]), 1, parts);
    };
    std::fs::write(path.join("cut.png"), b"\x89PNG\r\n\x1a\n\0\0\0").unwrap();
    let textured = |file: &str| format!("mtllib a.mtl\n{}", PLAIN.replace("f ", "usemtl a\nf ") + file);
    for (texture, part) in [("brick.png", "there is no file 'brick.png'"), ("cut.png", "cut short")] {
        std::fs::write(path.join("a.mtl"), format!("newmtl a\nmap_Kd {texture}\n")).unwrap();
        drawn("a.obj", &textured(""), &["a.mtl:2:1: a texture is replaced by a magenta checker", part]);
    }
    let no_numbers = PLAIN.replace(['0', '1'], "nan").replace("f nan", "f 1");
    std::fs::write(path.join("nan.obj"), &no_numbers).unwrap();
    assert_reports(render(path, "nan.obj", &[]), 1, &["infinite or not numbers", "nothing is visible"]);
    let inside = "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, -1]\n[[material]]\nname = 'glass'\n\
                  kind = 'dielectric'\n[[model]]\nshape = 'sphere'\nmaterial = 'glass'\n";
    drawn("inside.toml", inside, &["the camera is inside a transparent object"]);
}

#[test]
fn an_empty_scene_is_an_error() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let light = r#"{"asset":{"version":"2.0"},"scenes":[{}],"scene":0}"#;
    for (name, text) in [
        ("empty.gltf", light),
        ("empty.toml", "[camera]\nposition = [0, 0, 3]\nlook_at = [0, 0, 0]\n"),
        ("empty.pbrt", "WorldBegin\nLightSource \"point\"\n"),
    ] {
        std::fs::write(path.join(name), text).unwrap();
        for flags in [&[][..], &["--ground", "mirror"], &["--background", "transparent"]] {
            let (code, said) = render(path, name, flags);
            assert!(!said.contains("NaN") && !said.contains("inf "), "{name}: {said}");
            assert_reports((code, said), 1, &["the scene is empty"]);
        }
    }
}

#[test]
fn command_lines_that_name_missing_things_are_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    std::fs::write(path.join("pot.obj"), PLAIN).unwrap();
    let refused = |more: &[&str], parts: &[&str]| assert_reports(render(path, "pot.obj", more), 2, parts);
    refused(&["--size", "0x0"], &["--size: '0x0' is not a size: each side has 1 to 65536 pixels"]);
    refused(&["--size", "99999x9"], &["--size: '99999x9' is not a size", "1 to 65536"]);
    refused(&["-o", "out.pgn"], &["out.pgn: 'pgn' is not a picture format", "did you mean 'png'?"]);
    refused(&["-o", "out"], &["out: the name has no extension of a picture format", "known are: png"]);
    refused(&["-o", "none/out.png"], &["there is no folder 'none'", "create it first"]);
    refused(&["--max-memory", "1X"], &["write 512M or 8G"]);
    let bilux = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("bilux").unwrap();
        let output = command.current_dir(path).args(arguments).output().unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    assert_reports(
        bilux(&["convert", "pot.obj", "-o", "pot.xyy"]),
        2,
        &["pot.xyy: this is not a scene format"],
    );
    assert_reports(bilux(&["convert", "pot.obj", "-o", "pot.png"]), 2, &["use `bilux render`"]);
    std::fs::write(path.join("t.tif"), b"II*\0\x08\0\0\0").unwrap();
    assert_reports(bilux(&["convert", "t.tif", "-o", "t.png"]), 1, &["t.tif: TIFF: the file ends"]);
    assert_reports(
        bilux(&["convert", "t.png", "-o", "t.tif"]),
        2,
        &["'tif' is not a picture format that can be written"],
    );
    assert_reports(bilux(&["generate", "teapts", "-o", "a.obj"]), 2, &["did you mean 'teapots'?"]);
    assert_reports(
        bilux(&["generate", "teapots", "-o", "a.png"]),
        2,
        &["this command writes a scene, not a picture"],
    );
}

#[test]
fn low_memory_suffices_or_is_reported() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    std::fs::write(path.join("large.obj"), PLAIN.repeat(40_000)).unwrap();
    let (code, said) = render(path, "large.obj", &["--max-memory", "1M"]);
    assert_reports((code, said), 1, &["large.obj: reading this takes more than", "--max-memory"]);
    std::fs::write(path.join("small.obj"), PLAIN).unwrap();
    let (code, said) = render(path, "small.obj", &["--size", "40000x40000"]);
    assert_reports(
        (code, said),
        1,
        &["would take about 320001 MB", "320000 MB for the picture", "(--max-memory 299G)"],
    );
}

#[test]
fn misspelt_names_get_suggestions() {
    let folder = TempDir::new().unwrap();
    let answered = |arguments: &[&str], hint: &str| {
        let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
        let output = command.current_dir(folder.path()).args(arguments).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && said.contains(hint), "{arguments:?}: {said}");
    };
    std::fs::write(folder.path().join("plain.obj"), PLAIN).unwrap();
    answered(&["bench", "rays", "teapot3"], "did you mean 'teapots3'?");
    answered(&["bench", "rays", "--accel", "bhv8"], "did you mean 'bvh8'?");
    answered(&["bench", "render", "--scenes", "caustic"], "did you mean 'caustics'?");
    answered(&["bench", "render", "--integrators", "bdtp"], "did you mean 'bdpt'?");
    answered(&["bench", "speed", "--rows", "modle"], "did you mean 'model'?");
    answered(&["bench", "speed", "--rows", "rays", "--against", "obvhs=x"], "embree=PATH");
    answered(&["render", "plain.obj", "-o", "x.png", "--build", "bets"], "did you mean 'best'?");
}
