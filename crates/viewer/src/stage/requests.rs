//! What those who watch ask for: moves, settings, layers, edits, another scene.

use super::Stage;
use super::show::{FOR_DENOISERS, Shown};
use crate::eye::{Eye, point_at};
use crate::inbox::{QUESTIONS, Waiting};
use crate::message::{Move, Request};
use bilux::pictures::denoise::{DenoiserChoice, Task, denoiser};
use bilux::scene::{Parameters, Span, Value};
use bilux::transport::aovs::Aov;
use bilux::{Edit, Settings};

impl Stage {
    /// Does what is asked for. What cannot be done keeps nothing else from being done: others may have asked for that.
    pub(super) fn serve(&mut self, waiting: Waiting) {
        let changes_picture = waiting.changes_picture();
        let Waiting { moves, size, settings, shown, edits, questions, reload, .. } = waiting;
        if changes_picture {
            (self.problem, self.measurement) = (None, None);
            self.served += 1;
            if let Some(dropped) = waiting.dropped {
                let opened = self.open(dropped);
                self.note(opened);
            }
            if let Some(variant) = waiting.variant {
                let chosen = self.choose_variant(variant);
                self.note(chosen);
            }
            if reload {
                let reloaded = self.reload();
                self.note(reloaded);
            }
            moves.iter().for_each(|it| self.make_move(it));
            self.size = size.unwrap_or(self.size);
            let set = self.set(settings).and_then(|()| self.pose());
            self.note(set);
            let showed = self.show(shown);
            self.note(showed);
            let are_edited = !edits.is_empty();
            for edit in edits {
                let edited = self.edit(edit);
                self.note(edited);
            }
            if let Some(other) = waiting.compared {
                let compared = self.compare(other);
                self.note(compared);
            }
            self.other_is_out_of_date(are_edited);
            if let Some(are_shown) = waiting.differences {
                self.show_differences(are_shown);
            }
            let begun = self.begin().map_err(|error| error.to_string());
            self.note(begun);
            if (are_edited || moves.contains(&Move::Home)) && !self.is_moved {
                self.go_home(true);
            }
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

    /// Makes an edit.
    fn edit(&mut self, edit: Request) -> Result<(), String> {
        if !self.options.may_edit {
            return Err("this viewer is read-only: start it with --edit to change the scene".to_owned());
        }
        let session = &mut self.session;
        let edited = match edit {
            Request::Edit { part, number, key, value } => {
                self.edits.change(session, (part, number), &key, value)
            }
            Request::Undo => self.edits.undo(session),
            Request::Redo => self.edits.redo(session),
            _ => Ok(()),
        };
        edited.map_err(|error| error.to_string())
    }

    /// True if the camera is inside of the scene, as in a room.
    pub(super) fn is_inside(&self) -> bool {
        let bounds = self.session.scene().bounds(self.session.job().settings().time);
        self.eye.is_some_and(|eye| bounds.contains(eye.position.as_vec3()))
    }

    /// Sees where the scene has its camera, and goes there if wanted.
    pub(super) fn go_home(&mut self, goes: bool) {
        self.home = Eye::of(self.session.job());
        if goes {
            (self.eye, self.is_moved) = (self.home, false);
        }
    }

    /// Looks for the denoiser that the settings ask for.
    pub(super) fn choose_denoiser(&mut self) -> Result<(), bilux::Error> {
        self.denoiser = self.denoiser_for(self.session.job().settings())?;
        self.choose_layers()
    }

    /// The denoiser that settings ask for.
    pub(super) fn denoiser_for(&self, settings: &Settings) -> Result<Option<DenoiserChoice>, bilux::Error> {
        Ok(match settings.denoise.as_str() {
            "off" | "display" => None,
            name => Some(denoiser(name, &Task { threads: settings.threads, ..Task::default() })?),
        })
    }

    /// Keeps the layers that are shown, or that a denoiser looks at.
    pub(super) fn choose_layers(&mut self) -> Result<(), bilux::Error> {
        let shown = if let Shown::Layer(aov) = self.shown { Some(aov) } else { None };
        let guides = if self.denoises() { &FOR_DENOISERS[..] } else { &[] };
        let wanted: Vec<Aov> = shown.into_iter().chain(guides.iter().copied()).collect();
        if wanted != self.layers {
            self.session.with_layers(&wanted)?;
            self.layers = wanted;
        }
        Ok(())
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
            self.go_home(true);
        }
        applied.map_err(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Options;
    use bilux::scene::Spec;
    use std::sync::Arc;

    /// Several browsers may ask at once, and one of them for what cannot be done.
    #[test]
    fn what_is_refused_keeps_nothing_else_from_being_done() {
        let mut settings = Parameters::default();
        settings.set("size", "16x12");
        settings.set("integrator", "path");
        let options = Options {
            address: "127.0.0.1:0".parse().unwrap(),
            title: String::new(),
            may_edit: false,
            may_drop: false,
            settings,
            max_memory: 1 << 30,
            command: Vec::new(),
            open: Box::new(|_| bilux::generate(&Spec::new("", "cornell")).map_err(|error| error.to_string())),
        };
        let inbox = Arc::new(crate::inbox::Inbox::default());
        let mut stage = Stage::new(options, inbox, Arc::default(), Arc::default()).unwrap();
        let mut asked =
            Waiting { size: Some([8, 6]), shown: Some("nothing".to_owned()), ..Waiting::default() };
        for (key, value) in [("seed", 5.into()), ("output", 1.into()), ("integrator", Value::from("pathh"))] {
            asked.settings.set(key, value);
        }
        asked.edits.push(Request::Undo);
        stage.serve(asked);
        assert_eq!(stage.problem.as_deref(), Some("'output' is not a setting that can be changed here"));
        let settings = stage.session.job().settings();
        assert_eq!((settings.seed, settings.integrator.entry.name), (5, "path"));
        assert!(settings.width <= 8 && stage.size == [8, 6], "{}x{}", settings.width, settings.height);
    }
}
