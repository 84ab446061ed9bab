//! Changes of single parameters, as an editor makes them; scene files and command lines repeat them.

use crate::builder::SceneBuilder;
use crate::cameras::CAMERAS;
use crate::lights::LIGHTS;
use crate::materials::MATERIALS;
use crate::messages::error::SceneError;
use crate::parameters::{Reader, Span, Spec, Value};
use bilux_math::registry::{Entry, ParameterKind};

/// The maximum number of names that an error lists.
const MAX_NAMES: usize = 100;

/// Part of a scene whose parameters can be changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A row of [`SceneBuilder::materials`].
    Material,
    /// A row of [`SceneBuilder::lights`].
    Light,
    /// A row of [`SceneBuilder::cameras`].
    Camera,
}

/// Which of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Which {
    /// The one with this number, from 0.
    Number(usize),
    /// All with this name.
    Name(String),
}

/// A new value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Part that is changed.
    pub part: Part,
    /// Which of them.
    pub which: Which,
    /// The parameter.
    pub key: String,
    /// New value. The name of a material stands for the material where the parameter is one.
    pub value: Value,
    /// Place where the change was written.
    pub at: Span,
}

impl Part {
    /// All of them.
    pub const ALL: [Part; 3] = [Part::Material, Part::Light, Part::Camera];

    /// Name of the part in files and on command lines.
    pub fn name(self) -> &'static str {
        match self {
            Part::Material => "material",
            Part::Light => "light",
            Part::Camera => "camera",
        }
    }

    /// The part with this name.
    pub fn named(name: &str) -> Option<Part> {
        Part::ALL.into_iter().find(|part| part.name() == name)
    }

    /// The row that says which parameters a kind has.
    pub fn row(self, kind: &str) -> Option<&'static Entry> {
        match self {
            Part::Material => MATERIALS.iter().map(|row| &row.entry).find(|row| row.name == kind),
            Part::Light => LIGHTS.iter().map(|row| &row.entry).find(|row| row.name == kind),
            Part::Camera => CAMERAS.iter().map(|row| &row.entry).find(|row| row.name == kind),
        }
    }

    /// Specs of these parts of a scene.
    pub fn all(self, scene: &SceneBuilder) -> Vec<&Spec> {
        match self {
            Part::Material => scene.materials.iter().collect(),
            Part::Light => scene.lights.iter().collect(),
            Part::Camera => scene.cameras.iter().map(|camera| &camera.spec).collect(),
        }
    }

    /// One of them, to change it.
    pub fn one(self, scene: &mut SceneBuilder, number: usize) -> Option<&mut Spec> {
        match self {
            Part::Material => scene.materials.get_mut(number),
            Part::Light => scene.lights.get_mut(number),
            Part::Camera => scene.cameras.get_mut(number).map(|camera| &mut camera.spec),
        }
    }

    /// Name or number by which a change refers to the one with this number: the name, if no other has it and it is not a
    /// number itself.
    pub fn which(self, scene: &SceneBuilder, number: usize) -> Which {
        let all = self.all(scene);
        let name = all.get(number).map_or("", |spec| &spec.name);
        let is_only = all.iter().filter(|spec| spec.name == name).count() == 1;
        let is_number = name.bytes().all(|byte| byte.is_ascii_digit());
        if is_only && !is_number { Which::Name(name.to_owned()) } else { Which::Number(number) }
    }
}

impl Change {
    /// Makes the change in a scene.
    ///
    /// # Errors
    /// If the scene has nothing of this name or number, or the value does not fit; then the scene stays as it was.
    pub fn make(&self, scene: &mut SceneBuilder) -> Result<(), SceneError> {
        let mut changed = Vec::new();
        for number in self.numbers(scene)? {
            let mut spec = self.part.all(scene)[number].clone();
            let row = self.part.row(&spec.kind);
            spec.parameters.set_at(&self.key, self.value_in(scene, row)?, self.at.clone());
            if let Some(row) = row {
                Reader::new(&spec, row)?;
            }
            changed.push((number, spec));
        }
        for (number, spec) in changed {
            if let Some(own) = self.part.one(scene, number) {
                *own = spec;
            }
        }
        Ok(())
    }

    /// The numbers of what is changed; there is at least one.
    fn numbers(&self, scene: &SceneBuilder) -> Result<Vec<usize>, SceneError> {
        let (what, all) = (self.part.name(), self.part.all(scene));
        match &self.which {
            Which::Number(number) if *number < all.len() => Ok(vec![*number]),
            Which::Number(number) => {
                let message =
                    format!("there is no {what} {number}: the scene has {}, counted from 0", all.len());
                Err(SceneError::invalid(message, &self.at))
            }
            Which::Name(name) => {
                let same = all.iter().enumerate().filter(|(_, spec)| spec.name == *name);
                let same: Vec<usize> = same.map(|(number, _)| number).collect();
                if same.is_empty() {
                    let known = all.iter().map(|spec| spec.name.as_str()).filter(|name| !name.is_empty());
                    return Err(SceneError::unknown(what, name, known.take(MAX_NAMES), &self.at));
                }
                Ok(same)
            }
        }
    }

    /// The value, with the number of a material in place of its name.
    fn value_in(&self, scene: &SceneBuilder, row: Option<&Entry>) -> Result<Value, SceneError> {
        let parameter = row.and_then(|row| row.parameters.iter().find(|p| p.name == self.key));
        let is_material = parameter.is_some_and(|p| p.kind == ParameterKind::Material);
        let Value::Text(name) = self.value.clone() else { return Ok(self.value.clone()) };
        if !is_material {
            return Ok(self.value.clone());
        }
        let names = || scene.materials.iter().map(|spec| spec.name.as_str());
        let found = names().position(|own| own == name).map(Value::Material);
        found.ok_or_else(|| SceneError::unknown("material", &name, names().take(MAX_NAMES), &self.at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cameras::CameraSpec;

    fn scene() -> SceneBuilder {
        let mut scene = SceneBuilder::default();
        for (name, kind) in [("red", "diffuse"), ("twin", "diffuse"), ("twin", "diffuse"), ("7", "diffuse")] {
            scene.add_material(Spec::new(name, kind));
        }
        scene.add_material(
            Spec::new("both", "mix").with("a", Value::Material(3)).with("b", Value::Material(3)),
        );
        scene.add_light(Spec::new("lamp", "point"));
        scene.cameras.push(CameraSpec::new(Spec::new("", "perspective")));
        scene
    }

    fn change(part: Part, which: Which, key: &str, value: impl Into<Value>) -> Change {
        Change { part, which, key: key.to_owned(), value: value.into(), at: Span::default() }
    }

    fn name(name: &str) -> Which {
        Which::Name(name.to_owned())
    }

    #[test]
    fn a_change_finds_its_part_by_name_or_number() {
        let mut all = scene();
        change(Part::Material, name("twin"), "reflectance", 0.25).make(&mut all).unwrap();
        change(Part::Light, Which::Number(0), "intensity", 9).make(&mut all).unwrap();
        change(Part::Camera, Which::Number(0), "fov", 20.0).make(&mut all).unwrap();
        let set = |spec: &Spec| spec.parameters.0.len();
        assert_eq!(all.materials[..4].iter().map(set).collect::<Vec<_>>(), [0, 1, 1, 0], "all of a name");
        assert_eq!(all.lights[0].number("intensity"), Some(9.0));
        assert_eq!(all.cameras[0].spec.number("fov"), Some(20.0));
        change(Part::Material, name("both"), "b", "red").make(&mut all).unwrap();
        assert_eq!(all.materials[4].value_or("b", 0), Value::Material(0));
    }

    #[test]
    fn what_does_not_fit_changes_nothing() {
        for (wrong, part) in [
            (change(Part::Material, name("read"), "reflectance", 1), "did you mean 'red'"),
            (change(Part::Material, Which::Number(5), "reflectance", 1), "the scene has 5"),
            (change(Part::Material, name("red"), "reflectanse", 1), "reflectance"),
            (change(Part::Material, name("red"), "reflectance", 7), "from 0 to 1"),
            (change(Part::Material, name("both"), "a", "gold"), "no material 'gold'"),
            (change(Part::Light, name("lamp"), "intensity", "bright"), "a colour"),
        ] {
            let mut all = scene();
            let error = wrong.make(&mut all).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
            assert_eq!((&all.materials, &all.lights), (&scene().materials, &scene().lights));
        }
    }

    #[test]
    fn names_that_say_which_one_is_meant_are_preferred() {
        let scene = scene();
        let which = |number| Part::Material.which(&scene, number);
        assert_eq!([which(0), which(4)], [name("red"), name("both")]);
        assert_eq!([which(1), which(2), which(3)], [1, 2, 3].map(Which::Number));
        assert_eq!(Part::Camera.which(&scene, 0), Which::Number(0));
    }
}
