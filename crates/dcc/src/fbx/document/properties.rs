//! The properties of objects, and the templates that hold what most of a class have in common.

use crate::fbx::tree::{Node, Value, Values};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_math::DVec3;
use std::collections::HashMap;

/// The values of each property, by its name.
type Table<'d> = HashMap<&'d [u8], Values<'d>>;

/// Properties that objects of a class have in common.
pub(super) struct Template<'d> {
    name: &'d [u8],
    table: Table<'d>,
}

/// The properties of an object.
pub(in crate::fbx) struct Properties<'d, 't> {
    own: Table<'d>,
    template: Option<&'t Table<'d>>,
    /// The values that an animation gives, which replace the others.
    animated: Option<&'t Animated<'d>>,
}

/// Numbers of properties, by their names; one of a single number is in x.
pub(in crate::fbx) type Animated<'d> = HashMap<&'d [u8], DVec3>;

impl<'d, 't> Properties<'d, 't> {
    pub(super) fn read(node: Node<'d>, template: Option<&'t Template<'d>>) -> Properties<'d, 't> {
        Properties { own: table(node), template: template.map(|template| &template.table), animated: None }
    }

    /// These properties with values of an animation.
    pub(in crate::fbx) fn animated(self, animated: Option<&'t Animated<'d>>) -> Properties<'d, 't> {
        Properties { animated, ..self }
    }

    /// The values of a property, as the object or else its template has them.
    pub(in crate::fbx) fn values(&self, name: &str) -> Option<Values<'d>> {
        self.stated(name).or_else(|| self.template?.get(name.as_bytes()).copied())
    }

    /// The values of a property, if the object itself has them.
    pub(in crate::fbx) fn stated(&self, name: &str) -> Option<Values<'d>> {
        self.own.get(name.as_bytes()).copied()
    }

    /// The names of the properties that the object itself has.
    pub(in crate::fbx) fn own_names(&self) -> impl Iterator<Item = &'d str> + '_ {
        self.own.keys().filter_map(|name| std::str::from_utf8(name).ok())
    }

    /// A number, if it is finite.
    pub(in crate::fbx) fn number(&self, name: &str) -> Option<f64> {
        if let Some(animated) = self.animated.and_then(|animated| animated.get(name.as_bytes())) {
            return Some(animated.x);
        }
        self.values(name)?.next()?.number().filter(|number| number.is_finite())
    }

    pub(in crate::fbx) fn integer(&self, name: &str) -> Option<i64> {
        self.values(name)?.next()?.integer()
    }

    pub(in crate::fbx) fn text(&self, name: &str) -> Option<&'d [u8]> {
        self.values(name)?.next()?.text()
    }

    /// Three numbers, if they are finite.
    pub(in crate::fbx) fn vector(&self, name: &str) -> Option<DVec3> {
        if let Some(animated) = self.animated.and_then(|animated| animated.get(name.as_bytes())) {
            return Some(*animated);
        }
        let mut values = self.values(name)?;
        let mut next = || values.next().and_then(Value::number);
        Some(DVec3::new(next()?, next()?, next()?)).filter(|vector| vector.is_finite())
    }
}

/// The properties that a node lists. Of two with one name the first counts.
fn table<'d>(node: Node<'d>) -> Table<'d> {
    // The name, type, label and flags come first; before version 7 there was no label.
    let lists = [("Properties70", "P", 3), ("Properties60", "Property", 2)];
    let mut table = Table::new();
    for (list, entry, skipped) in lists {
        for property in node.children_named(list).flat_map(|list| list.children()) {
            let mut values = property.values();
            let name = values.next().and_then(Value::text).filter(|_| property.name() == entry.as_bytes());
            let Some(name) = name else { continue };
            if values.nth(skipped - 1).is_some() {
                table.entry(name).or_insert(values);
            }
        }
    }
    table
}

/// The templates of each class.
pub(super) fn templates<'d>(
    root: Node<'d>,
    budget: &mut Budget,
) -> Result<HashMap<&'d [u8], Vec<Template<'d>>>, FormatError> {
    let mut templates: HashMap<&'d [u8], Vec<Template<'d>>> = HashMap::new();
    let lists = root.children_named("Definitions").flat_map(|list| list.children());
    for class in lists.filter(|node| node.name() == b"ObjectType") {
        let Some(name) = class.value(0).and_then(Value::text) else { continue };
        for node in class.children_named("PropertyTemplate") {
            let table = table(node);
            budget.take::<(&[u8], Values)>(table.len(), node.file())?;
            let name_of_it = node.value(0).and_then(Value::text).unwrap_or_default();
            templates.entry(name).or_default().push(Template { name: name_of_it, table });
        }
    }
    Ok(templates)
}

/// The template for a kind of a class: `FbxCamera` for cameras; if there is only one, that.
pub(super) fn template_for<'t, 'd>(kind: &[u8], templates: &'t [Template<'d>]) -> Option<&'t Template<'d>> {
    let is_of_kind =
        |template: &&Template| template.name.strip_prefix(b"Fbx").is_some_and(|name| name == kind);
    match templates {
        [only] => Some(only),
        several => several.iter().find(is_of_kind),
    }
}
