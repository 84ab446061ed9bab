//! `--replay`: one sample again, in words and, with a name for a picture, drawn into that.

use super::aov;
use super::input::Input;
use super::targets::is_stdout;
use crate::commands::DONE;
use crate::commands::shared::progress::Report;
use crate::process::{output, usage};
use anyhow::Context;
use bilux::Job;
use bilux::light_path::LightPath;
use bilux::path_drawing::with_path;
use bilux::pictures::{WriteOptions, to_display};
use std::path::Path;

/// Prints the sample, and draws it into the picture if that has a name.
pub fn run(input: &Input, job: &Job, path: &Path) -> anyhow::Result<u8> {
    let Input { arguments, common, interrupt, .. } = *input;
    let [x, y, sample] = arguments.replay.unwrap_or_default();
    let light_path = LightPath::of(job, x, y, sample).context("--replay")?;
    output::print(&light_path.replay)?;
    if is_stdout(path) {
        return Ok(DONE);
    }
    let denoiser = job.denoiser().map_err(usage::wrong)?;
    let label = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let report = Report::new(&label, common, interrupt.clone());
    interrupt.ends_itself(true);
    let outcome = job.render(&report)?;
    let seconds = report.finish();
    let picture = match denoiser.filter(|_| !outcome.rendered.cancelled) {
        Some(chosen) => outcome.denoised(chosen)?,
        None => outcome.picture()?,
    };
    let options = job.write_options_for(&picture)?;
    let shown = to_display(&picture, options.exposure, options.tone_map)?;
    let mut drawn = with_path(&shown, &light_path)?;
    job.describe(&mut drawn, &outcome, None);
    // Where there is nothing but the path, its exposure and its curve are in the picture already.
    let options =
        WriteOptions { quality: arguments.quality.unwrap_or(options.quality), ..WriteOptions::default() };
    bilux::pictures::write(path, &drawn, &options)?;
    interrupt.ends_itself(false);
    if !common.quiet {
        output::eprint(format_args!(
            "{}: the path of sample {sample} of pixel {x},{y} drawn into the picture, {seconds:.2} s",
            path.display()
        ));
    }
    Ok(if outcome.rendered.cancelled { interrupt.exit_status() } else { DONE })
}

/// Refuses, before any work, what a drawn path does not go with.
pub fn check(arguments: &crate::arguments::Render) -> anyhow::Result<()> {
    if arguments.replay.is_some() && !aov::layers(arguments).is_empty() {
        anyhow::bail!(
            "--replay draws a path and writes no layers: leave out --aov and --labels, or render without --replay"
        );
    }
    Ok(())
}
