//! `bilux`, the command line. It reads arguments, shows progress and writes files; the library does all of the
//! rendering.

// A binary exports nothing, so `pub` here means visible to sibling modules.
#![allow(unreachable_pub)]

mod arguments;
mod commands;
mod preview;
mod process;
mod sandbox;

use arguments::{Arguments, Command};
use clap::Parser;
use commands::shared::advice;
use process::{allocator, memory, output, usage};
use std::io::Write;
use std::process::ExitCode;

/// The work failed.
const FAILED: u8 = 1;
/// The command line was wrong.
const WRONG_COMMAND_LINE: u8 = 2;
/// The reader of standard output went away: the status that shells report for a program that a closed pipe has ended.
const CLOSED_PIPE: u8 = 128 + 13;

fn main() -> ExitCode {
    report_panics();
    allocator::begin();
    let result = match Arguments::try_parse() {
        Ok(mut arguments) => {
            // A worker's jobs are bounded in the process that renders them.
            if !matches!(arguments.command, Command::Worker(_)) {
                memory::bound(&mut arguments.common.max_memory);
            }
            run(arguments)
        }
        Err(answer) => print_answer(&advice::added(answer)),
    };
    match result {
        Ok(code) => ExitCode::from(code),
        Err(error) if output::is_closed_pipe(&error) => ExitCode::from(CLOSED_PIPE),
        Err(error) => {
            output::error(&error);
            let wrong = usage::is_command_line(&error);
            ExitCode::from(if wrong { WRONG_COMMAND_LINE } else { FAILED })
        }
    }
}

fn run(arguments: Arguments) -> anyhow::Result<u8> {
    let common = &arguments.common;
    match arguments.command {
        Command::Render(render) => commands::render::run(&render, common),
        Command::Serve(serve) => commands::serve::run(*serve, common),
        Command::Info(info) => commands::info::run(&info, common),
        Command::Explain(explain) => commands::explain::run(&explain, common),
        Command::Convert(convert) => commands::convert::run(&convert, common),
        Command::Denoise(denoise) => commands::denoise::run(&denoise, common),
        Command::Sensor(sensor) => commands::sensor::run(&sensor, common),
        Command::Compare(compare) => commands::compare::run(&compare, common),
        Command::Generate(generate) => commands::generate::run(&generate, common),
        Command::Merge(merge) => commands::merge::run(&merge, common),
        Command::Farm(farm) => commands::farm::run(&farm, common),
        Command::Worker(worker) => commands::worker::run(&worker, common),
        Command::Bench(bench) => commands::bench::run(&bench, common),
        Command::List(list) => commands::list::run(&list),
        Command::Completions { shell } => commands::manual::completions(shell),
        Command::Man { folder } => commands::manual::pages(folder.as_deref()),
        Command::Schema => commands::list::schema(),
        Command::Licenses => commands::manual::licenses(),
    }
}

/// Prints help or the version to standard output, or what is wrong with the command line to standard error.
fn print_answer(answer: &clap::Error) -> anyhow::Result<u8> {
    let text = answer.render();
    let printed = match (output::calls_itself_dumb(), answer.use_stderr()) {
        // The library would colour its text where the variable CI is set, whatever the terminal says.
        (true, true) => write!(std::io::stderr(), "{text}"),
        (true, false) => write!(std::io::stdout(), "{text}"),
        _ => answer.print(),
    };
    let printed = printed.and_then(|()| std::io::stdout().flush());
    // If standard error is closed, there is nowhere to report the failure.
    if !answer.use_stderr() {
        printed.map_err(output::PrintError)?;
    }
    Ok(u8::try_from(answer.exit_code()).unwrap_or(WRONG_COMMAND_LINE))
}

/// Reports a panic as a bug in Bilux. Panics inside picture decoders are caught and become errors.
fn report_panics() {
    std::panic::set_hook(Box::new(|panic| {
        if !bilux::pictures::is_decoding() {
            output::eprint(format_args!("error: this is a bug in Bilux; please report it: {panic}"));
        }
    }));
}
