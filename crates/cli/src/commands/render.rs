//! `bilux render`: pictures from scenes.

use super::{
    DONE, aov, check_choices, check_folder, denoise, read_options_with, stats, tell_warnings, time_limit,
};
use crate::arguments::{Common, Render};
use crate::denoising::{begin_loading, check_scenes};
use crate::interrupt::Interrupt;
use crate::progress::Report;
use crate::{output, settings_from, usage};
use anyhow::{Context, bail};
use bilux::budget::{DEFAULT_BUDGET, with_default_budget, with_fast_budget};
use bilux::formats::ReadOptions;
use bilux::pictures::denoise::Chosen;
use bilux::pictures::formats::{BitDepth, format_of_path};
use bilux::scene::{Parameters, SceneBuilder};
use bilux::transport::{Reached, Window};
use bilux::{Job, Outcome};
use std::cell::Cell;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub fn run(arguments: &Render, common: &Common) -> anyhow::Result<u8> {
    let interrupt = Interrupt::listen()?;
    let user = settings_from::render(arguments).map_err(usage::wrong)?;
    let targets = targets(arguments).map_err(usage::wrong)?;
    aov::check(arguments).map_err(usage::wrong)?;
    arguments.studio.check().map_err(usage::wrong)?;
    if let Some(timeout) = arguments.timeout {
        interrupt.end_after(timeout);
    }
    begin_loading(arguments, common);
    let mut failed = 0;
    for (scene, output) in &targets {
        match render_one(scene, output, &user, arguments, common, &interrupt) {
            Ok(DONE) => {}
            Ok(status) => return Ok(status),
            Err(error) => {
                let error = usage::naming(scene, error);
                // Of many the others are not to wait for one that is broken; what is wrong for all ends it.
                if targets.len() == 1 || usage::is_command_line(&error) {
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

/// Every scene with its picture's name, found wrong before anything is rendered.
fn targets(arguments: &Render) -> anyhow::Result<Vec<(PathBuf, PathBuf)>> {
    let pattern = arguments.output.to_string_lossy();
    check_scenes(&arguments.scenes)?;
    if arguments.scenes.len() > 1 && !pattern.contains("{stem}") {
        bail!("one picture for {} scenes: write -o '{{stem}}.png'", arguments.scenes.len());
    }
    let mut targets = Vec::new();
    for scene in &arguments.scenes {
        let stem = scene.file_stem().map_or("stdin".into(), |s| s.to_string_lossy());
        let output = PathBuf::from(pattern.replace("{stem}", &stem));
        if !is_stdout(&output) {
            check_folder(&output)?;
            let format = format_of_path(&output)?;
            if format.write.is_none() {
                bail!("{}: {} pictures can be read, but not written", output.display(), format.entry.name);
            }
            if arguments.samples.is_some() && format.entry.name != "exr" {
                bail!("{}: a part of the samples needs an .exr, which can hold exact sums", output.display());
            }
        }
        if targets.iter().any(|(_, other)| *other == output) && !is_stdout(&output) {
            bail!("{}: two scenes would be written there", output.display());
        }
        targets.push((scene.clone(), output));
    }
    Ok(targets)
}

fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// A scene file, that may have to be read again for another time.
struct Input<'a> {
    path: &'a Path,
    /// What came from standard input, which can be read but once, and its format.
    piped: Option<(Vec<u8>, &'a str)>,
    arguments: &'a Render,
    common: &'a Common,
    /// When the picture was begun that is rendered next.
    begun: Cell<Instant>,
}

impl Input<'_> {
    fn open<'a>(path: &'a Path, arguments: &'a Render, common: &'a Common) -> anyhow::Result<Input<'a>> {
        let mut piped = None;
        if is_stdout(path) {
            let format = arguments
                .input_format
                .as_deref()
                .context("say what comes from standard input: --input-format toml (see `bilux list formats`)")
                .map_err(usage::wrong)?;
            let mut bytes = Vec::new();
            std::io::stdin().take(common.max_memory).read_to_end(&mut bytes)?;
            piped = Some((bytes, format));
        }
        Ok(Input { path, piped, arguments, common, begun: Cell::new(Instant::now()) })
    }

    /// The scene as it is at a time in seconds, and for frames as it is at all times.
    fn read(&self, time: f32, whole_movement: bool) -> anyhow::Result<SceneBuilder> {
        let choices = &self.arguments.choices;
        let options = ReadOptions { whole_movement, ..read_options_with(self.common, choices, time) };
        let mut scene = match &self.piped {
            Some((bytes, format)) => {
                bilux::formats::read_bytes(bytes, format, Some(Path::new(".")), "standard input", &options)?
            }
            None => bilux::load(self.path, &options)?,
        };
        check_choices(&scene, &self.arguments.choices).map_err(usage::wrong)?;
        self.arguments.studio.set_up(&mut scene, &options)?;
        Ok(scene)
    }

    /// The job of a scene, with all that the command line says of it.
    fn job(&self, scene: &SceneBuilder, user: &Parameters) -> anyhow::Result<Job> {
        let arguments = self.arguments;
        let mut job = Job::within(scene, user, self.common.max_memory)?;
        if self.common.sandbox {
            job.sandbox();
        }
        job.begun_at(self.begun.get());
        aov::prepare(arguments, &mut job)?;
        if let Some((from, to)) = arguments.samples {
            job.samples(from..to);
        }
        if let Some([x, y, width, height]) = arguments.crop {
            job.crop(Window { x, y, width, height });
        }
        if arguments.stats.is_some() {
            job.count_work();
        }
        Ok(job)
    }
}

fn render_one(
    path: &Path,
    output: &Path,
    user: &Parameters,
    arguments: &Render,
    common: &Common,
    interrupt: &Interrupt,
) -> anyhow::Result<u8> {
    let input = Input::open(path, arguments, common)?;
    let mut scene = input.read(arguments.at.unwrap_or(0.0), arguments.frames.is_some())?;
    tell_warnings(&scene.warnings, common)?;
    let Some(count) = arguments.studio.turntable else {
        return render_scene(&input, &mut scene, output, user, interrupt);
    };
    for frame in 0..count {
        let turned = crate::studio::turned(user, frame as f32 / count as f32)?;
        let output = frame_path(output, frame);
        let status = render_scene(&input, &mut scene, &output, &turned, interrupt)?;
        if status != DONE {
            return Ok(status);
        }
        input.begun.set(Instant::now());
    }
    Ok(DONE)
}

fn render_scene(
    input: &Input,
    scene: &mut SceneBuilder,
    output: &Path,
    user: &Parameters,
    interrupt: &Interrupt,
) -> anyhow::Result<u8> {
    let Input { arguments, common, .. } = *input;
    let begun = Instant::now();
    let mut user = user.clone();
    let is_whole = !is_part(arguments) && arguments.replay.is_none();
    if arguments.fast {
        with_fast_budget(&scene.settings, &mut user);
    }
    let by_default = is_whole && with_default_budget(&scene.settings, &mut user);
    let mut job = input.job(scene, &user)?;
    if scene.inventory.moves() && job.settings().time != arguments.at.unwrap_or(0.0) {
        // The time was said elsewhere than by --at.
        *scene = input.read(job.settings().time, arguments.frames.is_some())?;
        job = input.job(scene, &user)?;
    }
    let build_seconds = begun.elapsed().as_secs_f64();
    tell_warnings(job.warnings(), common)?;
    if !common.quiet {
        job.notes().iter().for_each(|note| output::say(format_args!("{}: {note}", output.display())));
    }
    if let Some([x, y, sample]) = arguments.replay {
        output::print(job.replay(x, y, sample)?);
        return Ok(DONE);
    }
    if by_default && !common.quiet {
        let (noise, seconds) = DEFAULT_BUDGET;
        output::say(format_args!(
            "{}: until {}% noise or {seconds} s (--noise, --time-limit); the same on every machine with --spp",
            output.display(),
            noise * 100.0
        ));
    }
    let Some((first, last)) = arguments.frames else {
        return finish(&mut job, output, input, build_seconds, interrupt);
    };
    for frame in first..=last {
        let time = frame as f32 / job.settings().fps;
        if frame > first {
            input.begun.set(Instant::now());
            job.begun_at(input.begun.get());
        }
        if scene.inventory.moves() {
            let mut posed = input.read(time, false)?;
            posed.inventory.movement = scene.inventory.movement.clone();
            job = input.job(&posed, &user)?;
        }
        job.at_time(time);
        let output = frame_path(output, frame);
        let status = finish(&mut job, &output, input, build_seconds, interrupt)?;
        if status != DONE {
            return Ok(status);
        }
    }
    Ok(DONE)
}

/// Says which way is up where that was decided here; once, however many pictures there are.
fn say_orientation(job: &Job, scene: &Path) {
    static SAID: std::sync::Once = std::sync::Once::new();
    if let Some(orientation) = job.orientation() {
        let (up, front) = (orientation.up.name(), orientation.front.name());
        let because = orientation.because.words();
        SAID.call_once(|| {
            output::say(format_args!(
                "{}: up is {up}, front is {front}, {because} (--up, --front)",
                scene.display()
            ));
        });
    }
}

/// `{frame}` filled in with four digits; put before the extension where it is missing.
fn frame_path(pattern: &Path, frame: u32) -> PathBuf {
    let text = pattern.to_string_lossy();
    if text.contains("{frame}") {
        return PathBuf::from(text.replace("{frame}", &format!("{frame:04}")));
    }
    let stem = pattern.file_stem().unwrap_or_default().to_string_lossy();
    let extension = pattern.extension().unwrap_or_default().to_string_lossy();
    pattern.with_file_name(format!("{stem}-{frame:04}.{extension}"))
}

fn finish(
    job: &mut Job,
    output: &Path,
    input: &Input,
    build_seconds: f64,
    interrupt: &Interrupt,
) -> anyhow::Result<u8> {
    let Input { path: scene, arguments, common, .. } = *input;
    let label = output.file_name().unwrap_or(output.as_os_str()).to_string_lossy().into_owned();
    let report = Report::new(&label, common, interrupt.clone());
    let for_display = is_stdout(output) || format_of_path(output)?.for_display;
    let denoiser = job.denoiser(for_display && !is_part(arguments)).map_err(usage::wrong)?;
    let before = input.begun.get().elapsed();
    interrupt.renders(true);
    let outcome = job.render(&report)?;
    let seconds = report.finish();
    let denoiser = denoiser.filter(|_| !outcome.cancelled);
    let denoised = write(job, &outcome, denoiser.as_ref(), output, arguments)?;
    interrupt.renders(false);
    let overrun = time_limit::overrun(job, &outcome, before, seconds, input.begun.get().elapsed());
    tell_odd_samples(&outcome);
    let all_aovs = aov::write(arguments, job, &outcome, output, common, interrupt)?;
    if let Some(path) = &arguments.stats {
        let stats = stats::of(job, &outcome, scene, build_seconds, seconds);
        let text = serde_json::to_string_pretty(&stats)?;
        bilux::pictures::formats::write_atomically(path, text.as_bytes())?;
    }
    if !common.quiet {
        say_orientation(job, scene);
        if let Some(choice) = &outcome.choice {
            output::say(format_args!(
                "{}: {} chose {choice}",
                output.display(),
                job.settings().integrator.entry.name
            ));
        }
        let s = job.settings();
        if let Some(reached) = &outcome.reached {
            output::say(format_args!("{}: {}", output.display(), how_far(reached)));
        }
        if let Some(told) = denoised {
            output::say(format_args!("{}: {told}", output.display()));
        }
        if let Some(overrun) = overrun {
            output::say(format_args!("{}: {overrun}", output.display()));
        }
        output::say(format_args!(
            "{}: {}x{}, {} by {}, {:.2} s after {build_seconds:.2} s of building, {:.2} Mrays/s{}",
            output.display(),
            s.width,
            s.height,
            s.integrator.entry.name,
            s.accel.name,
            seconds,
            outcome.counters.rays as f64 / seconds.max(1e-9) / 1e6,
            match outcome.cancelled {
                true if interrupt.timed_out() => "; ended by --timeout: this is what there is",
                true => "; interrupted: this is what there is",
                false => "",
            },
        ));
    }
    Ok(if outcome.cancelled || !all_aovs { interrupt.exit_status() } else { DONE })
}

/// True for a part of a picture.
fn is_part(arguments: &Render) -> bool {
    arguments.samples.is_some() || arguments.crop.is_some()
}

/// A part of a picture goes into an `.exr` with its exact sums; anything else is the picture, denoised if it is to be. Gives what is to be
/// told about that.
fn write(
    job: &Job,
    outcome: &Outcome,
    denoiser: Option<&Chosen>,
    output: &Path,
    arguments: &Render,
) -> anyhow::Result<Option<String>> {
    let is_exr = !is_stdout(output) && aov::is_exr(output);
    let is_part = is_exr && (is_part(arguments) || outcome.cancelled);
    let begun = Instant::now();
    let (mut picture, told) = match denoiser.filter(|_| !is_part) {
        Some(chosen) => {
            let picture = outcome.denoised(chosen)?;
            (picture, Some(denoise::told(chosen, begun.elapsed().as_secs_f64())))
        }
        None if is_part => (job.partial(outcome)?, None),
        None => (outcome.picture()?, None),
    };
    if is_exr {
        outcome.push_layers(&mut picture, &aov::layers(arguments))?;
        if told.is_some() {
            picture.push_rgb("noisy", &outcome.picture()?.to_rgb().unwrap_or_default())?;
        }
    }
    let mut options = job.write_options_for(&picture)?;
    if arguments.bits == "16" {
        options.bit_depth = BitDepth::Sixteen;
    }
    if is_stdout(output) {
        output::print_bytes(&bilux::pictures::formats::write_bytes("png", &picture, &options)?);
    } else {
        bilux::pictures::write(output, &picture, &options)?;
    }
    Ok(told)
}

/// Samples that are no number are counted and located, never hidden.
fn tell_odd_samples(outcome: &Outcome) {
    let trouble = outcome.film.trouble();
    if let Some(first) = trouble.first_non_finite {
        output::warning(format_args!(
            "{} samples were not finite and are left out; see the first with --replay {},{},{}",
            trouble.non_finite, first.x, first.y, first.sample
        ));
    }
    if let Some(first) = trouble.first_overflowed {
        output::warning(format_args!(
            "{} samples were brighter than the film can hold; see the first with --replay {},{},{}",
            trouble.overflowed, first.x, first.y, first.sample
        ));
    }
}

/// Where a picture ended that could end early.
fn how_far(reached: &Reached) -> String {
    let noise = reached.noise.map(|noise| format!(", {:.1}% noise", noise * 100.0)).unwrap_or_default();
    // The samples by which noise is told are in the mean: said where it may matter.
    let bias = reached.bias.filter(|bias| *bias >= 0.05);
    let bias =
        bias.map(|bias| format!(", shifted by the rule by at most {bias:.2} of it")).unwrap_or_default();
    format!("{} samples a pixel{noise}{bias}", reached.spp)
}
