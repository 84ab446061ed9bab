//! Two pictures side by side: the picture, and another one with another setting or of the scene before its edits. Both get
//! the same time, in turns.

use super::Stage;
use super::comparison::Comparison;
use super::refining::{Interruptible, STEP};
use super::show::{FOR_DENOISERS, Shown};
use crate::frame::{Facts, Frame};
use crate::message::Other;
use crate::settings::{self, Level};
use bilux::pictures::metrics::{HeatMap, Pair, heat_map};
use bilux::pictures::{METRICS, Picture, WriteOptions, downscaled};
use bilux::scene::Parameters;
use bilux::transport::NoiseMeter;
use bilux::{Budget, Edit, Error, JobRequest, Session};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How often the other picture is shown, and the two are compared.
const SHOWN_EVERY: Duration = Duration::from_millis(400);
/// How often the map of differences is made, which takes long.
const MAPPED_EVERY: Duration = Duration::from_millis(1500);
/// The largest number of its pixels: the map takes about 0.2 s then, and nothing interrupts it.
const MAPPED_PIXELS: usize = 250_000;

impl Stage {
    /// Compares the picture with another one, or with none.
    pub(super) fn compare(&mut self, other: Option<Other>) -> Result<(), String> {
        if let Some(Other::Setting(key, _)) = &other
            && !crate::catalogue::is_offered(key)
        {
            return Err(format!("'{key}' is not a setting that can be compared here"));
        }
        let shows_differences = self.comparison.as_ref().is_some_and(|it| it.differences);
        self.comparison =
            other.map(|other| Comparison { differences: shows_differences, ..Comparison::with(other) });
        if self.comparison.is_none() {
            self.outlets.other.send_replace(None);
        }
        // Two pictures that are compared may be denoised differently from one.
        self.choose_denoiser().map_err(|error| error.to_string())
    }

    /// Shows where the two pictures differ, or the other one.
    pub(super) fn show_differences(&mut self, are_shown: bool) {
        if let Some(it) = &mut self.comparison {
            (it.differences, it.is_shown, it.is_due) = (are_shown, false, true);
        }
    }

    /// What the other picture is of has changed.
    pub(super) fn other_is_out_of_date(&mut self, by_scene: bool) {
        if let Some(it) = &mut self.comparison {
            it.is_current = false;
            // An edit changes nothing before it.
            it.is_other_scene |= by_scene && it.other != Other::Unedited;
        }
    }

    /// True if the other picture is to be refined next: it has had less time than the picture.
    pub(super) fn is_turn_of_other(&self) -> bool {
        let Some(it) = self.comparison.as_ref().filter(|it| it.goes_on()) else { return false };
        self.level == Level::Full
            && self.session.samples() > 0
            && (it.is_due || self.rests || it.worked <= self.worked)
    }

    /// Refines the other picture a little, and shows it. If that fails, nothing is compared any more.
    pub(super) fn work_on_other(&mut self) -> Result<(), Error> {
        let Some(mut it) = self.comparison.take() else { return Ok(()) };
        self.refine(&mut it).inspect_err(|_| drop(self.outlets.other.send_replace(None)))?;
        self.comparison = Some(it);
        Ok(())
    }

    fn refine(&mut self, it: &mut Comparison) -> Result<(), Error> {
        if !it.is_current {
            self.bring_up_to_date(it)?;
        }
        let Some(session) = &mut it.session else { return Ok(()) };
        if std::mem::take(&mut it.is_due) && session.samples() > 0 {
            // Its next sample may take seconds.
            return self.publish_other(it);
        }
        let (begun, before) = (Instant::now(), session.samples());
        let budget = if before > 0 { Budget::Time(STEP) } else { Budget::Samples(1) };
        session.step(budget, &Interruptible(&self.inbox))?;
        let samples = session.samples();
        if samples > before {
            it.worked += begun.elapsed();
            it.is_shown = false;
        }
        if let (1, Some(outcome)) = (samples, session.outcome()) {
            it.meter.look(&outcome.rendered.film, samples);
        }
        let often = if it.differences { MAPPED_EVERY } else { SHOWN_EVERY };
        let is_due = it.last_shown.elapsed() >= often || session.is_done() || samples == 1;
        if samples > 0 && !it.is_shown && is_due {
            self.publish_other(it)?;
        }
        Ok(())
    }

    /// Gives the other picture the scene and the settings of the picture, except for what is compared.
    fn bring_up_to_date(&self, it: &mut Comparison) -> Result<(), Error> {
        let wanted = self.settings_of_other(&it.other);
        let restarts = match &mut it.session {
            Some(session) if !it.is_other_scene => session.apply(Edit::Settings(wanted))?,
            _ => {
                let is_unedited = it.other == Other::Unedited;
                let scene = if is_unedited { &self.version.unedited } else { self.session.scene() };
                let request = JobRequest::from(&wanted).max_memory(self.common.max_memory);
                let built = self.version.built.clone();
                it.session = Some(Session::sharing(scene.clone(), request, built)?);
                true
            }
        };
        if restarts {
            it.facts.picture += 1;
            (it.meter, it.facts.noise, it.worked) = (NoiseMeter::default(), None, Duration::ZERO);
        }
        it.denoiser = match &it.session {
            Some(session) => self.denoiser_for(session.job().settings(), true)?,
            None => None,
        };
        if let (Some(session), Some(_), true) = (&mut it.session, &it.denoiser, restarts) {
            session.with_layers(&FOR_DENOISERS)?;
        }
        (it.is_current, it.is_other_scene, it.is_shown) = (true, false, false);
        Ok(())
    }

    fn settings_of_other(&self, other: &Other) -> Parameters {
        let mut all = self.asked();
        if let Other::Setting(key, value) = other {
            all.set(key, value.clone());
        }
        let mut all = settings::with_defaults(&all);
        settings::set_level(&mut all, &self.session.scene().settings, self.size, Level::Full);
        all
    }

    /// Shows the other picture, or where the two differ.
    fn publish_other(&mut self, it: &mut Comparison) -> Result<(), Error> {
        let Some((session, outcome)) = it.session.as_ref().and_then(|s| Some((s, s.outcome()?))) else {
            return Ok(());
        };
        let job = session.job();
        let (picture, options) = Shown::Picture.of(job, outcome, it.denoiser.as_ref())?;
        let own = self.session.outcome().map(|outcome| outcome.picture()).transpose()?;
        let (error, map) = match own {
            Some(own) if self.level == Level::Full => {
                differences(&own, &outcome.picture()?, &options, it.differences)?
            }
            _ => (None, None),
        };
        if session.samples() > 1 {
            it.facts.noise = it.meter.look(&outcome.rendered.film, session.samples()).or(it.facts.noise);
        }
        let is_done = session.is_done();
        it.facts = Facts {
            shown: if map.is_some() { "differences" } else { "picture" },
            total: job.samples_per_pixel(),
            rests: is_done,
            choice: outcome.rendered.choice.as_ref().map(ToString::to_string),
            eye: self.facts.eye,
            difference: error.or(it.facts.difference),
            ..it.facts.clone()
        }
        .of(
            [picture.width() as u32, picture.height() as u32],
            session.samples(),
            outcome.rendered.counters.rays,
            it.worked,
        );
        self.frame += 1;
        let (picture, options) = map.map_or((picture, options), |map| (map, WriteOptions::default()));
        let frame = Frame::new(self.frame, &picture, &options, self.size, &it.facts)?;
        self.outlets.other.send_replace(Some(Arc::new(frame)));
        (it.last_shown, it.is_shown) = (Instant::now(), true);
        Ok(())
    }
}

/// The map of differences as people see them, of so many pixels that requests need not wait for it.
fn map_of(a: &Picture, b: &Picture, options: &WriteOptions) -> Result<Picture, Error> {
    let factor = (1..).find(|factor| a.pixel_count() / (factor * factor) <= MAPPED_PIXELS).unwrap_or(1);
    let (a, b) = (downscaled(a, factor)?, downscaled(b, factor)?);
    let pair = Pair::new(&a, &b, options.exposure, options.tone_map)?;
    Ok(heat_map(&pair, HeatMap::Flip)?)
}

/// How far two pictures are from each other, relative to their light; and a map of that, as people see it, if wanted.
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
