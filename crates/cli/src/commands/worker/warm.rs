//! The process that renders, from the inside: it takes command lines of `bilux render`, each a JSON array in a line of its
//! own, and answers each with what `--json` prints and a last line, `{"done": STATUS, "error": …}`.

use crate::arguments::{Arguments, Command};
use crate::commands;
use crate::process::interrupt::interrupt;
use crate::process::{memory, output, usage};
use anyhow::bail;
use clap::Parser;
use serde_json::json;
use std::io::BufRead;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;

/// Takes jobs until there are no more, or one was stopped by a signal.
pub fn run() -> anyhow::Result<u8> {
    // A terminal and systemd send theirs to both processes, and the other one sends its own.
    interrupt().ignore_more();
    let (send, jobs) = channel::<String>();
    let renders = Arc::new(AtomicBool::new(false));
    let is_rendering = renders.clone();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines().map_while(Result::ok) {
            if send.send(line).is_err() {
                return;
            }
        }
        // Whoever waits for the result is gone: nobody needs it.
        if is_rendering.load(Ordering::SeqCst) {
            let _ = signal_hook::low_level::raise(signal_hook::consts::SIGTERM);
        }
    });
    while let Ok(line) = jobs.recv() {
        let words: Vec<String> = serde_json::from_str(&line)?;
        renders.store(true, Ordering::SeqCst);
        let (status, error) = match render(&words) {
            Ok(status) => (status, None),
            Err(error) => (if usage::is_command_line(&error) { 2 } else { 1 }, Some(output::message(&error))),
        };
        renders.store(false, Ordering::SeqCst);
        output::print(json!({ "done": status, "error": error }))?;
        if status > 2 {
            break;
        }
    }
    Ok(commands::DONE)
}

/// Renders what a command line says.
fn render(words: &[String]) -> anyhow::Result<u8> {
    let Arguments { mut common, command, .. } = Arguments::try_parse_from(words)?;
    memory::bound(&mut common.max_memory);
    match &command {
        Command::Render(render) => commands::render::run(render, &common),
        _ => bail!("this is no render"),
    }
}
