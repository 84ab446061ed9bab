//! `bilux bench`: benchmarks.

use super::{DONE, check_folder, read_options};
use crate::arguments::{Bench, BenchKind, Common};
use crate::{output, usage};
use anyhow::{Context, anyhow};
use bilux::settings::{parse_size, size_error};
use bilux_bench::Options;

pub fn run(arguments: &Bench, common: &Common) -> anyhow::Result<u8> {
    let defaults = Options::default();
    if common.sandbox {
        return Err(usage::wrong(anyhow!(
            "--sandbox: benchmarks load other engines and write files, so they cannot run in it: leave it out"
        )));
    }
    let size = |text: &String| parse_size(text).with_context(|| format!("--size: {}", size_error(text)));
    let size = arguments.size.as_ref().map(size).transpose().map_err(usage::wrong)?;
    let options = Options {
        counts: arguments.counts.clone(),
        accels: arguments.accel.clone(),
        size,
        repeats: arguments.repeats.unwrap_or(defaults.repeats),
        layout: arguments.layout.clone().unwrap_or(defaults.layout),
    };
    if let Some(path) = &arguments.output {
        check_folder(path).map_err(usage::wrong)?;
        bilux::pictures::format_of_path(path).map_err(usage::wrong)?;
    }
    let progress = |what: &str| {
        if !common.quiet {
            output::eprint(format_args!("measuring {what}"));
        }
    };
    let report = match arguments.kind {
        BenchKind::Paper => bilux_bench::paper::run(&options, &progress)?,
        BenchKind::Teapots => bilux_bench::teapots::run(&options, &progress)?,
        BenchKind::Frames => bilux_bench::frames::run(&options, &progress)?,
        BenchKind::Visibility => bilux_bench::visibility::run(&options, &progress)?,
        BenchKind::Build => bilux_bench::build::run(&options, &progress)?,
        BenchKind::Rays => bilux_bench::rays::run(&rays(arguments, common)?, &progress)?,
        BenchKind::Render => render(arguments, common, &progress)?,
        BenchKind::Load => load(arguments, common, &progress)?,
        BenchKind::Models => models(arguments, &progress)?,
        BenchKind::Speed => speed(arguments, common, &progress)?,
    };
    if arguments.json {
        output::print(serde_json::to_string_pretty(&report.json())?)?;
    } else {
        output::print(report.text.trim_end())?;
    }
    if let Some(path) = &arguments.output {
        let picture = report.picture.context("-o: this benchmark produces no picture: leave it out")?;
        bilux::pictures::write(path, &picture, &Default::default())?;
    }
    Ok(DONE)
}

/// Runs `bench render`, or makes its references.
fn render(
    arguments: &Bench,
    common: &Common,
    progress: bilux_bench::ProgressFn,
) -> anyhow::Result<bilux_bench::Report> {
    use bilux_bench::render::{Options, ReferenceOptions, make_references, run};
    let defaults = Options::default();
    if let Some(folder) = &arguments.make_references {
        let seconds = arguments.seconds.last().copied().unwrap_or(MINUTE);
        let scenes = arguments.gallery.clone();
        let making = ReferenceOptions { folder: folder.clone(), scenes, seconds, threads: arguments.threads };
        return Ok(make_references(&making, progress)?);
    }
    let options = Options {
        scenes: arguments.gallery.clone(),
        files: arguments.scenes.clone(),
        read: read_options(common),
        reference_seconds: arguments.reference_seconds.unwrap_or(defaults.reference_seconds),
        integrators: arguments.integrators.clone(),
        seconds: if arguments.seconds.is_empty() { defaults.seconds } else { arguments.seconds.clone() },
        seeds: arguments.seeds.unwrap_or(defaults.seeds),
        threads: arguments.threads,
        report: arguments.report.clone(),
    };
    Ok(run(&options, progress)?)
}

/// Runs `bench load` with one process per file, so that each file's memory is measured on its own.
fn load(
    arguments: &Bench,
    common: &Common,
    progress: bilux_bench::ProgressFn,
) -> anyhow::Result<bilux_bench::Report> {
    use bilux_bench::load::{Options, make, report, run};
    let repeats = arguments.repeats.unwrap_or(5);
    if let [file] = arguments.scenes.as_slice() {
        let options = Options { files: vec![file.clone()], repeats, read: read_options(common) };
        return Ok(run(&options, progress)?);
    }
    let folder = std::env::temp_dir().join(format!("bilux-load-{}", std::process::id()));
    let files = if arguments.scenes.is_empty() {
        progress("files of 100 MB and a million instances, generated now");
        std::fs::create_dir_all(&folder)
            .with_context(|| format!("{}: cannot create the folder", folder.display()))?;
        make(&folder, 100_000_000, 1_000_000)?
    } else {
        arguments.scenes.clone()
    };
    let rows = files.iter().map(|file| {
        progress(&file.display().to_string());
        let mut command = std::process::Command::new(std::env::current_exe()?);
        command.args(["bench", "load", "--json", "--quiet", "--repeats", &repeats.to_string()]);
        command.args(["--max-memory", &common.max_memory.to_string()]).arg(file);
        let output = command.stderr(std::process::Stdio::inherit()).output()?;
        anyhow::ensure!(output.status.success(), "{}: could not be measured", file.display());
        let found: serde_json::Value = serde_json::from_slice(&output.stdout)?;
        Ok(found["rows"][0].clone())
    });
    let rows = rows.collect::<anyhow::Result<Vec<_>>>();
    if arguments.scenes.is_empty() {
        // The generated files are no longer needed.
        let _ = std::fs::remove_dir_all(&folder);
    }
    Ok(report(rows?))
}

/// Runs `bench models` with this program itself.
fn models(arguments: &Bench, progress: bilux_bench::ProgressFn) -> anyhow::Result<bilux_bench::Report> {
    use bilux_bench::models::{Options, SECONDS, run};
    let options = Options {
        program: std::env::current_exe()?,
        files: arguments.scenes.clone(),
        seconds: arguments.seconds.last().copied().unwrap_or(SECONDS),
        references: arguments.references.clone(),
    };
    Ok(run(&options, progress)?)
}

/// Runs `bench speed`, which measures memory with this program itself.
fn speed(
    arguments: &Bench,
    common: &Common,
    progress: bilux_bench::ProgressFn,
) -> anyhow::Result<bilux_bench::Report> {
    use bilux_bench::speed::{Options, run};
    let defaults = Options::default();
    let against = arguments.against.last().map(|(name, path)| match name.as_str() {
        "embree" => Ok(path.clone()),
        other => Err(usage::wrong(anyhow!("--against {other}: bench speed knows only embree=PATH"))),
    });
    let options = Options {
        rows: arguments.rows.clone(),
        model: arguments.model.clone(),
        read: read_options(common),
        python: arguments.python.clone().unwrap_or(defaults.python),
        embree: against.transpose()?.unwrap_or(defaults.embree),
        program: std::env::current_exe()?,
        repeats: arguments.repeats.unwrap_or(defaults.repeats),
        seconds: arguments.seconds.last().copied().unwrap_or(defaults.seconds),
        share: defaults.share,
    };
    Ok(run(&options, progress)?)
}

/// The default time in seconds that each integrator spends on a reference.
const MINUTE: f64 = 60.0;

/// The options of `bench rays`.
fn rays(arguments: &Bench, common: &Common) -> anyhow::Result<bilux_bench::rays::Options> {
    let defaults = bilux_bench::rays::Options::default();
    let (numbers, files): (Vec<&String>, Vec<&String>) =
        arguments.rays.iter().partition(|text| text.parse::<u64>().is_ok());
    let count = match numbers.last() {
        Some(text) => text.parse().ok().filter(|n| (1..=MAX_RAYS).contains(n)).with_context(|| {
            format!(
                "--rays {text}: write a number of rays from 1 to {MAX_RAYS}; for a file of this name, write \
                     ./{text}"
            )
        })?,
        None => defaults.count,
    };
    Ok(bilux_bench::rays::Options {
        scenes: arguments.scenes.clone(),
        read: read_options(common),
        accels: arguments.accel.clone(),
        count,
        rounds: arguments.rounds.unwrap_or(defaults.rounds),
        against: arguments.against.clone(),
        dump: arguments.dump.clone(),
        mesh: arguments.mesh.clone(),
        rays: files.into_iter().map(Into::into).collect(),
        hits: arguments.hits.clone(),
    })
}

/// More would not fit into the memory of most machines.
const MAX_RAYS: usize = 1 << 26;
