//! Plugins of Mitsuba with their properties, as elements describe them.

use super::transforms::Placement;
use super::values::GivenColour;
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::names::{shortened, unknown};
use bilux_math::DVec3;
use bilux_scene::error::nearest_name;
use bilux_scene::{SceneError, Span};
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::Arc;

/// An object of the scene, such as a shape: the kind of element, its type, its properties and its parts.
#[derive(Debug)]
pub(super) struct Plugin {
    /// `shape`, `bsdf` and so on.
    pub(super) tag: &'static str,
    /// The type of plugin, such as `obj`.
    pub(super) kind: String,
    pub(super) id: String,
    pub(super) properties: Vec<Property>,
    pub(super) at: Span,
    /// The names that something looked up.
    asked: RefCell<Vec<&'static str>>,
}

/// A property, or a part, which may have no name.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) value: Value,
    pub(super) at: Span,
    pub(super) used: Cell<bool>,
}

/// The value of a property.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Number(f64),
    Integer(i64),
    Flag(bool),
    Text(String),
    Vector(DVec3),
    Transform(Arc<Placement>),
    Colour(GivenColour),
    /// A part.
    Object(Rc<Plugin>),
    /// A part that has this id elsewhere.
    Reference(Arc<str>),
}

impl Plugin {
    pub(super) fn new(
        tag: &'static str,
        kind: String,
        id: String,
        properties: Vec<Property>,
        at: Span,
    ) -> Plugin {
        Plugin { tag, kind, id, properties, at, asked: RefCell::default() }
    }

    /// Name of the plugin in messages.
    pub(super) fn named(&self) -> String {
        format!("the {} '{}'", self.tag, shortened(&self.kind))
    }

    /// The last property with this name.
    pub(super) fn find(&self, name: &'static str) -> Option<&Property> {
        {
            let mut asked = self.asked.borrow_mut();
            if !asked.contains(&name) {
                asked.push(name);
            }
        }
        let found = self.properties.iter().rev().find(|property| property.name == name);
        found.inspect(|property| property.used.set(true))
    }

    /// True if it has this property.
    pub(super) fn has(&self, name: &'static str) -> bool {
        self.find(name).is_some()
    }

    /// Looks up what changes nothing that one sees.
    pub(super) fn ignore(&self, names: &[&'static str]) {
        names.iter().for_each(|name| _ = self.find(name));
    }

    /// The location of a property, or else of the whole.
    pub(super) fn place(&self, name: &str) -> Span {
        self.properties
            .iter()
            .rev()
            .find(|property| property.name == name)
            .map_or(&self.at, |p| &p.at)
            .clone()
    }

    fn wrong(&self, name: &str, wanted: &str) -> FormatError {
        let message = format!("'{name}' of {} must be {wanted}", self.named());
        FormatError::malformed(message, self.place(name))
    }

    /// The error for a property that must be given.
    pub(super) fn missing(&self, what: &str) -> FormatError {
        SceneError::Missing { what: what.to_owned(), at: self.at.clone() }.into()
    }

    /// A finite number.
    pub(super) fn number(&self, name: &'static str) -> Result<Option<f64>, FormatError> {
        match self.find(name).map(|property| &property.value) {
            None => Ok(None),
            Some(Value::Number(number)) if number.is_finite() => Ok(Some(*number)),
            Some(Value::Integer(number)) => Ok(Some(*number as f64)),
            Some(_) => Err(self.wrong(name, "a finite number")),
        }
    }

    /// Finite number, or a default.
    pub(super) fn number_or(&self, name: &'static str, default: f64) -> Result<f64, FormatError> {
        Ok(self.number(name)?.unwrap_or(default))
    }

    /// A whole number.
    pub(super) fn integer(&self, name: &'static str) -> Result<Option<i64>, FormatError> {
        match self.find(name).map(|property| &property.value) {
            None => Ok(None),
            Some(Value::Integer(number)) => Ok(Some(*number)),
            Some(Value::Number(number)) if number.fract() == 0.0 && number.abs() < 1e15 => {
                Ok(Some(*number as i64))
            }
            Some(_) => Err(self.wrong(name, "a whole number")),
        }
    }

    /// True or false.
    pub(super) fn flag(&self, name: &'static str, default: bool) -> Result<bool, FormatError> {
        match self.find(name).map(|property| &property.value) {
            None => Ok(default),
            Some(Value::Flag(flag)) => Ok(*flag),
            Some(_) => Err(self.wrong(name, "true or false")),
        }
    }

    /// A text.
    pub(super) fn text(&self, name: &'static str) -> Result<Option<&str>, FormatError> {
        match self.find(name).map(|property| &property.value) {
            None => Ok(None),
            Some(Value::Text(text)) => Ok(Some(text)),
            Some(_) => Err(self.wrong(name, "a string")),
        }
    }

    /// A point or a direction.
    pub(super) fn vector(&self, name: &'static str) -> Result<Option<DVec3>, FormatError> {
        match self.find(name).map(|property| &property.value) {
            None => Ok(None),
            Some(Value::Vector(vector)) if vector.is_finite() => Ok(Some(*vector)),
            Some(_) => Err(self.wrong(name, "three finite numbers")),
        }
    }

    /// A transform, which may move.
    pub(super) fn placement(&self, name: &'static str) -> Result<Option<Arc<Placement>>, FormatError> {
        match self.find(name).map(|property| &property.value) {
            None => Ok(None),
            Some(Value::Transform(placement)) => Ok(Some(placement.clone())),
            Some(_) => Err(self.wrong(name, "a transform")),
        }
    }

    /// The name of a file, which must be given.
    pub(super) fn file(&self) -> Result<(&str, Span), FormatError> {
        let name = self.text("filename")?.ok_or_else(|| self.missing("filename"))?;
        Ok((name, self.place("filename")))
    }

    /// Warns about properties that nothing looked up.
    pub(super) fn report_unused(&self, diagnostics: &mut Diagnostics) {
        let is_part = |value: &Value| matches!(value, Value::Object(_) | Value::Reference(_));
        for property in self.properties.iter().filter(|p| !p.used.get() && !is_part(&p.value)) {
            let known: Vec<String> = self.asked.borrow().iter().map(|name| (*name).to_owned()).collect();
            let meant = nearest_name(&shortened(&property.name), &known);
            let meant = meant.map_or_else(String::new, |name| format!("; did you mean '{name}'?"));
            let what = format!("'{}' of {} is not used{meant}", shortened(&property.name), self.named());
            diagnostics.note(&what, || property.at.clone());
        }
    }
}

/// The row of a plugin's type in a table.
pub(super) fn row<'t, T>(plugin: &Plugin, table: &'t [(&'static str, T)]) -> Result<&'t T, FormatError> {
    let found = table.iter().find(|(name, _)| *name == plugin.kind);
    found.map(|(_, row)| row).ok_or_else(|| {
        let names = table.iter().map(|(name, _)| *name);
        unknown(format!("type of {}", plugin.tag), &plugin.kind, names, &plugin.at)
    })
}
