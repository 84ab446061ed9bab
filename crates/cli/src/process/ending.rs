//! End of the process in the midst of its work: after a signal, a timeout, or where memory runs out. The process says why, on
//! standard error and, if `--json` promises a line for each scene, on standard output; and it leaves no half-written file.
//!
//! Nothing here allocates memory or waits for another thread or process, since there may be no memory, the other thread may be
//! the one that ends, and whoever should read the message may not.

use crate::process::interrupt::interrupt;
use serde_json::json;
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// Picture that is under way, for the message.
static UNDER_WAY: Mutex<Option<UnderWay>> = Mutex::new(None);

/// A file that goes when a server or the timeout ends the process, since nobody has asked for it.
static UNASKED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// The first who ends the process does; others wait for that.
static IS_ENDING: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// Whether it is this thread, which gives up if it fails at that.
    static ENDS: Cell<bool> = const { Cell::new(false) };
}

/// The picture that is being made.
struct UnderWay {
    /// The beginning of the line on standard error.
    before: String,
    /// The beginning of the line of JSON, up to the message, if one is wanted.
    json: Option<String>,
}

/// Says which picture is being made from now on.
pub fn under_way(scene: &Path, picture: &Path, wants_json: bool) {
    let (scene, picture) = (scene.to_string_lossy(), picture.to_string_lossy());
    let json = wants_json.then(|| {
        let line = json!({ "scene": scene, "picture": picture }).to_string();
        format!("{},\"error\":\"", line.trim_end_matches('}'))
    });
    let before = format!("error: {scene}: ");
    *UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner) = Some(UnderWay { before, json });
}

/// The picture is made, and whoever wants to know has been told.
pub fn finished() {
    *UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner) = None;
}

/// Says which file goes when a server or the timeout ends the process.
pub fn unasked(path: Option<PathBuf>) {
    *UNASKED.lock().unwrap_or_else(PoisonError::into_inner) = path;
}

/// A server or the timeout has ended the work: removes what nobody has asked for.
pub fn remove_unasked() {
    if let Ok(Some(path)) = UNASKED.try_lock().as_deref() {
        // Mostly it is not there yet.
        let _ = std::fs::remove_file(path);
    }
}

/// Ends the process. The message, which contains neither quotes nor backslashes, is for a picture that is under way: where
/// there is none, the status says enough.
pub fn end(status: u8, message: &str) -> ! {
    finish(status, message, false)
}

/// Ends the process, and says why even if no picture is under way.
pub fn fail(status: u8, message: &str) -> ! {
    finish(status, message, true)
}

fn finish(status: u8, message: &str, always: bool) -> ! {
    if ENDS.replace(true) {
        exit(status);
    }
    if IS_ENDING.swap(true, Ordering::SeqCst) {
        loop {
            std::thread::park();
        }
    }
    match UNDER_WAY.try_lock().as_deref() {
        Ok(Some(UnderWay { before, json })) => {
            write(Stream::Error, &[before, message, "\n"]);
            if let Some(json) = json {
                write(Stream::Output, &[json, message, "\"}\n"]);
            }
        }
        _ if always => write(Stream::Error, &["error: ", message, "\n"]),
        _ => {}
    }
    // In this order: no file comes into its place after the first step.
    bilux::pictures::formats::remove_unfinished();
    if interrupt().is_terminated() {
        remove_unasked();
    }
    exit(status)
}

enum Stream {
    Output,
    Error,
}

/// Writes past the buffers and locks of the standard library, and into no pipe that is full.
#[cfg(unix)]
fn write(stream: Stream, texts: &[&str]) {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    /// A pipe that takes anything takes so much at once (`PIPE_BUF` of Linux).
    const PIECE: usize = 4096;
    let file = match stream {
        Stream::Output => rustix::stdio::stdout(),
        Stream::Error => rustix::stdio::stderr(),
    };
    let now = Timespec { tv_sec: 0, tv_nsec: 0 };
    for text in texts {
        let mut rest = text.as_bytes();
        while !rest.is_empty() {
            if poll(&mut [PollFd::new(&file, PollFlags::OUT)], Some(&now)) == Ok(0) {
                return;
            }
            match rustix::io::write(file, &rest[..rest.len().min(PIECE)]) {
                Ok(count @ 1..) => rest = &rest[count..],
                Err(rustix::io::Errno::INTR) => {}
                // There is nowhere to report it.
                _ => return,
            }
        }
    }
}

#[cfg(not(unix))]
fn write(stream: Stream, texts: &[&str]) {
    use std::io::Write;
    for text in texts {
        let _ = match stream {
            Stream::Output => std::io::stdout().write_all(text.as_bytes()),
            Stream::Error => std::io::stderr().write_all(text.as_bytes()),
        };
    }
}

/// Ends the process without the functions that libraries have registered for its end: other threads still use them.
fn exit(status: u8) -> ! {
    signal_hook::low_level::exit(i32::from(status))
}
