//! `--aov`: what a render writes besides its picture.

use super::lengths;
use super::targets::is_stdout;
use crate::arguments::assignments::from_flag;
use crate::arguments::{Common, Render};
use crate::commands::shared::progress::Report;
use crate::process::interrupt::Interrupt;
use crate::process::{output, usage};
use anyhow::{Context, bail};
use bilux::pictures::WriteOptions;
use bilux::pictures::formats::format_of_path;
use bilux::scene::SceneError;
use bilux::strategies::{Light, picture, sheet};
use bilux::transport::aovs::{self, Aov};
use bilux::transport::{Interval, Strategies, integrators, strategies::MAX_EDGES};
use bilux::{ExtraLayers, Job, Outcome};
use std::path::{Path, PathBuf};

/// The layers of an `.exr`.
pub struct Layers<'a> {
    /// The layers that rendering keeps.
    pub kept: &'a [Aov],
    /// The layers that are made after it.
    pub extra: Option<&'a ExtraLayers>,
}

/// Checks, before any work, that the outputs asked for exist and have a place to go.
pub fn check(arguments: &Render) -> anyhow::Result<()> {
    for name in &arguments.aov {
        aovs::find(name, &from_flag("--aov"))?;
    }
    if arguments.samples.is_some() && layers(arguments).iter().any(|aov| aov.needs_all_samples()) {
        bail!(
            "these layers need all samples ({}): leave out --samples, or divide the picture by --crop",
            Aov::names_that_need_all_samples()
        );
    }
    if arguments.samples.is_some() && arguments.lengths.is_some() {
        bail!("--lengths takes all samples: leave out --samples, or divide the picture by --crop");
    }
    if arguments.lengths.is_some() && is_stdout(arguments.output_or_stdout()) {
        bail!(
            "--lengths writes a file next to the picture, so the picture needs a file name: -o picture.png"
        );
    }
    let flag = if arguments.aov.is_empty() { "--labels" } else { "--aov" };
    if (arguments.labels || !arguments.aov.is_empty()) && is_stdout(arguments.output_or_stdout()) {
        bail!("{flag} writes files next to the picture, so the picture needs a file name: -o picture.png");
    }
    Ok(())
}

/// The outputs that become layers of the picture.
pub fn layers(arguments: &Render) -> Vec<Aov> {
    Aov::layers().filter(|&aov| wants(arguments, aov)).collect()
}

/// True if this output was asked for.
pub fn wants(arguments: &Render, aov: Aov) -> bool {
    arguments.labels && aov.is_label() || arguments.aov.iter().any(|name| name == aov.row().entry.name)
}

/// Layers that a render keeps for its outputs while it takes samples.
pub fn kept(arguments: &Render) -> Vec<Aov> {
    let interval = [Aov::Interval].into_iter().filter(|&aov| wants(arguments, aov));
    layers(arguments).into_iter().chain(interval).collect()
}

/// Checks that the picture's integrator can provide the outputs.
pub fn check_job(arguments: &Render, job: &Job) -> anyhow::Result<()> {
    if wants(arguments, Aov::Strategies) && !job.has_strategies() {
        let (name, others) = (job.settings().integrator.entry.name, integrators::with_strategies());
        let message = format!(
            "the integrator '{name}' has no separate strategies; choose one of: {}",
            others.collect::<Vec<_>>().join(", ")
        );
        return Err(SceneError::invalid(message, &from_flag("--aov")).into());
    }
    if let Some(bins) = &arguments.lengths {
        job.check_lengths(bins).context("--lengths").map_err(usage::wrong)?;
    }
    ExtraLayers::check(job, &layers(arguments)).context("--aov").map_err(usage::wrong)
}

/// Makes the layers that are made once the picture is there; `None` if that was interrupted.
pub fn extra(
    arguments: &Render,
    job: &Job,
    outcome: &Outcome,
    report: &Report,
) -> anyhow::Result<Option<ExtraLayers>> {
    let layers = layers(arguments);
    let extra = ExtraLayers::of(job, outcome, &layers, report)?;
    if extra.is_none() {
        output::eprint(format_args!(
            "interrupted, so these layers are missing: {}",
            layers
                .iter()
                .filter(|aov| aov.is_extra())
                .filter_map(|aov| aov.layer())
                .collect::<Vec<_>>()
                .join(", ")
        ));
    }
    Ok(extra)
}

/// Renders and writes the outputs besides the picture; returns false if it was stopped.
pub fn write(
    arguments: &Render,
    job: &Job,
    outcome: &Outcome,
    output: &Path,
    layers: &Layers,
    common: &Common,
    interrupt: &Interrupt,
) -> anyhow::Result<bool> {
    if let Some(interval) = &outcome.rendered.interval {
        write_interval(interval, outcome, output, common)?;
    }
    if !layers.kept.is_empty() && !is_exr(output) {
        let path = output.with_extension("layers.exr");
        let mut picture = outcome.layered(layers.kept)?;
        if let Some(extra) = layers.extra {
            extra.push(&mut picture)?;
        }
        job.describe(&mut picture, outcome, None);
        bilux::pictures::write(&path, &picture, &WriteOptions::default())?;
    }
    if layers.extra.is_none() {
        return Ok(false);
    }
    if let Some(bins) = arguments.lengths.filter(|_| !outcome.rendered.cancelled)
        && !lengths::write(bins, job, outcome, output, common, interrupt)?
    {
        return Ok(false);
    }
    if !wants(arguments, Aov::Strategies) || outcome.rendered.cancelled {
        return Ok(!outcome.rendered.cancelled);
    }
    let folder = output.with_extension("strategies");
    let report =
        Report::new(&folder.file_name().unwrap_or_default().to_string_lossy(), common, interrupt.clone());
    let strategies = job.strategies(outcome, &report)?;
    let seconds = report.finish();
    let Some(strategies) = strategies else {
        output::eprint(format_args!("{}: interrupted, so it was not written", folder.display()));
        return Ok(false);
    };
    write_strategies(&strategies, outcome, &folder, &job.write_options()?)?;
    if !common.quiet {
        output::eprint(format_args!(
            "{}: {} strategies for paths of up to {MAX_EDGES} edges, {seconds:.2} s{}",
            folder.display(),
            strategies.pictures.len(),
            longer(&strategies, outcome),
        ));
    }
    Ok(true)
}

/// The files, other than the picture and its folder of strategies, that a render writes.
pub fn files(arguments: &Render, output: &Path) -> Vec<PathBuf> {
    let layers = !layers(arguments).is_empty() && !is_exr(output);
    let extensions = [
        ("layers.exr", layers),
        ("interval.exr", wants(arguments, Aov::Interval)),
        (lengths::EXTENSION, arguments.lengths.is_some()),
    ];
    let written = extensions.into_iter().filter(|(_, is_written)| *is_written);
    written.map(|(extension, _)| output.with_extension(extension)).collect()
}

/// True for files that hold layers.
pub fn is_exr(path: &Path) -> bool {
    format_of_path(path).is_ok_and(|format| format.entry.name == "exr")
}

/// Writes `OUT.interval.exr`.
fn write_interval(
    interval: &Interval,
    outcome: &Outcome,
    output: &Path,
    common: &Common,
) -> anyhow::Result<()> {
    let path = output.with_extension("interval.exr");
    if interval.degrees_of_freedom() == 0 {
        output::warning(format_args!(
            "{}: not written, since an interval needs at least 2 samples per pixel",
            path.display()
        ));
        return Ok(());
    }
    let mut picture = interval.to_picture()?;
    picture.crop = outcome.rendered.film.crop();
    bilux::pictures::write(&path, &picture, &WriteOptions::default())?;
    if !common.quiet {
        output::eprint(format_args!(
            "{}: 95% intervals of {} in {} replicates",
            path.display(),
            output::counted(interval.samples(), "sample", "samples"),
            interval.degrees_of_freedom() + 1,
        ));
    }
    Ok(())
}

/// Writes `s1-t2.exr` and `s1-t2-unweighted.exr` for each strategy, and two sheets that show all of them.
fn write_strategies(
    strategies: &Strategies,
    outcome: &Outcome,
    folder: &Path,
    options: &WriteOptions,
) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{}: cannot create the folder", folder.display()))?;
    for one in &strategies.pictures {
        for (light, end) in [(Light::Weighted, ""), (Light::Unweighted, "-unweighted")] {
            let path: PathBuf = folder.join(format!("{}{end}.exr", one.strategy));
            let mut picture = picture(strategies, one, light)?;
            picture.crop = outcome.rendered.film.crop();
            bilux::pictures::write(path, &picture, options)?;
        }
    }
    for light in Light::BOTH {
        let path = folder.join(format!("{}.png", light.name()));
        bilux::pictures::write(path, &sheet(strategies, light)?, options)?;
    }
    Ok(())
}

/// The light of paths that are too long for the sheets, as a remark.
fn longer(strategies: &Strategies, outcome: &Outcome) -> String {
    let light = |pixels: &[bilux::math::Rgb]| -> f64 {
        pixels.iter().filter(|pixel| pixel.is_finite()).map(|pixel| f64::from(pixel.luminance())).sum()
    };
    let shown: f64 = strategies.pictures.iter().map(|one| light(&one.weighted)).sum();
    let missing = 1.0 - shown / light(&outcome.rendered.film.to_rgb());
    if missing > 5e-4 {
        format!("; longer paths carry {:.1}% of the light", missing * 100.0)
    } else {
        String::new()
    }
}
