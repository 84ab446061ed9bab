//! Reference with which the viewer compares its picture.

use super::show::{FOR_DENOISERS, Shown};
use super::steps::{Interruptible, STEP};
use crate::frame::Facts;
use crate::inbox::Inbox;
use crate::message::Other;
use bilux::pictures::denoise::DenoiserChoice;
use bilux::pictures::metrics::{HeatMap, Pair, heat_map};
use bilux::pictures::{METRICS, Picture, WriteOptions, downscaled};
use bilux::scene::Parameters;
use bilux::transport::NoiseMeter;
use bilux::{Budget, Edit, Error, Outcome, Session};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Interval at which the other picture is shown, and the two are compared.
const SHOWN_EVERY: Duration = Duration::from_millis(400);
/// Interval at which the map of differences is made, which takes long.
const MAPPED_EVERY: Duration = Duration::from_millis(1500);
/// The largest number of its pixels: the map takes about 0.2 s then, and nothing interrupts it.
const MAPPED_PIXELS: usize = 250_000;

/// The other picture.
pub(super) struct Comparison {
    other: Other,
    /// Show where the two differ.
    differences: bool,
    session: Option<Session>,
    /// The denoiser of the other picture.
    denoiser: Option<DenoiserChoice>,
    /// Whether its session is that of the scene and the settings that are shown.
    is_current: bool,
    /// Whether its scene has to be built anew.
    is_other_scene: bool,
    /// Whether its samples begin anew.
    restarts: bool,
    meter: NoiseMeter,
    facts: Facts,
    worked: Duration,
    last_shown: Instant,
    is_shown: bool,
    /// Whether it is to be shown at once, as it is: something else of it is asked for.
    is_due: bool,
}

impl Comparison {
    /// A comparison with something, which is not rendered yet; differences are shown if they were before.
    pub(super) fn with(other: Other, before: Option<&Comparison>) -> Comparison {
        Comparison {
            other,
            differences: before.is_some_and(|it| it.differences),
            session: None,
            denoiser: None,
            is_current: false,
            is_other_scene: true,
            restarts: false,
            meter: NoiseMeter::default(),
            facts: Facts { side: "other", ..Facts::default() },
            worked: Duration::ZERO,
            last_shown: Instant::now(),
            is_shown: false,
            is_due: false,
        }
    }

    /// Picture that is compared with.
    pub(super) fn other(&self) -> &Other {
        &self.other
    }

    /// Facts of the picture that was made last.
    pub(super) fn facts(&self) -> &Facts {
        &self.facts
    }

    /// Comparison in JSON, for the page.
    pub(super) fn state(&self) -> Value {
        match &self.other {
            Other::Setting(key, value) => {
                let value = super::json::value_json(value);
                json!({ "with": "setting", "key": key, "value": value, "differences": self.differences })
            }
            Other::Unedited => json!({ "with": "unedited", "differences": self.differences }),
        }
    }

    /// The samples of each pixel so far.
    pub(super) fn samples(&self) -> u32 {
        self.session.as_ref().map_or(0, Session::samples)
    }

    /// The samples of each pixel that there will be, once that is known.
    pub(super) fn total(&self) -> Option<u32> {
        self.session.as_ref().map(|session| session.job().samples_per_pixel())
    }

    /// Shows where the two pictures differ, or the other one.
    pub(super) fn show_differences(&mut self, are_shown: bool) {
        (self.differences, self.is_shown, self.is_due) = (are_shown, false, true);
    }

    /// Shows it once more, even if it is done.
    pub(super) fn show_again(&mut self) {
        self.is_shown = false;
    }

    /// Notes that it was shown.
    pub(super) fn was_shown(&mut self) {
        (self.last_shown, self.is_shown) = (Instant::now(), true);
    }

    /// Notes that the settings, or also the scene, have changed.
    pub(super) fn is_out_of_date(&mut self, by_scene: bool) {
        self.is_current = false;
        // An edit changes nothing before it.
        self.is_other_scene |= by_scene && self.other != Other::Unedited;
    }

    /// Another version of the scene is shown.
    pub(super) fn forget(&mut self) {
        (self.session, self.is_current) = (None, false);
    }

    /// True if its session is that of the scene and the settings that are shown.
    pub(super) fn is_current(&self) -> bool {
        self.is_current
    }

    /// True if there is something to be done for it.
    pub(super) fn goes_on(&self) -> bool {
        let is_done = self.session.as_ref().is_some_and(Session::is_done);
        !(self.is_current && is_done && self.is_shown)
    }

    /// True if it is to be shown at once, or has had no more time than the picture.
    pub(super) fn is_urgent(&self, worked: Duration) -> bool {
        self.is_due || self.worked <= worked
    }

    /// Gives it these settings; `begin` makes its session where its scene has changed.
    ///
    /// # Errors
    /// If it cannot be rendered with them.
    pub(super) fn bring_up_to_date(
        &mut self,
        wanted: Parameters,
        begin: impl FnOnce(&Other, Parameters) -> Result<Session, Error>,
    ) -> Result<&Session, Error> {
        let (session, restarts) = match self.session.take().filter(|_| !self.is_other_scene) {
            Some(mut session) => {
                let restarts = session.apply(Edit::Settings(wanted))?;
                (session, restarts)
            }
            None => (begin(&self.other, wanted)?, true),
        };
        if restarts {
            self.facts.picture += 1;
            (self.meter, self.facts.noise, self.worked) = (NoiseMeter::default(), None, Duration::ZERO);
        }
        (self.is_current, self.is_other_scene, self.is_shown) = (true, false, false);
        self.restarts = restarts;
        Ok(self.session.insert(session))
    }

    /// Denoises it from now on, or shows it as it is.
    ///
    /// # Errors
    /// If the layers that guide the denoiser cannot be kept.
    pub(super) fn denoise_by(&mut self, denoiser: Option<DenoiserChoice>) -> Result<(), Error> {
        if let (Some(session), Some(_), true) = (&mut self.session, &denoiser, self.restarts) {
            session.with_layers(&FOR_DENOISERS)?;
        }
        self.denoiser = denoiser;
        Ok(())
    }

    /// Refines it a little. Returns true if it is to be shown.
    ///
    /// # Errors
    /// If the integrator fails.
    pub(super) fn step(&mut self, inbox: &Inbox) -> Result<bool, Error> {
        let Some(session) = &mut self.session else { return Ok(false) };
        if std::mem::take(&mut self.is_due) && session.samples() > 0 {
            // Its next sample may take seconds.
            return Ok(true);
        }
        let (begun, before) = (Instant::now(), session.samples());
        let budget = if before > 0 { Budget::Time(STEP) } else { Budget::Samples(1) };
        session.step(budget, &Interruptible(inbox))?;
        let samples = session.samples();
        if samples > before {
            self.worked += begun.elapsed();
            self.is_shown = false;
        }
        if let (1, Some(outcome)) = (samples, session.outcome()) {
            self.meter.look(&outcome.rendered.film, samples);
        }
        let often = if self.differences { MAPPED_EVERY } else { SHOWN_EVERY };
        let is_due = self.last_shown.elapsed() >= often || session.is_done() || samples == 1;
        Ok(samples > 0 && !self.is_shown && is_due)
    }

    /// The picture to show, with its [`facts`](Self::facts): the other picture, or where the two differ, if there is a picture of
    /// one's own in full size. Both have their camera at the same place.
    ///
    /// # Errors
    /// If memory is short, or the denoiser fails.
    pub(super) fn picture(
        &mut self,
        own: Option<&Outcome>,
        eye: [[f64; 3]; 2],
    ) -> Result<Option<(Picture, WriteOptions)>, Error> {
        let Some((session, outcome)) = self.session.as_ref().and_then(|s| Some((s, s.outcome()?))) else {
            return Ok(None);
        };
        let (picture, options) = Shown::Picture.of(session.job(), outcome, self.denoiser.as_ref())?;
        let (error, map) = match own {
            Some(own) => differences(&own.picture()?, &outcome.picture()?, &options, self.differences)?,
            None => (None, None),
        };
        let (samples, film) = (session.samples(), &outcome.rendered.film);
        let noise = if samples > 1 { self.meter.look(film, samples) } else { None };
        let facts = Facts {
            shown: if map.is_some() { "differences" } else { "picture" },
            total: session.job().samples_per_pixel(),
            rests: session.is_done(),
            choice: outcome.rendered.choice.as_ref().map(ToString::to_string),
            eye,
            noise: noise.or(self.facts.noise),
            difference: error.or(self.facts.difference),
            ..self.facts.clone()
        };
        let size = [picture.width() as u32, picture.height() as u32];
        self.facts = facts.of(size, samples, outcome.rendered.counters.rays, self.worked);
        Ok(Some(map.map_or((picture, options), |map| (map, WriteOptions::default()))))
    }
}

/// The map of differences as people see them, of so many pixels that requests need not wait for it.
fn map_of(a: &Picture, b: &Picture, options: &WriteOptions) -> Result<Picture, Error> {
    let factor = (1..).find(|factor| a.pixel_count() / (factor * factor) <= MAPPED_PIXELS).unwrap_or(1);
    let (a, b) = (downscaled(a, factor)?, downscaled(b, factor)?);
    let pair = Pair::new(&a, &b, options.exposure, options.tone_map)?;
    Ok(heat_map(&pair, HeatMap::Flip)?)
}

/// Distance of two pictures, relative to their light; and a map of their differences, as people see them, if wanted.
fn differences(
    a: &Picture,
    b: &Picture,
    options: &WriteOptions,
    is_wanted: bool,
) -> Result<(Option<f64>, Option<Picture>), Error> {
    let pair = Pair::new(a, b, options.exposure, options.tone_map)?;
    let squared = METRICS.iter().find(|row| row.entry.name == "relmse").map(|row| (row.evaluate)(&pair));
    let map = if is_wanted { Some(map_of(a, b, options)?) } else { None };
    Ok((squared.filter(|x| x.is_finite()).map(f64::sqrt), map))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::math::Rgb;

    /// A tenth more light everywhere is a difference of a tenth.
    #[test]
    fn differences_are_relative_to_light_and_not_to_its_square() {
        let grey = |light: f32| Picture::from_rgb(8, 8, vec![Rgb::grey(light); 64]).unwrap();
        let options = WriteOptions::default();
        let (found, map) = differences(&grey(5.5), &grey(5.0), &options, true).unwrap();
        assert!((found.unwrap() - 0.1).abs() < 1e-3 && map.is_some(), "{found:?}");
        assert_eq!(differences(&grey(5.0), &grey(5.0), &options, false).unwrap().0, Some(0.0));
    }
}
