//! What those who watch ask for: moves, settings, layers, edits, another scene.

use super::show::{FOR_DENOISERS, Shown};
use super::{Stage, settings};
use crate::eye::{Eye, point_at};
use crate::inbox::{QUESTIONS, Waiting};
use crate::message::{Move, Request};
use bilux::pictures::denoise::{Task, denoiser};
use bilux::scene::{Parameters, Span, Value};
use bilux::transport::aovs::Aov;
use bilux::{Edit, Session};

impl Stage {
    /// Does what is asked for. What cannot be done keeps nothing else from being done: others may have asked for that.
    pub(super) fn serve(&mut self, waiting: Waiting) {
        let Waiting { moves, size, settings, shown, edits, questions, reload } = waiting;
        let changes = !moves.is_empty() || !settings.0.is_empty() || !edits.is_empty();
        if changes || size.is_some() || shown.is_some() || reload {
            self.problem = None;
            if reload {
                let reloaded = self.reload();
                self.note(reloaded);
            }
            moves.iter().for_each(|it| self.make_move(it));
            self.size = size.unwrap_or(self.size);
            let set = self.set(settings);
            self.note(set);
            let showed = self.show(shown);
            self.note(showed);
            for edit in edits {
                let edited = self.edit(edit);
                self.note(edited);
            }
            let begun = self.begin().map_err(|error| error.to_string());
            self.note(begun);
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
            return Err("this viewer is read-only: start it with --edit to change materials".to_owned());
        }
        let session = &mut self.session;
        let edited = match edit {
            Request::Edit { material, key, value } => self.edits.change(session, material, &key, value),
            Request::Undo => self.edits.undo(session),
            Request::Redo => self.edits.redo(session),
            _ => Ok(()),
        };
        edited.map_err(|error| error.to_string())
    }

    /// Opens the scene again; if that fails, everything stays as it is.
    fn reload(&mut self) -> Result<(), String> {
        let scene = (self.options.open)()?;
        self.watched.add(&scene.files);
        let settings = settings::with_defaults(&self.user);
        let session = Session::within(scene, &settings, self.options.max_memory);
        self.session = session.map_err(|error| error.to_string())?;
        (self.edits, self.layers) = Default::default();
        self.go_home(!self.is_moved);
        self.choose_layers().map_err(|error| error.to_string())
    }

    /// True if the camera is inside of the scene, as in a room.
    pub(super) fn is_inside(&self) -> bool {
        let bounds = self.session.scene().bounds(self.session.job().settings().time);
        self.eye.is_some_and(|eye| bounds.contains(eye.position.as_vec3()))
    }

    /// Sees where the scene has its camera, and goes there if wanted.
    fn go_home(&mut self, goes: bool) {
        self.home = Eye::of(self.session.job());
        if goes {
            (self.eye, self.is_moved) = (self.home, false);
        }
    }

    /// Looks for the denoiser that the settings ask for.
    pub(super) fn choose_denoiser(&mut self) -> Result<(), bilux::Error> {
        let settings = self.session.job().settings();
        let name = settings.denoise.as_str();
        self.denoiser = match name {
            "off" | "display" => None,
            name => Some(denoiser(name, &Task { threads: settings.threads, ..Task::default() })?),
        };
        self.choose_layers()
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
            settings,
            max_memory: 1 << 30,
            command: Vec::new(),
            open: Box::new(|| bilux::generate(&Spec::new("", "cornell")).map_err(|error| error.to_string())),
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
