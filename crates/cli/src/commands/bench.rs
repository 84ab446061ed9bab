//! `bilux bench`: benchmarks.

use crate::arguments::measuring::{
    BenchKind, LoadBench, ModelsBench, RaysBench, RenderBench, Repeated, SpeedBench,
};
use crate::arguments::{Bench, Common};
use crate::commands::DONE;
use crate::commands::shared::checks::check_folder;
use crate::commands::shared::reading::read_options;
use crate::process::{output, usage};
use anyhow::{Context, anyhow};
use bilux::settings::{parse_size, size_error};
use bilux_bench::Options;

pub fn run(arguments: &Bench, common: &Common) -> anyhow::Result<u8> {
    if common.sandbox {
        return Err(usage::wrong(anyhow!(
            "--sandbox: benchmarks load other engines and write files, so they cannot run in it: leave it out"
        )));
    }
    let picture = match &arguments.kind {
        BenchKind::Paper(paper) => paper.output.as_ref(),
        _ => None,
    };
    if let Some(path) = picture {
        check_folder(path).map_err(usage::wrong)?;
        bilux::pictures::format_of_path(path).map_err(usage::wrong)?;
    }
    let progress = |what: &str| {
        if !common.quiet {
            output::eprint(format_args!("measuring {what}"));
        }
    };
    let report = report(&arguments.kind, common, &progress)?;
    if arguments.json {
        output::print(serde_json::to_string_pretty(&report.json())?)?;
    } else {
        output::print(report.text.trim_end())?;
    }
    if let (Some(path), Some(figures)) = (picture, report.picture) {
        bilux::pictures::write(path, &figures, &Default::default())?;
    }
    Ok(DONE)
}

/// Runs a benchmark.
fn report(
    kind: &BenchKind,
    common: &Common,
    progress: bilux_bench::ProgressFn,
) -> anyhow::Result<bilux_bench::Report> {
    Ok(match kind {
        BenchKind::Paper(of) => {
            let options = Options { size: size(of.size.as_ref())?, ..Options::default() };
            bilux_bench::paper::run(&options, progress)?
        }
        BenchKind::Teapots(of) => {
            let options = Options {
                counts: of.counts.clone(),
                accels: of.structures.accel.clone(),
                size: size(of.picture.size.as_ref())?,
                ..repeated(&of.repeated)
            };
            bilux_bench::teapots::run(&options, progress)?
        }
        BenchKind::Frames(of) => {
            let options = Options {
                counts: of.counts.into_iter().collect(),
                accels: of.structures.accel.clone(),
                size: size(of.picture.size.as_ref())?,
                ..Options::default()
            };
            bilux_bench::frames::run(&options, progress)?
        }
        BenchKind::Visibility(of) => {
            let options = Options {
                counts: of.counts.into_iter().collect(),
                size: size(of.picture.size.as_ref())?,
                ..repeated(&of.repeated)
            };
            bilux_bench::visibility::run(&options, progress)?
        }
        BenchKind::Build(of) => {
            let options = Options {
                counts: of.counts.clone(),
                accels: of.structures.accel.clone(),
                ..repeated(&of.repeated)
            };
            bilux_bench::build::run(&options, progress)?
        }
        BenchKind::Rays(of) => bilux_bench::rays::run(&rays(of, common)?, progress)?,
        BenchKind::Render(of) => render(of, common, progress)?,
        BenchKind::Load(of) => load(of, common, progress)?,
        BenchKind::Models(of) => models(of, progress)?,
        BenchKind::Speed(of) => speed(of, common, progress)?,
    })
}

/// The width and the height, if they are given.
fn size(text: Option<&String>) -> anyhow::Result<Option<(u32, u32)>> {
    let size = |text: &String| parse_size(text).with_context(|| format!("--size: {}", size_error(text)));
    text.map(size).transpose().map_err(usage::wrong)
}

/// Number of repeats, and the place of teapots meanwhile.
fn repeated(of: &Repeated) -> Options {
    let defaults = Options::default();
    Options {
        repeats: of.repeats.unwrap_or(defaults.repeats),
        layout: of.layout.clone().unwrap_or(defaults.layout),
        ..defaults
    }
}

/// Runs `bench render`, or makes its references.
fn render(
    arguments: &RenderBench,
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
    arguments: &LoadBench,
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
fn models(arguments: &ModelsBench, progress: bilux_bench::ProgressFn) -> anyhow::Result<bilux_bench::Report> {
    use bilux_bench::models::{Options, SECONDS, run};
    let options = Options {
        program: std::env::current_exe()?,
        files: arguments.scenes.clone(),
        seconds: arguments.seconds.unwrap_or(SECONDS),
        references: arguments.references.clone(),
    };
    Ok(run(&options, progress)?)
}

/// Runs `bench speed`, which measures memory with this program itself.
fn speed(
    arguments: &SpeedBench,
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
        seconds: arguments.seconds.unwrap_or(defaults.seconds),
        share: defaults.share,
    };
    Ok(run(&options, progress)?)
}

/// The default time in seconds that each integrator spends on a reference.
const MINUTE: f64 = 60.0;

/// The options of `bench rays`.
fn rays(arguments: &RaysBench, common: &Common) -> anyhow::Result<bilux_bench::rays::Options> {
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
        accels: arguments.structures.accel.clone(),
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
