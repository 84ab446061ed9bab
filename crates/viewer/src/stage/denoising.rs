//! Denoising beside the render: it takes long for a large picture, and nobody who moves the camera may wait for it.

use super::Stage;
use super::denoisers::{Cleaned, Denoising};
use super::refinement::Refinement;
use crate::frame::Facts;
use crate::settings::{Level, denoiser_of};
use bilux::pictures::denoise::{DenoiserChoice, Task, denoiser};
use bilux::{Error, Settings};

impl Stage {
    /// Looks for the denoiser that the settings ask for.
    pub(super) fn choose_denoiser(&mut self) -> Result<(), Error> {
        let settings = self.session.job().settings();
        self.denoisers.chosen = self.denoiser_for(settings, self.comparison.is_some())?;
        self.choose_layers()
    }

    /// The denoiser that settings ask for. Two pictures that are compared are not denoised unless that is asked for: what
    /// people want to see is their noise.
    pub(super) fn denoiser_for(
        &self,
        settings: &Settings,
        is_compared: bool,
    ) -> Result<Option<DenoiserChoice>, Error> {
        let is_open = settings.denoise == "display" && is_compared;
        let name = denoiser_of(settings).filter(|_| !is_open);
        Ok(name.map(|name| denoiser(name, &self.task())).transpose()?)
    }

    /// Begins to denoise the picture as it is, unless an earlier one still is; it is shown when that is done. One is denoised
    /// at a time, even if it is not wanted any more: where denoising takes long, many together would take longer.
    pub(super) fn begin_denoising(&mut self, facts: Facts) -> Result<(), Error> {
        let Some(outcome) = self.session.outcome().filter(|_| !self.denoisers.are_at_work()) else {
            return Ok(());
        };
        let by = self.denoisers.name().unwrap_or(self.denoisers.for_previews.name);
        let (inbox, changes) = (self.inbox.clone(), self.refinement.changes);
        self.denoisers.work = Some(Denoising::begin(outcome, by, self.task(), facts, changes, inbox)?);
        Ok(())
    }

    /// Task for a denoiser.
    fn task(&self) -> Task {
        let threads = self.session.job().settings().threads;
        Task { threads, sandboxed: self.common.sandboxed, ..Task::default() }
    }

    /// Shows the picture that was being denoised, if that is done, and the picture is still wanted.
    pub(super) fn take_denoised(&mut self) -> Result<(), Error> {
        let Some((it, result)) = self.denoisers.take() else { return Ok(()) };
        let result = result?;
        if !self.denoises() {
            return Ok(());
        }
        let (picture, samples) = (it.facts.picture, it.facts.samples);
        let is_wanted = it.changes == self.refinement.changes;
        if is_wanted {
            let time = it.begun.elapsed();
            self.denoisers.cleaned = Some(Cleaned { picture, samples, by: it.by, result, time });
            self.show_cleaned(&it.facts)?;
        }
        // The last samples may have been taken meanwhile, or another denoiser chosen, or another picture begun.
        let Refinement { facts, rests, level, .. } = &self.refinement;
        let now = (facts.picture, self.session.samples(), self.denoisers.name());
        let is_last = is_wanted && (picture, samples, Some(it.by)) == now;
        if *rests && *level == Level::Full && !is_last { self.publish() } else { Ok(()) }
    }

    /// Shows the newest picture that was denoised.
    pub(super) fn show_cleaned(&mut self, facts: &Facts) -> Result<(), Error> {
        let Some(cleaned) = &self.denoisers.cleaned else { return Ok(()) };
        let options = self.session.job().write_options_for(&cleaned.result)?;
        let (picture, facts) = (cleaned.result.clone(), facts.clone());
        self.send(&picture, &options, facts)
    }
}
