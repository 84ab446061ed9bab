//! Light transport: every integrator on eight scenes, each difficult in a different way, or on the user's own scenes,
//! for equal CPU time, against references.
//!
//! For each scene, integrator and budget, the benchmark renders several pictures that differ only in their seeds;
//! errors are medians over these. The number of samples follows from the speed measured just before, so a picture is
//! still a pure function of its settings. Only rendering is timed, not building trees.

mod cost;
mod curves;
mod errors;
mod page;
mod predicted;
mod reference;
mod table;
mod test_scene;

pub(crate) use cost::Clock;
pub use errors::{BLOCK, bias2, relmse, relmse_trimmed};
pub(crate) use errors::{block_relmse, mean};
pub use reference::{Reference, ReferenceOptions, make_references};

use crate::{ProgressFn, Report, median};
use bilux::formats::ReadOptions;
use bilux::pictures::WriteOptions;
use bilux::scene::error::nearest_name;
use bilux::scene::{Parameters, SceneBuilder, Value as Setting};
use bilux::transport::{Choice, INTEGRATORS};
use bilux::{Error, Job, Quiet};
use bilux_math::Rgb;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Instant;
use test_scene::{TestScene, test_scenes};

/// The width and height of the pictures: whole blocks of [`BLOCK`] pixels.
pub const SIZE: (u32, u32) = (128, 96);

/// The scenes, by the names of their generators, each with the file of its reference.
pub const SCENES: &[(&str, &[u8])] = &[
    ("daylight", include_bytes!("../../references/daylight.exr")),
    ("indirect", include_bytes!("../../references/indirect.exr")),
    ("lampshades", include_bytes!("../../references/lampshades.exr")),
    ("caustics", include_bytes!("../../references/caustics.exr")),
    ("pool", include_bytes!("../../references/pool.exr")),
    ("bidirectional", include_bytes!("../../references/bidirectional.exr")),
    ("door-ajar", include_bytes!("../../references/door-ajar.exr")),
    ("many-lights", include_bytes!("../../references/many-lights.exr")),
];

/// The maximum number of trial pictures for finding a number of samples, and the first of their seeds.
const TRIALS: u64 = 3;
const TRIAL_SEED: u64 = 1 << 31;

/// The default integrators, as far as they are available.
const USUAL: [&str; 5] = ["path", "bdpt", "vcm", "sppm", "auto"];

/// The benchmark's options.
#[derive(Clone, Debug)]
pub struct Options {
    /// Names from [`SCENES`]; all of them if there are neither names nor files.
    pub scenes: Vec<String>,
    /// The user's own scene files. Their references are rendered first.
    pub files: Vec<PathBuf>,
    /// How files are read.
    pub read: ReadOptions,
    /// The CPU seconds that each of the two integrators spends on the reference of a file.
    pub reference_seconds: f64,
    /// Names of integrators, `auto:TECHNIQUES` for one set of techniques of `auto`; if empty, the default ones.
    pub integrators: Vec<String>,
    /// CPU seconds per picture, summed over all threads.
    pub seconds: Vec<f64>,
    /// The number of pictures per scene, integrator and budget, at least 1.
    pub seeds: u32,
    /// The number of threads; 0 for all cores.
    pub threads: u32,
    /// The folder for a page with pictures and curves.
    pub report: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Options {
        Options {
            scenes: Vec::new(),
            files: Vec::new(),
            read: ReadOptions::default(),
            reference_seconds: 60.0,
            integrators: Vec::new(),
            seconds: vec![1.0, 4.0],
            seeds: 5,
            threads: 0,
            report: None,
        }
    }
}

/// The result of one integrator on a scene within a budget.
struct Row {
    scene: String,
    integrator: String,
    /// The budget, in CPU seconds.
    seconds: f64,
    /// The CPU seconds that the pictures actually took.
    took: f64,
    samples: u32,
    relmse: f64,
    relmse_trimmed: f64,
    /// `None` for a single picture.
    bias2: Option<f64>,
    mean: f64,
    /// `None` if the system does not report it.
    peak_mb: Option<f64>,
    /// The first of the pictures.
    picture: Vec<Rgb>,
    /// What `auto` chose there, and why.
    choice: Option<Choice>,
}

impl Row {
    fn json(&self, scene: &Measured) -> Value {
        let reference = &scene.reference;
        let compared = scene.compared(self);
        json!({
            "scene": self.scene, "integrator": self.integrator, "seconds": self.seconds, "samples": self.samples,
            "relmse": self.relmse, "relmse_trimmed": self.relmse_trimmed, "bias2": self.bias2, "mean": self.mean,
            "peak_mb": self.peak_mb, "cpu_seconds": self.took, "reference_mean": reference.mean(),
            "reference_relmse": reference.relmse, "predicted": compared.predicted, "measured": compared.measured,
            "measured_trimmed": compared.measured_trimmed,
            "chosen": self.choice.as_ref().map(|choice| choice.best().techniques),
        })
    }
}

/// Everything that was measured on a scene.
struct Measured {
    scene: String,
    summary: String,
    reference: Reference,
    /// How its pictures are displayed.
    shown: WriteOptions,
    rows: Vec<Row>,
}

/// Runs the benchmark.
///
/// # Errors
/// If a scene or an integrator is unknown, or the page cannot be written.
pub fn run(options: &Options, progress: ProgressFn) -> Result<Report, Error> {
    let integrators = chosen_integrators(&options.integrators)?;
    if let Some(wrong) = options.seconds.iter().find(|s| !(**s > 0.0 && s.is_finite())) {
        return Err(Error::Settings(format!("--seconds {wrong}: a budget is a number of seconds above 0")));
    }
    if let Some(folder) = &options.report {
        std::fs::create_dir_all(folder)
            .map_err(|e| Error::Settings(format!("cannot make the folder '{}': {e}", folder.display())))?;
    }
    let test_scenes = test_scenes(options, progress)?;
    let cells = test_scenes.len() * integrators.len();
    let mut bench =
        Bench { options, progress, begun: Instant::now(), done: 0.0, all: cells as f64 * options.work() };
    let mut measured = Vec::new();
    for test_scene in test_scenes {
        measured.push(bench.scene(test_scene, &integrators)?);
    }
    if let Some(folder) = &options.report {
        page::write(folder, &measured, options)?;
    }
    let rows = measured.iter().flat_map(|m| m.rows.iter().map(|row| row.json(m))).collect();
    Ok(Report { rows, text: table::text(&measured, options), ..Report::default() })
}

impl Options {
    /// The CPU seconds of an integrator on a scene.
    fn work(&self) -> f64 {
        self.seconds.iter().sum::<f64>() * f64::from(self.seeds.max(1))
    }
}

/// A run in progress.
struct Bench<'a> {
    options: &'a Options,
    progress: ProgressFn<'a>,
    begun: Instant,
    /// The CPU seconds of the pictures rendered so far, and of all pictures.
    done: f64,
    all: f64,
}

impl Bench<'_> {
    fn scene(&mut self, test_scene: TestScene, integrators: &[String]) -> Result<Measured, Error> {
        let shown = Job::new(&test_scene.scene, &settings("path", 1, 0, 1))?.write_options()?;
        let mut rows = Vec::new();
        for integrator in integrators {
            let mut speed =
                calibrate(&test_scene.scene, integrator, &self.options.seconds, self.options.threads)?;
            for &seconds in &self.options.seconds {
                (self.progress)(&format!(
                    "{}, {integrator}, {seconds} s{}",
                    test_scene.name,
                    self.time_left()
                ));
                let row = self.cell(&test_scene, integrator, seconds, speed)?;
                speed = f64::from(row.samples) / row.took.max(1e-3);
                rows.push(row);
            }
        }
        let TestScene { name, summary, reference, .. } = test_scene;
        Ok(Measured { scene: name, summary, reference, shown, rows })
    }

    /// Renders the pictures of one scene by one integrator within one budget. `speed` is samples per pixel per CPU
    /// second.
    fn cell(
        &mut self,
        test_scene: &TestScene,
        integrator: &str,
        seconds: f64,
        speed: f64,
    ) -> Result<Row, Error> {
        let (scene, reference) = (&test_scene.scene, &test_scene.reference);
        let samples = self.fitting(scene, integrator, seconds, speed)?;
        let (mut took, mut peaks, mut pictures) = (Vec::new(), Vec::new(), Vec::new());
        let mut choice = None;
        for seed in 1..=u64::from(self.options.seeds.max(1)) {
            let render = shoot(scene, &settings(integrator, samples, seed, self.options.threads))?;
            self.done += seconds;
            took.push(render.seconds);
            peaks.extend(render.peak_mb);
            pictures.push(render.picture);
            choice = choice.or(render.choice);
        }
        let over = |error: &dyn Fn(&[Rgb]) -> f64| median(pictures.iter().map(|p| error(p)).collect());
        Ok(Row {
            scene: test_scene.name.clone(),
            integrator: integrator.to_owned(),
            seconds,
            took: median(took),
            samples,
            relmse: over(&|p| relmse(p, &reference.pixels)),
            relmse_trimmed: over(&|p| relmse_trimmed(p, &reference.pixels)),
            bias2: bias2(&pictures, &reference.pixels, SIZE.0 as usize),
            mean: over(&errors::mean),
            peak_mb: (!peaks.is_empty()).then(|| median(peaks)),
            picture: pictures.swap_remove(0),
            choice,
        })
    }

    /// The number of samples with which a picture takes its budget. One-off costs, such as a pilot pass that decides
    /// how to go on, distort the speed of short renders, so trial pictures measure it.
    fn fitting(
        &self,
        scene: &SceneBuilder,
        integrator: &str,
        seconds: f64,
        speed: f64,
    ) -> Result<u32, Error> {
        let mut samples = ((speed * seconds).round() as u32).max(1);
        for seed in 0..TRIALS {
            let took = shoot(scene, &settings(integrator, samples, TRIAL_SEED + seed, self.options.threads))?
                .seconds;
            let better = ((f64::from(samples) * seconds / took.max(1e-3)).round() as u32).max(1);
            if better == samples || (took / seconds - 1.0).abs() < 0.1 {
                break;
            }
            samples = better;
        }
        Ok(samples)
    }

    fn time_left(&self) -> String {
        if self.done == 0.0 {
            return String::new();
        }
        let left = self.begun.elapsed().as_secs_f64() * (self.all - self.done) / self.done;
        format!("; {left:.0} s left")
    }
}

/// Measures samples per pixel per CPU second, with ever longer renders until one takes a fifth of the smallest budget.
fn calibrate(scene: &SceneBuilder, integrator: &str, budgets: &[f64], threads: u32) -> Result<f64, Error> {
    let smallest = budgets.iter().copied().fold(f64::INFINITY, f64::min);
    let mut samples = 1;
    loop {
        let render = shoot(scene, &settings(integrator, samples, 0, threads))?;
        let speed = f64::from(samples) / render.seconds.max(1e-3);
        if render.seconds >= 0.2 * smallest || samples > 1 << 20 {
            return Ok(speed);
        }
        samples *= if render.seconds < 0.04 * smallest { 4 } else { 2 };
    }
}

/// A picture and its cost.
struct TimedRender {
    seconds: f64,
    peak_mb: Option<f64>,
    picture: Vec<Rgb>,
    choice: Option<Choice>,
}

fn shoot(scene: &SceneBuilder, settings: &Parameters) -> Result<TimedRender, Error> {
    let job = Job::new(scene, settings)?;
    let clock = Clock::start(job.settings().threads);
    let outcome = job.render(&Quiet)?;
    let (seconds, peak_mb) = clock.stop();
    Ok(TimedRender {
        seconds,
        peak_mb,
        picture: outcome.rendered.film.to_rgb(),
        choice: outcome.rendered.choice,
    })
}

fn settings(integrator: &str, samples: u32, seed: u64, threads: u32) -> Parameters {
    let mut settings = Parameters::default();
    let (name, techniques) = integrator.split_once(':').unwrap_or((integrator, ""));
    settings.set("integrator", name);
    if !techniques.is_empty() {
        settings.set("techniques", techniques);
    }
    settings.set("size", Setting::Text(format!("{}x{}", SIZE.0, SIZE.1)));
    settings.set("spp", Setting::Integer(i64::from(samples)));
    settings.set("seed", Setting::Integer(seed as i64));
    settings.set("threads", Setting::Integer(i64::from(threads)));
    settings
}

fn chosen_integrators(names: &[String]) -> Result<Vec<String>, Error> {
    let known: Vec<String> =
        INTEGRATORS.iter().filter(|row| !row.classic).map(|row| row.entry.name.to_owned()).collect();
    if names.is_empty() {
        return Ok(USUAL.map(str::to_owned).into_iter().filter(|name| known.contains(name)).collect());
    }
    let plain = |name: &String| name.strip_prefix("auto:").map_or(name.clone(), |_| "auto".to_owned());
    names.iter().try_for_each(|name| check("integrator", &plain(name), &known))?;
    Ok(names.to_vec())
}

fn check(what: &str, name: &str, known: &[String]) -> Result<(), Error> {
    if known.iter().any(|k| k == name) {
        return Ok(());
    }
    let hint = match nearest_name(name, known) {
        Some(nearest) => format!("did you mean '{nearest}'?"),
        None => format!("there are {}", known.join(", ")),
    };
    Err(Error::Settings(format!("there is no {what} '{name}'; {hint}")))
}
