//! Standard input in place of files, standard output in place of pictures, and terminals of all kinds.

use assert_cmd::Command;
use bilux::pictures::{Limits, read_bytes};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SCENE: &str = "[camera]\nposition = [0, 1, 4]\nlook_at = [0, 0, 0]\n[[light]]\nkind = \"environment\"\nradiance = 0.5\n\
                     [[model]]\nshape = \"box\"\nsize = [1, 2, 3]\n";

fn bilux(folder: &Path, line: &str) -> Command {
    let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
    command.current_dir(folder).args(line.split_whitespace());
    command
}

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("a.toml"), SCENE).unwrap();
    folder
}

fn output(mut command: Command) -> Vec<u8> {
    command.assert().success().get_output().stdout.clone()
}

#[test]
fn what_is_piped_in_is_read_as_a_file_is() {
    let folder = folder();
    let path = folder.path();
    for (of_file, piped) in [
        ("info a.toml --json", "info - --json"),
        ("info a.toml --json", "info - --json --input-format toml"),
        ("info a.toml --json --sandbox", "info - --json --sandbox"),
        ("explain a.toml --json --set size=16x16", "explain - --json --set size=16x16"),
    ] {
        let [file, pipe] = [bilux(path, of_file), {
            let mut command = bilux(path, piped);
            command.write_stdin(SCENE);
            command
        }]
        .map(output);
        assert_eq!(String::from_utf8(file).unwrap(), String::from_utf8(pipe).unwrap(), "{piped}");
    }
    bilux(path, "convert a.toml -o file.obj -q").assert().success();
    bilux(path, "convert - -o pipe.obj -q").write_stdin(SCENE).assert().success();
    let [file, pipe] = ["file.obj", "pipe.obj"].map(|name| fs::read_to_string(path.join(name)).unwrap());
    assert_eq!(file.replace("file", "pipe"), pipe);
    for (line, input, said) in [
        ("info -", "", "standard input is empty"),
        ("info - --input-format tml", SCENE, "did you mean 'toml'?"),
        ("convert - -o x.obj", "GIF89a", "a picture"),
    ] {
        let failed = bilux(path, line).write_stdin(input).assert().failure();
        let error = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(error.contains(said), "{line}: {error}");
    }
}

#[test]
fn pictures_go_to_standard_output_in_any_format() {
    let folder = folder();
    let path = folder.path();
    let rows = bilux::pictures::PICTURE_FORMATS.iter().filter(|row| row.write.is_some());
    let formats: Vec<&str> = rows.map(|row| row.entry.name).collect();
    assert!(formats.len() >= 7);
    for format in formats {
        let render = format!("--size 12x9 --spp 1 -i path -q --seed 3 --output-format {format}");
        let bytes = output(bilux(path, &format!("render a.toml -o - {render}")));
        let picture = read_bytes(&bytes, Some(format), &Limits::default()).unwrap();
        assert_eq!((picture.width(), picture.height()), (12, 9), "{format}");
        let again = output({
            let mut command = bilux(path, "convert - -o - --output-format png -q");
            command.write_stdin(bytes);
            command
        });
        assert!(again.starts_with(b"\x89PNG"), "{format}");
    }
    let plain = output(bilux(path, "render a.toml -o - --size 12x9 --spp 1 -i path -q --seed 3"));
    bilux(path, "render a.toml -o a.png --size 12x9 --spp 1 -i path -q --seed 3").assert().success();
    assert_eq!(plain, fs::read(path.join("a.png")).unwrap());
    for (line, said) in [
        ("render a.toml -o - --output-format xyz", "there is no picture format 'xyz'"),
        ("render a.toml -o a.png --output-format exr", "--output-format is for -o -"),
        ("render a.toml -o - --quality 50", "--quality is only for JPEG"),
        ("convert a.png -o b.png --output-format exr", "--output-format is for -o -"),
        ("convert a.toml -o b.obj --output-format exr", "--output-format is of a picture"),
        (
            "render a.toml -o cloud.xyz",
            "xyz is a format of scenes, not of pictures: write a picture, such as cloud.png",
        ),
        ("convert a.png -o cloud.csv", "name it with --heat-map"),
    ] {
        let failed = bilux(path, line).assert().code(2);
        let error = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(error.contains(said), "{line}: {error}");
    }
}

/// By `script`, which gives a program a terminal.
#[cfg(target_os = "linux")]
#[test]
#[expect(clippy::print_stderr, reason = "a test that is skipped says so")]
fn terminals_get_no_pictures_and_only_what_they_understand() {
    let folder = folder();
    let program = assert_cmd::cargo::cargo_bin("bilux");
    let has_script = std::process::Command::new("script").arg("--version").output().is_ok();
    if !has_script {
        eprintln!("SKIPPED: there is no program `script`, which gives a terminal");
        return;
    }
    let on_terminal = |line: &str, environment: [(&str, &str); 2]| {
        let mut command = std::process::Command::new("script");
        command.args(["-qec", &format!("{} {line}", program.display()), "/dev/null"]);
        command.current_dir(folder.path()).envs(environment);
        String::from_utf8_lossy(&command.output().unwrap().stdout).into_owned()
    };
    let said = on_terminal("render a.toml -o - --spp 1", [("TERM", "xterm"), ("NO_COLOR", "")]);
    assert!(
        said.contains("a picture is no text for a terminal") && said.contains("\x1b[1;31merror"),
        "{said:?}"
    );
    let line = "render a.toml -o a.png --spp 64 --size 64x64 -i path --preview";
    assert!(on_terminal(line, [("TERM", "xterm"), ("NO_COLOR", "")]).contains('\x1b'));
    assert!(!on_terminal(line, [("TERM", "dumb"), ("NO_COLOR", "")]).contains('\x1b'));
    let broken = "render missing.toml -o a.png";
    assert!(!on_terminal(broken, [("TERM", "xterm"), ("NO_COLOR", "1")]).contains('\x1b'));
    assert!(!on_terminal(broken, [("TERM", "dumb"), ("NO_COLOR", "")]).contains('\x1b'));
    // The variable CI, which continuous integration sets, is no terminal either.
    for line in ["rendr", "--help", "info"] {
        assert!(!on_terminal(line, [("TERM", "dumb"), ("CI", "true")]).contains('\x1b'), "{line}");
    }
}

#[test]
fn advice_on_memory_is_enough() {
    let folder = folder();
    let path = folder.path();
    bilux(path, "render a.toml -o a.png --size 400x300 --spp 1 -i path -q").assert().success();
    // Bytes of that size fit into a megabyte, and are converted as such; these are planes.
    bilux(path, "render a.toml -o deep.png --bits 16 --size 300x200 --spp 1 -i path -q").assert().success();
    for line in [
        "convert deep.png -o b.png",
        "compare a.png a.png",
        "sensor a.png -o s.png",
        "render a.toml -o c.png --size 400x300 --spp 1",
    ] {
        let failed = bilux(path, &format!("{line} --max-memory 1M")).assert().code(predicates_one_or_two());
        let error = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        let (_, advice) = error.rsplit_once("--max-memory ").unwrap_or_else(|| panic!("{line}: {error}"));
        let amount = advice.split(|c: char| !c.is_ascii_alphanumeric()).next().unwrap();
        let done = bilux(path, &format!("{line} --max-memory {amount} -q")).output().unwrap();
        assert!(
            !String::from_utf8_lossy(&done.stderr).contains("--max-memory"),
            "{line}: {amount}: {done:?}"
        );
    }
}

/// A picture that is too large is an error of the work, or of the command line.
fn predicates_one_or_two() -> Vec<i32> {
    vec![1, 2]
}

#[test]
fn programs_are_no_scenes_whatever_their_names() {
    let folder = folder();
    let path = folder.path();
    let heads: [&[u8]; 3] = [b"\x7fELF\x02\x01\x01", b"MZ\x90\0\x03", b"\xcf\xfa\xed\xfe\x07"];
    for (head, extension) in
        heads.iter().flat_map(|head| ["glb", "exe", "obj", "fbx", "toml"].map(|e| (head, e)))
    {
        let name = format!("program.{extension}");
        fs::write(path.join(&name), [head, &[0; 4000][..]].concat()).unwrap();
        let failed = bilux(path, &format!("info {name}")).assert().failure();
        let error = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(error.contains("this is a program"), "{name}: {error}");
    }
}
