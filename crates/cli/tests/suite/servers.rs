//! Guarantees that a server relies on: parts that are complete or refused, an end within two seconds wherever the work is, limits of
//! memory that give a message, and a sandbox that a link does not lead out of.
#![cfg(unix)]

use crate::hang_up;
use serde_json::Value;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

fn bilux(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_bilux"));
    command.current_dir(folder).env("OIDN_LIB", "nowhere").args(line.split_whitespace());
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// The exit status, and what is said on standard output and standard error.
fn answer(folder: &Path, line: &str) -> (i32, String, String) {
    of(bilux(folder, line).output().unwrap())
}

fn of(output: Output) -> (i32, String, String) {
    let text = |bytes| String::from_utf8(bytes).unwrap();
    // As shells report a process that a signal has ended, such as one that has only just started.
    let status = output.status.code().or_else(|| output.status.signal().map(|signal| 128 + signal));
    (status.unwrap_or(-1), text(output.stdout), text(output.stderr))
}

fn done(folder: &Path, line: &str) {
    let (status, _, said) = answer(folder, line);
    assert_eq!(status, 0, "{line}: {said}");
}

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    done(folder.path(), "generate cornell -o box.toml -q");
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Files beside pictures that nobody asked for.
fn left_over(folder: &Path) -> Vec<String> {
    let is_left = |name: &String| name.ends_with(".part") || name.contains(".checkpoint");
    names(folder).into_iter().filter(is_left).collect()
}

fn signal(child: &Child, name: &str) {
    let killed = Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
}

#[test]
fn parts_that_lack_samples_are_refused_with_what_they_lack() {
    let folder = folder();
    let path = folder.path();
    let render = "render box.toml --size 16x12 --spp 8 -i path -q";
    for samples in ["0..2", "2..4", "6..8"] {
        done(path, &format!("{render} --samples {samples} -o {samples}.exr"));
    }
    done(path, &format!("{render} --samples 4..6 --crop 0,0,16,5 -o above.exr"));
    done(path, &format!("{render} --samples 4..6 --crop 0,5,16,7 -o below.exr"));
    done(path, &format!("{render} -o whole.pfm"));
    for (parts, lacks) in [
        ("0..2.exr 2..4.exr", "lack samples 4..8, out of 8"),
        ("2..4.exr 6..8.exr", "lack samples 0..2 and samples 4..6, out of 8"),
        ("0..2.exr 2..4.exr 6..8.exr above.exr", "lack samples 4..6 of the pixels 0,5,16,7, out of 8"),
    ] {
        let (status, _, said) = answer(path, &format!("merge {parts} -o merged.pfm"));
        assert!(status == 1 && said.contains(lacks) && said.contains("--partial"), "{parts}: {said}");
        assert!(!path.join("merged.pfm").exists(), "{parts}");
        let (status, _, said) = answer(path, &format!("merge {parts} -o sums.exr --partial"));
        assert!(status == 0 && said.contains(lacks), "{parts}: {said}");
    }
    // What was merged without the last part knows that it is missing, and takes it later.
    let (status, _, said) = answer(path, "merge sums.exr -o merged.pfm");
    assert!(status == 1 && said.contains("lack samples 4..6 of the pixels 0,5,16,7"), "{said}");
    done(path, "merge below.exr sums.exr -o merged.pfm");
    assert!(fs::read(path.join("merged.pfm")).unwrap() == fs::read(path.join("whole.pfm")).unwrap());
    let (status, _, said) = answer(path, "merge sums.exr above.exr -o twice.pfm --partial");
    assert!(status == 1 && said.contains("samples 4..6 of the pixels 0,0,16,5"), "twice: {said}");
}

#[test]
fn a_picture_can_be_continued_by_parts_that_ask_for_more() {
    let folder = folder();
    let path = folder.path();
    let render = "render box.toml --size 16x12 -i path -q";
    done(path, &format!("{render} --spp 4 --samples 0..4 -o first.exr"));
    done(path, &format!("{render} --spp 8 --samples 4..6 -o more.exr"));
    done(path, "merge first.exr -o first.pfm");
    let (status, _, said) = answer(path, "merge first.exr more.exr -o all.pfm");
    assert!(status == 1 && said.contains("lack samples 6..8, out of 8"), "{said}");
    done(path, &format!("{render} --spp 8 --samples 6..8 -o last.exr"));
    done(path, "merge first.exr last.exr more.exr -o all.exr");
    let all = bilux::pictures::read(path.join("all.exr")).unwrap();
    assert!(all.metadata["bilux.settings"].contains("spp=8"), "{:?}", all.metadata);
}

/// Samples taken, by the sums that a part keeps of each pixel.
fn samples_in(part: &Path) -> f64 {
    let picture = bilux::pictures::read(part).unwrap();
    let counts = picture.integer_plane("samples").unwrap();
    counts.iter().map(|&count| f64::from(count)).sum::<f64>() / counts.len() as f64
}

#[test]
fn an_interrupted_render_says_what_was_taken_and_leaves_nothing_else() {
    let folder = folder();
    let path = folder.path();
    // Without --checkpoint and --resume, a server finds the picture and nothing beside it.
    for (more, is_kept) in [("", false), ("--checkpoint 60", true), ("--resume", true)] {
        let line = format!(
            "render box.toml --size 48x48 -i path --threads 1 --spp 100000 --timeout 1.5 -o a.exr --json {more} --stats s.json"
        );
        let (status, out, said) = answer(path, &line);
        assert_eq!(status, 124, "{said}");
        let taken = samples_in(&path.join("a.exr"));
        assert!(taken > 0.0 && taken < 100_000.0);
        let stats = fs::read_to_string(path.join("s.json")).unwrap();
        for text in [out, stats] {
            let json: Value = serde_json::from_str(&text).unwrap();
            let spp = json["spp"].as_f64().unwrap();
            assert!((spp - taken).abs() < 1e-9 * taken, "{spp}, but the film has {taken}");
            assert_eq!(json["spp_asked"], 100_000);
        }
        let left = left_over(path);
        assert_eq!(left.len(), usize::from(is_kept), "{more}: {left:?}");
        left.iter().for_each(|name| fs::remove_file(path.join(name)).unwrap());
    }
    // As far as it goes, a part that was interrupted can be merged; but it is known not to be all.
    let (status, _, said) = answer(path, "merge a.exr -o a.png");
    assert!(status == 1 && said.contains("out of 100000 for each pixel"), "{said}");
    done(path, "merge a.exr -o a.png --partial");
    // Where noise decides, no number was asked for.
    let (_, out, _) = answer(path, "render box.toml --size 16x16 -i path --noise 50% -o b.png --json -q");
    let json: Value = serde_json::from_str(&out).unwrap();
    assert!(json["spp_asked"].is_null() && json["spp"].as_u64().is_some(), "{out}");
}

/// Starts a command, and sends it a signal when this file is there.
fn signalled_when(folder: &Path, line: &str, file: &str, name: &str) -> (i32, String, String) {
    let child = bilux(folder, line).spawn().unwrap();
    let begun = Instant::now();
    while !folder.join(file).exists() {
        assert!(begun.elapsed() < Duration::from_secs(30), "{line}: there is no {file}");
        std::thread::sleep(Duration::from_millis(5));
    }
    signal(&child, name);
    of(child.wait_with_output().unwrap())
}

/// A signal stops what comes after a picture, but the picture is there, and the line says so.
#[test]
fn a_picture_that_is_written_is_no_failure_whatever_ends_the_rest() {
    let folder = folder();
    let path = folder.path();
    let line = "render box.toml --size 120x90 -i bdpt --spp 48 --aov strategies -o a.png --json -q";
    let (status, out, said) = signalled_when(path, line, "a.png", "-TERM");
    assert_eq!(status, 143, "{said}");
    let json: Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out}"));
    assert!(json["error"].is_null() && json["complete"] == true, "{out}");
    assert!(!path.join("a.strategies").exists(), "it was too late");
}

#[test]
fn a_terminal_that_closes_ends_it_as_ctrl_c_does_but_not_under_nohup() {
    hang_up::is_not_ignored();
    let folder = folder();
    let path = folder.path();
    let line = "render box.toml --size 48x48 -i path --spp 100000 --checkpoint 0.05 -o a.png";
    let (status, _, said) = signalled_when(path, line, "a.png.checkpoint", "-HUP");
    assert!(status == 129 && said.contains("add --resume to continue"), "{status}: {said}");
    assert!(bilux::pictures::read(path.join("a.png")).is_ok());
    let binary = env!("CARGO_BIN_EXE_bilux");
    let script = format!("trap '' HUP; exec {binary} render - -o b.png");
    let mut shell = Command::new("sh");
    shell.current_dir(path).args(["-c", &script]).stdin(Stdio::piped()).stderr(Stdio::null());
    let mut child = shell.spawn().unwrap();
    // Its scene does not end before it does.
    let scene = child.stdin.take();
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-HUP");
    std::thread::sleep(Duration::from_millis(200));
    assert!(child.try_wait().unwrap().is_none(), "it goes on");
    signal(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(143));
    drop(scene);
}

/// The handler that ends the process when memory runs out is no shield against others who end it.
#[test]
fn sigabrt_ends_it_as_it_does_every_program() {
    let folder = folder();
    let child = bilux(folder.path(), "render - -o a.png").stdin(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-ABRT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.signal(), Some(6), "{output:?}");
}

#[test]
fn a_pipe_that_nobody_reads_does_not_keep_it() {
    let folder = folder();
    let (_reader, writer) = std::io::pipe().unwrap();
    let mut filling =
        Command::new("cat").arg("/dev/zero").stdout(writer.try_clone().unwrap()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(200));
    for is_output in [true, false] {
        let mut command = bilux(folder.path(), "render - -o a.png --json");
        command.stdin(Stdio::piped());
        match is_output {
            true => command.stdout(writer.try_clone().unwrap()),
            false => command.stderr(writer.try_clone().unwrap()),
        };
        let child = command.spawn().unwrap();
        std::thread::sleep(Duration::from_millis(300));
        ends_in_time(child, "-TERM", "a full pipe");
    }
    filling.kill().unwrap();
    filling.wait().unwrap();
}

#[test]
fn sigterm_leaves_the_picture_and_no_checkpoint() {
    let folder = folder();
    let path = folder.path();
    let line = "render box.toml --size 48x48 -i path --spp 100000 --stats s.json -o a.png";
    for (more, is_kept) in [("", false), ("--checkpoint 0.1", true)] {
        let child = bilux(path, &format!("{line} {more}")).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(1500));
        signal(&child, "-TERM");
        let (status, _, said) = of(child.wait_with_output().unwrap());
        assert_eq!(status, 143, "{said}");
        assert!(bilux::pictures::read(path.join("a.png")).is_ok());
        assert_eq!(left_over(path).len(), usize::from(is_kept), "{more}: {:?}", left_over(path));
    }
}

#[test]
fn sigterm_between_frames_leaves_no_list_of_them_unless_it_is_asked_for() {
    let folder = folder();
    let path = folder.path();
    let line = "render box.toml --size 24x24 -i path --spp 20 --turntable 2000 -q -o f.png --json";
    for (more, signal_name, is_kept) in [
        ("", "-TERM", false),
        ("", "-INT", true),
        ("--checkpoint 60", "-TERM", true),
        ("--timeout 4", "", false),
    ] {
        let line = format!("{line} {more}");
        let (status, out, said) = match signal_name {
            "" => answer(path, &line),
            name => signalled_when(path, &line, "f-frames.png.checkpoint", name),
        };
        assert!([124, 130, 143].contains(&status), "{status}: {said}");
        let pictures: Vec<Value> =
            out.lines().map(|line| serde_json::from_str::<Value>(line).unwrap()["picture"].clone()).collect();
        let once: std::collections::HashSet<&Value> = pictures.iter().collect();
        assert_eq!(once.len(), pictures.len(), "a picture is told of twice: {out}");
        assert_eq!(
            path.join("f-frames.png.checkpoint").exists(),
            is_kept,
            "{more} {signal_name}: {:?}",
            left_over(path)
        );
        left_over(path).iter().for_each(|name| fs::remove_file(path.join(name)).unwrap());
    }
}

/// The longest that a process may live after a signal; a little more than what is promised, for a loaded machine.
const END: Duration = Duration::from_millis(2600);

/// Sends a signal, and checks that the process ends in time, with the status that shells report.
fn ends_in_time(child: Child, name: &str, what: &str) -> String {
    let begun = Instant::now();
    signal(&child, name);
    let (status, out, said) = of(child.wait_with_output().unwrap());
    assert!(begun.elapsed() < END, "{what}: {:?}", begun.elapsed());
    assert!([if name == "-INT" { 130 } else { 143 }, 0].contains(&status), "{what}: {status}: {said}");
    assert!(!said.contains("panicked"), "{what}: {said}");
    out
}

/// An OBJ file of one triangle, many times, that takes seconds to read.
pub(crate) fn long_to_read() -> String {
    "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned() + &"f 1 2 3\n".repeat(3_000_000)
}

#[test]
fn a_signal_ends_it_at_once_while_it_reads() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    // A pipe that nobody closes: reading never ends. Files take seconds.
    fs::write(path.join("long.obj"), long_to_read()).unwrap();
    for (name, line) in [
        ("-TERM", "render - -o a.png --json"),
        ("-INT", "render - -o a.png --json"),
        ("-TERM", "info long.obj"),
        ("-INT", "convert long.obj -o b.ply"),
        ("-TERM", "generate teapots --from long.obj --count 2 -o two.obj"),
    ] {
        let mut child = bilux(path, line).stdin(Stdio::piped()).spawn().unwrap();
        let pipe = child.stdin.take();
        std::thread::sleep(Duration::from_millis(300));
        let out = ends_in_time(child, name, line);
        drop(pipe);
        if line.contains("--json") {
            let json: Value = serde_json::from_str(&out).unwrap();
            assert!(json["error"].as_str().unwrap().contains("before there was a picture"), "{out}");
        }
        assert!(left_over(path).is_empty() && !path.join("a.png").exists());
    }
}

/// Reading text, building trees, tracing, denoising and writing take turns here; the moments of the signals hit them all.
#[test]
fn a_signal_ends_it_within_two_seconds_wherever_it_is() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let side = 300;
    let vertex = |i: usize| format!("v {} {} {}\n", i % side, (i * 7919) % 13, i / side);
    let face = |i: usize| format!("f {} {} {}\n", i + 1, i + 2, i + side + 1);
    let text: String = (0..side * side).map(vertex).chain((0..side * (side - 1) - 1).map(face)).collect();
    fs::write(path.join("hills.obj"), text).unwrap();
    let line = "render hills.obj --size 1200x900 --spp 2 --noise 0.01% --denoise=builtin -o a.png";
    for after in [20, 60, 120, 250, 450, 700, 1100, 1800] {
        let child = bilux(path, line).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(after));
        ends_in_time(child, "-TERM", &format!("after {after} ms"));
        assert!(left_over(path).is_empty(), "after {after} ms: {:?}", left_over(path));
    }
}

#[test]
fn a_file_that_grows_too_large_leaves_nothing() {
    let folder = folder();
    let path = folder.path();
    let binary = env!("CARGO_BIN_EXE_bilux");
    let line = "render box.toml --size 256x256 --spp 1 -i path -o a.exr --json -q";
    let script = format!("ulimit -f 16; exec {binary} {line}");
    let output = Command::new("sh").current_dir(path).args(["-c", &script]).output().unwrap();
    let (status, out, said) = of(output);
    assert!(status == 1 && said.contains("File too large") && out.contains("\"error\""), "{status}: {said}");
    assert!(left_over(path).is_empty() && !path.join("a.exr").exists(), "{:?}", names(path));
}

/// At any limit of memory it makes the picture, or says in a message and a line of JSON why it does not. 134 would be an
/// abort, 101 a panic, 137 and 139 a kill.
#[cfg(target_os = "linux")]
#[test]
fn too_little_memory_is_a_message() {
    let folder = folder();
    let path = folder.path();
    let binary = env!("CARGO_BIN_EXE_bilux");
    let line = "render box.toml --size 160x120 --spp 1 -i path --aov albedo,depth -o a.exr --json -q";
    let run = |megabytes: u32, line: &str| {
        let script = format!("ulimit -v {}; exec {binary} {line}", megabytes << 10);
        of(Command::new("sh").current_dir(path).args(["-c", &script]).output().unwrap())
    };
    // With less, the system cannot load the program.
    let least = (20..200).step_by(2).find(|&megabytes| run(megabytes, "-V").0 == 0).unwrap();
    let mut statuses = Vec::new();
    for more in [0, 4, 10, 20, 35, 50, 70, 90, 120, 160, 260, 460, 760, 1560] {
        let megabytes = least + more;
        let (status, out, said) = run(megabytes, line);
        assert!([0, 1].contains(&status), "{megabytes} MB: {status}: {said}");
        assert!(!said.contains("panicked"), "{megabytes} MB: {said}");
        let json: Value =
            serde_json::from_str(&out).unwrap_or_else(|_| panic!("{megabytes} MB: {out:?} {said}"));
        assert_eq!(json["error"].is_string(), status == 1, "{megabytes} MB: {out}");
        statuses.push(status);
    }
    assert_eq!(
        (statuses[0], statuses[statuses.len() - 1]),
        (1, 0),
        "{least} MB are too little, 1.6 GB enough: {statuses:?}"
    );
    // A scene that needs more than the limit is refused before it is built, and the message names the limit.
    let line = "render box.toml --size 8000x8000 --spp 1 -o a.exr --json -q";
    let script = format!("ulimit -v 1000000; exec {binary} {line}");
    let (status, _, said) = of(Command::new("sh").current_dir(path).args(["-c", &script]).output().unwrap());
    assert!(status == 1 && said.contains("make the picture smaller") && said.contains("ulimit -v"), "{said}");
}

#[test]
fn every_command_that_reads_pictures_keeps_to_max_memory() {
    let folder = folder();
    let path = folder.path();
    done(path, "render box.toml --size 256x256 --spp 1 --samples 0..1 -i path -o a.exr -q");
    for line in
        ["compare a.exr a.exr", "merge a.exr -o b.png", "denoise a.exr -o b.png", "convert a.exr -o b.png"]
    {
        let (status, _, said) = answer(path, &format!("{line} --max-memory 1M"));
        assert!(status != 0 && said.contains("a.exr"), "{line}: {status} {said}");
        done(path, line);
    }
}

/// Reports about other programs (`docs/lab/reports-use.md`): mistakes that went unnoticed, with status 0.
#[test]
fn mistakes_on_the_command_line_are_errors_before_any_work() {
    let folder = folder();
    let path = folder.path();
    fs::create_dir(path.join("dir")).unwrap();
    done(path, "render box.toml --size 8x8 --spp 1 -i path -o a.png -q");
    for (line, what) in [
        ("compare a.png a.png --heat-map nowhere/h.png", "there is no folder 'nowhere'"),
        ("compare a.png a.png --html nowhere/h.html", "there is no folder 'nowhere'"),
        ("convert box.toml -o dir", "this is a folder"),
        ("render box.toml -o dir/", "this is a folder"),
        ("merge a.png -o dir", "this is a folder"),
        ("convert box.toml -o b.ply more", "unexpected argument 'more'"),
        ("compare a.png a.png more", "unexpected argument 'more'"),
        ("info box.toml more", "unexpected argument 'more'"),
        ("render box.toml -o b.png --spp 3x", "'3x'"),
        ("render box.toml -o b.png --size 64", "write 64x64"),
        ("render box.toml -o b.png --crop 1,2", "'1,2'"),
        ("render box.toml -o b.png --samples 3", "'3'"),
        ("render box.toml -o b.png --aov depht", "did you mean 'depth'"),
        ("render box.toml -o b.png --set spp", "write KEY=VALUE"),
        ("render box.toml -o b.png --set sp=4", "'spp'"),
        ("render box.toml -o b.png --timeout soon", "'soon'"),
    ] {
        let (status, out, said) = answer(path, line);
        assert!(status == 2 && said.contains(what) && out.is_empty(), "{line}: {status} {said}");
        assert!(!path.join("b.png").exists() && !path.join("b.ply").exists(), "{line}");
    }
}

#[test]
fn standard_output_has_the_picture_and_nothing_else_in_any_language() {
    let folder = folder();
    let path = folder.path();
    let line = "render box.toml --size 8x8 --spp 1 -i path --exposure 0.5";
    done(path, &format!("{line} -o a.png -q"));
    let file = fs::read(path.join("a.png")).unwrap();
    for language in ["C", "de_DE.UTF-8", "tr_TR.UTF-8"] {
        let mut command = bilux(path, &format!("{line} -o - -vv --progress lines"));
        let output = command.env("LC_ALL", language).env("LANG", language).output().unwrap();
        assert!(output.stdout == file, "{language}");
        assert!(!output.stderr.is_empty(), "what it says goes to standard error");
    }
}

/// Each option of a pair has its own effect, without the other one and with it.
#[test]
fn each_option_of_a_pair_works_alone() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    // A wedge, which looks different from everywhere.
    let wedge = "v 0 0 0\nv 3 0 0\nv 0 0 2\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
    fs::write(path.join("wedge.obj"), wedge).unwrap();
    let picture = |options: &str| {
        done(path, &format!("render wedge.obj --size 24x18 --spp 2 -i path -o a.png -q {options}"));
        fs::read(path.join("a.png")).unwrap()
    };
    let plain = picture("");
    for (one, other) in [
        ("--up z", "--front x"),
        ("--eye 4,3,5", "--look-at 1,0,0"),
        ("--orbit 40,0", "--orbit=0,30"),
        ("--zoom 2", "--focal 80"),
        ("--ground none", "--background #204060"),
        ("--exposure=-1", "--tonemap agx"),
        ("--seed 5", "--max-depth 0"),
    ] {
        let both = match (one.strip_prefix("--orbit"), other.strip_prefix("--orbit")) {
            (Some(_), Some(_)) => "--orbit 40,30".to_owned(),
            _ => format!("{one} {other}"),
        };
        let pictures = [plain.clone(), picture(one), picture(other), picture(&both)];
        for (i, first) in pictures.iter().enumerate() {
            for second in &pictures[..i] {
                assert!(first != second, "{one} and {other}: two of the four are the same");
            }
        }
        let turned = format!("{other} {one}");
        assert!(
            both == "--orbit 40,30" || picture(&turned) == pictures[3],
            "{one} and {other}: their order counts"
        );
    }
}

fn link(target: &str, link: &Path) {
    std::os::unix::fs::symlink(target, link).unwrap();
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn a_link_does_not_lead_out_of_a_sandbox() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    for name in ["uploads", "uploads/parts", "elsewhere", "out"] {
        fs::create_dir(path.join(name)).unwrap();
    }
    for name in ["elsewhere/secret.obj", "uploads/parts/real.obj", "uploads/own.obj"] {
        fs::write(path.join(name), TRIANGLE).unwrap();
    }
    done(path, "render uploads/own.obj --size 8x8 --spp 1 -o elsewhere/secret.exr -q");
    link("../elsewhere/secret.obj", &path.join("uploads/out.obj"));
    link("out.obj", &path.join("uploads/chain.obj"));
    link("parts/real.obj", &path.join("uploads/within.obj"));
    link("uploads", &path.join("current"));
    link("../elsewhere/secret.exr", &path.join("uploads/sky.exr"));
    let render = "--size 8x8 --spp 1 -o out/a.png --sandbox -q";
    for scene in ["uploads/out.obj", "uploads/chain.obj", "uploads/parts/../out.obj"] {
        let lines = [
            format!("render {scene} {render} --json"),
            format!("info {scene} --sandbox"),
            format!("explain {scene} --sandbox"),
            format!("convert {scene} -o out/a.ply --sandbox"),
            format!("generate teapots --from {scene} --count 2 -o out/two.obj --sandbox"),
        ];
        for line in lines {
            let (status, out, said) = answer(path, &line);
            let is_refused = status == 1 && said.contains("link that leads out of it");
            assert!(is_refused, "{line}: {status} {said}");
            assert_eq!(out.contains("\"error\""), line.contains("--json"), "{line}: {out}");
            done(path, &line.replace("--sandbox", ""));
        }
    }
    // So does a picture that an option names; and one scene that leads out does not stop another.
    let (status, _, said) = answer(path, &format!("render uploads/own.obj --env uploads/sky.exr {render}"));
    assert!(status == 1 && said.contains("uploads/sky.exr: --sandbox"), "{said}");
    let both = "render uploads/out.obj uploads/own.obj --size 8x8 --spp 1 -o out/{stem}.png --sandbox -q";
    let (status, _, said) = answer(path, both);
    assert!(status == 1 && said.contains("1 of 2") && path.join("out/own.png").exists(), "{said}");
    // A link within the folder is as good as a file, and so is a link to the folder.
    for scene in ["uploads/within.obj", "current/own.obj", "current/within.obj", "uploads/parts/../own.obj"] {
        done(path, &format!("render {scene} {render}"));
    }
}

#[test]
fn what_is_written_beside_the_picture_does_not_lead_out_of_a_sandbox() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    fs::create_dir(path.join("out")).unwrap();
    fs::write(path.join("own.obj"), TRIANGLE).unwrap();
    fs::write(path.join("theirs"), "theirs").unwrap();
    link("../theirs", &path.join("out/a.layers.exr"));
    link("../theirs", &path.join("out/b.png.checkpoint"));
    for (name, more) in [("a.png", "--aov depth"), ("b.png", "--checkpoint 1")] {
        let line = format!("render own.obj --size 8x8 --spp 1 -o out/{name} {more} --sandbox");
        let (status, _, said) = answer(path, &line);
        assert!(status == 2 && said.contains("--sandbox writes only to"), "{said}");
        assert_eq!(fs::read_to_string(path.join("theirs")).unwrap(), "theirs");
    }
}
