//! How a picture comes about: small and soon at first, then larger, then refined.

use super::pace::divided;
use super::show::Shown;
use super::{Level, Stage};
use crate::frame::{Facts, Frame};
use crate::inbox::Inbox;
use bilux::transport::{NoiseMeter, Progress};
use bilux::{Budget, Edit, Error, Settings};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a step of the picture takes: then requests are looked at.
pub(super) const STEP: Duration = Duration::from_millis(60);
/// How often a picture that gets better is shown.
const SHOWN_EVERY: Duration = Duration::from_millis(250);
/// How long nothing has changed when the picture itself is begun: some integrators then choose their strategies first.
const SETTLED: Duration = Duration::from_millis(180);

/// Stops a step whose picture is out of date.
pub(super) struct Interruptible<'a>(pub(super) &'a Inbox);

impl Progress for Interruptible<'_> {
    fn begin(&self, _samples: u64) {}

    fn advance(&self, _samples: u64, _rays: u64) {}

    fn is_cancelled(&self) -> bool {
        self.0.interrupts()
    }
}

impl Stage {
    /// Begins the picture anew, with small pictures first, unless what has changed is only how it is displayed.
    pub(super) fn begin(&mut self) -> Result<(), Error> {
        (self.rests, self.changed) = (false, Instant::now());
        self.other_is_out_of_date(false);
        let full = Settings::of(self.session.scene(), &self.settings_for(Level::Full))?;
        let has_samples = self.level == Level::Full && self.session.samples() > 0;
        if has_samples && full.takes_samples_of(self.session.job().settings()) {
            self.enter(Level::Full)?;
            self.rests = self.session.is_done();
            return self.publish();
        }
        self.enter(Level::Preview(self.pace.divisor(self.size)))
    }

    /// True if what is shown is denoised: small previews always are, or little could be seen in them; the picture if that
    /// is asked for. A preview in full size soon gives way to the picture.
    pub(super) fn denoises(&self) -> bool {
        match self.level {
            Level::Preview(1) => false,
            Level::Preview(_) => {
                self.shown == Shown::Picture && !self.session.job().settings().integrator.classic
            }
            Level::Full => self.denoiser.is_some(),
        }
    }

    /// Goes on with another level.
    fn enter(&mut self, level: Level) -> Result<(), Error> {
        let begun = Instant::now();
        self.level = level;
        self.choose_layers()?;
        if self.session.apply(Edit::Settings(self.settings_for(level)))? || self.session.samples() == 0 {
            self.facts.picture += 1;
            (self.meter, self.facts.noise) = (NoiseMeter::default(), None);
            self.worked = Duration::ZERO;
        }
        self.entering = begun.elapsed();
        Ok(())
    }

    /// Refines what is being rendered a little, and shows it.
    pub(super) fn work(&mut self) -> Result<(), Error> {
        let (begun, before) = (Instant::now(), self.session.samples());
        let budget = match self.level {
            Level::Full if before > 0 => Budget::Time(STEP),
            _ => Budget::Samples(1),
        };
        self.session.step(budget, &Interruptible(&self.inbox))?;
        let samples = self.session.samples();
        if samples == before && !self.session.is_done() {
            return Ok(());
        }
        self.worked += begun.elapsed();
        if samples == 1
            && let Some(outcome) = self.session.outcome()
        {
            // Noise is measured by what later samples change.
            self.meter.look(&outcome.rendered.film, samples);
        }
        match self.level {
            Level::Preview(divisor) => {
                self.publish()?;
                self.pace.learn(divided(self.size, divisor), self.entering, begun.elapsed());
                self.answer_waiting();
                self.go_on_from(divisor)
            }
            Level::Full => {
                let is_done = self.session.is_done();
                let is_more = samples.is_power_of_two() && self.denoiser.is_none() && samples <= 4;
                if is_done || is_more || self.is_due() {
                    self.rests = is_done;
                    self.publish()?;
                    if let (true, Some(it)) = (is_done, &mut self.comparison) {
                        // How far the two are from each other in the end.
                        it.is_shown = false;
                    }
                    self.answer_waiting();
                }
                Ok(())
            }
        }
    }

    /// True if it is time to show the picture again; with a denoiser, which takes long, less often.
    fn is_due(&self) -> bool {
        let often = if self.denoiser.is_some() { 8 } else { 1 };
        self.last_shown.elapsed() >= SHOWN_EVERY * often
    }

    /// Goes on with a larger picture, or with the picture itself once nothing changes any more.
    fn go_on_from(&mut self, divisor: u32) -> Result<(), Error> {
        if divisor > 1 {
            return self.enter(Level::Preview(divisor / 2));
        }
        if self.settings_for(Level::Full) == self.settings_for(Level::Preview(1)) {
            self.level = Level::Full;
            return Ok(());
        }
        if self.changed.elapsed() >= SETTLED {
            return self.enter(Level::Full);
        }
        Ok(())
    }

    /// Shows the picture as it is.
    fn publish(&mut self) -> Result<(), Error> {
        let (job, Some(outcome)) = (self.session.job(), self.session.outcome()) else { return Ok(()) };
        let is_preview = self.level != Level::Full;
        let chosen = self.denoiser.as_ref().unwrap_or(&self.for_previews);
        let denoiser = self.denoises().then_some(chosen);
        let (picture, options) = self.shown.of(job, outcome, denoiser)?;
        if !is_preview && self.session.samples() > 1 {
            self.facts.noise =
                self.meter.look(&outcome.rendered.film, self.session.samples()).or(self.facts.noise);
        }
        let point = |p: bilux::math::DVec3| p.to_array();
        let facts = Facts {
            shown: self.shown.name(),
            total: job.samples_per_pixel(),
            is_preview,
            rests: self.rests,
            choice: outcome.rendered.choice.as_ref().map(ToString::to_string),
            eye: self.eye.map_or([[0.0; 3]; 2], |eye| [point(eye.position), point(eye.pivot)]),
            ..self.facts.clone()
        }
        .of(&picture, self.session.samples(), outcome.rendered.counters.rays, self.worked);
        self.frame += 1;
        let frame = Frame::new(self.frame, &picture, &options, self.size, &facts)?;
        self.facts = facts;
        if self.rests {
            // Before the frame: after a picture that rests, nothing more may come.
            self.publish_state();
        }
        self.outlets.frames.send_replace(Some(Arc::new(frame)));
        self.last_shown = Instant::now();
        Ok(())
    }
}
