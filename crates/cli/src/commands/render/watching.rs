//! `bilux render --watch`: renders again whenever a file of the scene changes.

use super::targets::{Target, is_stdout};
use crate::arguments::{Common, Render};
use crate::commands::DONE;
use crate::process::interrupt::Interrupt;
use crate::process::{output, usage};
use anyhow::bail;
use bilux::watch::{Changes, Watched};
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Interval at which the files are looked at.
const EVERY: Duration = Duration::from_millis(200);
/// Interval at which it is checked whether there is something to do.
const TICK: Duration = Duration::from_millis(20);

/// Refuses to watch what cannot change, or several scenes.
pub fn check(arguments: &Render) -> anyhow::Result<()> {
    if arguments.lasting.watch {
        if arguments.scenes.len() > 1 {
            bail!("--watch: one scene can be watched at a time: name one");
        }
        if arguments.scenes.iter().any(|scene| is_stdout(scene)) {
            bail!("--watch: a scene on standard input cannot be watched: name a file");
        }
        if is_stdout(arguments.output_or_stdout()) {
            bail!("--watch: standard output takes one picture: name a file, such as -o picture.png");
        }
    }
    Ok(())
}

/// Renders with `render`, and again after each change, until a signal comes. A scene that is broken leaves the picture as it is.
pub fn run(
    target: &Target,
    common: &Common,
    interrupt: &Interrupt,
    render: impl Fn(&Watched) -> anyhow::Result<u8>,
) -> anyhow::Result<u8> {
    let watched = Watched::default();
    watched.add(&BTreeSet::from([target.scene.clone()]));
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let mut changes = Changes::of(&watched);
        let is_over = &is_over;
        scope.spawn(move || {
            while !is_over.load(Ordering::Relaxed) {
                std::thread::sleep(EVERY);
                if changes.are_there() {
                    interrupt.supersede(true);
                    changes.seen();
                }
            }
        });
        let result = render_again_and_again(target, common, interrupt, || render(&watched));
        is_over.store(true, Ordering::Relaxed);
        result
    })
}

fn render_again_and_again(
    target: &Target,
    common: &Common,
    interrupt: &Interrupt,
    render: impl Fn() -> anyhow::Result<u8>,
) -> anyhow::Result<u8> {
    loop {
        interrupt.supersede(false);
        match render() {
            Ok(DONE) => {}
            Ok(status) => return Ok(status),
            Err(error) if usage::is_command_line(&error) || output::is_closed_pipe(&error) => {
                return Err(error);
            }
            Err(error) => {
                output::error(&usage::naming(&target.scene, error));
                if target.output.exists() {
                    output::eprint(format_args!("{}: the picture stays as it was", target.output.display()));
                }
            }
        }
        if !common.quiet && !interrupt.is_requested() {
            let scene = target.scene.display();
            output::eprint(format_args!("{scene}: waits for a change; Ctrl-C ends"));
        }
        interrupt.ends_itself(true);
        while !interrupt.is_requested() {
            std::thread::sleep(TICK);
        }
        interrupt.ends_itself(interrupt.is_signalled());
        if interrupt.is_signalled() {
            return Ok(DONE);
        }
    }
}
