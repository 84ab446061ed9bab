//! Edits of materials, lights and cameras, which can be undone, and made again elsewhere.

use bilux::scene::cameras::CameraSpec;
use bilux::scene::{Change, Part, SceneBuilder, SceneError, Span, Spec, Value};
use bilux::{Edit, Error, Session};

/// The maximum number of edits that can be undone.
const STEPS: usize = 200;

/// Edit of a parameter, with the part before and after.
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
        part: Part,
        number: usize,
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

#[cfg(test)]
mod tests {
    use super::*;
    use bilux::scene::{Parameters, Which};

    /// The box of Cornell with three lamps, in few pixels.
    fn session() -> Session {
        let mut scene = bilux::generate(&Spec::new("", "cornell")).unwrap();
        scene.lights.retain(|light| light.name == "lamp");
        for name in ["second", "third"] {
            let mut lamp = scene.lights[0].clone();
            name.clone_into(&mut lamp.name);
            scene.lights.push(lamp);
        }
        let mut settings = Parameters::default();
        settings.set("size", "8x8");
        Session::new(scene, &settings).unwrap()
    }

    fn radiances(session: &Session) -> Vec<Value> {
        session.scene().lights.iter().map(|light| light.value_or("radiance", 0.0f32)).collect()
    }

    /// The edit is made again in the file as it is now, and undone it is that file, not the one before.
    #[test]
    fn undo_in_a_scene_that_was_opened_anew_is_the_new_file() {
        let (mut before, mut edits) = (session(), Edits::default());
        edits.change(&mut before, Part::Light, 1, "radiance", Value::Number(7.0)).unwrap();
        let mut scene = session().scene().clone();
        scene.lights[1].parameters.set("radiance", 3.0f32);
        let mut settings = Parameters::default();
        settings.set("size", "8x8");
        let mut now = Session::new(scene, &settings).unwrap();
        edits.again(&mut now).unwrap();
        assert_eq!(radiances(&now)[1], Value::Number(7.0));
        edits.undo(&mut now).unwrap();
        assert_eq!(radiances(&now)[1], Value::Number(3.0));
        edits.redo(&mut now).unwrap();
        assert_eq!(radiances(&now)[1], Value::Number(7.0));
    }

    /// Edits of a camera leave it on its way, also where they are taken back and made again.
    #[test]
    fn a_camera_that_moves_goes_on_to_move_when_it_is_edited() {
        let mut scene = session().scene().clone();
        let ways = [1.0f32, -2.0].map(|x| {
            let mut at = Parameters::default();
            at.set("position", bilux::math::Vec3::new(x, 1.0, 4.0));
            vec![(0.5, at.clone()), (2.0, at)]
        });
        let spec = scene.cameras[0].spec.clone();
        scene.cameras = ways.clone().map(|keyframes| CameraSpec { spec: spec.clone(), keyframes }).into();
        let mut settings = Parameters::default();
        settings.set("size", "8x8");
        let (mut session, mut edits) = (Session::new(scene, &settings).unwrap(), Edits::default());
        edits.change(&mut session, Part::Camera, 1, "fov", Value::Number(30.0)).unwrap();
        let is_as_it_was = |session: &Session, fov: Option<f32>| {
            let cameras = &session.scene().cameras;
            let moves = cameras.iter().zip(&ways).all(|(camera, way)| camera.keyframes == *way);
            moves && cameras.len() == 2 && fov.is_none_or(|fov| cameras[1].spec.number("fov") == Some(fov))
        };
        assert!(is_as_it_was(&session, Some(30.0)), "{:?}", session.scene().cameras);
        edits.undo(&mut session).unwrap();
        assert!(is_as_it_was(&session, None) && session.scene().cameras[1].spec == spec);
        edits.redo(&mut session).unwrap();
        assert!(is_as_it_was(&session, Some(30.0)), "{:?}", session.scene().cameras);
    }

    /// A slider makes one step of many changes. Another light, another part and another parameter are other steps.
    #[test]
    fn only_changes_of_the_same_parameter_of_the_same_part_are_one_step() {
        let (mut session, mut edits) = (session(), Edits::default());
        let at_first = radiances(&session);
        let changes = [
            (Part::Light, 0, "radiance", 1.0),
            (Part::Light, 0, "radiance", 2.0),
            (Part::Light, 1, "radiance", 3.0),
            (Part::Light, 1, "radiance", 4.0),
            (Part::Material, 1, "reflectance", 0.5),
            (Part::Material, 0, "reflectance", 0.25),
        ];
        for (part, number, key, value) in changes {
            edits.change(&mut session, part, number, key, Value::Number(value)).unwrap();
        }
        let now = radiances(&session);
        assert_eq!(now, [Value::Number(2.0), Value::Number(4.0), at_first[2].clone()]);
        let named = |change: &Change| match &change.which {
            Which::Name(name) => format!("{} {name} {} {:?}", change.part.name(), change.key, change.value),
            Which::Number(number) => {
                format!("{} {number} {} {:?}", change.part.name(), change.key, change.value)
            }
        };
        let saved: Vec<String> = edits.changes(session.scene()).iter().map(named).collect();
        assert_eq!(saved.len(), 4, "{saved:?}");
        assert!(saved[0].starts_with("light lamp radiance") && saved[0].contains('2'), "{saved:?}");
        assert!(saved[1].starts_with("light second radiance") && saved[1].contains('4'), "{saved:?}");
        // Made again in the scene as it was opened, they give the same scene.
        let mut again = super::tests::session();
        edits.again(&mut again).unwrap();
        assert_eq!(format!("{:?}", again.scene().lights), format!("{:?}", session.scene().lights));
        assert_eq!(format!("{:?}", again.scene().materials), format!("{:?}", session.scene().materials));
        let mut steps = 0;
        while edits.can_undo() {
            edits.undo(&mut again).unwrap();
            steps += 1;
        }
        assert_eq!((steps, radiances(&again)), (4, at_first));
    }
}
