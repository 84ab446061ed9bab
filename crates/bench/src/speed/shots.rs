//! Pictures and what they cost.

use crate::render::Clock;
use bilux::budget::with_default_budget;
use bilux::math::Rgb;
use bilux::scene::{Parameters, SceneBuilder, Value};
use bilux::{Denoised, Error, Job, JobRequest, Quiet};
use std::path::Path;
use std::time::Instant;

/// A picture that took some time; trees were built before.
pub(super) struct Shot {
    /// CPU seconds of all threads.
    pub(super) cpu_seconds: f64,
    /// Seconds on the clock.
    pub(super) seconds: f64,
    pub(super) pixels: Vec<Rgb>,
    /// The rays that were counted, if they were.
    pub(super) rays: u64,
}

impl Shot {
    pub(super) fn of(job: &Job) -> Result<Shot, Error> {
        let clock = Clock::start(job.settings().threads);
        let begun = Instant::now();
        let outcome = job.render(&Quiet)?;
        let seconds = begun.elapsed().as_secs_f64();
        let (cpu_seconds, _) = clock.stop();
        // The system counts in hundredths, so that very short pictures seem to take no time.
        let cpu_seconds = cpu_seconds.max(1e-3);
        Ok(Shot {
            cpu_seconds,
            seconds,
            pixels: outcome.rendered.film.to_rgb(),
            rays: outcome.rendered.counters.rays,
        })
    }
}

/// A picture with default settings, from a scene to a file.
pub(super) struct UserPicture {
    /// Samples per pixel.
    pub(super) samples: u32,
    /// Width and height of the picture, as `WxH`.
    pub(super) size: String,
}

/// Renders as the command line does: with its default limits, denoised and written. `begun` is when the scene's file was
/// opened.
pub(super) fn as_a_user(
    scene: &SceneBuilder,
    mut user: Parameters,
    begun: Instant,
    output: &Path,
) -> Result<UserPicture, Error> {
    with_default_budget(&scene.settings, &mut user);
    let request = JobRequest::from(&user).begun_at(begun).denoised(Denoised::ForDisplay);
    let job = Job::new(scene, request)?;
    let outcome = job.render(&Quiet)?;
    let picture = match job.denoiser()? {
        Some(denoiser) => outcome.denoised(denoiser)?,
        None => outcome.picture()?,
    };
    bilux::pictures::write(output, &picture, &job.write_options_for(&picture)?)?;
    Ok(UserPicture {
        samples: outcome.rendered.reached.map_or(job.settings().spp, |reached| reached.spp),
        size: format!("{}x{}", job.settings().width, job.settings().height),
    })
}

/// Settings of a picture to be rendered.
#[derive(Clone, Copy)]
pub(super) struct Plan {
    pub(super) integrator: &'static str,
    /// The width and the height.
    pub(super) side: u32,
    pub(super) samples: u32,
    pub(super) seed: u32,
    /// 0 for all cores.
    pub(super) threads: u32,
    pub(super) max_depth: u32,
}

impl Plan {
    /// Samples of the whole picture, in millions.
    pub(super) fn millions(&self) -> f64 {
        f64::from(self.side * self.side) * f64::from(self.samples) * 1e-6
    }

    pub(super) fn settings(&self) -> Parameters {
        let mut settings = Parameters::default();
        settings.set("integrator", self.integrator);
        settings.set("filter", "box");
        settings.set("size", Value::Text(format!("{0}x{0}", self.side)));
        let numbers = [
            ("spp", self.samples),
            ("seed", self.seed),
            ("threads", self.threads),
            ("max_depth", self.max_depth),
        ];
        numbers.iter().for_each(|&(key, n)| settings.set(key, Value::Integer(i64::from(n))));
        settings
    }

    pub(super) fn shoot(&self, scene: &SceneBuilder) -> Result<Shot, Error> {
        Shot::of(&Job::new(scene, &self.settings())?)
    }
}
