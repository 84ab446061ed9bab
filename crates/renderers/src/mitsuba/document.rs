//! Descriptions that the elements of a file give, before anything is made of them.

use super::plugin::{Plugin, Property, Value};
use bilux_import::FormatError;
use bilux_import::input::names::unknown;
use bilux_import::input::reading::Reading;
use bilux_scene::Span;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

/// Everything that the files describe. Ids may be used before the file gives them.
#[derive(Default)]
pub(super) struct Document {
    /// The parts of the scene, in order.
    pub(super) parts: Vec<Rc<Plugin>>,
    /// All objects with an id, and other names for them.
    pub(super) ids: HashMap<Arc<str>, Rc<Plugin>>,
    pub(super) files: Files,
}

impl Document {
    /// The object that a property holds or refers to; `None` for other values.
    pub(super) fn part(&self, property: &Property) -> Result<Option<Rc<Plugin>>, FormatError> {
        match &property.value {
            Value::Object(object) => Ok(Some(object.clone())),
            Value::Reference(id) => match self.ids.get(id) {
                Some(object) => Ok(Some(object.clone())),
                None => Err(unknown("id", id, self.ids.keys().map(|id| &**id), &property.at)),
            },
            _ => Ok(None),
        }
    }

    /// The parts of a plugin that are elements of this kind, each with its name.
    pub(super) fn parts_of(
        &self,
        plugin: &Plugin,
        tag: &str,
    ) -> Result<Vec<(String, Rc<Plugin>)>, FormatError> {
        let mut found = Vec::new();
        for property in &plugin.properties {
            if let Some(part) = self.part(property)?.filter(|part| part.tag == tag) {
                property.used.set(true);
                found.push((property.name.clone(), part));
            }
        }
        Ok(found)
    }

    /// The first of them.
    pub(super) fn part_of(&self, plugin: &Plugin, tag: &str) -> Result<Option<Rc<Plugin>>, FormatError> {
        Ok(self.parts_of(plugin, tag)?.into_iter().next().map(|(_, part)| part))
    }

    /// The first plugin of this type within a material.
    pub(super) fn within(
        &self,
        material: &Rc<Plugin>,
        kind: &str,
    ) -> Result<Option<Rc<Plugin>>, FormatError> {
        let (mut seen, mut open) = (HashSet::new(), vec![material.clone()]);
        while let Some(plugin) = open.pop() {
            if plugin.kind == kind {
                return Ok(Some(plugin));
            }
            // They may refer to themselves.
            if seen.insert(Rc::as_ptr(&plugin)) {
                for property in plugin.properties.iter().rev() {
                    open.extend(self.part(property)?);
                }
            }
        }
        Ok(None)
    }

    /// The name of the attribute of vertices or faces that a material has as a colour.
    pub(super) fn attribute(&self, material: &Rc<Plugin>) -> Result<Option<String>, FormatError> {
        Ok(match self.within(material, "mesh_attribute")? {
            Some(texture) => texture.text("name")?.map(str::to_owned),
            None => None,
        })
    }
}

/// Folders of the files that a scene names.
#[derive(Default)]
pub(super) struct Files {
    /// The folder of the first file.
    pub(super) folder: Option<PathBuf>,
    /// More folders, relative to it, the last of which is looked in first.
    pub(super) paths: Vec<String>,
}

impl Files {
    /// The file with this name, and the name under which the folder of the scene has it.
    pub(super) fn locate(
        &self,
        name: &str,
        at: &Span,
        reading: &Reading,
    ) -> Result<(PathBuf, String), FormatError> {
        for path in self.paths.iter().rev() {
            let joined = Path::new(path).join(name).to_string_lossy().into_owned();
            if let Ok(found) = reading.locator.locate(self.folder.as_deref(), &joined, at) {
                return Ok((found, joined));
            }
        }
        let found = reading.locator.locate(self.folder.as_deref(), name, at);
        // What an included file names may lie beside that file.
        let beside = Path::new(&*at.file).parent().filter(|_| found.is_err() && self.folder.is_some());
        if let Some(Ok(path)) = beside.map(|folder| reading.locator.locate(Some(folder), name, at)) {
            let name = path.display().to_string();
            return Ok((path, name));
        }
        Ok((found?, name.to_owned()))
    }
}
