//! What those who watch ask of their view: moves, settings, layers.

use super::Stage;
use super::show::Shown;
use crate::eye::{own_bounds, point_at};
use crate::inbox::{QUESTIONS, Waiting};
use crate::message::Move;
use bilux::Edit;
use bilux::scene::{Parameters, Span, Value};

impl Stage {
    /// Does what is asked for. What cannot be done keeps nothing else from being done: others may have asked for that.
    pub(super) fn serve(&mut self, waiting: Waiting) {
        let (changes_picture, is_answered) = (waiting.changes_picture(), waiting.answered.is_some());
        let Waiting { moves, size, settings, shown, questions, answered, .. } = waiting;
        if changes_picture || is_answered {
            self.problem = None;
            self.served += 1;
        }
        if changes_picture {
            self.measurement = None;
            let taken = self.take_newest();
            self.note(taken);
            if let Some(other) = waiting.compared {
                let compared = self.compare(other);
                self.note(compared);
            }
            self.resize(size.unwrap_or(self.wanted_size));
            moves.iter().for_each(|it| self.make_move(it));
            let set = self.set(settings);
            self.note(set);
            let showed = self.show(shown);
            self.note(showed);
            self.other_is_out_of_date(waiting.scene_changed);
            if let Some(are_shown) = waiting.differences {
                self.show_differences(are_shown);
            }
            let begun = self.begin().map_err(|error| error.to_string());
            self.note(begun);
        }
        if let Some(Some(problem)) = answered {
            self.note(Err(problem));
        }
        if changes_picture || is_answered {
            self.publish_state();
        }
        // What waits for a picture is asked again by those who still want it.
        self.questions.extend(questions);
        let many = self.questions.len().saturating_sub(QUESTIONS);
        self.questions.drain(..many);
        self.answer_waiting();
    }

    /// Keeps the first problem, for the page.
    fn note(&mut self, result: Result<(), String>) {
        if let Err(problem) = result {
            self.problem.get_or_insert(problem);
        }
    }

    /// Moves the camera.
    fn make_move(&mut self, it: &Move) {
        let job = self.session.job();
        if *it == Move::Home {
            (self.is_moved, self.eye) = (false, self.home);
            return;
        }
        let Some(mut eye) = self.eye else { return };
        match *it {
            Move::Orbit([right, up]) => eye.orbit(right, up),
            Move::Look([right, up]) => eye.look(right, up),
            Move::Pan([right, up]) => {
                let height = f64::from(job.camera().height_at(eye.pivot.as_vec3(), job.settings().time));
                eye.pan(right * height, up * height);
            }
            Move::Fly([right, up, forward]) => eye.fly(right, up, forward),
            Move::Approach(factor) => eye.approach(factor),
            Move::Focus(at) => {
                if let Some(point) = point_at(job, at.map(|x| x as f32)) {
                    eye.focus(point);
                }
            }
            Move::Home => {}
        }
        (self.eye, self.is_moved) = (Some(eye), true);
    }

    /// Shows the picture or one of its layers.
    fn show(&mut self, what: Option<String>) -> Result<(), String> {
        let Some(what) = what else { return Ok(()) };
        self.shown = Shown::named(&what).ok_or_else(|| format!("there is no layer '{what}' to show"))?;
        self.choose_layers().map_err(|error| error.to_string())
    }

    /// True if the camera is inside of the scene, as in a room.
    pub(super) fn is_inside(&self) -> bool {
        let (job, own) = (self.session.job(), self.session.scene().objects.len());
        let bounds = own_bounds(job.completed_scene(), own, job.settings().time);
        self.eye.is_some_and(|eye| bounds.contains(eye.position.as_vec3()))
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
        let (before, eye) = (self.user.clone(), (self.eye, self.is_moved));
        let changes_camera = settings.iter().any(|(key, ..)| key == "camera");
        for (key, value, _) in settings {
            self.user.set(key, value.clone());
        }
        if changes_camera {
            self.is_moved = false;
        }
        let applied = self.session.apply(Edit::Settings(self.settings_for(self.level)));
        let applied = applied.and_then(|_| self.choose_denoiser());
        if applied.is_err() {
            self.user = before;
            (self.eye, self.is_moved) = eye;
        } else if changes_camera {
            self.find_home();
            (self.eye, self.is_moved) = (self.home, false);
        }
        applied.map_err(|error| error.to_string())
    }
}
