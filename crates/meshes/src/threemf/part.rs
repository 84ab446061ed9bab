//! A part with a model: its resources, its build items and its metadata.

use super::model::{Item, Model, Reference, Resource};
use super::namespaces::{DRAFT, Namespace};
use super::package::resolved;
use super::xml::{Element, Level, Xml};
use bilux_import::FormatError;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;
use std::sync::Arc;

/// Reads a part into the model.
pub(super) struct PartReader<'a, 'o> {
    pub(super) reading: &'a mut Reading<'o>,
    pub(super) model: &'a mut Model,
    pub(super) diagnostics: &'a mut Diagnostics,
    pub(super) xml: Xml,
    /// The number of the part.
    pub(super) part: usize,
    /// Name of the part in messages.
    pub(super) file: Arc<str>,
}

/// Names of metadata that need no prefix. [3MF Core 1.3, 3.4.1]
const METADATA: [&str; 9] = [
    "Title",
    "Designer",
    "Description",
    "Copyright",
    "LicenseTerms",
    "Rating",
    "CreationDate",
    "ModificationDate",
    "Application",
];

impl PartReader<'_, '_> {
    /// Reads the whole part. Only the first part has metadata and items.
    pub(super) fn read(mut self) -> Result<(), FormatError> {
        let Some(root) = self.xml.child(Level::DOCUMENT)? else {
            let at = self.xml.here();
            return Err(FormatError::malformed("this part of the file is empty", at));
        };
        if !root.is("model") {
            let message = "this is no 3MF model: its root has to be 'model' of the core specification, 3dmanufacturing/core/2015/02";
            return Err(root.error(message));
        }
        check_extensions(&root)?;
        if root.get("xmlns") == Some(DRAFT) {
            let at = root.at();
            self.diagnostics.note("the model is of the draft of 2013: it is read as 3MF of today", || at);
        }
        let unit = unit(&root)?;
        if root.get("xml:space").is_some() {
            let at = root.at();
            self.diagnostics
                .note("the model says how to treat white space (xml:space), which 3MF forbids", || at);
        }
        let (level, at) = (root.inside, root.at());
        if self.part == 0 {
            self.model.unit = unit;
        } else if self.model.unit != unit {
            self.diagnostics.note(
                "a part of the file has another unit than the first; its numbers are taken as they are",
                || at.clone(),
            );
        }
        let (mut has_resources, mut has_build) = (false, false);
        while let Some(child) = self.xml.child(level)? {
            let inside = child.inside;
            match (child.namespace, child.name) {
                (Namespace::Core, "metadata") if self.part == 0 => self.metadata()?,
                (Namespace::Core, "resources") => {
                    has_resources = true;
                    self.resources(inside)?;
                }
                (Namespace::Core, "build") => {
                    has_build = true;
                    if self.part == 0 {
                        self.items(inside)?;
                    }
                }
                (Namespace::Undeclared, name) => return Err(undeclared(&child, name)),
                _ => {}
            }
        }
        for (is_there, name) in [(has_resources, "resources"), (has_build, "build")] {
            // The build of another part than the first is not used. [3MF Production 1.1]
            if !is_there && name == "build" && self.part != 0 {
                self.diagnostics.note("a part of the file has no element 'build'", || at.clone());
            } else if !is_there {
                let message =
                    format!("this model has no element '{name}': it was cut off, or its program is faulty");
                return Err(FormatError::malformed(message, at.clone()));
            }
        }
        if self.xml.child(Level::DOCUMENT)?.is_some() {
            let at = self.xml.here();
            return Err(FormatError::malformed("a second root element follows: a part has one model", at));
        }
        Ok(())
    }

    /// Reads the element of metadata that has just been opened.
    fn metadata(&mut self) -> Result<(), FormatError> {
        // The element is still in the buffer.
        let (name, inside, at) = match self.xml.current() {
            Some(element) => (element.words("name").into_owned(), element.inside, element.at()),
            None => return Ok(()),
        };
        let text = self.xml.text(inside)?;
        if !name.contains(':') && !METADATA.contains(&&*name) {
            self.diagnostics
                .remark("metadata without a prefix have names that the specification does not list", || {
                    at.clone()
                });
        }
        self.reading.budget.take_bytes(2 * name.len() as u64 + 64, &self.file)?;
        if name == "Application" {
            self.model.application = text.chars().take(100).collect();
        }
        if !self.model.metadata.insert(name) {
            self.diagnostics.note("two metadata have the same name", || at);
        }
        Ok(())
    }

    fn items(&mut self, level: Level) -> Result<(), FormatError> {
        let file = self.file.clone();
        while let Some(element) = self.xml.child(level)? {
            if !element.is("item") {
                continue;
            }
            let id = element.need_index("objectid")?;
            let object = Reference { part: part_of(&element, self.model, self.part)?, id };
            if object.part == self.part && self.model.find(object).is_none() {
                let message = format!("object {id} is to be built, but no object with this id comes before");
                return Err(element.error(message));
            }
            let printable =
                element.attributes().flatten().find(|(key, _)| key.rsplit(':').next() == Some("printable"));
            let is_printed = printable.is_none_or(|(_, value)| !matches!(value, "0" | "false"));
            self.reading.budget.take::<Item>(1, &file)?;
            let (transform, at) = (element.transform()?, element.at());
            self.model.items.push(Item { object, transform, is_printed, at });
        }
        Ok(())
    }

    /// The id of the element that has just been opened. Slicers read 0 too.
    pub(super) fn id(&mut self) -> Result<u32, FormatError> {
        let Some(element) = self.xml.current() else { return Ok(0) };
        let (id, at) = (element.need_index("id")?, element.at());
        if id == 0 {
            self.diagnostics.note("an id is 0: ids begin at 1", || at);
        }
        Ok(id)
    }

    /// Notes what a number of this part stands for.
    pub(super) fn register(
        reading: &mut Reading,
        model: &mut Model,
        element: &Element,
        part: usize,
        id: u32,
        resource: Resource,
    ) -> Result<(), FormatError> {
        reading.budget.take::<((usize, u32), Resource)>(2, "resources")?;
        match model.resources.insert((part, id), resource) {
            None => Ok(()),
            Some(_) => Err(element.error(format!("two resources have the id {id}: each needs its own"))),
        }
    }
}

/// The part that an item or a component refers to. Only the first part may refer to others, which ends all circles.
pub(super) fn part_of(element: &Element, model: &mut Model, part: usize) -> Result<usize, FormatError> {
    let Some(path) = element.of(Namespace::Production, "path") else { return Ok(part) };
    if part != 0 {
        return Err(element.error("only the main part of a file can refer to objects of other parts"));
    }
    let path = resolved("", &super::attributes::unescaped(path));
    let known = model.parts.iter().position(|known| known.eq_ignore_ascii_case(&path));
    Ok(known.unwrap_or_else(|| {
        model.parts.push(path);
        model.parts.len() - 1
    }))
}

/// The error for an element whose prefix is not declared.
pub(super) fn undeclared(element: &Element, name: &str) -> FormatError {
    element.error(format!("the prefix of '{name}' is not declared: this is no XML with namespaces"))
}

/// Refuses files that require an extension that is not supported, by its name.
fn check_extensions(root: &Element) -> Result<(), FormatError> {
    for prefix in root.get("requiredextensions").unwrap_or_default().split_ascii_whitespace() {
        let namespace = root.namespace_of(prefix);
        if namespace.is_supported() {
            continue;
        }
        let declaration = format!("xmlns:{prefix}");
        let message = match (namespace, root.get(&declaration)) {
            (Namespace::Named(what), _) => {
                format!(
                    "this file requires the extension for {what}, which is not supported: export it as plain meshes"
                )
            }
            (_, Some(address)) => format!(
                "this file requires the extension '{address}', which is not supported: export it as plain meshes"
            ),
            (_, None) => {
                format!("this file requires the extension '{prefix}', but does not declare this prefix")
            }
        };
        return Err(root.error(message));
    }
    Ok(())
}

/// Metres per unit. [3MF Core 1.3, 3.2]
fn unit(root: &Element) -> Result<f64, FormatError> {
    Ok(match root.get("unit") {
        None | Some("millimeter") => 0.001,
        Some("micron") => 1e-6,
        Some("centimeter") => 0.01,
        Some("inch") => 0.0254,
        Some("foot") => 0.3048,
        Some("meter") => 1.0,
        Some(other) => {
            let wanted = "micron, millimeter, centimeter, inch, foot or meter";
            return Err(root.wrong("unit", other, wanted));
        }
    })
}
