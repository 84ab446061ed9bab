//! `bilux worker`: jobs in, results out, one process.
#![cfg(unix)]

use crate::hang_up;
use crate::servers::long_to_read;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const CARD: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    for name in ["a", "b", "c"] {
        std::fs::create_dir(folder.path().join(name)).unwrap();
        std::fs::write(folder.path().join(format!("{name}/card.obj")), CARD).unwrap();
    }
    folder
}

fn bilux(folder: &Path) -> Command {
    let mut bilux = Command::new(env!("CARGO_BIN_EXE_bilux"));
    bilux.current_dir(folder);
    bilux
}

/// The results of jobs, each a line.
fn results(folder: &Path, options: &[&str], lines: &[String]) -> Vec<Value> {
    let mut worker = bilux(folder);
    worker.arg("worker").args(options).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut worker = worker.spawn().unwrap();
    let mut input = worker.stdin.take().unwrap();
    for line in lines {
        writeln!(input, "{line}").unwrap();
    }
    drop(input);
    let output = worker.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn job(id: u32, scene: &str, more: Value) -> String {
    let mut job = json!({ "id": id, "scene": scene, "output": format!("{id}.png"), "size": [24, 16], "spp": 2, "integrator": "path" });
    job.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    job.to_string()
}

#[test]
fn every_line_gets_its_result_and_pictures_are_those_of_render() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("broken.obj"), "v 0 0 0\nf 1 2 9\n").unwrap();
    let lines = [
        job(1, "a/card.obj", json!({})),
        "this is no JSON".to_owned(),
        job(2, "missing.obj", json!({})),
        String::new(),
        job(3, "broken.obj", json!({})),
        job(4, "a/card.obj", json!({ "sze": 5 })),
        job(5, "a/card.obj", json!({ "spp": "many" })),
        job(6, "a/card.obj", json!({ "output": "none/6.png" })),
        job(7, "b/card.obj", json!({ "orbit": [30, 20], "ground": "shadow" })),
        job(8, "a/card.obj", json!({ "output": "8-{frame}.png", "turntable": 3 })),
        job(
            9,
            "a/card.obj",
            json!({ "aov": ["depth", "position"], "output": "9.exr", "integrator": "path" }),
        ),
    ];
    let results = results(path, &[], &lines);
    let statuses: Vec<(Value, i64)> =
        results.iter().map(|result| (result["id"].clone(), result["status"].as_i64().unwrap())).collect();
    let wanted = [(1, 0), (0, 2), (2, 1), (3, 1), (4, 2), (5, 2), (6, 2), (7, 0), (8, 0), (9, 0)];
    let wanted = wanted.map(|(id, status)| (if id == 0 { Value::Null } else { json!(id) }, status));
    assert_eq!(statuses, wanted, "{results:#?}");
    assert_eq!((&results[1]["line"], &results[3]["line"]), (&json!(2), &json!(5)), "empty lines count");
    let keys = |result: &Value| result.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert!(results.iter().all(|result| keys(result) == keys(&results[0])), "{results:#?}");
    let error = |index: usize| results[index]["error"].as_str().unwrap().to_owned();
    assert!(error(1).contains("no JSON object"), "{}", error(1));
    assert!(error(2).contains("missing.obj"), "{}", error(2));
    assert!(error(3).contains("broken.obj:2:1"), "{}", error(3));
    assert!(error(4).contains("did you mean 'size'?"), "{}", error(4));
    assert!(error(5).contains("--spp"), "{}", error(5));
    assert!(error(6).contains("there is no folder 'none'"), "{}", error(6));
    for (index, pictures) in [(0, 1), (7, 1), (8, 3), (9, 1)] {
        let result = &results[index];
        assert!(result["error"].is_null() && result["warnings"] == json!([]), "{result:#}");
        assert!(result["seconds"].as_f64().unwrap() > 0.0);
        assert_eq!(result["pictures"].as_array().unwrap().len(), pictures, "{result:#}");
        assert_eq!((&result["pictures"][0]["width"], &result["pictures"][0]["spp"]), (&json!(24), &json!(2)));
    }
    let rendered = |options: &[&str]| {
        let common = ["--size", "24x16", "--spp", "2", "-i", "path", "-q", "-o", "same.png"];
        assert!(bilux(path).arg("render").args(options).args(common).status().unwrap().success());
        std::fs::read(path.join("same.png")).unwrap()
    };
    assert!(std::fs::read(path.join("1.png")).unwrap() == rendered(&["a/card.obj"]));
    let options = ["b/card.obj", "--orbit", "30,20", "--ground", "shadow"];
    assert!(
        std::fs::read(path.join("7.png")).unwrap() == rendered(&options),
        "no job is changed by those before it"
    );
    assert!(path.join("8-0002.png").is_file() && path.join("9.exr").is_file());
    assert!(!path.join("2.png").exists() && !path.join("3.png").exists());
}

#[test]
fn a_job_that_takes_too_long_is_stopped_and_the_next_is_not() {
    // On a busy machine nothing may be rendered in half a second.
    for seconds in [0.5, 8.0] {
        let folder = folder();
        let path = folder.path();
        let long = json!({ "spp": 4_000_000, "size": "100x100", "timeout": seconds });
        let lines =
            [job(1, "a/card.obj", long), job(2, "a/card.obj", json!({})), job(3, "a/card.obj", json!({}))];
        let begun = Instant::now();
        let results = results(path, &["--timeout", "60"], &lines);
        assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
        assert_eq!(results[0]["status"], 124, "{results:#?}");
        let wanted = format!("the time of {seconds} s was up");
        assert!(results[0]["error"].as_str().unwrap().contains(&wanted), "{results:#?}");
        assert_eq!((&results[1]["status"], &results[2]["status"]), (&json!(0), &json!(0)));
        let is_saved = path.join("1.png").is_file();
        if is_saved || seconds > 0.5 {
            assert!(is_saved, "what was rendered is saved");
            assert_eq!(results[0]["pictures"][0]["complete"], false);
            return;
        }
    }
}

#[test]
fn the_worker_s_own_limit_ends_a_job_too() {
    let folder = folder();
    let long = job(1, "a/card.obj", json!({ "spp": 4_000_000, "size": "100x100", "timeout": 1000 }));
    let results =
        results(folder.path(), &["--timeout", "0.3", "--max-memory", "1M"], std::slice::from_ref(&long));
    assert_eq!(results[0]["status"], 1, "{results:#?}");
    assert!(results[0]["error"].as_str().unwrap().contains("--max-memory"), "{results:#?}");
    let results = self::results(folder.path(), &["--timeout", "0.3"], &[long]);
    assert_eq!(results[0]["status"], 124, "{results:#?}");
}

#[test]
fn a_sandbox_holds_for_each_job() {
    let folder = folder();
    let path = folder.path();
    for name in ["a", "b"] {
        let text = format!("[[model]]\nfile = \"../c/card.obj\"\n[[model]]\nfile = \"card.obj\"\n# {name}\n");
        std::fs::write(path.join(format!("{name}/out.toml")), text).unwrap();
    }
    let lines = [
        job(1, "a/card.obj", json!({ "output": "a/1.png" })),
        job(2, "a/out.toml", json!({ "output": "a/2.png", "sandbox": false })),
        job(3, "b/card.obj", json!({ "output": "b/3.png" })),
        job(4, "b/card.obj", json!({ "output": "b/4.png" })),
        job(5, "a/card.obj", json!({ "output": "b/5.png" })),
    ];
    let results = results(path, &["--sandbox"], &lines);
    let statuses: Vec<i64> = results.iter().map(|result| result["status"].as_i64().unwrap()).collect();
    assert_eq!(statuses, [0, 1, 0, 0, 0], "{results:#?}");
    assert!(results[1]["error"].as_str().unwrap().contains("../c/card.obj"), "{results:#?}");
    assert!(results[1]["warnings"][0].as_str().unwrap().starts_with("sandbox: "), "{results:#?}");
    assert!(path.join("b/5.png").is_file() && !path.join("a/2.png").exists());
    let many: Vec<String> = (0..30).map(|id| job(id, "a/card.obj", json!({ "size": "4x4" }))).collect();
    let results = self::results(path, &["--sandbox"], &many);
    assert!(results.len() == 30 && results.iter().all(|result| result["status"] == 0), "{results:#?}");
}

/// A worker that gets one job after the other.
struct Talk {
    worker: Child,
    jobs: ChildStdin,
    results: BufReader<ChildStdout>,
}

impl Talk {
    fn with(worker: &mut Command) -> Talk {
        let mut worker = worker.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let (jobs, results) = (worker.stdin.take().unwrap(), BufReader::new(worker.stdout.take().unwrap()));
        Talk { worker, jobs, results }
    }

    fn begun(folder: &Path, options: &[&str]) -> Talk {
        Talk::with(bilux(folder).arg("worker").args(options))
    }

    fn send(&mut self, job: &str) {
        writeln!(self.jobs, "{job}").unwrap();
    }

    fn result(&mut self) -> Value {
        let mut line = String::new();
        self.results.read_line(&mut line).unwrap();
        serde_json::from_str(&line).unwrap_or(Value::Null)
    }

    fn done(&mut self, job: &str) -> Value {
        self.send(job);
        self.result()
    }

    /// Begins a job that lasts, and waits until there is something to save.
    fn begin_long(&mut self, id: u32) {
        self.send(&job(id, "a/card.obj", json!({ "spp": 4_000_000, "size": "100x100" })));
        std::thread::sleep(Duration::from_millis(700));
    }

    /// The process that renders.
    fn child(&self) -> String {
        let children = Command::new("pgrep").arg("-P").arg(self.worker.id().to_string()).output().unwrap();
        String::from_utf8(children.stdout).unwrap().trim().to_owned()
    }

    /// No more jobs: the status with which it ends.
    fn end(self) -> Option<i32> {
        let Talk { mut worker, jobs, .. } = self;
        drop(jobs);
        worker.wait().unwrap().code()
    }
}

fn kill(signal: &str, processes: &[String]) {
    assert!(Command::new("kill").arg(signal).args(processes).status().unwrap().success());
}

/// Ctrl-C of a terminal and SIGTERM of systemd come to both processes, others only to the worker.
#[test]
fn a_signal_ends_the_stream_with_a_result_for_the_job_under_way() {
    hang_up::is_not_ignored();
    for (signal, to_both, status) in [
        ("-TERM", false, 143),
        ("-TERM", true, 143),
        ("-INT", false, 130),
        ("-INT", true, 130),
        ("-HUP", true, 129),
    ] {
        let folder = folder();
        let mut talk = Talk::begun(folder.path(), &[]);
        assert_eq!(talk.done(&job(1, "a/card.obj", json!({})))["status"], 0);
        talk.begin_long(2);
        let worker = talk.worker.id().to_string();
        let begun = Instant::now();
        kill(signal, &if to_both { vec![talk.child(), worker] } else { vec![worker] });
        let last = talk.result();
        assert_eq!(
            (&last["id"], &last["status"]),
            (&json!(2), &json!(status)),
            "{signal} {to_both}: {last:#}"
        );
        assert_eq!(last["error"], "the worker was ended by a signal");
        assert_eq!(talk.worker.wait().unwrap().code(), Some(status));
        assert!(begun.elapsed() < Duration::from_secs(3), "{:?}", begun.elapsed());
        assert!(folder.path().join("2.png").is_file(), "{signal} {to_both}: what is rendered is saved");
    }
    // And one that waits for jobs ends at once.
    let folder = folder();
    let mut idle = Talk::begun(folder.path(), &[]);
    std::thread::sleep(Duration::from_millis(300));
    let begun = Instant::now();
    kill("-TERM", &[idle.worker.id().to_string()]);
    assert_eq!(idle.worker.wait().unwrap().code(), Some(143));
    assert!(begun.elapsed() < Duration::from_secs(2));
}

#[test]
fn a_process_that_dies_takes_one_job_with_it() {
    let folder = folder();
    let mut talk = Talk::begun(folder.path(), &[]);
    talk.begin_long(1);
    kill("-KILL", &[talk.child()]);
    let dead = talk.result();
    assert_eq!((&dead["id"], &dead["status"]), (&json!(1), &json!(1)), "{dead:#}");
    assert!(dead["error"].as_str().unwrap().contains("has ended (signal: 9"), "{dead:#}");
    assert_eq!(talk.done(&job(2, "a/card.obj", json!({})))["status"], 0);
    assert_eq!(talk.end(), Some(0));
}

/// Reading never ends: there is nothing to save, and the result says what stopped it.
#[test]
fn a_job_that_is_stopped_while_it_reads_says_so() {
    let folder = folder();
    let path = folder.path();
    std::fs::write(path.join("long.obj"), long_to_read()).unwrap();
    let lines = [job(1, "long.obj", json!({ "timeout": 0.3 })), job(2, "a/card.obj", json!({}))];
    let results = results(path, &[], &lines);
    let error = "timeout: the time of 0.3 s was up before there was a picture to save";
    assert_eq!((&results[0]["status"], &results[0]["error"]), (&json!(124), &json!(error)), "{results:#?}");
    assert!(results[0]["pictures"] == json!([]) && results[1]["status"] == 0, "{results:#?}");
}

/// A sandbox has what its jobs needed when it was entered: files by their own numbers, not by their folders or names.
#[test]
fn jobs_in_a_sandbox_get_all_that_they_need() {
    let folder = folder();
    let path = folder.path();
    std::fs::create_dir(path.join("skies")).unwrap();
    for name in ["one", "two"] {
        std::fs::write(path.join(format!("skies/{name}.ppm")), "P3 1 1 255 128 128 128\n").unwrap();
    }
    let mut talk = Talk::begun(path, &["--sandbox"]);
    let mut done = |id: u32, scene: &str, more: Value| {
        let result = talk.done(&job(id, scene, more));
        assert_eq!(result["status"], 0, "{result:#}");
    };
    let lit =
        |sky: &str, id: u32| json!({ "env": format!("skies/{sky}.ppm"), "output": format!("b/{id}.png") });
    done(1, "a/card.obj", lit("one", 1));
    done(2, "a/card.obj", lit("two", 2));
    done(3, "a/card.obj", lit("one", 3));
    // A checkpoint that a process left which was killed.
    std::fs::write(path.join("b/4.png.checkpoint"), "half of one").unwrap();
    done(4, "a/card.obj", lit("one", 4));
    // Another folder of the same name.
    std::fs::remove_dir_all(path.join("a")).unwrap();
    std::fs::create_dir(path.join("a")).unwrap();
    std::fs::write(path.join("a/card.obj"), CARD).unwrap();
    done(5, "a/card.obj", lit("one", 5));
    assert_eq!(talk.end(), Some(0));
}

/// A new version takes the place of the program while the worker runs.
#[cfg(target_os = "linux")]
#[test]
fn a_worker_outlives_its_file() {
    let folder = folder();
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("bilux-{}", std::process::id()));
    std::fs::hard_link(env!("CARGO_BIN_EXE_bilux"), &program).unwrap();
    let mut talk = Talk::with(Command::new(&program).current_dir(folder.path()).arg("worker"));
    assert_eq!(talk.done(&job(1, "a/card.obj", json!({})))["status"], 0);
    std::fs::remove_file(&program).unwrap();
    let result = talk.done(&job(2, "a/card.obj", json!({ "sandbox": true })));
    assert_eq!(result["status"], 0, "{result:#}");
    assert_eq!(talk.end(), Some(0));
}

/// A sandbox is never left: after a job that needs less than the one before, a third that needs as much as the first is
/// rendered all the same.
#[test]
fn a_job_that_needs_less_takes_nothing_from_those_after_it() {
    let folder = folder();
    let path = folder.path();
    std::fs::create_dir(path.join("skies")).unwrap();
    std::fs::write(path.join("skies/one.ppm"), "P3 1 1 255 128 128 128\n").unwrap();
    let mut talk = Talk::begun(path, &["--sandbox"]);
    for (id, sky) in [(1, true), (2, false), (3, true), (4, false), (5, true)] {
        let mut more = json!({ "output": format!("b/{id}.png") });
        if sky {
            more["env"] = json!("skies/one.ppm");
        }
        let result = talk.done(&job(id, "a/card.obj", more));
        assert_eq!((&result["status"], &result["warnings"]), (&json!(0), &json!([])), "{result:#}");
    }
    assert_eq!(talk.end(), Some(0));
}
