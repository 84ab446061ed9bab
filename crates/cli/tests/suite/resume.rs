//! Renders that are killed, interrupted or short of disk space lose nothing: `--resume` goes on to the bytes of a render that was
//! left alone.
#![cfg(unix)]

use assert_cmd::Command;
use assert_cmd::assert::Assert;
use bilux::math::hash::hash_words;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};
use tempfile::TempDir;

fn bilux(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
    command.current_dir(folder);
    command
}

fn run(folder: &Path, line: &str) -> Assert {
    bilux(folder).args(line.split_whitespace()).assert()
}

fn stderr(assert: &Assert) -> String {
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    run(folder.path(), "--quiet generate cornell -o box.toml").success();
    folder
}

fn names(folder: &Path) -> Vec<String> {
    let entry =
        |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().to_string_lossy().into_owned();
    let mut names: Vec<String> = std::fs::read_dir(folder).unwrap().map(entry).collect();
    names.sort();
    names
}

/// Starts a render, and sends it a signal after some time. Returns true if it had ended before.
fn start_and_signal(folder: &Path, line: &str, signal: &str, after: Duration) -> bool {
    let binary = assert_cmd::cargo::cargo_bin("bilux");
    let mut command = std::process::Command::new(binary);
    command.current_dir(folder).args(line.split_whitespace()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
    std::thread::sleep(after);
    let has_ended = child.try_wait().unwrap().is_some();
    if !has_ended {
        let id = child.id().to_string();
        let _ = std::process::Command::new("kill").args([signal, &id]).status().unwrap();
    }
    let status = child.wait().unwrap();
    assert!(!has_ended || status.success(), "{line}: {status}");
    has_ended
}

/// Kills renders of a picture so many times at random moments, and returns how often one went on from a checkpoint.
fn kill_and_resume(folder: &Path, line: &str, name: &str, kills: u32, seed: u64) -> u32 {
    let begun = Instant::now();
    run(folder, &format!("{line} --checkpoint off -o whole-{name}")).success();
    let whole = begun.elapsed();
    let line = format!("{line} --checkpoint 0.05 --resume -o {name}");
    let assert_same = |when: &str| {
        let bytes = |name: &str| std::fs::read(folder.join(name)).unwrap();
        assert!(bytes(name) == bytes(&format!("whole-{name}")), "{line}: other bytes {when}");
        let left: Vec<String> =
            names(folder).into_iter().filter(|file| file.contains("checkpoint")).collect();
        assert!(left.is_empty(), "{left:?} are left");
    };
    let (mut done, mut resumed) = (0, 0);
    for attempt in 0..10 * u64::from(kills) {
        if done == kills {
            break;
        }
        let has_checkpoint = folder.join(format!("{name}.checkpoint")).exists();
        // Anywhere in the time of the whole, and so also while the scene is read, while a checkpoint is written, and at the end.
        let share = hash_words([seed, attempt]) as f64 / u64::MAX as f64;
        if start_and_signal(folder, &line, "-KILL", whole.mul_f64(share)) {
            // The next one begins anew.
            assert_same("before a kill");
        } else {
            done += 1;
        }
        resumed += u32::from(has_checkpoint);
    }
    assert_eq!(done, kills, "{line}: it always ends before");
    resumed += u32::from(folder.join(format!("{name}.checkpoint")).exists());
    run(folder, &line).success();
    assert_same("after the kills");
    resumed
}

#[test]
fn twenty_kills_at_random_moments_change_no_byte() {
    let folder = folder();
    let cases = [
        ("path", "--spp 100", 4),
        ("vcm", "--spp 16", 4),
        ("auto", "--spp 100", 3),
        ("path", "--noise 8%", 3),
        ("vcm", "--noise 15%", 3),
        ("auto", "--noise 8% --denoise=builtin", 3),
    ];
    let mut resumed = 0;
    for (i, (integrator, end, kills)) in cases.into_iter().enumerate() {
        let line = format!("--quiet render box.toml --size 48x48 -i {integrator} {end}");
        resumed += kill_and_resume(folder.path(), &line, &format!("{i}.png"), kills, i as u64);
    }
    assert_eq!(cases.iter().map(|(.., kills)| kills).sum::<u32>(), 20);
    assert!(resumed >= 6, "only {resumed} renders went on from a checkpoint");
}

/// A checkpoint of a render that was interrupted, and its line without the output.
fn interrupted(folder: &Path, more: &str) -> (String, PathBuf) {
    let line = format!("render box.toml --size 48x48 -i path --spp 4000 {more}");
    assert!(!start_and_signal(folder, &format!("{line} -o a.png"), "-INT", Duration::from_millis(900)));
    let file = folder.join("a.png.checkpoint");
    assert!(file.is_file() && folder.join("a.png").is_file(), "an interrupt keeps both");
    (line, file)
}

#[test]
fn a_checkpoint_that_does_not_fit_is_refused_with_what_differs() {
    let folder = folder();
    let path = folder.path();
    let (_, file) = interrupted(path, "");
    let kept = std::fs::read(&file).unwrap();
    let refused =
        |line: &str| stderr(&run(path, &format!("render box.toml -o a.png --resume {line}")).code(1));
    let said = refused("--size 48x48 -i path --spp 4000 --seed 7");
    assert!(said.contains("what differs: seed (0 there, 7 here)"), "{said}");
    let said = refused("--size 32x32 -i vcm --spp 4000");
    assert!(said.contains("size (48x48 there, 32x32 here), integrator (path there, vcm here)"), "{said}");
    let said = refused("--size 48x48 -i path --spp 1");
    assert!(said.contains("ask for more samples"), "{said}");
    let said = refused("--size 48x48 -i path --noise 1%");
    assert!(said.contains("the noise so far"), "{said}");
    std::fs::write(
        path.join("box.toml"),
        std::fs::read_to_string(path.join("box.toml")).unwrap().replace("0.", "0.0"),
    )
    .unwrap();
    let said = refused("--size 48x48 -i path --spp 4000");
    assert!(said.contains("the scene, its files"), "{said}");
    assert!(std::fs::read(&file).unwrap() == kept, "a refusal changes nothing");
}

#[test]
fn a_damaged_checkpoint_is_refused_and_never_overwritten_in_silence() {
    let folder = folder();
    let path = folder.path();
    let (line, file) = interrupted(path, "");
    let whole = std::fs::read(&file).unwrap();
    for round in 0..40u64 {
        let mut bytes = whole.clone();
        let random = hash_words([round, 3]) as usize;
        match round % 4 {
            0 => bytes.truncate(random % whole.len()),
            // One sum altered: the planted bug that would give another picture.
            _ => bytes[random % whole.len()] ^= 1 << (random >> 40 & 7),
        }
        std::fs::write(&file, &bytes).unwrap();
        let said = stderr(&run(path, &format!("{line} -o a.png --resume")).code(1));
        assert!(said.contains("a.png.checkpoint: this") && !said.contains("panicked"), "{said}");
        assert!(std::fs::read(&file).unwrap() == bytes);
    }
    // Without --resume it is kept under another name.
    std::fs::write(&file, "not a checkpoint").unwrap();
    let said = stderr(&run(path, "render box.toml --size 8x8 --spp 1 -o a.png").success());
    assert!(said.contains("is kept as a.png.checkpoint.old"), "{said}");
    assert_eq!(std::fs::read(path.join("a.png.checkpoint.old")).unwrap(), b"not a checkpoint");
}

#[test]
fn a_render_without_resume_keeps_the_checkpoint_until_it_has_got_further() {
    let folder = folder();
    let path = folder.path();
    let (line, file) = interrupted(path, "");
    let kept = std::fs::read(&file).unwrap();
    // A draft of the same picture, with fewer samples.
    let draft = line.replace("--spp 4000", "--spp 1");
    let said = stderr(&run(path, &format!("{draft} -o a.png")).success());
    assert!(said.contains("--resume continues from them"), "{said}");
    assert!(std::fs::read(&file).unwrap() == kept, "it is lost");
    // And one that is interrupted at once.
    assert!(!start_and_signal(
        path,
        &format!("{line} -o a.png --threads 1"),
        "-INT",
        Duration::from_millis(120)
    ));
    assert!(std::fs::read(&file).unwrap() == kept, "it is lost");
}

#[test]
fn a_full_disk_keeps_the_old_checkpoint_and_the_render_goes_on() {
    let folder = folder();
    let path = folder.path();
    let line = "render box.toml --size 96x96 -i path --spp 60 --checkpoint 0.05 -o a.png";
    // A file may have 64 blocks of 512 or 1024 bytes: enough for the picture, too few for a checkpoint.
    let script = format!("trap '' XFSZ; ulimit -f 64; exec \"$BILUX\" {line}");
    let mut shell = Command::new("sh");
    shell.current_dir(path).env("BILUX", assert_cmd::cargo::cargo_bin("bilux")).args(["-c", &script]);
    let said = stderr(&shell.assert().success());
    assert!(said.contains("cannot write the checkpoint") && said.contains("the render goes on"), "{said}");
    assert_eq!(said.matches("cannot write the checkpoint").count(), 1, "it is said once: {said}");
    run(path, &line.replace("a.png", "b.png")).success();
    assert!(std::fs::read(path.join("a.png")).unwrap() == std::fs::read(path.join("b.png")).unwrap());
    assert!(names(path).iter().all(|name| !name.contains("checkpoint")), "{:?}", names(path));
}

#[test]
fn finished_frames_are_not_rendered_again() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let generate = "--quiet generate teapots --count 2 --set moving=true --set tessellation=3 -o move.toml";
    run(path, generate).success();
    let line = "render move.toml --size 32x24 --spp 60 --frames 0-5 --set fps=2 --checkpoint 0.05";
    run(path, &format!("--quiet {line} -o whole-{{frame}}.png")).success();
    let mut pauses = (1..).map(|i| Duration::from_millis(120 * i));
    // Until at least one frame is finished.
    while !path.join("part-0000.png").exists() {
        start_and_signal(
            path,
            &format!("{line} --resume -o part-{{frame}}.png"),
            "-KILL",
            pauses.next().unwrap(),
        );
    }
    if path.join("part-frames.png.checkpoint").exists() {
        let other = run(path, &format!("{line} --seed 4 --resume -o part-{{frame}}.png")).code(1);
        assert!(stderr(&other).contains("seed"), "{}", stderr(&other));
        // What changes no sample may be another.
        let quick = format!("{line} --set cpu=baseline --set early_out=false --threads 1");
        let said = stderr(&run(path, &format!("{quick} --resume -o part-{{frame}}.png")).success());
        assert!(said.contains("part-0000.png: finished before"), "{said}");
    }
    for frame in 0..=5 {
        let bytes = |name: &str| std::fs::read(path.join(format!("{name}-{frame:04}.png"))).unwrap();
        assert!(bytes("part") == bytes("whole"), "frame {frame} differs");
    }
    assert!(names(path).iter().all(|name| !name.contains("checkpoint")), "{:?}", names(path));
}

/// Waits until something is true.
fn wait_until(what: &str, is_true: impl Fn() -> bool) {
    let begun = Instant::now();
    while !is_true() {
        assert!(begun.elapsed() < Duration::from_secs(30), "{what}: not after 30 s");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_watched_scene_is_rendered_again_and_a_broken_one_keeps_the_picture() {
    let folder = folder();
    let path = folder.path();
    let said = std::fs::File::create(path.join("said")).unwrap();
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("bilux"))
        .current_dir(path)
        .args("render box.toml --size 24x24 --spp 2 --watch -o a.png".split_whitespace())
        .stderr(said)
        .spawn()
        .unwrap();
    let log = || std::fs::read_to_string(path.join("said")).unwrap();
    let waits =
        |times: usize| wait_until("it waits", || log().matches("waits for a change").count() >= times);
    let picture = || std::fs::read(path.join("a.png")).unwrap_or_default();
    waits(1);
    let first = picture();
    let scene = std::fs::read_to_string(path.join("box.toml")).unwrap();
    // The files that were read join those that are watched at the next look.
    std::thread::sleep(Duration::from_millis(500));
    std::fs::write(path.join("box.toml"), "[[broken").unwrap();
    waits(2);
    assert!(
        log().contains("error: box.toml:1") && log().contains("the picture stays as it was"),
        "{}",
        log()
    );
    assert!(picture() == first);
    std::fs::write(path.join("box.toml"), format!("{scene}\n[render]\nexposure = 1.0\n")).unwrap();
    waits(3);
    assert!(picture() != first, "{}", log());
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    assert!(child.wait().unwrap().success());
}

#[test]
fn a_preview_is_drawn_where_it_is_asked_for() {
    let folder = folder();
    let path = folder.path();
    let line = "render box.toml --size 24x24 --spp 8 --quiet -o a.png";
    run(path, line).success();
    let plain = std::fs::read(path.join("a.png")).unwrap();
    for (name, mark) in [
        ("blocks", "▀"),
        ("kitty", "\x1b_Ga=T"),
        ("iterm", "\x1b]1337;File=inline=1"),
        ("sixel", "\x1bP9;1q"),
    ] {
        let said = stderr(&run(path, &format!("{line} --preview={name}")).success().stdout(""));
        assert!(said.contains(mark), "{name}: {said:?}");
        assert!(std::fs::read(path.join("a.png")).unwrap() == plain, "{name} changes the picture");
    }
    let said = stderr(&run(path, &format!("{line} --preview")).success());
    assert!(said.contains("no terminal") && !said.contains('\x1b'), "{said:?}");
}
