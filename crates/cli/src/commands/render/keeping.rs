//! The checkpoints of a picture: from which one it goes on, where the next ones go, and when the last one is not needed any more.

use super::input::Input;
use super::log::counted_samples;
use super::targets::is_stdout;
use crate::arguments::Render;
use crate::arguments::lasting::Checkpoints;
use crate::process::interrupt::Interrupt;
use crate::process::output;
use anyhow::{Context, bail};
use bilux::Job;
use bilux::checkpoint::{CheckpointError, CheckpointWriter, Head, Identity, SavedRender, checkpoint_path};
use bilux::scene::{Span, Warning};
use std::path::{Path, PathBuf};

/// Refuses checkpoints of what is not a file.
pub fn check(arguments: &Render) -> anyhow::Result<()> {
    let flags =
        [("--resume", arguments.lasting.resume), ("--checkpoint", arguments.lasting.checkpoint.is_some())];
    for (flag, _) in flags.iter().filter(|(_, is_given)| *is_given) {
        if is_stdout(arguments.output_or_stdout()) {
            bail!(
                "{flag}: a checkpoint lies next to the picture, so the picture needs a file name: -o picture.png"
            );
        }
        if arguments.replay.is_some() {
            bail!("{flag}: --replay takes one sample, which needs no checkpoint: leave it out");
        }
    }
    Ok(())
}

/// The checkpoint of one picture.
pub struct Keeping {
    path: Option<PathBuf>,
    every: Checkpoints,
    /// Samples per pixel of an older checkpoint of the same picture, which a render that begins anew must not lose.
    older: Option<f64>,
    has_resumed: bool,
    /// Whether the command line speaks of checkpoints.
    is_asked: bool,
}

impl Keeping {
    /// Looks for a checkpoint of the picture, and reads it if the render is to go on from it.
    pub fn begin(input: &Input, job: &Job, output: &Path) -> anyhow::Result<(Keeping, Option<SavedRender>)> {
        let (lasting, common) = (&input.arguments.lasting, input.common);
        let every = lasting.checkpoints();
        let is_asked = lasting.is_asked();
        let mut keeping = Keeping { path: None, every, older: None, has_resumed: false, is_asked };
        if is_stdout(output) || lasting.watch {
            return Ok((keeping, None));
        }
        let path = checkpoint_path(output);
        let is_there = path.symlink_metadata().is_ok();
        let mut saved = None;
        if lasting.resume && is_there {
            let read = SavedRender::read(&path, common.max_memory).map_err(bilux::Error::from)?;
            if !common.quiet {
                output::eprint(format_args!(
                    "{}: resumes at {} per pixel, after {:.0} s of work",
                    output.display(),
                    counted_samples(read.head.samples),
                    read.head.spent.as_secs_f64()
                ));
            }
            (saved, keeping.has_resumed) = (Some(read), true);
        } else if lasting.resume && input.arguments.frames.is_none() && input.arguments.turntable.is_none() {
            if !common.quiet {
                output::eprint(format_args!("{}: not there: begins with the first sample", path.display()));
            }
        } else if is_there {
            keeping.older = warn_of_older(input, job, &path, every)?;
        }
        keeping.path = Some(path);
        Ok((keeping, saved))
    }

    /// Writer of the checkpoints of this render; `saved` is the one that it goes on from.
    pub fn writer<'a>(&self, job: &'a Job, saved: Option<&SavedRender>) -> Option<CheckpointWriter<'a>> {
        let (path, Checkpoints::Every(every)) = (self.path.as_ref()?, self.every) else { return None };
        let mut writer = CheckpointWriter::new(job, path, Some(every)).on_failure(|error| {
            output::warning(format_args!(
                "{}; the render goes on, and the checkpoint before, if there is one, is kept",
                output::error_text(error)
            ));
        });
        if let Some(saved) = saved {
            writer = writer.continuing(saved);
        }
        Some(match self.older {
            Some(samples) => writer.keeping_until(samples),
            None => writer,
        })
    }

    /// True if the command line speaks of checkpoints; otherwise they are only for a process that is killed, and for Ctrl-C.
    pub fn is_asked(&self) -> bool {
        self.is_asked
    }

    /// The render was stopped and its picture saved: says where it can go on. A server that stops it, or a timeout, finds
    /// nothing beside the picture that it has not asked for.
    pub fn stop(&self, written: Option<f64>, interrupt: &Interrupt, quiet: bool) -> anyhow::Result<()> {
        let (Some(path), Some(kept)) = (&self.path, written) else { return Ok(()) };
        let is_ours = self.older.is_none_or(|older| kept > older);
        if !self.is_asked && interrupt.is_terminated() && is_ours {
            return remove(path, "the render was stopped");
        }
        if !quiet && path.is_file() {
            output::eprint(format_args!(
                "{}: holds {} per pixel; add --resume to continue from there",
                path.display(),
                counted_samples(kept)
            ));
        }
        Ok(())
    }

    /// The picture is written, with so many samples per pixel: removes its checkpoint.
    pub fn finish(&self, written: Option<f64>, rendered: u32) -> anyhow::Result<()> {
        // A draft with fewer samples does not supersede an older checkpoint.
        let is_ours = match self.older {
            Some(older) => f64::from(rendered) >= older,
            None => written.is_some() || self.has_resumed,
        };
        match &self.path {
            Some(path) if is_ours => remove(path, "the picture is finished"),
            _ => Ok(()),
        }
    }
}

/// Removes a checkpoint, if it is there.
fn remove(path: &Path, since: &str) -> anyhow::Result<()> {
    if !path.is_file() {
        return Ok(());
    }
    let failed = || format!("{}: {since}, but this cannot be removed", path.display());
    std::fs::remove_file(path).with_context(failed)
}

/// Warns of a checkpoint that a render without `--resume` finds. One of the same picture is kept until this render has got
/// further: returns its samples. Any other is moved out of the way.
fn warn_of_older(input: &Input, job: &Job, path: &Path, every: Checkpoints) -> anyhow::Result<Option<f64>> {
    let warn = |message: String| input.warn(&[Warning { message, at: Span::default() }]);
    let shown = path.display();
    let head = Head::read(path);
    if let Ok(head) = &head
        && Identity::of(job).differences(&head.identity).is_empty()
    {
        warn(format!(
            "{shown}: this picture already has {} per pixel, and --resume continues from them; without --resume the render starts \
             over, and keeps this file until it has more",
            counted_samples(head.samples)
        ))?;
        return Ok(Some(head.samples));
    }
    let what = match head {
        Err(CheckpointError::Damaged { .. }) => "damaged, or not one of this version of Bilux",
        Err(error) => return Err(bilux::Error::from(error).into()),
        Ok(_) => "that of another scene or other settings",
    };
    if every == Checkpoints::Off {
        return Ok(None);
    }
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".old");
    let old = path.with_file_name(name);
    let replaced = if old.exists() { ", in place of the one there" } else { "" };
    warn(format!("{shown}: this checkpoint is {what}; it is kept as {}{replaced}", old.display()))?;
    std::fs::rename(path, &old).with_context(|| format!("{shown}: cannot rename it to {}", old.display()))?;
    Ok(None)
}
