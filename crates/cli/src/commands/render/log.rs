//! Report about a picture once it is written: a line of text, or a line of JSON.

use crate::process::output;
use bilux::budget::DEFAULT_BUDGET;
use bilux::pictures::denoise::DenoiserChoice;
use bilux::scene::OrientationSource;
use bilux::{Job, Outcome};
use serde_json::json;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A picture that was rendered.
pub struct Rendered<'a> {
    pub job: &'a Job,
    pub outcome: &'a Outcome,
    pub scene: &'a Path,
    pub output: &'a Path,
    /// Seconds spent building acceleration structures and the like.
    pub build_seconds: f64,
    /// The time until rendering began, and until it ended; that of denoising; and the time until the picture was written.
    pub times: [Duration; 4],
    /// Seconds spent rendering.
    pub seconds: f64,
    /// Seconds from reading the scene to the last byte written.
    pub total_seconds: f64,
    /// The denoiser that was used.
    pub denoiser: Option<&'a DenoiserChoice>,
    /// Whether nothing was cut short: neither samples nor denoising.
    pub is_whole: bool,
    /// Whether `--timeout` ended it.
    pub timed_out: bool,
    /// Why it took longer than its time limit, if it did.
    pub overrun: Option<String>,
    pub warnings: &'a [String],
}

impl Rendered<'_> {
    /// The samples of each pixel that were taken, and those that were asked for, if noise or time alone does not decide.
    pub fn samples(&self) -> [serde_json::Value; 2] {
        let taken = self.outcome.samples_per_pixel();
        let whole = (taken.fract() == 0.0).then(|| (taken as u64).into());
        [whole.unwrap_or_else(|| taken.into()), self.job.asked_samples().into()]
    }

    /// The remaining noise, as a fraction of the light, if it was measured.
    fn noise(&self) -> Option<f32> {
        self.outcome.rendered.reached.and_then(|reached| reached.noise)
    }

    /// Prints the report as text: one line, and more with `-v`.
    pub fn print(&self, verbose: u8) {
        let (s, output) = (self.job.settings(), self.output.display());
        self.report_orientation(verbose);
        if verbose > 0 {
            self.report_details();
        }
        let noise = self.noise().map(|noise| format!(", {:.1}% noise", noise * 100.0)).unwrap_or_default();
        let denoised = self.denoiser.map(|chosen| format!(", denoised by {}", chosen.denoiser.describe()));
        let lit = self.job.studio_light().map(|with| format!(", lit by the studio ({with})"));
        let cut = match self.is_whole {
            false if self.timed_out => "; ended by --timeout: this is the picture so far",
            false => "; interrupted: this is the picture so far",
            true if self.outcome.rendered.spacing.is_some() => {
                "; its time ended within the first sample: pixels without one are interpolated"
            }
            true => "",
        };
        if let Some(overrun) = &self.overrun {
            output::eprint(format_args!("{output}: {overrun}"));
        }
        output::eprint(format_args!(
            "{output}: {}x{}, {} per pixel, {:.1} s{noise}{}{}{cut}",
            s.width,
            s.height,
            counted_samples(self.outcome.samples_per_pixel()),
            self.total_seconds,
            denoised.unwrap_or_default(),
            lit.unwrap_or_default(),
        ));
        // A log is no place for advice on what to install.
        let advice = self.denoiser.and_then(|chosen| chosen.advice.as_ref());
        if let Some(advice) = advice.filter(|_| verbose > 0 || std::io::stderr().is_terminal()) {
            output::eprint(format_args!("{output}: {advice}"));
        }
    }

    /// Reports the orientation if it was decided here, or, without `-v`, if it was guessed; once for a scene,
    /// however many pictures there are.
    fn report_orientation(&self, verbose: u8) {
        static SAID: Mutex<Option<PathBuf>> = Mutex::new(None);
        let is_reported = |source| verbose > 0 || source == OrientationSource::Shape;
        let Some(orientation) = self.job.orientation().filter(|found| is_reported(found.source)) else {
            return;
        };
        let mut said = SAID.lock().unwrap_or_else(PoisonError::into_inner);
        if said.as_deref() == Some(self.scene) {
            return;
        }
        let (up, front, source) =
            (orientation.up.name(), orientation.front.name(), orientation.source.words());
        output::eprint(format_args!(
            "{}: up is {up}, front is {front}, {source} (change it with --up and --front)",
            self.scene.display()
        ));
        *said = Some(self.scene.to_owned());
    }

    fn report_details(&self) {
        let (s, outcome, output) = (self.job.settings(), self.outcome, self.output.display());
        if let Some(choice) = &outcome.rendered.choice {
            output::eprint(format_args!("{output}: {} chose {choice}", s.integrator.entry.name));
        }
        output::eprint(format_args!(
            "{output}: {} with {}, {:.2} million rays per second",
            s.integrator.entry.name,
            s.accel.name,
            outcome.rendered.counters.rays as f64 / self.seconds.max(1e-9) / 1e6,
        ));
        let [before, rendered, denoised, written] = self.times.map(|time| time.as_secs_f64());
        let [features, pilot] =
            [outcome.surfaces.time, outcome.rendered.planning].map(|time| time.as_secs_f64());
        output::eprint(format_args!(
            "{output}: seconds for reading {:.2}, building {:.2}, features {features:.2}, pilot {pilot:.2}, samples {:.2}, \
             denoising {denoised:.2}, writing and layers {:.2}",
            (before - self.build_seconds).max(0.0),
            self.build_seconds,
            (rendered - before - features - pilot).max(0.0),
            (written - rendered - denoised).max(0.0),
        ));
        // The samples that measure the noise are also in the mean; this reports the bias where it may matter.
        if let Some(bias) =
            outcome.rendered.reached.and_then(|reached| reached.bias).filter(|bias| *bias >= 0.05)
        {
            output::eprint(format_args!(
                "{output}: stopping at a noise level biases the mean by at most {bias:.2} of the noise"
            ));
        }
    }

    /// The report as JSON.
    pub fn json(&self) -> serde_json::Value {
        let s = self.job.settings();
        let [spp, asked] = self.samples();
        json!({
            "scene": self.scene.to_string_lossy(), "picture": self.output.to_string_lossy(),
            "width": s.width, "height": s.height, "spp": spp, "spp_asked": asked, "noise": self.noise(),
            "seconds": self.total_seconds, "integrator": s.integrator.entry.name,
            "denoiser": self.denoiser.map(|chosen| chosen.denoiser.describe()), "seed": s.seed,
            "complete": self.is_whole, "warnings": self.warnings, "notes": self.job.notes(),
        })
    }
}

/// A number of samples as text; their mean over the pixels need not be whole.
pub fn counted_samples(number: f64) -> String {
    let steps = if number < 1.0 {
        100.0
    } else if number < 10.0 {
        10.0
    } else {
        1.0
    };
    let rounded = (number * steps).round() / steps;
    if rounded == 1.0 { "1 sample".to_owned() } else { format!("{rounded} samples") }
}

/// Prints a line of JSON about a scene that could not be rendered.
pub fn print_failure(scene: &Path, picture: &Path, error: &anyhow::Error) -> anyhow::Result<()> {
    let (scene, picture) = (scene.to_string_lossy(), picture.to_string_lossy());
    output::print(json!({ "scene": scene, "picture": picture, "error": output::message(error) }))
}

/// Reports the default limits of a render for which nobody set any.
pub fn report_default_budget(output: &Path) {
    let (noise, seconds) = DEFAULT_BUDGET;
    output::eprint(format_args!(
        "{}: renders until {}% noise or {seconds} s; --noise and --time-limit change these limits, and --spp makes \
         the picture the same on every machine",
        output.display(),
        noise * 100.0
    ));
}

/// Reports samples that are not finite or overflowed: they are counted and located, never hidden.
pub fn report_sample_failures(outcome: &Outcome) {
    let failures = outcome.rendered.film.sample_failures();
    if let Some(first) = failures.first_non_finite {
        output::warning(format_args!(
            "{} not finite and left out; see the first with --replay {},{},{}",
            output::counted(failures.non_finite, "sample is", "samples are"),
            first.x,
            first.y,
            first.sample
        ));
    }
    if let Some(first) = failures.first_overflowed {
        output::warning(format_args!(
            "{} brighter than the film can hold; see the first with --replay {},{},{}",
            output::counted(failures.overflowed, "sample is", "samples are"),
            first.x,
            first.y,
            first.sample
        ));
    }
}
