//! `bilux`, the command line. It reads arguments, shows progress and writes files; whatever is rendered is
//! rendered by the library.

// A program's modules are all its own: `pub` here means: for the modules beside.
#![allow(unreachable_pub)]

mod arguments;
mod choices;
mod commands;
mod comparison;
mod denoising;
mod interrupt;
mod measuring;
mod output;
mod progress;
mod settings_from;
mod studio;
mod usage;
mod values;
mod version;

use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

/// The work failed.
const FAILED: u8 = 1;
/// The command line was wrong.
const WRONG_COMMAND_LINE: u8 = 2;

fn main() -> ExitCode {
    tell_faults_of_ours();
    let arguments = Arguments::parse();
    let result = match arguments.command {
        Command::Render(ref render) => commands::render::run(render, &arguments.common),
        Command::Info(ref info) => commands::info::run(info, &arguments.common),
        Command::Convert(ref convert) => commands::convert::run(convert, &arguments.common),
        Command::Denoise(ref denoise) => commands::denoise::run(denoise, &arguments.common),
        Command::Compare(ref compare) => commands::compare::run(compare),
        Command::Generate(ref generate) => commands::generate::run(generate, &arguments.common),
        Command::Merge(ref merge) => commands::merge::run(merge, &arguments.common),
        Command::Bench(ref bench) => commands::bench::run(bench, &arguments.common),
        Command::List(ref list) => commands::list::run(list),
        Command::Completions { shell } => commands::manual::completions(shell),
        Command::Man { ref folder } => commands::manual::pages(folder.as_deref()),
        Command::Schema => commands::list::schema(),
        Command::Licenses => commands::manual::licenses(),
    };
    match result {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            output::error(&error);
            let wrong = usage::is_command_line(&error);
            ExitCode::from(if wrong { WRONG_COMMAND_LINE } else { FAILED })
        }
    }
}

/// A panic is a fault of ours, and says so. Those inside picture decoders are caught and become errors.
fn tell_faults_of_ours() {
    std::panic::set_hook(Box::new(|panic| {
        if !bilux::pictures::is_decoding() {
            output::say(format_args!("error: a fault of Bilux itself, please report it: {panic}"));
        }
    }));
}
