//! The process that renders.

use super::job::Job;
use super::signals::Signals;
use crate::sandbox::folder_of;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How often the time and signals are looked at while a job is rendered.
const EVERY: Duration = Duration::from_millis(20);

/// How long saving may take once a job is stopped.
const GRACE: Duration = Duration::from_millis(1500);

/// How many jobs one process takes in a sandbox: the kernel allows no more than 16 of them on top of each other.
const JOBS_IN_SANDBOX: u32 = 12;

/// Why a job was stopped, as the status of a command that is.
const TIMED_OUT: u8 = 124;

/// The status after Ctrl-C.
const INTERRUPTED: u8 = 130;

/// A process, and what it is allowed to do.
pub struct Process {
    child: Child,
    jobs: Option<ChildStdin>,
    answers: Receiver<String>,
    /// The folders to which its sandbox confines it, if it is in one.
    confined_to: Option<Vec<PathBuf>>,
    done: u32,
}

/// How a job ended.
pub struct Ending {
    /// As that of `bilux render`.
    pub status: u8,
    /// Why it failed.
    pub error: Option<String>,
    /// What `bilux render --json` says about each picture.
    pub pictures: Vec<Value>,
    /// Whether the process can take another job.
    pub is_alive: bool,
}

impl Ending {
    /// One of a job that was not begun.
    pub fn failed(error: String) -> Ending {
        Ending { status: 1, error: Some(error), pictures: Vec::new(), is_alive: false }
    }
}

impl Process {
    /// Starts one.
    pub fn start() -> std::io::Result<Process> {
        let mut command = Command::new(std::env::current_exe()?);
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
        Ok(Process { child, jobs, answers, confined_to: None, done: 0 })
    }

    /// True if its sandbox, if it is in one, fits the job.
    pub fn may_take(&self, job: &Job) -> bool {
        let is_fresh = self.done == 0;
        let fits = self.confined_to == job.confined_to.as_deref().map(folders);
        is_fresh || fits && (self.confined_to.is_none() || self.done < JOBS_IN_SANDBOX)
    }

    /// Renders a job within its time.
    pub fn render(&mut self, job: &Job, signals: &Signals) -> Ending {
        self.confined_to = job.confined_to.as_deref().map(folders);
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
                        Some(status) => return stop.ending(status, answer["error"].as_str(), said),
                        None => said.push(answer),
                    }
                }
                Err(RecvTimeoutError::Timeout) => stop.look_at(&mut self.child, signals),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        // It is dying, or dead.
        self.jobs = None;
        stop.death(self.child.wait().ok(), said)
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
                // A terminal sends Ctrl-C to both processes, and a second signal would end the work at once.
                if status != INTERRUPTED {
                    ask_to_stop(process);
                }
            }
            Some((when, _)) if when.elapsed() > GRACE => {
                let _ = process.kill();
            }
            _ => {}
        }
    }

    /// The ending of a job that the process itself has ended with this status.
    fn ending(&self, status: u64, error: Option<&str>, said: Vec<Value>) -> Ending {
        let own = u8::try_from(status).unwrap_or(1);
        // A process that was told to stop does not take another job.
        let is_alive = self.asked.is_none() && own <= 2;
        let status = match self.asked {
            Some((_, status)) if own > 2 => status,
            _ => own,
        };
        let (failures, pictures): (Vec<Value>, Vec<Value>) =
            said.into_iter().partition(|picture| picture.get("error").is_some());
        let error = error.map(str::to_owned).or_else(|| failure(&failures));
        let error = error.or_else(|| self.reason().filter(|_| status > 2));
        Ending { status, error, pictures, is_alive }
    }

    /// The ending of a job with which the process ended.
    fn death(&self, status: Option<ExitStatus>, said: Vec<Value>) -> Ending {
        let code = status.and_then(|status| status.code()).and_then(|code| u8::try_from(code).ok());
        let how = status.map_or_else(|| "for a reason unknown".to_owned(), |status| status.to_string());
        let (failures, pictures): (Vec<Value>, Vec<Value>) =
            said.into_iter().partition(|picture| picture.get("error").is_some());
        let died = || {
            format!(
                "the process that rendered it has ended ({how}): it may have needed more memory than there is; the next job \
                 gets another"
            )
        };
        let (status, error) = match self.asked {
            Some((_, status)) => (status, failure(&failures).or_else(|| self.reason())),
            None => {
                (code.filter(|&code| code == 2).unwrap_or(1), failure(&failures).or_else(|| Some(died())))
            }
        };
        Ending { status, error, pictures, is_alive: false }
    }

    /// Why it was stopped.
    fn reason(&self) -> Option<String> {
        let (_, status) = self.asked?;
        let seconds = self.job.timeout.unwrap_or_default().as_secs_f64();
        Some(match status {
            TIMED_OUT => format!("timeout: the time of {seconds} s was up"),
            _ => "the worker was ended by a signal".to_owned(),
        })
    }
}

/// The message of the first failure.
fn failure(failures: &[Value]) -> Option<String> {
    failures.first().and_then(|failure| failure["error"].as_str()).map(str::to_owned)
}

/// The folders of these files.
fn folders(files: &[PathBuf]) -> Vec<PathBuf> {
    let folder = |file: &PathBuf| -> PathBuf {
        let folder: &Path = folder_of(file);
        folder.canonicalize().unwrap_or_else(|_| folder.to_owned())
    };
    files.iter().map(folder).collect()
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
