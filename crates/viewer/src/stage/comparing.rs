//! Two pictures side by side: the picture, and another one with another setting or of the scene before its edits. Both get
//! the same time, in turns.

use super::Stage;
use super::comparison::Comparison;
use crate::message::Other;
use crate::settings::{self, Level};
use bilux::scene::Parameters;
use bilux::{Error, JobRequest, Session};

impl Stage {
    /// Compares the picture with another one, or with none.
    pub(super) fn compare(&mut self, other: Option<Other>) -> Result<(), String> {
        if let Some(Other::Setting(key, _)) = &other
            && !crate::catalogue::is_offered(key)
        {
            return Err(format!("'{key}' is not a setting that can be compared here"));
        }
        let before = self.comparison.take();
        self.comparison = other.map(|other| Comparison::with(other, before.as_ref()));
        if self.comparison.is_none() {
            self.publisher.show_other(None);
        }
        // Two pictures that are compared may be denoised differently from one.
        self.choose_denoiser().map_err(|error| error.to_string())
    }

    /// Notes that the settings of the other picture, or also its scene, have changed.
    pub(super) fn other_is_out_of_date(&mut self, by_scene: bool) {
        if let Some(it) = &mut self.comparison {
            it.is_out_of_date(by_scene);
        }
    }

    /// True if the other picture is to be refined next: it has had less time than the picture.
    pub(super) fn is_turn_of_other(&self) -> bool {
        let Some(it) = self.comparison.as_ref().filter(|it| it.goes_on()) else { return false };
        self.refinement.level == Level::Full
            && self.session.samples() > 0
            && (self.refinement.rests || it.is_urgent(self.refinement.worked))
    }

    /// Refines the other picture a little, and shows it. If that fails, nothing is compared any more.
    pub(super) fn work_on_other(&mut self) -> Result<(), Error> {
        let Some(mut it) = self.comparison.take() else { return Ok(()) };
        self.refine(&mut it).inspect_err(|_| self.publisher.show_other(None))?;
        self.comparison = Some(it);
        Ok(())
    }

    fn refine(&mut self, it: &mut Comparison) -> Result<(), Error> {
        if !it.is_current() {
            let session = it.bring_up_to_date(self.settings_of_other(it.other()), |other, wanted| {
                let is_unedited = *other == Other::Unedited;
                let scene = if is_unedited { &self.version.unedited } else { self.session.scene() };
                let request = JobRequest::from(&wanted).max_memory(self.common.max_memory);
                Session::sharing(scene.clone(), request, self.version.built.clone())
            })?;
            let denoiser = self.denoiser_for(session.job().settings(), true)?;
            it.denoise_by(denoiser)?;
        }
        if !it.step(&self.inbox)? {
            return Ok(());
        }
        let own = self.session.outcome().filter(|_| self.refinement.level == Level::Full);
        let Some((picture, options)) = it.picture(own, self.refinement.facts.eye)? else { return Ok(()) };
        let frame = self.publisher.frame(&picture, &options, self.viewpoint.size, it.facts())?;
        self.publisher.show_other(Some(frame));
        it.was_shown();
        Ok(())
    }

    fn settings_of_other(&self, other: &Other) -> Parameters {
        let mut all = self.asked();
        if let Other::Setting(key, value) = other {
            all.set(key, value.clone());
        }
        let mut all = settings::with_defaults(&all);
        settings::set_level(&mut all, &self.session.scene().settings, self.viewpoint.size, Level::Full);
        all
    }
}
