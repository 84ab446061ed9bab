//! Pictures of photons, and light by the length of its path, through the binary.

use assert_cmd::Command;
use bilux::pictures::formats::read;
use std::path::Path;
use tempfile::TempDir;

fn bilux(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
    command.current_dir(folder).args(arguments);
    command
}

/// A folder with a scene and its light.
fn lit() -> TempDir {
    let folder = TempDir::new().unwrap();
    bilux(folder.path(), &["generate", "cornell", "-o", "box.toml"]).assert().success();
    let render =
        ["render", "box.toml", "-i", "path", "--size", "24x24", "--spp", "4", "-o", "light.exr", "-q"];
    bilux(folder.path(), &render).assert().success();
    folder
}

#[test]
fn a_sensor_reads_the_same_bytes_on_any_number_of_threads() {
    let folder = lit();
    let path = folder.path();
    let shoot = |name: &str, threads: &str, more: &[&str]| {
        let words = [&["sensor", "light.exr", "-o", name, "-q"], more].concat();
        bilux(path, &words).env("RAYON_NUM_THREADS", threads).assert().success().stdout("").stderr("");
        std::fs::read(path.join(name)).unwrap()
    };
    for more in [&["--pattern", "prism"][..], &["--output-kind", "raw", "--iso", "800"]] {
        let one = shoot("one.png", "1", more);
        assert!(
            one == shoot("three.png", "3", more)
                && one != shoot("other.png", "1", &[more, &["--seed", "4"]].concat())
        );
    }
    // Raw numbers are whole, within the range, and have the black level below them.
    shoot("raw.exr", "2", &["--output-kind", "raw", "--bit-depth", "10", "--black-level", "32"]);
    let raw = read(path.join("raw.exr")).unwrap();
    let numbers = raw.channel("Y").unwrap();
    assert!(numbers.iter().all(|n| n.fract() == 0.0 && (0.0..=1023.0).contains(n)));
    assert!(numbers.iter().filter(|n| **n > 100.0).count() > 100);
}

#[test]
fn a_wrong_sensor_is_refused_before_the_work() {
    let folder = lit();
    for (words, wanted) in [
        (&["sensor", "light.exr", "-o", "light.exr"][..], "not overwritten"),
        (&["sensor", "light.exr", "-o", "a.png", "--f-number", "0"], "--f-number: the value is 0"),
        (&["sensor", "light.exr", "-o", "a.png", "--exposure-time", "long"], "--exposure-time"),
        (&["sensor", "light.exr", "-o", "a.png", "--pattern", "rgb"], "--pattern"),
        (&["sensor", "light.exr", "-o", "a.png", "--quantum-efficiency", "1,2"], "--quantum-efficiency"),
        (&["sensor", "light.exr", "-o", "a.xyz"], "xyz"),
        (&["sensor", "light.exr", "-o", "no/a.png"], "there is no folder"),
        (&["render", "box.toml", "-o", "a.png", "--lengths", "1,0,4"], "--lengths"),
        (&["render", "box.toml", "-o", "a.png", "--lengths", "1,2"], "--lengths"),
        (&["render", "box.toml", "-o", "a.png", "--lengths", "1,2,3", "-i", "vcm"], "choose path or bdpt"),
        (&["render", "box.toml", "-o", "-", "--lengths", "1,2,3", "-i", "path"], "file name"),
    ] {
        let output = bilux(folder.path(), words).assert().code(2).get_output().clone();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(wanted), "{words:?}: {said}");
    }
    let missing =
        bilux(folder.path(), &["sensor", "no.exr", "-o", "a.png"]).assert().code(1).get_output().clone();
    assert!(String::from_utf8_lossy(&missing.stderr).contains("no.exr"));
    let dark = ["sensor", "light.exr", "-o", "a.png", "--bit-depth", "4"];
    let dark = bilux(folder.path(), &dark).assert().code(1).get_output().clone();
    assert!(String::from_utf8_lossy(&dark.stderr).contains("black level"));
}

#[test]
fn intervals_of_length_are_layers_that_add_up() {
    let folder = lit();
    let words = ["render", "box.toml", "-i", "path", "--size", "24x24", "--spp", "4", "-o", "box.exr", "-q"];
    let words = [&words[..], &["--lengths", "1.5,0.25,8"]].concat();
    bilux(folder.path(), &words).assert().success();
    let [light, lengths] =
        ["light.exr", "box.lengths.exr"].map(|name| read(folder.path().join(name)).unwrap());
    assert_eq!(lengths.metadata["bilux.lengths"], "1.5,0.25,8");
    let layers: Vec<String> = (0..8).map(|i| format!("length_{i:05}")).chain(["rest".to_owned()]).collect();
    for channel in ["R", "G", "B"] {
        let whole = light.channel(channel).unwrap();
        let parts: Vec<&[f32]> =
            layers.iter().map(|layer| lengths.channel(&format!("{layer}.{channel}")).unwrap()).collect();
        for (i, whole) in whole.iter().enumerate() {
            let sum: f32 = parts.iter().map(|part| part[i]).sum();
            assert!((sum - whole).abs() < 1e-4 * (1.0 + whole), "{channel} {i}: {sum}, {whole}");
        }
        assert!(parts.iter().filter(|part| part.iter().any(|light| *light > 0.01)).count() > 4);
    }
}
