//! Requests of those who watch to their view: moves, settings, layers.

use super::Stage;
use super::show::Shown;
use crate::inbox::Waiting;
use bilux::Edit;
use bilux::scene::{Parameters, Span, Value};

impl Stage {
    /// Does what is asked for. What cannot be done keeps nothing else from being done: others may have asked for that.
    pub(super) fn serve(&mut self, waiting: Waiting) {
        let (changes_picture, is_answered) = (waiting.changes_picture(), waiting.answered.is_some());
        let Waiting { moves, size, settings, shown, questions, answered, .. } = waiting;
        if changes_picture || is_answered {
            self.publisher.serve();
        }
        if changes_picture {
            self.questions.measure(None);
            let taken = self.take_newest();
            self.publisher.note(taken);
            if let Some(other) = waiting.compared {
                let compared = self.compare(other);
                self.publisher.note(compared);
            }
            self.resize(size.unwrap_or(self.viewpoint.wanted_size));
            moves.iter().for_each(|it| self.viewpoint.make(it, self.session.job()));
            let set = self.set(settings);
            self.publisher.note(set);
            let showed = self.show(shown);
            self.publisher.note(showed);
            self.other_is_out_of_date(waiting.scene_changed);
            if let Some(are_shown) = waiting.differences {
                self.comparison.iter_mut().for_each(|it| it.show_differences(are_shown));
            }
            let begun = self.begin().map_err(|error| error.to_string());
            self.publisher.note(begun);
        }
        if let Some(Some(problem)) = answered {
            self.publisher.note(Err(problem));
        }
        if changes_picture || is_answered {
            self.publish_state();
        }
        self.questions.add(questions);
        self.answer_waiting();
    }

    /// Shows the picture or one of its layers.
    fn show(&mut self, what: Option<String>) -> Result<(), String> {
        let Some(what) = what else { return Ok(()) };
        self.shown = Shown::named(&what).ok_or_else(|| format!("there is no layer '{what}' to show"))?;
        self.choose_layers().map_err(|error| error.to_string())
    }

    /// Changes settings, all at once if that is possible; otherwise one by one, without those that are refused.
    fn set(&mut self, settings: Parameters) -> Result<(), String> {
        let is_offered = |(key, ..): &(String, _, _)| crate::catalogue::is_offered(key);
        let (offered, others): (Vec<_>, Vec<_>) = settings.0.into_iter().partition(is_offered);
        let refuse =
            |(key, ..): &(String, _, _)| Err(format!("'{key}' is not a setting that can be changed here"));
        let mut set = self.set_together(&offered);
        if set.is_err() && offered.len() > 1 {
            set = Ok(());
            for one in &offered {
                set = set.and(self.set_together(std::slice::from_ref(one)));
            }
        }
        others.first().map_or(Ok(()), refuse).and(set)
    }

    /// Changes all of these settings, or none.
    fn set_together(&mut self, settings: &[(String, Value, Span)]) -> Result<(), String> {
        if settings.is_empty() {
            return Ok(());
        }
        let before = (self.user.clone(), self.viewpoint);
        let changes_camera = settings.iter().any(|(key, ..)| key == "camera");
        for (key, value, _) in settings {
            self.user.set(key, value.clone());
        }
        if changes_camera {
            self.viewpoint.is_moved = false;
        }
        let applied = self.session.apply(Edit::Settings(self.settings_for(self.refinement.level)));
        let applied = applied.and_then(|_| self.choose_denoiser());
        if applied.is_err() {
            (self.user, self.viewpoint) = before;
        } else if changes_camera {
            // Another camera may have pictures of another shape.
            self.resize(self.viewpoint.wanted_size);
            self.viewpoint.home = self.home();
            self.viewpoint.go_home();
        }
        applied.map_err(|error| error.to_string())
    }
}
