//! `bilux denoise`: removes the noise from a picture.

use crate::arguments::values::Exposure;
use crate::arguments::{Common, Denoise};
use crate::commands::DONE;
use crate::commands::shared::checks::check_folder;
use crate::commands::shared::checks::check_not_input;
use crate::commands::shared::checks::check_quality;
use crate::commands::shared::checks::warn_lost_alpha;
use crate::commands::shared::pictures::{read_picture, with_main};
use crate::commands::shared::sandbox_paths::SandboxPaths;
use crate::process::{output, usage};
use anyhow::Context;
use bilux::pictures::denoise::{DenoiserChoice, Task, denoise, denoiser};
use bilux::pictures::formats::format_of_path;
use bilux::pictures::{Limits, WriteOptions, auto_exposure, tone_map};
use std::io::IsTerminal;
use std::time::Instant;

pub fn run(arguments: &Denoise, common: &Common) -> anyhow::Result<u8> {
    let (input, output) = (&arguments.input, &arguments.output);
    check_folder(output).map_err(usage::wrong)?;
    check_not_input(output, [&**input]).map_err(usage::wrong)?;
    format_of_path(output).map_err(usage::wrong)?;
    check_quality(arguments.quality, output).map_err(usage::wrong)?;
    let confines = SandboxPaths::default().reading(input).writing(output);
    confines.check_written(output, common).map_err(usage::wrong)?;
    let tone_map = tone_map(&arguments.tonemap).context("--tonemap").map_err(usage::wrong)?;
    let threads = arguments.threads as usize;
    if arguments.by != "builtin" {
        crate::commands::render::denoisers::load(threads, common);
    }
    let task = Task { threads, sandboxed: common.sandbox, ..Task::default() };
    let chosen = denoiser(&arguments.by, &task).context("--by").map_err(usage::wrong)?;
    confines.enter(common)?;
    let noisy = read_picture(input, &Limits::new(common.max_memory), common)?;
    let noisy = with_main(noisy, arguments.layer.as_deref(), input, common)?;
    let begun = Instant::now();
    let smooth = denoise(&noisy, &*chosen.denoiser)?;
    let seconds = begun.elapsed().as_secs_f64();
    let exposure = match arguments.exposure {
        Exposure::Stops(stops) => stops,
        Exposure::Auto => auto_exposure(&smooth),
    };
    let mut options = WriteOptions { exposure, tone_map, ..WriteOptions::default() };
    options.quality = arguments.quality.unwrap_or(options.quality);
    warn_lost_alpha(&smooth, output, None, common)?;
    bilux::pictures::write(output, &smooth, &options)?;
    if !common.quiet {
        let shows_advice = common.verbose > 0 || std::io::stderr().is_terminal();
        output::eprint(format_args!("{}: {}", output.display(), summary(&chosen, seconds, shows_advice)));
    }
    Ok(DONE)
}

/// Which denoiser ran, and how to get a better one.
fn summary(chosen: &DenoiserChoice, seconds: f64, shows_advice: bool) -> String {
    let advice = chosen
        .advice
        .as_ref()
        .filter(|_| shows_advice)
        .map(|advice| format!("; {advice}"))
        .unwrap_or_default();
    format!("denoised by {} in {seconds:.2} s{advice}", chosen.denoiser.describe())
}
