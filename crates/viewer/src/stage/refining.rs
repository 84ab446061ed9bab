//! Refinement of a picture: small and soon at first, then clean in half the size or less, then in full size, refined.

use super::Stage;
use super::show::{FOR_DENOISERS, Shown};
use super::steps::{Interruptible, STEP};
use crate::frame::Facts;
use crate::settings::{Level, divided};
use bilux::pictures::{Picture, WriteOptions};
use bilux::transport::aovs::Aov;
use bilux::{Budget, Edit, Error, Outcome, Settings};
use std::time::{Duration, Instant};

/// Interval at which a picture that gets better is shown.
const SHOWN_EVERY: Duration = Duration::from_millis(250);
/// Time without changes after which the picture itself is begun: some integrators then choose their strategies first.
const SETTLED: Duration = Duration::from_millis(180);
/// Time after the last change for which samples are taken for a clean picture, and their maximum number.
const CLEAN: Duration = Duration::from_millis(600);
const CLEAN_SAMPLES: u32 = 16;
/// Time of the samples, at least, as a multiple of that of denoising them.
const SHARE: u32 = 4;
/// Interval at which a picture that is denoised is shown.
const CLEANED_EVERY: Duration = Duration::from_secs(2);

impl Stage {
    /// Begins the picture anew, with small pictures first, unless what has changed is only how it is displayed.
    pub(super) fn begin(&mut self) -> Result<(), Error> {
        (self.refinement.rests, self.refinement.changed) = (false, Instant::now());
        self.other_is_out_of_date(false);
        let full = Settings::of(self.session.scene(), &self.settings_for(Level::Full))?;
        let has_samples = self.refinement.level == Level::Full && self.session.samples() > 0;
        if has_samples && full.takes_samples_of(self.session.job().settings()) {
            self.enter(Level::Full)?;
            if self.session.samples() > 0 {
                self.refinement.rests = self.session.is_done();
                return self.publish_again();
            }
        }
        self.refinement.begin();
        self.enter(Level::Preview(self.refinement.pace.divisor(self.viewpoint.size)))
    }

    /// True if what is shown is denoised: small previews always are, or little could be seen in them; larger ones and the
    /// picture if that is asked for.
    pub(super) fn denoises(&self) -> bool {
        let is_picture = self.shown == Shown::Picture;
        match self.refinement.level {
            Level::Preview(1) | Level::Full => is_picture && self.denoisers.chosen.is_some(),
            Level::Preview(_) | Level::Clean(_) => {
                is_picture && !self.session.job().settings().integrator.classic
            }
        }
    }

    /// Keeps the layers that are shown, or that a denoiser looks at.
    pub(super) fn choose_layers(&mut self) -> Result<(), Error> {
        let shown = if let Shown::Layer(aov) = self.shown { Some(aov) } else { None };
        let guides = if self.denoises() { &FOR_DENOISERS[..] } else { &[] };
        let wanted: Vec<Aov> = shown.into_iter().chain(guides.iter().copied()).collect();
        if wanted != self.layers {
            self.session.with_layers(&wanted)?;
            self.layers = wanted;
        }
        Ok(())
    }

    /// Goes on with another level.
    fn enter(&mut self, level: Level) -> Result<(), Error> {
        let begun = Instant::now();
        self.refinement.level = level;
        let restarts = self.session.apply(Edit::Settings(self.settings_for(level)))?;
        self.choose_layers()?;
        if restarts || self.session.samples() == 0 {
            self.refinement.begin_samples();
        }
        self.refinement.entering = begun.elapsed();
        Ok(())
    }

    /// Refines what is being rendered a little, and shows it.
    pub(super) fn work(&mut self) -> Result<(), Error> {
        let (begun, before) = (Instant::now(), self.session.samples());
        let budget = match self.refinement.level {
            Level::Full if before > 0 => Budget::Time(STEP),
            _ => Budget::Samples(1),
        };
        self.session.step(budget, &Interruptible(&self.inbox))?;
        let samples = self.session.samples();
        if samples == before && !self.session.is_done() {
            return Ok(());
        }
        self.refinement.worked += begun.elapsed();
        if let (1, Some(outcome)) = (samples, self.session.outcome()) {
            self.refinement.look_first(outcome);
        }
        match self.refinement.level {
            Level::Preview(divisor) => {
                self.publish()?;
                self.refinement.pace.learn(
                    divided(self.viewpoint.size, divisor),
                    self.refinement.entering,
                    begun.elapsed(),
                );
                self.answer_waiting();
                self.go_on_from(divisor)
            }
            Level::Clean(divisor) => {
                let is_late = self.refinement.changed.elapsed() >= CLEAN;
                // A larger one has as many samples as the full size would have when it is first shown.
                let is_enough = is_late && samples >= self.refinement.enough || samples >= CLEAN_SAMPLES;
                if !is_enough && !self.session.is_done() {
                    return Ok(());
                }
                self.publish()?;
                self.refinement.enough = samples.div_ceil(2);
                let (size, enough) = (self.viewpoint.size, self.refinement.enough);
                match self.refinement.pace.after_clean(size, divisor, enough) {
                    1 => self.enter(Level::Full),
                    larger => self.enter(Level::Clean(larger)),
                }
            }
            Level::Full => {
                self.refinement.rests = self.session.is_done();
                if self.is_due() {
                    self.publish()?;
                    if let (true, Some(it)) = (self.refinement.rests, &mut self.comparison) {
                        // How far the two are from each other in the end.
                        it.show_again();
                    }
                }
                self.answer_waiting();
                Ok(())
            }
        }
    }

    /// True if it is time to show the picture in full size again; with a denoiser, which takes long, less often.
    fn is_due(&self) -> bool {
        let samples = self.session.samples();
        if self.denoises() && self.denoisers.are_at_work() {
            return false;
        }
        if self.session.is_done() || !self.refinement.is_full_shown {
            return self.session.is_done() || samples >= self.refinement.enough;
        }
        if !self.denoises() {
            let is_more = samples.is_power_of_two() && samples <= 4;
            return is_more || self.publisher.since_shown() >= SHOWN_EVERY;
        }
        let often = self.denoisers.time().map_or(CLEANED_EVERY, |time| CLEANED_EVERY.max(time * SHARE));
        self.publisher.since_shown() >= often
    }

    /// Goes on with a larger picture, or with the picture itself once nothing changes any more.
    fn go_on_from(&mut self, divisor: u32) -> Result<(), Error> {
        if divisor > 1 {
            let cleans = self.denoises() && self.denoisers.chosen.is_some();
            let clean = self.refinement.pace.clean_divisor(self.viewpoint.size);
            let next = match cleans && divisor / 2 <= clean {
                true => Level::Clean(clean.min(divisor)),
                false => Level::Preview(divisor / 2),
            };
            return self.enter(next);
        }
        if self.settings_for(Level::Full) == self.settings_for(Level::Preview(1)) {
            self.refinement.level = Level::Full;
            return self.choose_layers();
        }
        if self.refinement.changed.elapsed() >= SETTLED {
            return self.enter(Level::Full);
        }
        Ok(())
    }

    /// Shows the picture as it is, denoised if that is wanted: a large picture as soon as that is done.
    pub(super) fn publish(&mut self) -> Result<(), Error> {
        let samples = self.session.samples();
        if let (true, Some(outcome)) =
            (self.refinement.level == Level::Full && samples > 1, self.session.outcome())
        {
            self.refinement.measure_noise(outcome, samples);
        }
        let (job, Some(outcome)) = (self.session.job(), self.session.outcome()) else { return Ok(()) };
        let facts = self.facts_of(outcome);
        // A clean picture does not wait until one that is not wanted any more is denoised.
        let is_soon = match self.refinement.level {
            Level::Preview(_) => true,
            Level::Clean(_) => self.denoisers.are_at_work(),
            Level::Full => false,
        };
        if self.denoises() && !is_soon {
            self.refinement.facts = facts.clone();
            return match self.denoisers.cleaned_samples(&facts) == Some(samples) {
                true => self.show_cleaned(&facts),
                false => self.begin_denoising(facts),
            };
        }
        let denoiser = self.denoises().then_some(&self.denoisers.for_previews);
        let (picture, options) = self.shown.of(job, outcome, denoiser)?;
        self.send(&picture, &options, facts)
    }

    /// Shows the picture at once in another way, from the same samples: one that was denoised before may have fewer.
    fn publish_again(&mut self) -> Result<(), Error> {
        let Some(outcome) = self.session.outcome().filter(|_| self.denoises()) else { return self.publish() };
        let facts = self.facts_of(outcome);
        match self.denoisers.cleaned_samples(&facts) {
            Some(samples) if samples < facts.samples => {
                self.show_cleaned(&Facts { samples, rests: false, ..facts })?;
                if self.refinement.rests { self.publish() } else { Ok(()) }
            }
            _ => self.publish(),
        }
    }

    /// Facts of the picture as it is.
    fn facts_of(&self, outcome: &Outcome) -> Facts {
        let (job, samples) = (self.session.job(), self.session.samples());
        let point = |p: bilux::math::DVec3| p.to_array();
        let facts = Facts {
            shown: self.shown.name(),
            total: job.samples_per_pixel(),
            is_preview: self.refinement.level != Level::Full,
            rests: self.refinement.level == Level::Full && self.session.is_done(),
            choice: outcome.rendered.choice.as_ref().map(ToString::to_string),
            eye: self.viewpoint.eye.map_or([[0.0; 3]; 2], |eye| [point(eye.position), point(eye.pivot)]),
            zoom: self.viewpoint.eye.filter(|_| self.viewpoint.is_moved).map(|eye| eye.zoom),
            ..self.refinement.facts.clone()
        };
        let settings = job.settings();
        let size = [settings.width, settings.height];
        facts.of(size, samples, outcome.rendered.counters.rays, self.refinement.worked)
    }

    /// Sends a picture to those who watch.
    pub(super) fn send(
        &mut self,
        picture: &Picture,
        options: &WriteOptions,
        facts: Facts,
    ) -> Result<(), Error> {
        let frame = self.publisher.frame(picture, options, self.viewpoint.size, &facts)?;
        let rests = facts.rests;
        self.refinement.note_frame(facts);
        if rests {
            // Before the frame: after a picture that rests, nothing more may come.
            self.publish_state();
        }
        self.publisher.show(frame);
        Ok(())
    }
}
