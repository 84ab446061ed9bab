//! `bilux render`: renders pictures of scenes.

use super::targets::{Target, frame_path, is_stdout, still_frames, targets};
use super::written::{self, is_part};
use super::{
    DONE, aov, check_choices, load, log, read_options_with, report_notes, report_warnings, stats, time_limit,
};
use crate::arguments::{Common, Render};
use crate::denoising::{begin_loading, check_scenes};
use crate::interrupt::Interrupt;
use crate::progress::Report;
use crate::sandbox::SandboxPaths;
use crate::{output, settings_from, usage};
use anyhow::{Context, anyhow, bail};
use bilux::budget::{with_default_budget, with_fast_budget};
use bilux::formats::ReadOptions;
use bilux::pictures::formats::format_of_path;
use bilux::scene::{Parameters, SceneBuilder, SceneError};
use bilux::transport::Window;
use bilux::transport::aovs::Aov;
use bilux::{Built, Job, Series};
use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub fn run(arguments: &Render, common: &Common) -> anyhow::Result<u8> {
    let interrupt = Interrupt::listen()?;
    let user = settings_from::render(arguments).map_err(usage::wrong)?;
    check_scenes(&arguments.scenes).map_err(usage::wrong)?;
    let targets = targets(arguments).map_err(usage::wrong)?;
    aov::check(arguments).map_err(usage::wrong)?;
    arguments.studio.check().map_err(usage::wrong)?;
    arguments.studio.check_files()?;
    if let Some(curve) = arguments.tonemap.as_deref().filter(|name| *name != "auto") {
        bilux::pictures::tone_map(curve).context("--tonemap").map_err(usage::wrong)?;
    }
    if let Some(timeout) = arguments.timeout {
        interrupt.end_after(timeout);
    }
    begin_loading(arguments, common);
    confine(&targets, arguments, common)?;
    let mut failed = 0;
    for target in &targets {
        match render_one(target, &user, arguments, common, &interrupt) {
            Ok(DONE) => {}
            Ok(status) => return Ok(status),
            Err(error) => {
                let error = usage::naming(&target.scene, error);
                if arguments.json && !output::is_closed_pipe(&error) {
                    log::print_failure(&target.scene, &target.output, &error)?;
                }
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

/// Under `--sandbox`: allows reading the scenes, their folders and the files that options name, and writing to the
/// picture's folder.
fn confine(targets: &[Target], arguments: &Render, common: &Common) -> anyhow::Result<()> {
    let studio = &arguments.studio;
    let mut confines = SandboxPaths::default();
    for scene in targets.iter().map(|target| &target.scene) {
        // A scene on standard input may name files in the working directory.
        confines = confines.reading_scene(if is_stdout(scene) { Path::new("./stdin") } else { scene });
    }
    for file in studio.env.as_deref().into_iter().chain(studio.picture_behind()) {
        confines = confines.reading(file);
    }
    if !is_stdout(&arguments.output) {
        confines = confines.writing(&arguments.output);
    }
    for target in targets {
        let files = [Some(&target.output), target.stats.as_ref()];
        for file in files.into_iter().flatten().filter(|file| !is_stdout(file)) {
            confines.check_written(file, common).map_err(usage::wrong)?;
        }
    }
    confines.enter(common)
}

/// A scene file, which may have to be read again for another time.
struct Input<'a> {
    path: &'a Path,
    /// The bytes from standard input, which can be read only once.
    piped: Option<Vec<u8>>,
    arguments: &'a Render,
    common: &'a Common,
    interrupt: &'a Interrupt,
    /// When the picture that is rendered next was started.
    begun: Cell<Instant>,
    /// What the pictures of a turntable share.
    built: RefCell<Built>,
    /// Every warning so far, for `--json`.
    warnings: RefCell<Vec<String>>,
    /// Every file that was read.
    files: RefCell<BTreeSet<PathBuf>>,
}

impl Input<'_> {
    fn open<'a>(
        path: &'a Path,
        arguments: &'a Render,
        common: &'a Common,
        interrupt: &'a Interrupt,
    ) -> anyhow::Result<Input<'a>> {
        let mut piped = None;
        if is_stdout(path) {
            check_input_format(&arguments.input_format).map_err(usage::wrong)?;
            let mut bytes = Vec::new();
            let input = std::io::stdin().take(common.max_memory).read_to_end(&mut bytes);
            input.context("cannot read standard input")?;
            if bytes.is_empty() {
                bail!("standard input is empty: name a scene file, or pipe in a scene");
            }
            piped = Some(bytes);
        }
        let begun = Cell::new(Instant::now());
        let (built, warnings, files) = (RefCell::default(), RefCell::default(), RefCell::default());
        Ok(Input { path, piped, arguments, common, interrupt, begun, built, warnings, files })
    }

    /// Prints warnings, and keeps them for `--json`.
    fn warn(&self, warnings: &[bilux::scene::Warning]) -> anyhow::Result<()> {
        self.warnings.borrow_mut().extend(warnings.iter().map(ToString::to_string));
        report_warnings(warnings, self.common)
    }

    /// Reads the scene as it is at a time in seconds; for frames, with its whole movement.
    fn read(&self, time: f32, whole_movement: bool) -> anyhow::Result<SceneBuilder> {
        let choices = &self.arguments.choices;
        let options = ReadOptions { whole_movement, ..read_options_with(self.common, choices, time) };
        let mut scene = match &self.piped {
            Some(bytes) => {
                // There is no file name, so the first bytes decide.
                let format =
                    Some(&*self.arguments.input_format).filter(|name| *name != "auto").unwrap_or_default();
                bilux::formats::read_bytes(bytes, format, Some(Path::new(".")), "standard input", &options)?
            }
            None => load(self.path, &options)?,
        };
        check_choices(&scene, &self.arguments.choices).map_err(usage::wrong)?;
        self.arguments.studio.set_up(&mut scene, &options)?;
        self.files.borrow_mut().extend(scene.files.iter().cloned());
        Ok(scene)
    }

    /// Refuses to write over a file that was read.
    fn check_outputs(&self, Target { output, stats, .. }: &Target) -> anyhow::Result<()> {
        let beside = aov::files(self.arguments, output);
        let mut written = beside.iter().chain([output]).chain(stats).filter(|file| !is_stdout(file));
        Ok(written.try_for_each(|file| bilux::formats::check_not_read(file, &self.files.borrow()))?)
    }

    /// Makes the job for a scene, with everything that the command line says about it.
    fn job(&self, scene: &SceneBuilder, user: &Parameters, series: &Series) -> anyhow::Result<Job> {
        let arguments = self.arguments;
        // From one picture of a turntable to the next only the camera moves.
        let (mut own, mut shared) = (Built::default(), self.built.borrow_mut());
        let built = if arguments.studio.turntable.is_some() { &mut *shared } else { &mut own };
        let mut job = Job::with_built(scene, user, self.common.max_memory, series, built)?;
        if self.common.sandbox {
            job.sandbox();
        }
        job.begun_at(self.begun.get());
        aov::prepare(arguments, &mut job)?;
        if let Some((from, to)) = arguments.samples {
            job.samples(from..to);
        }
        if let Some([x, y, width, height]) = arguments.crop {
            let s = job.settings();
            let fits = |at: u32, side: u32, most: u32| {
                side > 0 && at.checked_add(side).is_some_and(|end| end <= most)
            };
            if !fits(x, width, s.width) || !fits(y, height, s.height) {
                let size = format!("{}x{}", s.width, s.height);
                return Err(usage::wrong(anyhow!(
                    "--crop {x},{y},{width},{height}: the window must contain pixels and lie within the picture, \
                     which is {size}"
                )));
            }
            job.crop(Window { x, y, width, height });
        }
        if arguments.stats.is_some() {
            job.count_work();
        }
        Ok(job)
    }
}

impl Input<'_> {
    /// Tells the job the next pose of a scene whose meshes move, if the layer of motion is wanted.
    fn set_next_pose(
        &self,
        job: &mut Job,
        scene: &SceneBuilder,
        (user, series): (&Parameters, &Series),
    ) -> anyhow::Result<()> {
        if scene.inventory.moves() && aov::wants(self.arguments, Aov::Motion) {
            let mut next = self.read(job.settings().time + 1.0 / job.settings().fps, false)?;
            next.movement = scene.movement.clone();
            job.moves_to(self.job(&next, user, series)?);
        }
        Ok(())
    }
}

fn render_one(
    target: &Target,
    user: &Parameters,
    arguments: &Render,
    common: &Common,
    interrupt: &Interrupt,
) -> anyhow::Result<u8> {
    let input = Input::open(&target.scene, arguments, common, interrupt)?;
    let mut scene = input.read(arguments.at.unwrap_or(0.0), arguments.frames.is_some())?;
    input.warn(&scene.warnings)?;
    report_notes(&scene.notes, common);
    input.warn(&still_frames(arguments, &scene))?;
    let Some(count) = arguments.studio.turntable else {
        return render_scene(&input, &mut scene, target, user, &Series::default());
    };
    let series = Series::turntable(&scene, user, common.max_memory, count)?;
    for frame in 0..count {
        let series = series.turned(frame, count);
        let status = render_scene(&input, &mut scene, &numbered(target, frame), user, &series)?;
        if status != DONE {
            return Ok(status);
        }
        input.begun.set(Instant::now());
    }
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
    let is_whole = !is_part(arguments) && arguments.replay.is_none();
    if arguments.fast {
        with_fast_budget(&scene.settings, &mut user);
    }
    let by_default = is_whole && with_default_budget(&scene.settings, &mut user);
    let mut job = input.job(scene, &user, series)?;
    if scene.inventory.moves() && job.settings().time != arguments.at.unwrap_or(0.0) {
        // The time was set otherwise than by --at.
        *scene = input.read(job.settings().time, arguments.frames.is_some())?;
        job = input.job(scene, &user, series)?;
    }
    input.set_next_pose(&mut job, scene, (&user, series))?;
    let build_seconds = begun.elapsed().as_secs_f64();
    input.warn(job.warnings())?;
    if common.verbose > 0 {
        job.notes()
            .iter()
            .for_each(|note| output::eprint(format_args!("{}: {note}", target.output.display())));
    }
    if let Some([x, y, sample]) = arguments.replay {
        output::print(job.replay(x, y, sample).context("--replay")?)?;
        return Ok(DONE);
    }
    if by_default && common.verbose > 0 {
        log::report_default_budget(&target.output);
    }
    let Some((first, last)) = arguments.frames else {
        return finish(input, &mut job, target, build_seconds);
    };
    let series = job.series();
    for frame in first..=last {
        let time = frame as f32 / job.settings().fps;
        if frame > first {
            input.begun.set(Instant::now());
            job.begun_at(input.begun.get());
        }
        if scene.inventory.moves() {
            let mut posed = input.read(time, false)?;
            posed.movement = scene.movement.clone();
            job = input.job(&posed, &user, &series)?;
        }
        job.at_time(time);
        input.set_next_pose(&mut job, scene, (&user, &series))?;
        let status = finish(input, &mut job, &numbered(target, frame), build_seconds)?;
        if status != DONE {
            return Ok(status);
        }
    }
    Ok(DONE)
}

fn finish(input: &Input, job: &mut Job, target: &Target, build_seconds: f64) -> anyhow::Result<u8> {
    let Input { arguments, common, interrupt, .. } = *input;
    input.check_outputs(target).map_err(usage::wrong)?;
    let output = &target.output;
    let label = output.file_name().unwrap_or(output.as_os_str()).to_string_lossy().into_owned();
    let for_display = is_stdout(output) || format_of_path(output)?.for_display;
    let denoiser = job.denoiser(for_display && !is_part(arguments)).map_err(usage::wrong)?;
    let before = input.begun.get().elapsed();
    let report = Report::new(&label, common, interrupt.clone());
    interrupt.renders(true);
    let outcome = job.render(&report)?;
    let seconds = report.finish();
    let rendered = input.begun.get().elapsed();
    let denoiser = denoiser.filter(|_| !outcome.rendered.cancelled);
    let extra = aov::extra(arguments, job, &outcome, &report)?;
    let layers = written::Layers { kept: &aov::layers(arguments), extra: extra.as_ref() };
    let denoised = written::write(arguments, common, job, &outcome, (denoiser.as_ref(), &layers), output)?;
    interrupt.renders(false);
    let overrun = time_limit::overrun(job, &outcome, [before, rendered, input.begun.get().elapsed()]);
    log::report_sample_failures(&outcome);
    let all_aovs = aov::write(arguments, job, &outcome, (output, &layers), common, interrupt)?;
    let rendered = log::Rendered {
        job,
        outcome: &outcome,
        scene: input.path,
        output,
        build_seconds,
        seconds,
        total_seconds: input.begun.get().elapsed().as_secs_f64(),
        denoiser: denoiser.as_ref().filter(|_| denoised),
        timed_out: interrupt.timed_out(),
        overrun,
        warnings: &input.warnings.borrow(),
    };
    write_stats(target, &rendered)?;
    if arguments.json {
        output::print(rendered.json())?;
    }
    if !common.quiet {
        rendered.print(common.verbose);
    }
    Ok(if outcome.rendered.cancelled || !all_aovs { interrupt.exit_status() } else { DONE })
}

/// Refuses an unknown scene format.
fn check_input_format(name: &str) -> anyhow::Result<()> {
    if name == "auto" || bilux::formats::format_named(name).is_some_and(|row| row.reads()) {
        return Ok(());
    }
    let rows = bilux::formats::SCENE_FORMATS.iter().filter(|row| row.reads());
    let names = rows.map(|row| row.entry.name).chain(["auto"]);
    Err(SceneError::unknown("scene format", name, names, &settings_from::from_flag("--input-format")).into())
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
