//! Jobs for farms: their tasks, run one by one, give the bytes that one render gives. `crates/python/tests/test_farm.py`
//! has them checked and run by OpenJD's own tools.

use assert_cmd::Command;
use std::path::Path;
use tempfile::TempDir;

fn bilux(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("bilux").expect("the binary is built with its tests");
    command.current_dir(folder).arg("--quiet");
    command
}

/// Runs every task of the job array as Slurm would, and returns their number.
fn run_array(job: &Path) -> usize {
    let script = std::fs::read_to_string(job.join("slurm.sh")).unwrap();
    let last = script.lines().find_map(|line| line.strip_prefix("#SBATCH --array=0-")).unwrap();
    let last: usize = last.parse().unwrap();
    let binary = assert_cmd::cargo::cargo_bin("bilux");
    // The order of tasks does not matter.
    for task in (0..=last).rev() {
        let mut shell = Command::new("sh");
        shell.current_dir(job).env("BILUX", &binary).env("SLURM_ARRAY_TASK_ID", task.to_string());
        shell.arg("slurm.sh").assert().success();
    }
    last + 1
}

/// Progress of a command in percent, as a scheduler is told of it by OpenJD's specification.
fn told(folder: &Path, words: &[&str]) -> Vec<f64> {
    let mut task = Command::cargo_bin("bilux").unwrap();
    let done = task.current_dir(folder).args(words).assert().success();
    let said = String::from_utf8_lossy(&done.get_output().stderr).into_owned();
    said.lines().filter_map(|line| line.strip_prefix("openjd_progress: ")?.parse().ok()).collect()
}

/// Runs the last line of the README's recipe for GNU parallel: the merge.
fn merge(job: &Path) {
    let readme = std::fs::read_to_string(job.join("README.md")).unwrap();
    let line = readme.lines().rfind(|line| line.contains("} \\") || line.contains(" merge ")).unwrap();
    let mut shell = Command::new("sh");
    shell.current_dir(job).env("BILUX", assert_cmd::cargo::cargo_bin("bilux"));
    shell.args(["-c", line]).assert().success();
}

#[cfg(unix)]
#[test]
fn merged_tasks_are_the_picture_of_one_render() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    // A name that a shell and a template must not misread.
    bilux(path).args(["generate", "trio", "-o", "it's $a {trio}.glb"]).assert().success();
    std::fs::write(path.join("back drop.ppm"), b"P6 2 1 255\n\x20\x40\x80\x80\x40\x20").unwrap();
    std::fs::create_dir(path.join("sky")).unwrap();
    std::fs::write(path.join("sky/sky.pfm"), b"PF\n1 1\n-1\n\0\0\x80\x3f\0\0\x80\x3f\0\0\0\x40").unwrap();
    let options = ["--spp", "7", "--size", "40x30", "--env=sky/sky.pfm", "--background", "back drop.ppm"];
    let options = [&options[..], &["--tonemap", "agx", "--exposure", "auto", "--max-depth", "4"]].concat();
    let scene = "it's $a {trio}.glb";
    bilux(path).args(["farm", scene, "--chunks", "3", "-o", "job", "--"]).args(&options).assert().success();
    bilux(path).args(["render", scene, "-o", "whole.png"]).args(&options).assert().success();
    // The job is complete: it can be moved, and what it was made from can be gone.
    std::fs::rename(path.join("job"), path.join("moved")).unwrap();
    for used in [scene, "back drop.ppm", "sky/sky.pfm"] {
        std::fs::remove_file(path.join(used)).unwrap();
    }
    assert_eq!(run_array(&path.join("moved")), 3);
    merge(&path.join("moved"));
    let merged = std::fs::read(path.join("moved/pictures/it's $a {trio}.png")).unwrap();
    assert!(merged == std::fs::read(path.join("whole.png")).unwrap(), "the merged picture differs");
}

#[cfg(unix)]
#[test]
fn tasks_write_the_frames_of_one_render() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    let generate = ["generate", "teapots", "--count", "2", "--set", "moving=true", "-o", "move.toml"];
    bilux(path).args(generate).args(["--set", "tessellation=3"]).assert().success();
    let options = ["--spp", "2", "--size", "32x24", "--set", "fps=2"];
    let farm = ["farm", "move.toml", "--frames", "1-5", "--chunks", "2", "-o", "job", "--"];
    bilux(path).args(farm).args(options).assert().success();
    let render = ["--progress=openjd", "render", "move.toml", "--frames", "1-5", "-o", "{stem}-{frame}.png"];
    assert_eq!(told(path, &[&render[..], &options].concat()), [20.0, 40.0, 60.0, 80.0, 100.0]);
    assert_eq!(run_array(&path.join("job")), 2);
    let frame =
        |folder: &Path, frame: u32| std::fs::read(folder.join(format!("move-{frame:04}.png"))).unwrap();
    for number in 1..=5 {
        assert!(frame(path, number) == frame(&path.join("job/pictures"), number), "frame {number} differs");
    }
    assert!(frame(path, 1) != frame(path, 5), "nothing moves");
}

#[cfg(unix)]
#[test]
fn tasks_write_the_pictures_of_one_turn() {
    let folder = TempDir::new().unwrap();
    let path = folder.path();
    bilux(path).args(["generate", "teapot", "--set", "tessellation=3", "-o", "pot.toml"]).assert().success();
    let options = ["--spp", "2", "--size", "32x24"];
    let farm = ["farm", "pot.toml", "--turntable", "5", "--chunks", "2", "-o", "job", "--"];
    bilux(path).args(farm).args(options).assert().success();
    let render = ["render", "pot.toml", "--turntable", "5", "-o", "{stem}-{frame}.png"];
    bilux(path).args(render).args(options).assert().success();
    assert_eq!(run_array(&path.join("job")), 2);
    let picture =
        |folder: &Path, number: u32| std::fs::read(folder.join(format!("pot-{number:04}.png"))).unwrap();
    for number in 0..5 {
        assert!(
            picture(path, number) == picture(&path.join("job/pictures"), number),
            "picture {number} differs"
        );
    }
    assert!(picture(path, 0) != picture(path, 2), "nothing turns");
    // A scheduler is told how far a task of several pictures is.
    let render = ["--progress=openjd", "render", "pot.toml", "--turntable", "5", "--frames", "1-4"];
    let words = [&render[..], &["-o", "a-{frame}.png"], &options].concat();
    assert_eq!(told(path, &words), [25.0, 50.0, 75.0, 100.0]);
    assert!(!path.join("a-0000.png").exists() && path.join("a-0004.png").exists());
    let wrong = ["render", "pot.toml", "--turntable", "5", "--frames", "1-5", "-o", "a-{frame}.png"];
    bilux(path).args(wrong).assert().code(2);
}

#[test]
fn a_job_that_cannot_be_made_leaves_no_folder() {
    let folder = TempDir::new().unwrap();
    bilux(folder.path()).args(["farm", "none.obj", "--chunks", "2", "-o", "job"]).assert().code(1);
    assert!(!folder.path().join("job").exists());
}
