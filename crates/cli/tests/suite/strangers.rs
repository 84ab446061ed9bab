//! Names in files of strangers, folders within folders, and backgrounds.

use assert_cmd::Command;
use std::path::Path;
use tempfile::TempDir;

fn bilux(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
    command.current_dir(folder);
    command
}

/// A name may hold what moves the cursor of a terminal or sets its title; it is shown written out. [CWE-150]
#[test]
fn names_in_files_do_not_reach_the_terminal_as_they_are() {
    let folder = TempDir::new().unwrap();
    let text = "mtllib \u{1b}]0;title\u{7}.mtl\no a\u{1b}[2Jb\nusemtl c\u{9b}d\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(folder.path().join("a.obj"), text).unwrap();
    let render = ["render", "a.obj", "-o", "a.png", "--size", "8x8", "--spp", "1", "-v"];
    for arguments in [&["info", "a.obj"][..], &render] {
        let output = bilux(folder.path()).args(arguments).assert().success();
        let said = [&output.get_output().stdout[..], &output.get_output().stderr].concat();
        let said = String::from_utf8(said).unwrap();
        let harmful = |c: char| c.is_control() && c != '\n' && c != '\t';
        assert!(!said.contains(harmful) && said.contains("\\u{1b}"), "{said:?}");
    }
}

#[test]
fn folders_within_folders_are_compared() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    for (place, reflectance) in [("one", "0.5"), ("other", "0.5"), ("one/sub", "0.5"), ("other/sub", "0.9")] {
        std::fs::create_dir_all(path.join(place)).unwrap();
        let scene = format!(
            "[[light]]\nkind = \"environment\"\n[[material]]\nname = \"m\"\nkind = \"diffuse\"\nreflectance = {reflectance}\n\
             [[model]]\nshape = \"sphere\"\nmaterial = \"m\"\n"
        );
        std::fs::write(path.join("s.toml"), scene).unwrap();
        let to = format!("{place}/a.png");
        let render = ["render", "s.toml", "-o", &to, "--size", "8x8", "--spp", "4", "-i", "path"];
        bilux(path).args(render).assert().success();
    }
    let output = bilux(path).args(["compare", "one", "other", "--max-rmse", "0.001"]).assert().code(1);
    let said = String::from_utf8_lossy(&output.get_output().stdout).into_owned();
    assert!(said.contains("sub/a.png"), "{said}");
    std::fs::copy(path.join("one/sub/a.png"), path.join("other/sub/a.png")).unwrap();
    bilux(path).args(["compare", "one", "other", "--max-rmse", "0.001"]).assert().success();
}

/// A background lights nothing and changes no tone curve: radiance 0.5 is 188 of 255. [IEC 61966-2-1]
#[test]
fn a_background_leaves_what_is_before_it_as_it_was() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let scene = "[camera]\nkind = \"perspective\"\nposition = [0, 0, 5]\n[[light]]\nkind = \"point\"\nposition = [0, 0, 4]\n\
                 intensity = 0\n[[material]]\nname = \"m\"\nkind = \"diffuse\"\nreflectance = 0\nemission = 0.5\n\
                 [[model]]\nshape = \"sphere\"\nmaterial = \"m\"\n";
    std::fs::write(path.join("s.toml"), scene).unwrap();
    for background in [&[][..], &["--background", "black"], &["--background", "transparent"]] {
        let render = ["render", "s.toml", "-o", "a.png", "--size", "9x9", "--spp", "4", "--denoise=off"];
        bilux(path).args(render).args(background).assert().success();
        let picture = bilux::pictures::read(path.join("a.png")).unwrap();
        assert_eq!((picture.rgb(4, 4).g * 255.0).round(), 188.0, "{background:?}");
    }
}
