//! Edits of materials, lights and cameras, which can be undone, and made again elsewhere.

use bilux::scene::cameras::CameraSpec;
use bilux::scene::{Change, Part, SceneBuilder, SceneError, Span, Spec, Value};
use bilux::{Edit, Error, Session};

/// The maximum number of edits that can be undone.
const STEPS: usize = 200;

/// What was edited, before and after.
struct Step {
    part: Part,
    number: usize,
    key: String,
    before: Spec,
    after: Spec,
}

impl Step {
    fn is_of(&self, part: Part, number: usize, key: &str) -> bool {
        (self.part, self.number, &*self.key) == (part, number, key)
    }
}

/// The edits so far.
#[derive(Default)]
pub(super) struct Edits {
    done: Vec<Step>,
    undone: Vec<Step>,
    /// Edits that are too old to be undone.
    old: Vec<Step>,
}

impl Edits {
    /// Changes a parameter. Changes of the same parameter, as a slider makes them, are one step.
    ///
    /// # Errors
    /// If there is no such part of the scene, or the value is wrong.
    pub(super) fn change(
        &mut self,
        session: &mut Session,
        (part, number): (Part, usize),
        key: &str,
        value: Value,
    ) -> Result<(), Error> {
        let before = spec_of(session.scene(), part, number)?;
        let after = before.clone().with(key, value);
        session.apply(replacing(session.scene(), part, number, after.clone()))?;
        self.undone.clear();
        match self.done.last_mut() {
            Some(last) if last.is_of(part, number, key) => last.after = after,
            _ => self.done.push(Step { part, number, key: key.to_owned(), before, after }),
        }
        if self.done.len() > STEPS {
            let oldest = self.done.remove(0);
            self.old.retain(|step| !step.is_of(oldest.part, oldest.number, &oldest.key));
            self.old.push(oldest);
        }
        Ok(())
    }

    /// Takes the last edit back.
    ///
    /// # Errors
    /// If the scene has changed, so that what was edited is gone.
    pub(super) fn undo(&mut self, session: &mut Session) -> Result<(), Error> {
        let Some(step) = self.done.pop() else { return Ok(()) };
        session.apply(replacing(session.scene(), step.part, step.number, step.before.clone()))?;
        self.undone.push(step);
        Ok(())
    }

    /// Makes the last edit that was taken back again.
    ///
    /// # Errors
    /// As for [`Edits::undo`].
    pub(super) fn redo(&mut self, session: &mut Session) -> Result<(), Error> {
        let Some(step) = self.undone.pop() else { return Ok(()) };
        session.apply(replacing(session.scene(), step.part, step.number, step.after.clone()))?;
        self.done.push(step);
        Ok(())
    }

    /// Makes all edits again, in a scene that has been opened anew. If they do not fit any more, there are none from then
    /// on.
    ///
    /// # Errors
    /// If an edit does not fit.
    pub(super) fn again(&mut self, session: &mut Session) -> Result<(), Error> {
        self.undone.clear();
        let mut steps: Vec<Step> = self.old.drain(..).chain(self.done.drain(..)).collect();
        let mut scene = session.scene().clone();
        for step in &mut steps {
            let before = spec_of(&scene, step.part, step.number)?;
            if (&before.kind, &before.name) != (&step.after.kind, &step.after.name) {
                let message = format!("{} {} is another one now", step.part.name(), step.number);
                return Err(SceneError::invalid(message, &Span::default()).into());
            }
            let value = step.after.value_or(&step.key, 0);
            step.after = before.clone().with(&step.key, value);
            step.before = before;
            if let Some(own) = step.part.one(&mut scene, step.number) {
                *own = step.after.clone();
            }
        }
        let edits = steps.iter().map(|step| replacing(&scene, step.part, step.number, step.after.clone()));
        session.apply_all(edits.collect())?;
        self.done = steps;
        Ok(())
    }

    /// The changes that make the scene what it is now from what it was when it was opened: the last value of each
    /// parameter that was edited.
    pub(super) fn changes(&self, scene: &SceneBuilder) -> Vec<Change> {
        let mut changes: Vec<Change> = Vec::new();
        for step in self.old.iter().chain(&self.done) {
            let which = step.part.which(scene, step.number);
            let same = |c: &Change| (c.part, &c.which, &c.key) == (step.part, &which, &step.key);
            changes.retain(|change| !same(change));
            let value = step.after.value_or(&step.key, 0);
            let (part, key, at) = (step.part, step.key.clone(), Span::default());
            changes.push(Change { part, which, key, value, at });
        }
        changes
    }

    /// True if there is something to undo.
    pub(super) fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    /// True if there is something to make again.
    pub(super) fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }
}

/// A part of a scene.
fn spec_of(scene: &SceneBuilder, part: Part, number: usize) -> Result<Spec, Error> {
    let all = part.all(scene);
    let message = || format!("there is no {} {number}: the scene has {}", part.name(), all.len());
    let found = all.get(number).map(|&spec| spec.clone());
    found.ok_or_else(|| SceneError::invalid(message(), &Span::default()).into())
}

/// The edit that puts another part in the place of one.
fn replacing(scene: &SceneBuilder, part: Part, number: usize, spec: Spec) -> Edit {
    match part {
        Part::Material => Edit::Material(number, spec),
        Part::Light => Edit::Light(number, spec),
        Part::Camera => {
            let keyframes = scene.cameras.get(number).map(|camera| camera.keyframes.clone());
            Edit::Camera(number, CameraSpec { spec, keyframes: keyframes.unwrap_or_default() })
        }
    }
}
