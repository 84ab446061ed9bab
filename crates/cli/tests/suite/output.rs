//! Output can be trusted: a write that fails is an error, results are what was asked for, and a sandbox holds.
#![allow(clippy::print_stderr, reason = "a test that skips says so")]

use bilux::pictures::{Picture, read};
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

fn bilux(folder: &Path, command: &str) -> Command {
    let mut bilux = Command::new(env!("CARGO_BIN_EXE_bilux"));
    // The variables that cargo sets for tests would make the loader search more places.
    bilux.current_dir(folder).env("OIDN_LIB", "nowhere").env_remove("LD_LIBRARY_PATH");
    bilux.args(command.split_whitespace()).stdin(Stdio::null());
    bilux
}

fn run(folder: &Path, command: &str) -> Output {
    bilux(folder, command).output().unwrap()
}

/// Runs a command and returns the exit status and what it prints to standard error.
fn answer(folder: &Path, command: &str) -> (Option<i32>, String) {
    let output = run(folder, command);
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[track_caller]
fn assert_done(folder: &Path, command: &str) -> String {
    let (code, said) = answer(folder, command);
    assert_eq!(code, Some(0), "{command}: {said}");
    said
}

/// A folder with a scene of one ball.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("ball.toml"), "[[model]]\nshape = \"sphere\"\n").unwrap();
    folder
}

const SMALL: &str = "--size 16x16 --spp 1";

/// Every command that prints a result.
fn printing() -> Vec<String> {
    let mut commands: Vec<String> = [
        "info ball.toml",
        "info ball.toml --json",
        "list materials",
        "list settings --json",
        "schema",
        "licenses",
        "man",
        "completions bash",
        "compare a.png a.png",
        "--help",
        "render --help",
        "--version",
    ]
    .map(str::to_owned)
    .into();
    for result in ["-o -", "-o out.png --json", "-o out.png --stats -", "-o out.png --replay 1,1,0"] {
        commands.push(format!("render ball.toml {SMALL} {result}"));
    }
    commands
}

#[cfg(target_os = "linux")]
#[test]
fn a_result_that_cannot_be_printed_is_an_error() {
    let folder = folder();
    let path = folder.path();
    assert_done(path, &format!("render ball.toml {SMALL} -o a.png"));
    for command in printing() {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let output = bilux(path, &command).stdout(full).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        // As everywhere, `compare` reserves 1 for pictures that differ.
        let status = if command.starts_with("compare") { 2 } else { 1 };
        assert_eq!(output.status.code(), Some(status), "{command}: {said}");
        assert!(said.contains("error: cannot write to standard output: No space left"), "{command}: {said}");
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = bilux(path, &command).stdout(writer).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(141), "{command}: {said}");
        assert!(!said.contains("error"), "{command}: {said}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_file_that_cannot_be_written_is_an_error() {
    let folder = folder();
    let path = folder.path();
    for name in ["full.png", "full.json", "full.toml"] {
        std::os::unix::fs::symlink("/dev/full", path.join(name)).unwrap();
    }
    let render = format!("render ball.toml {SMALL}");
    for command in [
        format!("{render} -o full.png"),
        format!("{render} -o a.png --stats full.json"),
        "generate teapot -o full.toml".to_owned(),
        "convert ball.toml -o full.toml".to_owned(),
    ] {
        let (code, said) = answer(path, &command);
        assert_eq!(code, Some(1), "{command}: {said}");
        assert!(said.contains("full.") && said.contains("No space left"), "{command}: {said}");
    }
}

#[test]
fn jpeg_and_webp_hold_the_picture() {
    let folder = folder();
    let path = folder.path();
    let render = "render ball.toml --size 64x48 --spp 64 --seed 3";
    assert_done(path, &format!("{render} -o a.png"));
    assert_done(path, &format!("{render} -o a.webp"));
    for quality in ["20", "95"] {
        assert_done(path, &format!("{render} -o q{quality}.jpg --quality {quality}"));
    }
    let open = |name: &str| read(path.join(name)).unwrap();
    assert_eq!(open("a.webp").to_rgb(), open("a.png").to_rgb());
    let difference = |name: &str| {
        let (a, b) = (open(name).to_rgb().unwrap(), open("a.png").to_rgb().unwrap());
        a.iter().zip(&b).map(|(a, b)| (*a - *b).map(f32::abs).max_channel()).sum::<f32>() / a.len() as f32
    };
    let (coarse, fine) = (difference("q20.jpg"), difference("q95.jpg"));
    assert!(fine < 0.01 && fine < coarse && coarse < 0.1, "{fine} {coarse}");
    let size = |name: &str| fs::metadata(path.join(name)).unwrap().len();
    assert!(size("q20.jpg") < size("q95.jpg"));
    // On standard output the format is stated, and has its quality.
    let piped = |quality: u8| {
        let options = format!("convert a.png -o - --output-format jpeg --quality {quality}");
        let output = bilux(path, &options).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        output.stdout.len()
    };
    assert!(piped(20) < piped(95));
    assert_done(path, "convert a.png -o b.webp");
    assert_eq!(fs::read(path.join("b.webp")).unwrap(), fs::read(path.join("a.webp")).unwrap());
}

#[test]
fn transparency_is_kept_or_reported_as_lost() {
    let folder = folder();
    let path = folder.path();
    let render = format!("render ball.toml {SMALL} --background transparent");
    let corner = |name: &str| -> Picture { read(path.join(name)).unwrap() };
    for name in ["a.png", "a.webp"] {
        assert!(!assert_done(path, &format!("{render} -o {name}")).contains("warning"));
        assert_eq!(corner(name).alpha_at(0, 0), 0.0, "{name}");
    }
    for name in ["a.jpg", "a.ppm"] {
        let said = assert_done(path, &format!("{render} -o {name}"));
        assert!(said.contains("does not support transparency and gets white there"), "{said}");
        assert!(corner(name).rgb(0, 0).to_array().iter().all(|c| *c > 0.98), "{name}");
        let (code, _) = answer(path, &format!("{render} --strict -o strict-{name}"));
        assert_eq!((code, path.join(format!("strict-{name}")).exists()), (Some(1), false));
    }
    let said = assert_done(path, &format!("render ball.toml {SMALL} --background #ff0000 -o red.jpg"));
    assert!(!said.contains("warning"), "{said}");
    let red = corner("red.jpg").rgb(0, 0);
    assert!(red.r > 0.95 && red.g < 0.05, "{red:?}");
}

#[test]
fn a_line_of_json_is_printed_for_each_picture() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("broken.obj"), "v 1 2\n").unwrap();
    let lines = |command: &str, status: i32| -> Vec<serde_json::Value> {
        let output = run(path, command);
        assert_eq!(output.status.code(), Some(status), "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    };
    let all = lines(&format!("render ball.toml broken.obj {SMALL} --json -o {{stem}}.png"), 1);
    assert_eq!(all.len(), 2);
    assert_eq!((&all[0]["scene"], &all[0]["picture"]), (&"ball.toml".into(), &"ball.png".into()));
    assert_eq!(
        (&all[0]["width"], &all[0]["spp"], &all[0]["complete"]),
        (&16.into(), &1.into(), &true.into())
    );
    assert!(all[0]["seconds"].as_f64().unwrap() > 0.0 && all[0]["error"].is_null());
    assert!(all[1]["error"].as_str().unwrap().contains("broken.obj:1"), "{}", all[1]);
    // A part states the samples that it took.
    let part = "render ball.toml --size 16x16 --spp 64 --samples 0..4 --json --progress none -o part.exr";
    assert_eq!(lines(part, 0)[0]["spp"], 4);
    assert!(assert_done(path, &part.replace("--json ", "")).contains(", 4 samples per pixel, "));
    let turned = lines(&format!("render ball.toml {SMALL} --turntable 2 --json -o t-{{frame}}.png"), 0);
    let pictures: Vec<_> = turned.iter().map(|line| line["picture"].as_str().unwrap().to_owned()).collect();
    assert_eq!(pictures, ["t-0000.png", "t-0001.png"]);
    let stats = lines(&format!("render ball.toml {SMALL} --stats - -o s.png"), 0);
    assert!(stats.len() == 1 && stats[0]["triangle_tests"].as_u64().unwrap() > 0);
    assert_done(
        path,
        &format!("render ball.toml {SMALL} --turntable 2 --stats t-{{frame}}.json -o t-{{frame}}.png"),
    );
    assert!(path.join("t-0000.json").is_file() && path.join("t-0001.json").is_file());
}

#[test]
fn standard_input_is_recognised_by_its_first_bytes() {
    let folder = folder();
    let path = folder.path();
    for format in ["toml", "obj", "glb", "ply", "stl", "off", "pbrt", "asc"] {
        let file = format!("ball.{format}");
        if format != "toml" {
            assert_done(path, &format!("convert ball.toml -o {file}"));
        }
        for named in ["", "--input-format auto"] {
            let command = format!("render - {SMALL} {named} -o {format}.png");
            let output = bilux(path, &command).stdin(File::open(path.join(&file)).unwrap()).output().unwrap();
            assert!(output.status.success(), "{format}: {}", String::from_utf8_lossy(&output.stderr));
        }
    }
    let (code, said) = answer(path, &format!("render - {SMALL} -o nothing.png"));
    assert!(code == Some(1) && said.contains("standard input"), "{said}");
}

/// The log of a picture is one line; `-v` adds more.
#[test]
fn the_log_of_a_picture_is_one_line() {
    let folder = folder();
    let path = folder.path();
    let render = "render ball.toml --size 16x16 --progress none --denoise=off -o a.png";
    for more in ["--spp 4", "--noise 20%"] {
        let said = assert_done(path, &format!("{render} {more}"));
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.starts_with("a.png: 16x16, ") && said.contains(" samples per pixel, "), "{said}");
        assert_eq!(said.contains("% noise"), more.contains("noise"), "{said}");
        let more = assert_done(path, &format!("{render} {more} -v"));
        assert!(more.lines().count() > 1 && more.contains("auto chose"), "{more}");
    }
    // A model of unknown orientation in the studio, and a denoiser that is not the best: neither needs action.
    fs::write(path.join("bare.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let model = "render bare.obj --size 16x16 --progress none --noise 20% -o b.png";
    let said = assert_done(path, model);
    assert!(said.lines().count() == 1 && said.contains(", denoised by "), "{said}");
    assert!(said.contains(", lit by the studio (a key light, a rim light and surroundings)"), "{said}");
    let more = assert_done(path, &format!("{model} -v"));
    assert!(more.contains("up is y, front is z"), "{more}");
    // A guess may be wrong, so it is reported: a plate lies flat.
    let corners = "v 0 0 -2\nv 3 0 -2\nv 3 2 -2\nv 0 2 -2\nv 0 0 -1.9\nv 3 0 -1.9\nv 3 2 -1.9\nv 0 2 -1.9\n";
    let faces = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    fs::write(path.join("plate.obj"), format!("{corners}{faces}")).unwrap();
    let said = assert_done(path, &model.replace("bare", "plate"));
    let guess = "plate.obj: up is z, front is -y, guessed from its shape (change it with --up and --front)";
    assert!(said.lines().count() == 2 && said.lines().any(|line| line == guess), "{said}");
}

/// A model below a sun of 10,000 lux, in a format that states no exposure.
fn sunlit(path: &Path) {
    let sun = "kind = \"directional\"\ndirection = [-0.5, -1, -0.8]\nirradiance = 10000\n";
    let scene = format!("[[model]]\nshape = \"sphere\"\n\n[[light]]\n{sun}");
    fs::write(path.join("sun.toml"), scene).unwrap();
    assert_done(path, "convert sun.toml -o sun.gltf -q");
    // Other programs do not say that there are no surroundings.
    let mut written: serde_json::Value =
        serde_json::from_slice(&fs::read(path.join("sun.gltf")).unwrap()).unwrap();
    assert!(written["scenes"][0].as_object_mut().unwrap().remove("extras").is_some());
    fs::write(path.join("sun.gltf"), written.to_string()).unwrap();
}

#[test]
fn what_is_decided_for_all_frames_is_said_once() {
    let folder = folder();
    let path = folder.path();
    sunlit(path);
    let said = assert_done(path, &format!("render sun.gltf {SMALL} --turntable 3 --progress none -o a.png"));
    assert_eq!((said.matches("is exposed by").count(), said.lines().count()), (1, 4), "{said}");
}

/// The exposure is that of the whole picture, however it is divided.
#[test]
fn parts_are_exposed_as_the_whole() {
    let folder = folder();
    let path = folder.path();
    sunlit(path);
    let render = "render sun.gltf -i path --size 24x18 --spp 4 -q";
    let picture = |name: &str| fs::read(path.join(name)).unwrap();
    assert_done(path, &format!("{render} -o whole.ppm"));
    assert_done(path, &format!("{render} -o threads.ppm --threads 3"));
    assert!(picture("threads.ppm") == picture("whole.ppm"));
    for parts in [["--samples 0..1", "--samples 1..4"], ["--crop 0,0,24,5", "--crop 0,5,24,13"]] {
        for (part, name) in parts.iter().zip(["a.exr", "b.exr"]) {
            assert_done(path, &format!("{render} {part} -o {name}"));
        }
        assert_done(path, "merge b.exr a.exr -o merged.ppm -q");
        assert!(picture("merged.ppm") == picture("whole.ppm"), "{parts:?}");
    }
    assert_done(path, &format!("{render} -o bright.ppm --exposure 0"));
    assert!(picture("bright.ppm") != picture("whole.ppm"));
}

/// The lines of JSON on the pages for programs have the keys of the real ones.
#[test]
fn the_pages_show_json_as_it_is() {
    let folder = folder();
    let path = folder.path();
    // Those of the picture within the result of a job, too.
    let keys = |text: &str| {
        let value: serde_json::Value = serde_json::from_str(text).unwrap();
        let objects = [Some(&value), value["pictures"].get(0)];
        let keys = objects.into_iter().flatten().flat_map(|object| object.as_object().unwrap().keys());
        keys.cloned().collect::<BTreeSet<_>>()
    };
    let printed = |command: &str| String::from_utf8(run(path, command).stdout).unwrap();
    let picture = printed(&format!("render ball.toml {SMALL} -o a.png --json -q"));
    let failure = printed("render none.obj -o a.png --json -q");
    let mut worker = bilux(path, "worker");
    let mut worker = worker.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let job = "{\"scene\": \"ball.toml\", \"output\": \"a.png\", \"spp\": 1}";
    worker.stdin.take().unwrap().write_all(job.as_bytes()).unwrap();
    let result = String::from_utf8(worker.wait_with_output().unwrap().stdout).unwrap();
    let mut found = [0; 3];
    for page in ["command-line.md", "tutorials/server.md"] {
        let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(page));
        let starts = ["{\"scene\":\"", "{\"id\":\""];
        let is_shown = |line: &&str| starts.iter().any(|start| line.starts_with(start));
        for line in text.unwrap().lines().filter(is_shown) {
            let is_job = line.starts_with(starts[1]);
            let real = if is_job { 2 } else { usize::from(line.contains("\"error\"")) };
            found[real] += 1;
            assert_eq!(keys(line), keys([&picture, &failure, &result][real]), "{page}: {line}");
        }
    }
    assert!(found.iter().all(|count| *count > 0), "{found:?}");
}

/// A scene in a folder of its own, next to a file that must be neither read nor written.
fn sandboxed() -> TempDir {
    let folder = folder();
    let path = folder.path();
    fs::create_dir(path.join("scene")).unwrap();
    fs::create_dir(path.join("out")).unwrap();
    fs::rename(path.join("ball.toml"), path.join("scene/ball.toml")).unwrap();
    fs::write(path.join("secret.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    folder
}

#[test]
fn a_sandbox_writes_only_beside_the_picture() {
    let folder = sandboxed();
    let path = folder.path();
    let render = format!("render scene/ball.toml {SMALL} --sandbox");
    assert_done(path, &format!("{render} -o out/a.png --stats out/a.json --aov depth,normal"));
    for name in ["a.png", "a.json", "a.layers.exr"] {
        assert!(path.join("out").join(name).is_file(), "{name}");
    }
    for (more, what) in [
        ("-o out/b.png --stats stats.json", "stats.json: --sandbox writes only to"),
        (
            "-o - --stats stats.json",
            "stats.json: --sandbox writes no other file if the picture goes to standard output",
        ),
    ] {
        let (code, said) = answer(path, &format!("{render} {more}"));
        assert!(code == Some(2) && said.contains(what), "{said}");
        assert!(!path.join("stats.json").exists());
    }
    #[cfg(unix)]
    {
        // A link in the folder may lead to somebody else's file.
        std::os::unix::fs::symlink("../secret.obj", path.join("out/link.png")).unwrap();
        let (code, said) = answer(path, &format!("{render} -o out/link.png"));
        assert!(code == Some(2) && said.contains("--sandbox writes only to"), "{said}");
        assert!(fs::read_to_string(path.join("secret.obj")).unwrap().starts_with("v 0 0 0"));
    }
}

/// `src/sandbox/landlock.rs` tests that the kernel refuses what it should.
#[cfg(target_os = "linux")]
#[test]
fn commands_work_within_a_sandbox_and_its_enforcement_is_reported() {
    let folder = sandboxed();
    let path = folder.path();
    let version = String::from_utf8(run(path, "-V").stdout).unwrap();
    assert!(version.contains("sandbox "), "{version}");
    let enforced = version.contains("enforced by the kernel (files and network)");
    fs::create_dir(path.join("out/more")).unwrap();
    for command in [
        "info scene/ball.toml",
        "convert scene/ball.toml -o out/a.obj",
        "generate teapot -o out/pot.toml",
        "generate teapots --from secret.obj --count 2 -o out/two.obj",
        "render scene/ball.toml --size 8x8 --spp 1 -o out/a.exr --aov albedo,normal,variance --samples 0..1",
        "render scene/ball.toml --size 8x8 --spp 1 -i bdpt --max-depth 2 -o out/b.exr --aov strategies",
        "render scene/ball.toml --size 8x8 --spp 1 -o out/b.png --env out/a.exr",
        "merge out/a.exr -o out/c.exr",
        "denoise out/a.exr -o out/c.png",
        "compare out/b.png out/b.png --heat-map out/d.png",
    ] {
        let said = assert_done(path, &format!("{command} --sandbox"));
        assert_eq!(said.contains("Landlock"), !enforced, "{command}: {said}");
    }
}

/// pbrt looks for a file in its working directory, so Bilux does too; a sandbox is the scene's folder alone.
#[test]
fn the_working_folder_is_searched_except_in_a_sandbox() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    fs::create_dir(path.join("scenes")).unwrap();
    fs::create_dir(path.join("out")).unwrap();
    let scene = "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\nInclude \"parts/ball.pbrt\"\n";
    fs::write(path.join("scenes/ball.pbrt"), scene).unwrap();
    fs::create_dir(path.join("parts")).unwrap();
    fs::write(path.join("parts/ball.pbrt"), "Translate 0 0 4\nShape \"sphere\"\n").unwrap();
    let render = format!("render scenes/ball.pbrt {SMALL} -o out/a.pfm");
    assert_done(path, &render);
    let found = fs::read(path.join("out/a.pfm")).unwrap();
    let refused = |command: &str| {
        let (code, said) = answer(path, command);
        // Not even tried: the kernel's own refusal would read otherwise.
        let what = "there is no file 'parts/ball.pbrt'";
        assert!(code == Some(1) && said.contains(what), "{command}: {said}");
    };
    refused(&format!("{render} --sandbox"));
    refused("info scenes/ball.pbrt --sandbox");
    // A file beside the scene comes first, and a sandbox reads it.
    fs::create_dir(path.join("scenes/parts")).unwrap();
    fs::write(path.join("scenes/parts/ball.pbrt"), "Translate 1 0 4\nShape \"sphere\"\n").unwrap();
    assert_done(path, &format!("{render} --sandbox"));
    let beside = fs::read(path.join("out/a.pfm")).unwrap();
    assert_done(path, &render);
    assert!(beside == fs::read(path.join("out/a.pfm")).unwrap() && beside != found);
}
