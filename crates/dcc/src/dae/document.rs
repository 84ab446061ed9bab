//! The file as a tree of elements that refer to each other by their ids.

use super::element::Element;
use super::settings::Settings;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::bytes::spellings::percent_decoded;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Source;
use std::collections::HashMap;
use std::path::Path;

/// All elements of a file.
pub(super) struct Document<'d> {
    pub(super) root: Element<'d>,
    pub(super) settings: Settings,
    /// The folder of the file.
    pub(super) folder: Option<&'d Path>,
    ids: HashMap<&'d str, Element<'d>>,
}

impl<'d> Document<'d> {
    pub(super) fn load(
        root: Element<'d>,
        source: &Source<'d>,
        budget: &mut Budget,
        diagnostics: &mut Diagnostics,
    ) -> Result<Document<'d>, FormatError> {
        if root.name() != "COLLADA" {
            let name = bilux_import::input::names::shortened(root.name());
            return Err(root.error(format!("a Collada file begins with <COLLADA>, not <{name}>")));
        }
        let mut ids = HashMap::new();
        for element in root.descendants() {
            let Some(id) = element.attribute("id") else { continue };
            budget.take::<(&str, Element)>(1, source.name)?;
            ids.entry(id).or_insert(element);
        }
        let settings = Settings::read(root, diagnostics);
        Ok(Document { root, settings, folder: source.folder, ids })
    }

    /// The element with an id.
    pub(super) fn with_id(&self, id: &str) -> Option<Element<'d>> {
        self.ids.get(id).copied()
    }

    /// The element that a URI refers to, if it is in this file. Some exporters leave the `#` out.
    pub(super) fn target(&self, uri: &str) -> Option<Element<'d>> {
        let id = uri.trim().trim_start_matches('#');
        let decoded = || std::str::from_utf8(&percent_decoded(id)).ok().and_then(|id| self.with_id(id));
        self.with_id(id).or_else(decoded)
    }

    /// The element that another one refers to; notes if there is none.
    pub(super) fn referred(
        &self,
        from: Element<'d>,
        attribute: &str,
        diagnostics: &mut Diagnostics,
    ) -> Option<Element<'d>> {
        let uri = from.attribute(attribute).unwrap_or_default();
        let found = self.target(uri);
        if found.is_none() {
            let is_elsewhere = uri.find('#').is_some_and(|at| at > 0);
            let what = if is_elsewhere {
                format!("what <{}> refers to is in another file, which is not read", from.name())
            } else {
                format!("what <{}> refers to does not exist", from.name())
            };
            diagnostics.note(&what, || from.at());
        }
        found
    }

    /// All elements of libraries, such as those of `library_animations`.
    pub(super) fn library(&self, name: &str) -> impl Iterator<Item = Element<'d>> {
        self.root.children_named(name).flat_map(Element::children)
    }
}
