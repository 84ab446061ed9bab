//! Suites that run while others are still built: a build leaves cores idle, at its end above all.

use super::chunks::{self, Chunk, Times};
use super::found;
use super::process::{self, Outcome};
use super::report::Report;
use super::totals::Totals;
use anyhow::{Result, bail};
use serde_json::Value;
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Choice of the tests that run, and their form.
#[derive(Clone, Debug, Default)]
pub(crate) struct Options {
    /// The packages whose tests run; those of all, if there are none here.
    pub(crate) packages: Vec<String>,
    /// Runs the long form of each test.
    pub(crate) is_long: bool,
}

/// Processes of tests, as many at a time as there are cores, until nothing waits and nothing more comes.
pub(crate) struct Running {
    work: Arc<Work>,
    workers: Vec<JoinHandle<()>>,
}

struct Work {
    options: Options,
    times: Times,
    waiting: Mutex<Waiting>,
    /// Chunks have come, or no more will.
    changed: Condvar,
    report: Mutex<Report>,
}

struct Waiting {
    chunks: Vec<Chunk>,
    /// Chunks that need all to be built.
    for_programs: Vec<Chunk>,
    is_open: bool,
}

impl Running {
    /// Waits for the first suite.
    pub(crate) fn start(options: Options) -> Running {
        let work = Arc::new(Work {
            options,
            times: Times::read(&times_path()),
            waiting: Mutex::new(Waiting { chunks: Vec::new(), for_programs: Vec::new(), is_open: true }),
            changed: Condvar::new(),
            report: Mutex::default(),
        });
        let worker = |_| {
            let work = work.clone();
            thread::spawn(move || work.until_closed())
        };
        let workers = (0..crate::cores::count()).map(worker).collect();
        Running { work, workers }
    }

    /// Runs the tests of the binary that one of cargo's messages is about, if they are asked for. Those that start a program of their
    /// package wait for [`Running::finish`]: cargo may build it later.
    pub(crate) fn add(&self, message: &Value) -> Result<()> {
        if let Some(suite) = found::listed(message, &self.work.options.packages)? {
            let has_program = suite.starts_programs();
            let chunks = chunks::divide(suite, &self.work.times);
            let mut waiting = lock(&self.work.waiting);
            if has_program {
                waiting.for_programs.extend(chunks)
            } else {
                waiting.chunks.extend(chunks)
            }
            self.work.changed.notify_all();
        }
        Ok(())
    }

    /// The CPU time of the tests that have ended.
    pub(crate) fn cpu_time(&self) -> Duration {
        Duration::from_secs_f64(lock(&self.work.report).times().map(|(.., seconds)| seconds).sum())
    }

    /// Waits until all tests have ended. One that failed is an error, and so is none that ran.
    pub(crate) fn finish(mut self, totals: &mut Totals) -> Result<()> {
        self.close();
        let report = std::mem::take(&mut *lock(&self.work.report));
        if !self.work.options.is_long {
            self.work.times.clone().with(report.times()).write(&times_path());
        }
        print!("{report}");
        *totals += Totals { passed: report.passed, failed: report.failed.len() };
        match (report.passed, report.failed.as_slice()) {
            (0, []) => bail!("no test ran"),
            (_, []) => Ok(()),
            (_, failed) => bail!("failed: {}", failed.join(", ")),
        }
    }

    fn close(&mut self) {
        let mut waiting = lock(&self.work.waiting);
        let more = std::mem::take(&mut waiting.for_programs);
        waiting.chunks.extend(more);
        waiting.is_open = false;
        drop(waiting);
        self.work.changed.notify_all();
        self.workers.drain(..).for_each(|worker| drop(worker.join()));
    }
}

/// Chunks that have not begun do not, where the build has failed.
impl Drop for Running {
    fn drop(&mut self) {
        let mut waiting = lock(&self.work.waiting);
        (waiting.chunks, waiting.for_programs) = (Vec::new(), Vec::new());
        drop(waiting);
        self.close();
    }
}

impl Work {
    fn until_closed(&self) {
        while let Some(chunk) = self.take() {
            let _core = crate::cores::take();
            self.run(chunk);
        }
    }

    /// The chunk that takes longest, so that all cores end together; waits until there is one or no more will come.
    fn take(&self) -> Option<Chunk> {
        let mut waiting = lock(&self.waiting);
        loop {
            let all = waiting.chunks.iter().enumerate();
            if let Some((longest, _)) = all.max_by(|(_, a), (_, b)| a.seconds.total_cmp(&b.seconds)) {
                return Some(waiting.chunks.swap_remove(longest));
            }
            if !waiting.is_open {
                return None;
            }
            waiting = self.changed.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Runs the tests of a chunk, in a second process those that a crash of the first left over, and so on.
    fn run(&self, Chunk { suite, mut tests, .. }: Chunk) {
        while !tests.is_empty() {
            let outcome = process::run(&suite, &tests, self.options.is_long)
                .unwrap_or_else(|error| Outcome::none(&tests, &error));
            let text = lock(&self.report).add(&suite, &outcome);
            print!("{text}");
            tests = outcome.left;
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// File of the times that tests took when they ran last, for the order of the next run.
fn times_path() -> PathBuf {
    crate::process::target_folder().join("test-times.tsv")
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    /// A suite with a test that passes, and one that fails.
    const SCRIPT: &str = "#!/bin/sh\ncase \"$*\" in *--list*) echo 'a: test'; echo 'b: test'; exit;; esac\n\
                          echo 'test a ... ok'; echo 'test b ... FAILED'; echo 'test result: FAILED. 1 passed; 1 failed'; exit 101";

    #[test]
    fn tests_run_before_the_build_has_ended() {
        let folder = crate::process::target_folder().join("tmp");
        fs::create_dir_all(&folder).unwrap();
        let program = folder.join(format!("early-{}", std::process::id()));
        fs::write(&program, SCRIPT).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        // A package with a program, whose tests wait.
        let with_program = folder.join(format!("with-program-{}", std::process::id()));
        fs::create_dir_all(with_program.join("src/bin")).unwrap();
        let message_in = |place: &std::path::Path, package: &str| {
            json!({ "package_id": format!("path+file:///r#{package}@0.1.0"), "manifest_path": place.join("Cargo.toml"),
                "target": { "kind": ["test"], "name": "suite" }, "profile": { "test": true }, "executable": program })
        };
        let message = |package: &str| message_in(&folder, package);
        // Its times are not kept.
        let packages = ["bilux-a", "bilux-c"].map(str::to_owned).to_vec();
        let running = Running::start(Options { packages, is_long: true });
        running.add(&message_in(&with_program, "bilux-c")).unwrap();
        running.add(&json!({ "profile": { "test": false } })).unwrap();
        running.add(&message("bilux-b")).unwrap();
        running.add(&message("bilux-a")).unwrap();
        while lock(&running.work.report).passed == 0 {
            thread::sleep(Duration::from_millis(5));
        }
        thread::sleep(Duration::from_millis(50));
        assert_eq!(lock(&running.work.report).passed, 1);
        let mut totals = Totals::default();
        let error = running.finish(&mut totals).unwrap_err().to_string();
        let wanted = "failed: bilux-a suite b, bilux-c suite b";
        assert_eq!((totals, &*error), (Totals { passed: 2, failed: 2 }, wanted));
        fs::remove_file(program).unwrap();
        fs::remove_dir_all(with_program).unwrap();
    }
}
