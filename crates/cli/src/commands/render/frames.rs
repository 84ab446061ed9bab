//! Which pictures of an animation or a turntable are finished, so that `--resume` does not render them again.

use super::input::Input;
use super::targets::{Target, is_stdout, named_by};
use crate::arguments::choices::{GlassArgument, defined};
use crate::arguments::lasting::Checkpoints;
use crate::arguments::studio::StudioArguments;
use crate::process::ending;
use crate::process::output;
use anyhow::{Context, bail};
use bilux::checkpoint::{CheckpointError, Identity, checkpoint_path};
use bilux::encoding::ContentHash;
use bilux::formats::Scheme;
use bilux::pictures::formats::write_atomically;
use bilux::scene::{Parameters, Value};
use bilux::settings::Effect;
use std::collections::BTreeSet;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// First line of the file.
const FIRST_LINE: &str = "bilux frames 1\n";
/// The line with the numbers of the frames that are finished.
const FINISHED: &str = "finished";

/// The frames that are finished, in a file next to them.
pub struct FinishedFrames<'a> {
    input: &'a Input<'a>,
    user: &'a Parameters,
    /// `None` if nothing is kept.
    path: Option<PathBuf>,
    /// The identity of all frames: what they depend on.
    identity: Option<Identity>,
    finished: BTreeSet<u32>,
}

impl<'a> FinishedFrames<'a> {
    /// Reads which frames are finished, if the render is to go on.
    pub fn begin(
        input: &'a Input<'a>,
        user: &'a Parameters,
        target: &Target,
    ) -> anyhow::Result<FinishedFrames<'a>> {
        let lasting = &input.arguments.lasting;
        let mut frames =
            FinishedFrames { input, user, path: None, identity: None, finished: BTreeSet::new() };
        if lasting.checkpoints() == Checkpoints::Off || is_stdout(&target.output) {
            return Ok(frames);
        }
        let path = journal_path(&target.output);
        if lasting.resume && path.exists() {
            let (identity, finished) = read(&path)?;
            let differences = frames.identity()?.differences(&identity);
            if !differences.is_empty() {
                return Err(bilux::Error::from(CheckpointError::OtherPicture { path, differences }).into());
            }
            frames.finished = finished;
        }
        if !lasting.is_asked() {
            ending::unasked(Some(path.clone()));
        }
        frames.path = Some(path);
        Ok(frames)
    }

    /// True if this frame is finished and its picture is there.
    pub fn has(&self, frame: u32, target: &Target) -> bool {
        let is_there = self.finished.contains(&frame) && target.output.is_file();
        if is_there && !self.input.common.quiet {
            output::eprint(format_args!("{}: finished before", target.output.display()));
        }
        is_there
    }

    /// Remembers that a frame is finished.
    pub fn add(&mut self, frame: u32) -> anyhow::Result<()> {
        let Some(path) = self.path.clone() else { return Ok(()) };
        self.finished.insert(frame);
        let numbers: Vec<String> = self.finished.iter().map(u32::to_string).collect();
        let text = format!("{FIRST_LINE}{}{FINISHED}={}\n", self.identity()?.to_text(), numbers.join(" "));
        if let Err(error) = write_atomically(&path, text.as_bytes()) {
            // The pictures are what counts.
            output::warning(output::error_text(&error.in_file(&path)));
        }
        Ok(())
    }

    /// The frames are stopped before all of them are finished.
    pub fn stop(self) {
        if self.input.interrupt.is_terminated() {
            ending::remove_unasked();
        }
    }

    /// All frames are finished.
    pub fn finish(self) -> anyhow::Result<()> {
        ending::unasked(None);
        match self.path.filter(|path| path.is_file()) {
            Some(path) => {
                std::fs::remove_file(&path).with_context(|| format!("{}: cannot remove it", path.display()))
            }
            None => Ok(()),
        }
    }

    /// Identity of all frames, which is computed once: the contents of all files, and the command line.
    fn identity(&mut self) -> anyhow::Result<&Identity> {
        if self.identity.is_none() {
            self.identity = Some(identity(self.input, self.user)?);
        }
        self.identity.as_ref().context("the identity is computed")
    }
}

/// The name of the file: that of the frames, with `frames` in place of their number.
fn journal_path(pattern: &Path) -> PathBuf {
    checkpoint_path(&named_by(pattern, "frames"))
}

fn identity(input: &Input, user: &Parameters) -> anyhow::Result<Identity> {
    let mut identity = Identity::default();
    identity.add("version", env!("CARGO_PKG_VERSION"));
    let is_for_speed = |key: &str| matches!(Effect::of(key), Some(Effect::Work | Effect::Building));
    for (key, value, _) in user.0.iter().filter(|(key, ..)| !is_for_speed(key)) {
        identity.add(key, &shown(value));
    }
    let a = input.arguments;
    let file = |path: &Option<PathBuf>| said(path.as_ref().map(|path| path.display()));
    let glass = match a.choices.glass {
        GlassArgument::Auto => "auto",
        GlassArgument::Thin => "thin",
        GlassArgument::Solid => "solid",
    };
    // Settings are there already.
    let StudioArguments { settings: _, preset, env, layer, change, intrinsics } = &a.studio;
    let options = [
        ("--preset", said(preset.as_ref())),
        ("--intrinsics", file(intrinsics)),
        ("--env", file(env)),
        ("--layer", said(layer.as_ref())),
        ("--background", said(a.studio.picture_behind().map(Path::display))),
        ("--change", change.join(" ")),
        ("--turntable", said(a.turntable)),
        ("--animation", said(a.choices.animation.as_ref())),
        ("--variant", said(a.choices.variant.as_ref())),
        ("--subdivide", said(a.choices.subdivide.map(Scheme::name))),
        ("--define", defined(&a.choices.definitions).join(" ")),
        ("--glass", glass.to_owned()),
        ("--light-radius", a.choices.light_radius.to_string()),
        ("--fast", a.fast.to_string()),
        ("--samples", said(a.samples.map(|(first, end)| format!("{first}..{end}")))),
        ("--crop", said(a.crop.map(|crop| crop.map(|side| side.to_string()).join(",")))),
        ("--lengths", said(a.lengths.map(|bins| format!("{},{},{}", bins.begin, bins.width, bins.count)))),
        ("--aov", a.aov.join(",")),
        ("--labels", a.labels.to_string()),
        ("--bits", a.bits.clone()),
        ("--quality", said(a.quality)),
    ];
    options.iter().for_each(|(name, value)| identity.add(name, value));
    for (name, bytes) in input.contents() {
        identity.add(&format!("the file {name}"), &ContentHash::of(&bytes?).to_string());
    }
    Ok(identity)
}

/// The value of an option.
fn said(value: Option<impl Display>) -> String {
    value.map_or_else(|| "not given".to_owned(), |value| value.to_string())
}

/// The value of a setting.
fn shown(value: &Value) -> String {
    match value {
        Value::Text(text) => text.clone(),
        Value::Integer(number) => number.to_string(),
        Value::Number(number) => number.to_string(),
        Value::Bool(yes) => yes.to_string(),
        other => format!("{other:?}"),
    }
}

fn read(path: &Path) -> anyhow::Result<(Identity, BTreeSet<u32>)> {
    let text =
        std::fs::read_to_string(path).with_context(|| format!("{}: cannot read it", path.display()))?;
    let parsed = text.strip_prefix(FIRST_LINE).and_then(|text| {
        let (lines, numbers) = text.rsplit_once(&format!("{FINISHED}="))?;
        let numbers: Option<BTreeSet<u32>> =
            numbers.strip_suffix('\n')?.split(' ').map(|n| n.parse().ok()).collect();
        Some((Identity::from_text(lines), numbers?))
    });
    let Some(parsed) = parsed else {
        bail!(
            "{}: this does not say which frames are finished, or is damaged: delete it, or leave out --resume",
            path.display()
        );
    };
    Ok(parsed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::{Arguments, Command, settings_from};
    use crate::process::interrupt::interrupt;
    use clap::{CommandFactory, Parser};

    #[test]
    fn the_file_lies_next_to_the_frames() {
        let name = |pattern: &str| journal_path(Path::new(pattern)).to_string_lossy().into_owned();
        assert_eq!(name("a/walk-{frame}.png"), "a/walk-frames.png.checkpoint");
        assert_eq!(name("walk.exr"), "walk-frames.exr.checkpoint");
        // Whatever else has such a name is not one of theirs.
        assert_eq!(name("take-0000.d/walk-0000.b.exr"), "take-0000.d/walk-0000.b-frames.exr.checkpoint");
    }

    /// Options that change no picture, or say only which pictures are wanted and where they go.
    const OF_NO_PICTURE: &str = "accel bsp-group bsp-split build checkpoint frames input-format json output output-format \
                                 preview replay resume stats threads timeout watch";

    /// Words that one option or another takes.
    const VALUES: [&str; 11] =
        ["", "7", "0.5", "x", "9x6", "1,2,3", "1,2,3,4", "0-1", "1..2", "loop", "material:0:kd=0.5"];

    /// Frames that were made without an option are not those with it, but for what changes no picture.
    #[test]
    fn every_option_that_changes_frames_is_in_their_identity() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("card.obj");
        std::fs::write(&scene, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let with = |option: &str| {
            let line = ["bilux", "render", scene.to_str()?, "--output=a.png", option];
            let Arguments { command, common, .. } = Arguments::try_parse_from(line).ok()?;
            let Command::Render(arguments) = command else { return None };
            let user = settings_from::render(&arguments).ok()?;
            let input = Input::open(&scene, &arguments, &common, interrupt(), None).ok()?;
            identity(&input, &user).ok()
        };
        let without = with("--strict").unwrap();
        let command = Arguments::command();
        let options = command.find_subcommand("render").unwrap().get_arguments();
        let mut wrong = Vec::new();
        for (option, name) in options.filter_map(|option| Some((option, option.get_long()?))) {
            let known = option.get_possible_values();
            let usual = |value: &str| option.get_default_values().iter().any(|usual| usual == value);
            let words =
                known.iter().map(|value| value.get_name()).filter(|value| !usual(value)).chain(VALUES);
            let mut lines = words.map(|word| match word {
                "" => format!("--{name}"),
                word => format!("--{name}={word}"),
            });
            let changes = lines.find_map(|line| with(&line)).map(|found| found != without);
            let is_of_no_picture = OF_NO_PICTURE.split(' ').any(|other| other == name);
            if name != "output" && changes != Some(!is_of_no_picture) {
                wrong.push(format!("--{name}: {changes:?}"));
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}
