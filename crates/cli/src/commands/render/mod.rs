//! `bilux render`: renders pictures of scenes.

pub(in crate::commands) mod aov;
pub(crate) mod denoisers;
pub(in crate::commands) mod finishing;
pub(in crate::commands) mod frames;
pub(in crate::commands) mod input;
pub(in crate::commands) mod keeping;
pub(in crate::commands) mod lengths;
pub(in crate::commands) mod log;
pub(in crate::commands) mod replaying;
pub(in crate::commands) mod stats;
pub(in crate::commands) mod targets;
pub(in crate::commands) mod time_limit;
pub(in crate::commands) mod watching;
pub(in crate::commands) mod written;

use crate::arguments::settings_from;
use crate::arguments::{Common, Render};
use crate::commands::DONE;
use crate::commands::shared::given::Given;
use crate::commands::shared::progress::of_series;
use crate::commands::shared::reading::report_notes;
use crate::commands::shared::sandbox_paths::{SandboxPaths, check_read, folder_of, leads_out};
use crate::process::ending::{finished, under_way};
use crate::process::interrupt::{Interrupt, interrupt};
use crate::process::{output, signals, usage};
use anyhow::bail;
use bilux::budget::{with_default_budget, with_fast_budget};
use bilux::checkpoint::checkpoint_path;
use bilux::scene::{Parameters, SceneBuilder};
use bilux::watch::Watched;
use bilux::{JobRequest, Series};
use denoisers::{begin_loading, check_scenes};
use finishing::finish;
use frames::FinishedFrames;
use input::{Input, Wanted};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;
use targets::{Target, frame_path, is_stdout, still_frames, targets};

pub fn run(arguments: &Render, common: &Common) -> anyhow::Result<u8> {
    let interrupt = interrupt();
    let user = settings_from::render(arguments).map_err(usage::wrong)?;
    check_scenes(&arguments.scenes).map_err(usage::wrong)?;
    let targets = targets(arguments).map_err(usage::wrong)?;
    aov::check(arguments).map_err(usage::wrong)?;
    keeping::check(arguments).map_err(usage::wrong)?;
    watching::check(arguments).map_err(usage::wrong)?;
    replaying::check(arguments).map_err(usage::wrong)?;
    arguments.studio.check().map_err(usage::wrong)?;
    arguments.studio.check_files()?;
    arguments.check_tonemap().map_err(usage::wrong)?;
    let begun = Instant::now();
    begin_loading(arguments, common);
    if let Err(error) = begin(&targets, arguments, common, begun) {
        // Nothing is rendered, which who reads JSON learns of each scene.
        if arguments.json && !usage::is_command_line(&error) {
            for target in &targets {
                log::print_failure(&target.scene, &target.output, &error)?;
            }
        }
        return Err(error);
    }
    if let ([target], true) = (&targets[..], arguments.lasting.watch) {
        return watching::run(target, common, interrupt, |watched| {
            render_one(target, &user, arguments, common, interrupt, Some(watched))
        });
    }
    let mut failed = 0;
    for target in &targets {
        match render_one(target, &user, arguments, common, interrupt, None) {
            Ok(DONE) => {}
            Ok(status) => return Ok(status),
            Err(error) => {
                let error = usage::naming(&target.scene, error);
                if arguments.json && !output::is_closed_pipe(&error) {
                    log::print_failure(&target.scene, &target.output, &error)?;
                }
                finished();
                // One broken scene does not stop the others; an error that concerns all of them does.
                if targets.len() == 1 || usage::is_command_line(&error) || output::is_closed_pipe(&error) {
                    return Err(error);
                }
                output::error(&error);
                failed += 1;
            }
        }
    }
    if failed > 0 {
        bail!("{failed} of {} scenes could not be rendered", targets.len());
    }
    Ok(DONE)
}

/// Prepares the process: its sandbox, its threads, and its end.
fn begin(targets: &[Target], arguments: &Render, common: &Common, begun: Instant) -> anyhow::Result<()> {
    confine(targets, arguments, common)?;
    match arguments.timeout {
        Some(timeout) => signals::end_after(interrupt(), timeout.saturating_sub(begun.elapsed()), timeout),
        None => Ok(()),
    }
}

/// Under `--sandbox`: refuses to write elsewhere than to the picture's folder, and confines the process.
fn confine(targets: &[Target], arguments: &Render, common: &Common) -> anyhow::Result<()> {
    let confines = confines(targets, arguments);
    for target in targets {
        let beside = if is_stdout(&target.output) { Vec::new() } else { beside(target, arguments) };
        let files = [&target.output].into_iter().chain(&target.stats).chain(&beside);
        for file in files.filter(|file| !is_stdout(file)) {
            confines.check_written(file, common).map_err(usage::wrong)?;
        }
    }
    confines.enter(common)
}

/// Permissions of a render under `--sandbox`: it reads the scenes, their folders and the files that options name, and writes to
/// the picture's folder.
pub fn confines(targets: &[Target], arguments: &Render) -> SandboxPaths {
    let studio = &arguments.studio;
    let mut confines = SandboxPaths::default();
    for scene in targets.iter().map(|target| &target.scene) {
        let scene = Given::place(scene);
        // One that leads out is refused when its turn comes, and does not stop the others.
        if !leads_out(scene) {
            confines = confines.reading_scene(scene);
        }
    }
    confines = confines.reading_options(studio);
    if let Some(output) = arguments.output.as_deref().filter(|output| !is_stdout(output)) {
        confines = confines.writing(output);
    }
    // Those of frames have names of their own.
    let folders: BTreeSet<&Path> = targets.iter().map(|target| folder_of(&target.output)).collect();
    for file in folders.into_iter().filter_map(|folder| folder.read_dir().ok()).flatten().flatten() {
        let is_checkpoint = file.path().extension().is_some_and(|extension| extension == "checkpoint");
        if is_checkpoint && !leads_out(&file.path()) {
            confines = confines.reading(&file.path());
        }
    }
    confines
}

/// Files that are written beside a picture.
fn beside(target: &Target, arguments: &Render) -> Vec<PathBuf> {
    let mut files = aov::files(arguments, &target.output);
    files.extend([checkpoint_path(&target.output), target.output.with_extension("strategies")]);
    files
}

fn render_one(
    target: &Target,
    user: &Parameters,
    arguments: &Render,
    common: &Common,
    interrupt: &Interrupt,
    watched: Option<&Watched>,
) -> anyhow::Result<u8> {
    under_way(&target.scene, &target.output, arguments.json);
    interrupt.ends_itself(false);
    check_read(&target.scene, common)?;
    let input = Input::open(&target.scene, arguments, common, interrupt, watched)?;
    let mut scene = input.read(arguments.studio.time(), arguments.moments().is_some())?;
    input.warn(&scene.warnings)?;
    report_notes(&scene.notes, common);
    input.warn(&still_frames(arguments, &scene))?;
    let Some(count) = arguments.turntable else {
        return render_scene(&input, &mut scene, target, user, &Series::default());
    };
    let series = Series::turntable(&scene, &JobRequest::from(user).max_memory(common.max_memory), count)?;
    let mut finished = FinishedFrames::begin(&input, user, target)?;
    let (first, last) = arguments.frames.unwrap_or((0, count - 1));
    for frame in first..=last {
        of_series(frame - first, last - first + 1);
        let (series, numbered) = (series.turned(frame, count), numbered(target, frame));
        if finished.has(frame, &numbered) {
            continue;
        }
        let status = render_scene(&input, &mut scene, &numbered, user, &series)?;
        if status != DONE {
            finished.stop();
            return Ok(status);
        }
        finished.add(frame)?;
        input.begun.set(Instant::now());
    }
    finished.finish()?;
    Ok(DONE)
}

/// The files of one frame.
fn numbered(target: &Target, frame: u32) -> Target {
    Target {
        scene: target.scene.clone(),
        output: frame_path(&target.output, frame),
        stats: target.stats.as_deref().map(|path| frame_path(path, frame)),
    }
}

fn render_scene(
    input: &Input,
    scene: &mut SceneBuilder,
    target: &Target,
    user: &Parameters,
    series: &Series,
) -> anyhow::Result<u8> {
    let Input { arguments, common, .. } = *input;
    let begun = Instant::now();
    let mut user = user.clone();
    let is_whole = !arguments.is_part() && (arguments.replay.is_none() || arguments.output.is_some());
    if arguments.fast {
        with_fast_budget(&scene.settings, &mut user);
    }
    let by_default = is_whole && with_default_budget(&scene.settings, &mut user);
    let output = &target.output;
    let wanted = Wanted { user: &user, series, output };
    let mut job = input.job(scene, wanted)?;
    if scene.inventory.moves() && job.settings().time != arguments.studio.time() {
        // The time was set otherwise than by --at.
        *scene = input.read(job.settings().time, arguments.moments().is_some())?;
        job = input.job(scene, wanted)?;
    }
    let job = input.with_other_poses(job, scene, wanted)?;
    let build_seconds = begun.elapsed().as_secs_f64();
    input.warn(job.warnings())?;
    // That the studio lights a model without light is part of the line about its picture.
    if common.verbose > 0 || !common.quiet && job.studio_light().is_none() {
        input.note(output, job.notes());
    }
    if arguments.replay.is_some() {
        return replaying::run(input, &job, output);
    }
    if by_default && common.verbose > 0 {
        log::report_default_budget(output);
    }
    let Some((first, last)) = arguments.moments() else {
        return finish(input, &job, target, build_seconds);
    };
    let (series, fps) = (job.series(), job.settings().fps);
    let wanted = Wanted { series: &series, ..wanted };
    let mut finished = FinishedFrames::begin(input, &user, target)?;
    for frame in first..=last {
        of_series(frame - first, last - first + 1);
        let numbered = numbered(target, frame);
        if finished.has(frame, &numbered) {
            continue;
        }
        let time = frame as f32 / fps;
        if frame > first {
            input.begun.set(Instant::now());
        }
        let posed = if scene.inventory.moves() {
            let mut posed = input.read(time, false)?;
            posed.movement = scene.movement.clone();
            &input.job(&posed, wanted)?
        } else {
            &job
        };
        let shown = posed.at_time(time).begun_at(input.begun.get());
        let shown = input.with_other_poses(shown, scene, wanted)?;
        let status = finish(input, &shown, &numbered, build_seconds)?;
        if status != DONE {
            finished.stop();
            return Ok(status);
        }
        finished.add(frame)?;
    }
    finished.finish()?;
    Ok(DONE)
}
