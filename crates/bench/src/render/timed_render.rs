//! Renders whose cost is measured.

use super::cost::Clock;
use super::scenes::SIZE;
use bilux::scene::{Parameters, SceneBuilder, Value};
use bilux::transport::Choice;
use bilux::{Error, Job, Quiet};
use bilux_math::Rgb;

/// Measures samples per pixel per CPU second, with ever longer renders until one takes a fifth of the smallest budget.
pub(super) fn calibrate(
    scene: &SceneBuilder,
    integrator: &str,
    budgets: &[f64],
    threads: u32,
) -> Result<f64, Error> {
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
pub(super) struct TimedRender {
    pub(super) seconds: f64,
    pub(super) peak_mb: Option<f64>,
    pub(super) picture: Vec<Rgb>,
    pub(super) choice: Option<Choice>,
}

/// Renders a picture, and measures what it costs.
pub(super) fn shoot(scene: &SceneBuilder, settings: &Parameters) -> Result<TimedRender, Error> {
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

/// The settings of a picture; `auto:TECHNIQUES` is `auto` with one set of techniques.
pub(super) fn settings(integrator: &str, samples: u32, seed: u64, threads: u32) -> Parameters {
    let mut settings = Parameters::default();
    let (name, techniques) = integrator.split_once(':').unwrap_or((integrator, ""));
    settings.set("integrator", name);
    if !techniques.is_empty() {
        settings.set("techniques", techniques);
    }
    settings.set("size", Value::Text(format!("{}x{}", SIZE.0, SIZE.1)));
    settings.set("spp", Value::Integer(i64::from(samples)));
    settings.set("seed", Value::Integer(seed as i64));
    settings.set("threads", Value::Integer(i64::from(threads)));
    settings
}
