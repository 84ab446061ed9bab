//! One process of tests: what each takes, and what is left over if it crashes.

use super::found::Suite;
use super::printed::{Ended, Printed};
use crate::process::{cpu_time_of, has_ended};
use anyhow::{Context, Error, Result};
use std::io::Read;
use std::process::{Child, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Outcome of the tests of a process.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    /// Tests that passed, and what they took.
    pub(super) passed: Vec<(String, Duration)>,
    /// Tests that failed, and what they took.
    pub(super) failed: Vec<(String, Duration)>,
    /// Tests with nothing to do, and why.
    pub(super) skipped: Vec<(String, String)>,
    /// Tests that have not run, since an earlier one ended the process.
    pub(super) left: Vec<String>,
    /// Output of the failing tests.
    pub(super) said: String,
}

impl Outcome {
    /// None of the tests could run.
    pub(super) fn none(tests: &[String], error: &Error) -> Outcome {
        let failed = tests.iter().map(|test| (test.clone(), Duration::ZERO)).collect();
        Outcome { failed, said: format!("{error:#}"), ..Outcome::default() }
    }
}

/// The longest that one test may take, of wall time.
fn limit(is_long: bool) -> Duration {
    Duration::from_secs(60 * if is_long { 240 } else { 20 })
}

/// Runs some tests of a suite in one process, one after the other.
pub(super) fn run(suite: &Suite, tests: &[String], is_long: bool) -> Result<Outcome> {
    let mut command = suite.command();
    command.args(["--test-threads=1", "--show-output", "--exact"]).args(tests);
    // A test that only runs if it is named is not, although its name is given.
    command.env("BILUX_WHOLE", "1");
    if is_long {
        command.env("BILUX_LONG", "1");
    }
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().with_context(|| format!("cannot start {}", suite.program.display()))?;
    Watch::new(child).until_it_ends(tests, limit(is_long))
}

/// Bytes from a process.
enum Came {
    Output(Vec<u8>),
    Error(Vec<u8>),
}

/// A process, and what has come from it.
struct Watch {
    child: Child,
    printed: Printed,
    errors: Vec<u8>,
    outcome: Outcome,
    begun: Instant,
    /// When the last test ended, and what the process had taken then.
    last: (Instant, Duration),
}

impl Watch {
    fn new(child: Child) -> Watch {
        let (printed, outcome) = (Printed::default(), Outcome::default());
        let begun = Instant::now();
        Watch { child, printed, errors: Vec::new(), outcome, begun, last: (begun, Duration::ZERO) }
    }

    fn until_it_ends(mut self, tests: &[String], limit: Duration) -> Result<Outcome> {
        let came = self.listen();
        let status = loop {
            let is_late = self.wait(&came, limit);
            if is_late {
                self.child.kill().context("cannot end a process of tests")?;
            }
            if let Some(status) = self.child.try_wait().context("a process of tests is lost")? {
                // What it has started may live on and keep its pipes open.
                while let Ok(came) = came.recv_timeout(Duration::from_millis(300)) {
                    self.take(came);
                }
                break if is_late { Err(limit) } else { Ok(status) };
            }
        };
        Ok(self.close(tests, status))
    }

    /// Reads standard output and standard error until both are closed.
    fn listen(&mut self) -> Receiver<Came> {
        let (sender, receiver) = channel();
        if let Some(output) = self.child.stdout.take() {
            forward(output, sender.clone(), Came::Output);
        }
        if let Some(errors) = self.child.stderr.take() {
            forward(errors, sender, Came::Error);
        }
        receiver
    }

    /// Takes what comes until nothing comes any more; whether one test takes longer than the limit.
    fn wait(&mut self, came: &Receiver<Came>, limit: Duration) -> bool {
        loop {
            match came.recv_timeout(Duration::from_millis(200)) {
                Ok(came) => self.take(came),
                _ if self.last.0.elapsed() > limit => return true,
                Err(RecvTimeoutError::Disconnected) => {
                    // It is about to end.
                    thread::sleep(Duration::from_millis(2));
                    return false;
                }
                Err(RecvTimeoutError::Timeout) if has_ended(self.child.id()) => return false,
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }

    fn take(&mut self, came: Came) {
        let ended = match came {
            Came::Output(bytes) => self.printed.add(&bytes),
            Came::Error(bytes) => return self.errors.extend(bytes),
        };
        if ended.is_empty() {
            return;
        }
        let now = cpu_time_of(self.child.id()).unwrap_or_else(|| self.begun.elapsed());
        let each = now.saturating_sub(self.last.1) / u32::try_from(ended.len()).unwrap_or(u32::MAX);
        self.last = (Instant::now(), self.last.1.max(now));
        for Ended { name, has_failed } in ended {
            let list = if has_failed { &mut self.outcome.failed } else { &mut self.outcome.passed };
            list.push((name, each));
        }
    }

    fn close(mut self, tests: &[String], status: Result<ExitStatus, Duration>) -> Outcome {
        let errors = String::from_utf8_lossy(&self.errors).trim().to_owned();
        self.outcome.skipped = self.printed.skipped();
        self.outcome.said = self.printed.failures().to_owned();
        let ran = |outcome: &Outcome, test: &String| {
            outcome.passed.iter().chain(&outcome.failed).any(|(name, _)| name == test)
        };
        let mut left: Vec<String> = tests.iter().filter(|test| !ran(&self.outcome, test)).cloned().collect();
        let is_whole = self.printed.is_closed() && left.is_empty();
        if is_whole && status.is_ok_and(|status| status.success() == self.outcome.failed.is_empty()) {
            if !self.outcome.failed.is_empty() {
                self.outcome.said = join(&self.outcome.said, &errors);
            }
            return self.outcome;
        }
        // The one that ran ended the process; if none did, the last that had run.
        let culprit = self.printed.running().map(str::to_owned).or_else(|| left.first().cloned());
        let culprit = culprit.or_else(|| tests.last().cloned()).unwrap_or_default();
        let how = status.map_or_else(
            |limit| format!("took longer than {} minutes", limit.as_secs() / 60),
            |status| format!("ended its process ({status})"),
        );
        self.outcome.said = format!("{culprit} {how}\n{}", join(self.printed.text().trim(), &errors));
        left.retain(|test| *test != culprit);
        self.outcome.passed.retain(|(test, _)| *test != culprit);
        self.outcome.failed.push((culprit, Duration::ZERO));
        self.outcome.left = left;
        self.outcome
    }
}

fn forward(mut from: impl Read + Send + 'static, to: Sender<Came>, make: fn(Vec<u8>) -> Came) {
    thread::spawn(move || {
        let mut bytes = [0; 1 << 14];
        while let Ok(length @ 1..) = from.read(&mut bytes) {
            if to.send(make(bytes[..length].to_vec())).is_err() {
                break;
            }
        }
    });
}

fn join(a: &str, b: &str) -> String {
    [a, b].into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join("\n")
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::PermissionsExt;

    /// Outcome of the tests a, b and c of a program that is a script.
    fn outcome(name: &str, script: &str, limit: Duration) -> Outcome {
        let folder = crate::process::target_folder().join("tmp");
        fs::create_dir_all(&folder).unwrap();
        let program = folder.join(format!("{name}-{}", std::process::id()));
        fs::write(&program, format!("#!/bin/sh\necho 'running 3 tests'\n{script}")).unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        let suite = Suite { program: program.clone(), folder, ..Suite::default() };
        let child = suite.command().stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let outcome = Watch::new(child).until_it_ends(&["a", "b", "c"].map(str::to_owned), limit).unwrap();
        fs::remove_file(program).unwrap();
        outcome
    }

    fn names(tests: &[(String, Duration)]) -> Vec<&str> {
        tests.iter().map(|(name, _)| &**name).collect()
    }

    #[test]
    fn tests_pass_and_fail() {
        let script = "echo 'test a ... ok'; echo 'test b ... FAILED'; echo 'test c ... ok'\n\
                      echo; echo failures:; echo; echo '---- b stdout ----'; echo panicked; echo warned >&2\n\
                      echo; echo failures:; echo '    b'; echo; echo 'test result: FAILED. 2 passed; 1 failed'; exit 101";
        let outcome = outcome("fails", script, limit(false));
        assert_eq!((names(&outcome.passed), names(&outcome.failed)), (vec!["a", "c"], vec!["b"]));
        assert_eq!(outcome.said, "---- b stdout ----\npanicked\nwarned");
        assert!(outcome.left.is_empty());
    }

    #[test]
    fn a_crash_names_the_test_and_leaves_the_others() {
        let outcome =
            outcome("crashes", "echo 'test a ... ok'; printf 'test b ... '; kill -ABRT $$", limit(false));
        assert_eq!((names(&outcome.passed), names(&outcome.failed)), (vec!["a"], vec!["b"]));
        assert!(outcome.said.starts_with("b ended its process (signal: 6"), "{}", outcome.said);
        assert_eq!(outcome.left, ["c"]);
    }

    #[test]
    fn an_end_without_a_closing_line_is_no_success() {
        let outcome =
            outcome("ends", "echo 'test a ... ok'; echo 'test b ... ok'; echo 'test c ... ok'", limit(false));
        assert_eq!((names(&outcome.passed), names(&outcome.failed)), (vec!["a", "b"], vec!["c"]));
    }

    #[test]
    fn a_test_that_never_ends_is_ended() {
        let script = "echo 'test a ... ok'; printf 'test b ... '; exec sleep 60";
        let outcome = outcome("hangs", script, Duration::from_millis(400));
        assert_eq!((names(&outcome.passed), names(&outcome.failed)), (vec!["a"], vec!["b"]));
        assert_eq!(
            (outcome.said.lines().next(), &*outcome.left),
            (Some("b took longer than 0 minutes"), &["c".to_owned()][..])
        );
    }
}
