//! Objects: a mesh, or components.

use super::model::{Component, Content, Object, Property, Reference, Resource, Role};
use super::namespaces::Namespace;
use super::part::{PartReader, part_of, undeclared};
use super::xml::{Element, Level};
use bilux_import::FormatError;

impl PartReader<'_, '_> {
    /// Reads the object that has just been opened.
    pub(super) fn object(&mut self) -> Result<(), FormatError> {
        let id = self.id()?;
        let Some(element) = self.xml.current() else { return Ok(()) };
        let role = role(&element)?;
        let (name, at, inside) = (element.words("name").into_owned(), element.at(), element.inside);
        let property = match (element.index("pid")?, element.index("pindex")?) {
            (None, None) => None,
            (None, Some(_)) => {
                return Err(element.error("an object with pindex needs a pid, which says of what"));
            }
            (Some(pid), index) => Some((pid, index.unwrap_or(0))),
        };
        let property = match property {
            None => None,
            Some((pid, index)) => match self.model.resources.get(&(self.part, pid)) {
                Some(&Resource::Group(group)) if (index as usize) < self.model.groups[group].len() => {
                    Some(Property { group, index })
                }
                Some(&Resource::Group(group)) => {
                    let count = self.model.groups[group].len();
                    let message =
                        format!("this object has pindex={index}, but its group has {count}, counted from 0");
                    return Err(element.error(message));
                }
                _ => {
                    let message = format!(
                        "this object has pid={pid}, but no group of properties with this id comes before it"
                    );
                    return Err(element.error(message));
                }
            },
        };
        if element.of(Namespace::Slices, "slicestackid").is_some() {
            let at = element.at();
            self.diagnostics.not_shown("slices (the mesh is shown)", || at);
        }
        // Registered at the end: an object cannot contain itself.
        let (content, unprinted) = self.content(inside, property)?;
        let role = if unprinted { Role::Modifier } else { role };
        let Some(content) = content else {
            let message = "this object has neither a mesh nor components";
            return Err(FormatError::malformed(message, at));
        };
        self.reading.budget.take_bytes((2 * size_of::<Object>() + name.len()) as u64, &self.file)?;
        let number = self.model.objects.len();
        if self.model.resources.insert((self.part, id), Resource::Object(number)).is_some() {
            let message = format!("two resources have the id {id}: each needs its own");
            return Err(FormatError::malformed(message, at));
        }
        self.model.objects.push(Object { name, role, property, content, at });
        Ok(())
    }

    fn content(
        &mut self,
        level: Level,
        property: Option<Property>,
    ) -> Result<(Option<Content>, bool), FormatError> {
        let (mut content, mut unprinted) = (None, false);
        while let Some(child) = self.xml.child(level)? {
            let inside = child.inside;
            match (child.namespace, child.name) {
                (Namespace::Core, "mesh") => {
                    content = Some(Content::Mesh(Box::new(self.mesh(inside, property)?)));
                }
                (Namespace::Core, "components") => {
                    content = Some(Content::Components(self.components(inside)?))
                }
                (Namespace::Core, "metadatagroup") => unprinted |= self.says_unprinted(inside)?,
                (Namespace::Named(what), _) => {
                    let at = child.at();
                    content.get_or_insert(Content::Components(Vec::new()));
                    self.diagnostics.not_shown(what, || at);
                }
                (Namespace::Undeclared, name) => return Err(undeclared(&child, name)),
                _ => {}
            }
        }
        Ok((content, unprinted))
    }

    /// True if metadata say that an object only changes how others are printed (Cura).
    fn says_unprinted(&mut self, level: Level) -> Result<bool, FormatError> {
        const MODIFIERS: [&str; 4] = ["anti_overhang_mesh", "infill_mesh", "cutting_mesh", "support_mesh"];
        let mut unprinted = false;
        while let Some(element) = self.xml.child(level)? {
            let name = element.get("name").unwrap_or_default();
            let is_it = MODIFIERS.contains(&name.rsplit(':').next().unwrap_or_default());
            let inside = element.inside;
            if element.name == "metadata" && is_it {
                unprinted |= self.xml.text(inside)?.eq_ignore_ascii_case("true");
            }
        }
        Ok(unprinted)
    }

    fn components(&mut self, level: Level) -> Result<Vec<Component>, FormatError> {
        let (mut components, file) = (Vec::new(), self.file.clone());
        while let Some(element) = self.xml.child(level)? {
            if !element.is("component") {
                continue;
            }
            let id = element.need_index("objectid")?;
            let object = Reference { part: part_of(&element, self.model, self.part)?, id };
            if object.part == self.part && !matches!(self.model.find(object), Some(Resource::Object(_))) {
                let message =
                    format!("this component is object {id}, but no object with this id comes before it");
                return Err(element.error(message));
            }
            self.reading.budget.take::<Component>(1, &file)?;
            components.push(Component { object, transform: element.transform()?, at: element.at() });
        }
        Ok(components)
    }
}

/// Purpose of an object, by its type.
fn role(element: &Element) -> Result<Role, FormatError> {
    Ok(match element.get("type") {
        None | Some("model" | "surface") => Role::Printed,
        Some("support" | "solidsupport") => Role::Support,
        Some("other") => Role::Other,
        Some(other) => {
            return Err(element.wrong("type", other, "model, support, solidsupport, surface or other"));
        }
    })
}
