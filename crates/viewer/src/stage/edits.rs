//! Edits of materials, which can be undone.

use bilux::scene::{Spec, Value};
use bilux::{Edit, Error, Session};

/// The maximum number of edits that can be undone.
const STEPS: usize = 200;

/// A material before and after an edit.
struct Step {
    material: usize,
    key: String,
    before: Spec,
    after: Spec,
}

/// The edits so far.
#[derive(Default)]
pub(super) struct Edits {
    done: Vec<Step>,
    undone: Vec<Step>,
}

impl Edits {
    /// Changes a parameter of a material. Changes of the same parameter, as a slider makes them, are one step.
    ///
    /// # Errors
    /// If there is no such material, or the value is wrong.
    pub(super) fn change(
        &mut self,
        session: &mut Session,
        material: usize,
        key: &str,
        value: Value,
    ) -> Result<(), Error> {
        let before = session.scene().materials.get(material).cloned().unwrap_or_default();
        let after = before.clone().with(key, value);
        session.apply(Edit::Material(material, after.clone()))?;
        self.undone.clear();
        match self.done.last_mut() {
            Some(last) if (last.material, &*last.key) == (material, key) => last.after = after,
            _ => self.done.push(Step { material, key: key.to_owned(), before, after }),
        }
        if self.done.len() > STEPS {
            self.done.remove(0);
        }
        Ok(())
    }

    /// Takes the last edit back.
    ///
    /// # Errors
    /// If the scene has changed, so that the material is gone.
    pub(super) fn undo(&mut self, session: &mut Session) -> Result<(), Error> {
        let Some(step) = self.done.pop() else { return Ok(()) };
        session.apply(Edit::Material(step.material, step.before.clone()))?;
        self.undone.push(step);
        Ok(())
    }

    /// Makes the last edit that was taken back again.
    ///
    /// # Errors
    /// As for [`Edits::undo`].
    pub(super) fn redo(&mut self, session: &mut Session) -> Result<(), Error> {
        let Some(step) = self.undone.pop() else { return Ok(()) };
        session.apply(Edit::Material(step.material, step.after.clone()))?;
        self.done.push(step);
        Ok(())
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
