//! One picture of `bilux render`: from its job to the file.

use super::aov;
use super::input::Input;
use super::keeping::Keeping;
use super::log;
use super::stats;
use super::targets::{Target, is_stdout};
use super::time_limit;
use super::written::{self, Denoising};
use crate::commands::DONE;
use crate::commands::shared::progress::Report;
use crate::preview::{Observers, Preview};
use crate::process::ending::{end, finished, under_way};
use crate::process::{output, usage};
use bilux::Job;
use bilux::checkpoint::render_from;
use std::sync::Arc;

/// Renders a picture and writes it, with what belongs to it.
pub fn finish(input: &Input, job: &Job, target: &Target, build_seconds: f64) -> anyhow::Result<u8> {
    let Input { arguments, common, interrupt, .. } = *input;
    input.check_outputs(target).map_err(usage::wrong)?;
    let output = &target.output;
    let label = output.file_name().unwrap_or(output.as_os_str()).to_string_lossy().into_owned();
    let denoiser = job.denoiser().map_err(usage::wrong)?;
    under_way(&target.scene, output, arguments.json);
    let (keeping, saved) = Keeping::begin(input, job, output)?;
    let before = input.begun.get().elapsed();
    let report = Report::new(&label, common, interrupt.clone());
    interrupt.ends_itself(true);
    let (outcome, kept) = {
        let writer = keeping.writer(job, saved.as_ref());
        let preview = arguments.lasting.preview.map(|choice| Preview::begin(choice, job, report.bar()));
        let preview = preview.transpose()?.flatten();
        let ends = Some(interrupt).filter(|_| !keeping.is_asked());
        let observers = Observers { writer: writer.as_ref(), preview: preview.as_ref(), ends };
        let outcome = render_from(job, saved, &report, &observers)?;
        if let Some(preview) = preview {
            preview.finish(&outcome);
        }
        (outcome, writer.and_then(|writer| writer.samples()))
    };
    let seconds = report.finish();
    if interrupt.is_superseded() && outcome.rendered.cancelled {
        interrupt.ends_itself(false);
        return Ok(DONE);
    }
    if outcome.rendered.cancelled && outcome.samples_per_pixel() == 0.0 {
        let status = interrupt.exit_status();
        let why = match arguments.timeout.filter(|_| interrupt.timed_out()) {
            Some(timeout) => format!("--timeout: the time of {} s was up", timeout.as_secs_f64()),
            None => "it was stopped".to_owned(),
        };
        end(status, &format!("{why} before there was a picture to save"));
    }
    let rendered = input.begun.get().elapsed();
    let denoiser = denoiser.filter(|_| !outcome.rendered.cancelled);
    let outcome = Arc::new(outcome);
    let extra = aov::extra(arguments, job, &outcome, &report)?;
    let layers = aov::Layers { kept: &aov::layers(arguments), extra: extra.as_ref() };
    let (denoising, smoothing) = written::write(input, job, &outcome, denoiser, &layers, output)?;
    let written = input.begun.get().elapsed();
    let is_whole = !outcome.rendered.cancelled && denoising != Denoising::CutShort;
    let overrun = time_limit::overrun(job, &outcome, [before, rendered, input.begun.get().elapsed()]);
    log::report_sample_failures(&outcome);
    let all_aovs = aov::write(arguments, job, &outcome, output, &layers, common, interrupt)?;
    let rendered = log::Rendered {
        job,
        outcome: &outcome,
        scene: input.path,
        output,
        build_seconds,
        times: [before, rendered, smoothing, written],
        seconds,
        total_seconds: input.begun.get().elapsed().as_secs_f64(),
        denoiser: denoiser.map(|chosen| &**chosen).filter(|_| denoising == Denoising::Done),
        is_whole,
        timed_out: interrupt.timed_out(),
        overrun,
        warnings: &input.warnings.borrow(),
    };
    write_stats(target, &rendered)?;
    if arguments.json {
        output::print(rendered.json())?;
    }
    finished();
    interrupt.ends_itself(false);
    if !common.quiet {
        rendered.print(common.verbose);
    }
    if !is_whole || !all_aovs || extra.is_none() {
        keeping.stop(kept, interrupt, common.quiet)?;
        return Ok(interrupt.exit_status());
    }
    let rendered = outcome.rendered.reached.map_or(job.samples_per_pixel(), |reached| reached.spp);
    keeping.finish(kept, rendered)?;
    Ok(DONE)
}

/// Writes what `--stats` asks for.
fn write_stats(target: &Target, rendered: &log::Rendered) -> anyhow::Result<()> {
    let Some(path) = &target.stats else { return Ok(()) };
    let stats = stats::of(rendered);
    if is_stdout(path) {
        return output::print(stats);
    }
    let text = serde_json::to_string_pretty(&stats)?;
    Ok(bilux::pictures::formats::write_atomically(path, text.as_bytes())
        .map_err(|error| error.in_file(path))?)
}
