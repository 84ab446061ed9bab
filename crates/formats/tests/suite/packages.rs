//! Models in packages: what they name above their own folder, and by the paths of the machine that they were made on.

use crate::warnings;
use bilux_formats::{FormatError, ReadOptions, read};
use bilux_math::Rgb;
use bilux_scene::{SceneBuilder, Value};
use std::path::Path;

/// A picture of one colour at a path, with the folders around it.
fn picture(path: &Path, colour: [f32; 3]) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let picture = bilux_pictures::Picture::from_rgb(1, 1, vec![Rgb::from_array(colour)]).unwrap();
    bilux_pictures::write(path, &picture, &Default::default()).unwrap();
}

/// A triangle whose picture has a name.
fn model(path: &Path, name: &str) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path.with_extension("mtl"), format!("newmtl m\nKd 1 1 1\nmap_Kd {name}\n")).unwrap();
    let text = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    std::fs::write(path, text).unwrap();
}

/// The channel of the only texel of the texture; `None` for a checker.
fn shown(scene: &SceneBuilder) -> Option<usize> {
    let spec = &scene.materials[scene.objects[0].material];
    let Some((Value::Texture(index), _)) = spec.parameters.find("kd") else { return None };
    let texture = &scene.textures[*index];
    let texel = texture.texel(0, 0).to_array();
    (texture.width() == 1).then(|| texel.iter().position(|channel| *channel > 0.5).unwrap())
}

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const GREEN: [f32; 3] = [0.0, 1.0, 0.0];

fn in_sandbox() -> ReadOptions {
    ReadOptions { whole_package: false, ..ReadOptions::default() }
}

#[test]
fn a_package_reaches_up_to_its_mark_and_no_further() {
    for mark in ["package.xml", "model.config", ".git"] {
        let folder = tempfile::tempdir().unwrap();
        let top = folder.path().join("robot");
        let path = top.join("meshes/visual/a.obj");
        model(&path, "../../materials/red.png");
        picture(&top.join("materials/red.png"), RED);
        let open = || read(&path, &ReadOptions::default()).unwrap();
        let closed = open();
        assert!(warnings(&closed).contains("lies outside"), "{mark}: {}", warnings(&closed));
        std::fs::write(top.join(mark), "").unwrap();
        assert_eq!(shown(&open()), Some(0), "{mark}");
        // Everything outside of it stays closed, and so does the package in a sandbox.
        assert!(warnings(&read(&path, &in_sandbox()).unwrap()).contains("lies outside"), "{mark}");
        picture(&folder.path().join("secret.png"), GREEN);
        model(&path, "../../../secret.png");
        assert!(warnings(&open()).contains("lies outside"), "{mark}");
    }
}

#[test]
fn a_pack_has_its_textures_beside_the_folders_of_its_formats() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("pack/obj/a.obj");
    model(&path, "U:\\artist\\work\\atlas.png");
    picture(&folder.path().join("pack/texture/atlas.png"), GREEN);
    picture(&folder.path().join("pack/other/atlas.png"), RED);
    let scene = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(shown(&scene), Some(1));
    assert!(scene.notes.iter().any(|note| note.message.contains("texture/atlas.png")), "{:?}", scene.notes);
    assert_eq!(shown(&read(&path, &in_sandbox()).unwrap()), None);
    let open = ReadOptions { allow_outside: true, ..in_sandbox() };
    assert_eq!(shown(&read(&path, &open).unwrap()), Some(1), "with files outside");
}

/// The longest end of a name that exists counts: three files have the same last part.
#[test]
fn names_of_other_machines_are_found_by_their_ends() {
    let folder = tempfile::tempdir().unwrap();
    let top = folder.path().join("pack");
    picture(&top.join("skins/old/wood.png"), RED);
    picture(&top.join("skins/wood.png"), GREEN);
    picture(&top.join("wood.png"), GREEN);
    std::fs::create_dir_all(top.join(".git")).unwrap();
    for (name, found) in [
        ("/disk/a/pack/skins/old/wood.png", Some(0)),
        ("C:\\b\\skins\\wood.png", Some(1)),
        ("model://robot/skins/old/wood.png", Some(0)),
        ("/disk/a/gone.png", None),
    ] {
        let path = top.join("models/obj/a.obj");
        model(&path, name);
        assert_eq!(shown(&read(&path, &ReadOptions::default()).unwrap()), found, "{name}");
    }
}

/// A scene that includes a file of its own name on another machine does not include itself.
#[test]
fn scenes_are_not_found_in_place_of_what_they_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.toml");
    std::fs::write(&path, "include = [\"/other/machine/a.toml\"]\n").unwrap();
    let error = read(&path, &ReadOptions::default()).unwrap_err();
    assert!(matches!(error, FormatError::MissingFile { .. } | FormatError::Malformed { .. }), "{error}");
}
