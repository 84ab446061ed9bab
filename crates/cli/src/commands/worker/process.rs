//! The process that renders.

use super::confines::Confines;
use super::job::Job;
use super::signals::Signals;
use crate::process::signals;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Interval at which the time and signals are looked at while a job is rendered.
const EVERY: Duration = Duration::from_millis(20);

/// Time that a process may take to end once it is asked to, which is a little longer than it gives itself.
const GRACE: Duration = signals::GRACE.saturating_add(Duration::from_millis(100));

/// Number of jobs that one process takes in a sandbox: the kernel allows no more than 16 sandboxes on top of each other.
const JOBS_IN_SANDBOX: u32 = 12;

/// Why a job was stopped, as the status of a command that is.
const TIMED_OUT: u8 = 124;

/// A process, and what it is allowed to do.
pub struct Process {
    child: Child,
    jobs: Option<ChildStdin>,
    answers: Receiver<String>,
    /// The permissions that its sandbox leaves it, if it is in one.
    confines: Option<Confines>,
    done: u32,
}

/// Ending of a job.
pub struct Ending {
    /// As that of `bilux render`.
    pub status: u8,
    /// Why it failed.
    pub error: Option<String>,
    /// The line of `bilux render --json` for each picture.
    pub pictures: Vec<Value>,
    /// Whether the process can take another job.
    pub is_alive: bool,
}

impl Ending {
    /// One of a job that was not begun.
    pub fn failed(status: u8, error: String) -> Ending {
        Ending { status, error: Some(error), pictures: Vec::new(), is_alive: false }
    }
}

impl Process {
    /// Starts one.
    pub fn start() -> std::io::Result<Process> {
        // This program itself: by now, its name may be that of a newer version.
        let itself = PathBuf::from("/proc/self/exe");
        let program = if cfg!(target_os = "linux") { itself } else { std::env::current_exe()? };
        let mut command = Command::new(program);
        command.args(["worker", "--warm"]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn()?;
        let (jobs, output) = (child.stdin.take(), child.stdout.take());
        let (send, answers) = channel();
        std::thread::spawn(move || {
            for line in
                output.into_iter().flat_map(|output| BufReader::new(output).lines()).map_while(Result::ok)
            {
                if send.send(line).is_err() {
                    return;
                }
            }
        });
        Ok(Process { child, jobs, answers, confines: None, done: 0 })
    }

    /// True if its sandbox, if it is in one, fits the job.
    pub fn may_take(&self, job: &Job) -> bool {
        match (&self.confines, &job.confines) {
            (None, None) => true,
            (Some(own), Some(needed)) => own.covers(needed) && self.done < JOBS_IN_SANDBOX,
            _ => self.done == 0,
        }
    }

    /// Renders a job within its time.
    pub fn render(&mut self, job: &Job, signals: &Signals) -> Ending {
        let before = self.confines.take();
        let entered = |job: &Confines| before.map_or_else(|| job.clone(), |own| own.then(job));
        self.confines = job.confines.as_ref().map(entered);
        self.done += 1;
        let line = format!("{}\n", json!(job.command));
        let sent = self.jobs.as_mut().map(|jobs| jobs.write_all(line.as_bytes()).and_then(|()| jobs.flush()));
        let mut stop = Stop { job, begun: Instant::now(), asked: None };
        let mut said = Vec::new();
        while let Some(Ok(())) = sent {
            match self.answers.recv_timeout(EVERY) {
                Ok(line) => {
                    let Ok(answer) = serde_json::from_str::<Value>(&line) else { continue };
                    match answer.get("done").and_then(Value::as_u64) {
                        Some(status) => {
                            let status = u8::try_from(status).unwrap_or(1);
                            return stop.ending(Ok((status, answer["error"].as_str())), said);
                        }
                        None => said.push(answer),
                    }
                }
                Err(RecvTimeoutError::Timeout) => stop.look_at(&mut self.child, signals),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        // It is dying, or dead.
        self.jobs = None;
        stop.ending(Err(self.child.wait().ok()), said)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Without more jobs it ends by itself.
        self.jobs = None;
        let begun = Instant::now();
        while matches!(self.child.try_wait(), Ok(None)) {
            if begun.elapsed() > GRACE {
                let _ = self.child.kill();
                let _ = self.child.wait();
                return;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

/// Stops a job when its time is up, or after a signal: politely at first.
struct Stop<'j> {
    job: &'j Job,
    begun: Instant,
    /// When it was asked to stop, and the status for that.
    asked: Option<(Instant, u8)>,
}

impl Stop<'_> {
    /// Asks the process to stop, or kills it, if it is time for that.
    fn look_at(&mut self, process: &mut Child, signals: &Signals) {
        let is_late = self.job.timeout.is_some_and(|timeout| self.begun.elapsed() >= timeout);
        match self.asked {
            None if signals.status().is_some() || is_late => {
                let status = signals.status().unwrap_or(TIMED_OUT);
                self.asked = Some((Instant::now(), status));
                ask_to_stop(process);
            }
            Some((when, _)) if when.elapsed() > GRACE => {
                let _ = process.kill();
            }
            _ => {}
        }
    }

    /// Ending of a job: with the status and the error that the process says, or with the process itself.
    fn ending(&self, how: Result<(u8, Option<&str>), Option<ExitStatus>>, said: Vec<Value>) -> Ending {
        let (failures, pictures): (Vec<Value>, Vec<Value>) =
            said.into_iter().partition(|line| line.get("error").is_some());
        let failure = failures.first().and_then(|failure| failure["error"].as_str()).map(str::to_owned);
        let is_cut = !matches!(how, Ok((0..=2, _)));
        let (status, error) = match (self.asked.filter(|_| is_cut), how) {
            (Some((_, status)), _) => (status, Some(self.reason(status, pictures.is_empty()))),
            (None, Ok((status, error))) => {
                let ended = || is_cut.then(|| self.reason(status, pictures.is_empty()));
                (status, error.map(str::to_owned).or(failure).or_else(ended))
            }
            (None, Err(status)) => (1, failure.or_else(|| Some(died(status)))),
        };
        // A process that was told to stop does not take another job.
        Ending { status, error, pictures, is_alive: self.asked.is_none() && !is_cut }
    }

    /// Why a job was stopped.
    fn reason(&self, status: u8, is_lost: bool) -> String {
        let seconds = self.job.timeout.unwrap_or_default().as_secs_f64();
        let why = match status {
            TIMED_OUT => format!("timeout: the time of {seconds} s was up"),
            _ => "the worker was ended by a signal".to_owned(),
        };
        why + if is_lost { " before there was a picture to save" } else { "" }
    }
}

/// Message about the end of a process, as far as it is known.
fn died(status: Option<ExitStatus>) -> String {
    let how = status.map_or_else(|| "for a reason unknown".to_owned(), |status| status.to_string());
    format!(
        "the process that rendered it has ended ({how}): it may have needed more memory than there is; the next job \
         gets another"
    )
}

/// Asks a process to stop, and to save what it has.
#[cfg(unix)]
fn ask_to_stop(process: &mut Child) {
    let id = rustix::process::Pid::from_child(process);
    let _ = rustix::process::kill_process(id, rustix::process::Signal::TERM);
}

/// Stops a process: here it cannot be asked.
#[cfg(not(unix))]
fn ask_to_stop(process: &mut Child) {
    let _ = process.kill();
}
