//! The options of `bilux render` that every task gets: the command line's own parser reads them, so that all work here,
//! except those that make no sense in a part of a picture or on another machine.

use super::farm_job::Word;
use super::files::Files;
use crate::arguments::farming::Farm;
use crate::arguments::{Arguments, Command, Render};
use crate::commands::render::aov;
use anyhow::bail;
use clap::Parser;
use std::path::Path;

/// The options whose value is a file.
const OF_FILES: [&str; 2] = ["--env", "--background"];

/// Parses the options.
///
/// # Errors
/// If one is unknown, or its value is wrong.
pub(super) fn parse(options: &[String]) -> anyhow::Result<Box<Render>> {
    let before = ["bilux", "render", "-o", "picture.exr"].map(str::to_owned);
    let words: Vec<String> = before.iter().chain(options).cloned().chain(["scene".to_owned()]).collect();
    match Arguments::try_parse_from(&words) {
        Ok(parsed) => match parsed.command {
            Command::Render(render) if render.scenes.len() == 1 => Ok(render),
            _ => bail!("after `--` come only options of `bilux render`; the scene comes before it"),
        },
        Err(error) => {
            let text = error.to_string();
            let text = text.strip_prefix("error: ").unwrap_or(&text);
            let text = text.split("\n\nUsage:").next().unwrap_or(text);
            let text = text.split("\n\nFor more information").next().unwrap_or(text).trim_end();
            bail!("after `--`: {text}");
        }
    }
}

/// Refuses options that tasks cannot have.
///
/// # Errors
/// If there is one, or if there is no such tone curve or layer.
pub(super) fn check(render: &Render, farm: &Farm, picture: &str) -> anyhow::Result<()> {
    aov::check(render)?;
    render.check_tonemap()?;
    let never = [
        ("--frames", render.frames.is_some(), "write it before `--`"),
        (
            "--samples",
            render.samples.is_some(),
            "each task takes a range of its own: set their number with --spp",
        ),
        ("--turntable", render.turntable.is_some(), "write it before `--`"),
        ("--replay", render.replay.is_some(), "it writes no picture"),
        ("--resume", render.lasting.resume, "a task's working directory is not kept"),
        ("--watch", render.lasting.watch, "a task renders once"),
        ("--preview", render.lasting.preview.is_some(), "a task has no terminal"),
        ("--lengths", render.lengths.is_some(), "parts do not have it"),
        ("--stats", render.stats.is_some(), "a task's working directory is not kept"),
    ];
    let is_exr = aov::is_exr(Path::new(picture));
    let of_parts = [
        ("--crop", render.crop.is_some(), "split the picture by its samples only"),
        ("--fast", render.fast, "a part does not know the noise of the whole: write --spp"),
        (
            "--denoise",
            wants_denoiser(render),
            "parts keep exact sums: run `bilux denoise` on the merged picture",
        ),
        ("--aov", !render.aov.is_empty() && !is_exr, "only an .exr holds layers: write --picture NAME.exr"),
        ("--labels", render.labels && !is_exr, "only an .exr holds layers: write --picture NAME.exr"),
        (
            "--aov",
            render.aov.iter().any(|name| name == "interval" || name == "strategies"),
            "parts do not have it",
        ),
        (
            "--bits",
            render.bits != "8",
            "the picture is merged with 8 bits: write --picture NAME.exr for more",
        ),
        (
            "--quality",
            render.quality.is_some(),
            "write --picture NAME.png, and convert it with `bilux convert`",
        ),
    ];
    let of_parts = of_parts.into_iter().filter(|_| farm.frames.is_none() && farm.turntable.is_none());
    match never.into_iter().chain(of_parts).find(|(_, is_set, _)| *is_set) {
        Some((flag, _, advice)) => bail!("{flag} does not work in the tasks of a farm: {advice}"),
        None => Ok(()),
    }
}

fn wants_denoiser(render: &Render) -> bool {
    render.settings.text("denoise").is_some_and(|name| name != "off" && name != "none")
}

/// The words of the options, with the job's copies in place of files.
pub(super) fn words(options: &[String], files: &Files) -> Vec<Word> {
    let mut words = Vec::new();
    let mut before = "";
    for option in options {
        let (flag, value) = option.split_once('=').unwrap_or(("", option));
        let names_file = OF_FILES.contains(&before) || OF_FILES.contains(&flag);
        let file = Some(value).filter(|_| names_file).and_then(|value| files.name_of(Path::new(value)).ok());
        words.push(match file {
            Some(name) if flag.is_empty() => Word::File(String::new(), name),
            Some(name) => Word::File(format!("{flag}="), name),
            None => Word::Text(option.clone()),
        });
        before = option;
    }
    words
}
