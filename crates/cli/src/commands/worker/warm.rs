//! The process that renders, from the inside: it takes command lines of `bilux render`, each a JSON array in a line of its
//! own, and answers each with what `--json` prints and a last line, `{"done": STATUS, "error": …}`.

use crate::arguments::{Arguments, Command};
use crate::{commands, memory, output, usage};
use clap::Parser;
use serde_json::json;
use std::io::BufRead;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;

/// Takes jobs until there are no more, or one was stopped by a signal.
pub fn run() -> anyhow::Result<u8> {
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
        let (status, error) = render(&words);
        renders.store(false, Ordering::SeqCst);
        output::print(json!({ "done": status, "error": error }))?;
        if status > 2 {
            break;
        }
    }
    Ok(commands::DONE)
}

/// Renders what a command line says: the status, and what is wrong.
fn render(words: &[String]) -> (u8, Option<String>) {
    let mut arguments = match Arguments::try_parse_from(words) {
        Ok(arguments) => arguments,
        Err(error) => return (2, Some(first_line(&error))),
    };
    memory::bound(&mut arguments.common);
    let Command::Render(render) = &arguments.command else {
        return (2, Some("this is no render".to_owned()));
    };
    match commands::render::run(render, &arguments.common) {
        Ok(status) => (status, None),
        Err(error) => (if usage::is_command_line(&error) { 2 } else { 1 }, Some(output::message(&error))),
    }
}

/// The first line of what is wrong with a command line.
fn first_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default();
    line.strip_prefix("error: ").unwrap_or(line).to_owned()
}
