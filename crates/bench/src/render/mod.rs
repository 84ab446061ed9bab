//! Light transport: every integrator on eight scenes, each difficult in a different way, or on the user's own scenes,
//! for equal CPU time, against references.
//!
//! For each scene, integrator and budget, the benchmark renders several pictures that differ only in their seeds;
//! errors are medians over these. The number of samples follows from the speed measured just before, so a picture is
//! still a pure function of its settings. Only rendering is timed, not building trees.

mod cost;
mod curves;
mod errors;
mod measured;
mod names;
mod options;
mod page;
mod predicted;
mod reference;
mod scenes;
mod table;
mod test_scene;
mod timed_render;

pub(crate) use cost::Clock;
pub use errors::{BLOCK, bias2, relmse, relmse_trimmed};
pub(crate) use errors::{block_relmse, mean};
pub use options::Options;
pub use reference::{Reference, ReferenceOptions, make_references};
pub use scenes::{SCENES, SIZE};

use crate::{ProgressFn, Report, median};
use bilux::scene::SceneBuilder;
use bilux::transport::INTEGRATORS;
use bilux::{Error, Job};
use bilux_math::Rgb;
use measured::{Measured, Row};
use names::check;
use serde_json::{Value, json};
use std::time::Instant;
use test_scene::{TestScene, test_scenes};
use timed_render::{calibrate, settings, shoot};

/// The first of the seeds of trial pictures, which find a number of samples.
const TRIAL_SEED: u64 = 1 << 31;

/// The default integrators, as far as they are available.
const USUAL: [&str; 5] = ["path", "bdpt", "vcm", "sppm", "auto"];

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
    let rows = measured.iter().flat_map(|m| m.rows.iter().map(|row| json(row, m))).collect();
    Ok(Report { rows, text: table::text(&measured, options), ..Report::default() })
}

/// A row as JSON.
fn json(row: &Row, scene: &Measured) -> Value {
    let reference = &scene.reference;
    let compared = scene.compared(row);
    json!({
        "scene": row.scene, "integrator": row.integrator, "seconds": row.seconds, "samples": row.samples,
        "relmse": row.relmse, "relmse_trimmed": row.relmse_trimmed, "bias2": row.bias2, "mean": row.mean,
        "peak_mb": row.peak_mb, "cpu_seconds": row.took, "reference_mean": reference.mean(),
        "reference_relmse": reference.relmse, "predicted": compared.predicted, "measured": compared.measured,
        "measured_trimmed": compared.measured_trimmed,
        "chosen": row.choice.as_ref().map(|choice| choice.best().techniques),
    })
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

    /// The number of samples with which a picture takes its budget. What is spent once, as on a pilot, comes on top of what each sample
    /// takes: two trial pictures tell one from the other.
    fn fitting(
        &self,
        scene: &SceneBuilder,
        integrator: &str,
        seconds: f64,
        speed: f64,
    ) -> Result<u32, Error> {
        let time = |samples: u32, seed: u64| {
            let settings = settings(integrator, samples, TRIAL_SEED + seed, self.options.threads);
            Ok::<f64, Error>(shoot(scene, &settings)?.seconds)
        };
        let many = ((speed * seconds).round() as u32).max(2);
        Ok(samples_in(seconds, [(1, time(1, 0)?), (many, time(many, 1)?)]))
    }

    fn time_left(&self) -> String {
        if self.done == 0.0 {
            return String::new();
        }
        let left = self.begun.elapsed().as_secs_f64() * (self.all - self.done) / self.done;
        format!("; {left:.0} s left")
    }
}

/// The number of samples that takes nearest to this many seconds, by what two other numbers of them took.
fn samples_in(seconds: f64, [(few, few_took), (many, many_took)]: [(u32, f64); 2]) -> u32 {
    let each = (many_took - few_took) / f64::from(many - few);
    // Clocks are coarse: a sample takes at most its part of the picture's time, and not much less than a tenth of that.
    let part = many_took.max(1e-3) / f64::from(many);
    let each = each.clamp(0.1 * part, part);
    (f64::from(many) + (seconds - many_took) / each).round().max(1.0) as u32
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

#[cfg(test)]
mod tests {
    use super::samples_in;

    #[test]
    fn what_is_spent_once_is_not_counted_for_each_sample() {
        // 0.4 s for a pilot, 0.3 for a sample.
        assert_eq!(samples_in(1.0, [(1, 0.7), (2, 1.0)]), 2);
        assert_eq!(samples_in(4.0, [(1, 0.7), (10, 3.4)]), 12);
        assert_eq!(samples_in(0.1, [(1, 0.7), (2, 1.0)]), 1);
        // One thing took no longer than ten.
        assert_eq!(samples_in(2.0, [(1, 1.0), (10, 1.0)]), 110);
    }
}
