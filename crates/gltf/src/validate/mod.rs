//! Validates every part of a file against the specification, whether or not it is shown.
//!
//! Tables describe the properties of objects ([`core_kinds`], [`material_kinds`], [`extension_kinds`]); rules
//! check how objects fit together ([`rules`]). Faults are reported as warnings, since most programs show such
//! files nevertheless.
//!
//! It stands beside the reader and knows only what both look at: the document, and how accessors and images are stored.

mod accessors;
mod animations;
mod attributes;
mod buffers;
mod core_kinds;
mod extension_kinds;
mod images;
mod material_kinds;
mod materials;
mod meshes;
mod nodes;
mod root;
mod rules;
mod schema;
mod skins;
mod vertices;
mod walk;

use crate::document::accessor::Accessor;
use crate::document::json::JsonNode;
use crate::document::json_document::Document;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::input::diagnostics::Diagnostics;
pub(crate) use images::compare as image;
use std::collections::{HashMap, HashSet};

/// The state of a validation.
struct Check<'d, 'a> {
    document: &'d Document<'d>,
    root: JsonNode<'d>,
    budget: &'a mut Budget,
    diagnostics: &'a mut Diagnostics,
    /// The list and the index of every item that is referenced.
    used: HashSet<(&'d str, usize)>,
    /// Extensions that are allowed on any object.
    extensions: HashSet<&'d str>,
    /// The use of each buffer view.
    roles: HashMap<usize, Role>,
    /// The vertex attributes' accessors in each buffer view.
    attributes_in: HashMap<usize, HashSet<usize>>,
}

/// True if a deviation exceeds the tolerance or is NaN.
fn is_off(deviation: f32, tolerance: f32) -> bool {
    deviation.is_nan() || deviation.abs() > tolerance
}

/// The kind of data in a buffer view.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Role {
    Vertices,
    Indices,
    Image,
    InverseBindMatrices,
    Animation,
    Sparse,
}

impl Role {
    fn words(self) -> &'static str {
        match self {
            Role::Vertices => "vertex attributes",
            Role::Indices => "indices",
            Role::Image => "an image",
            Role::InverseBindMatrices => "inverse bind matrices",
            Role::Animation => "keyframes",
            Role::Sparse => "sparse elements",
        }
    }
}

/// Reports every fault of a document as a warning, except for those of the bytes of images ([`image`]).
pub(crate) fn document(document: &Document, budget: &mut Budget, diagnostics: &mut Diagnostics) {
    let mut check = Check {
        document,
        root: document.root,
        budget,
        diagnostics,
        used: HashSet::new(),
        extensions: HashSet::new(),
        roles: HashMap::new(),
        attributes_in: HashMap::new(),
    };
    check.object(check.root, &core_kinds::ROOT);
}

impl<'d> Check<'d, '_> {
    /// Reports a fault at a node.
    fn report(&mut self, at: JsonNode<'d>, message: impl AsRef<str>) {
        self.diagnostics.note(message.as_ref(), || at.at());
    }

    /// Reports something at a node that has no effect on the picture.
    fn remark(&mut self, at: JsonNode<'d>, message: &str) {
        self.diagnostics.remark(message, || at.at());
    }

    /// Reports a fault at a property, or at the object if it has no such property.
    fn report_key(&mut self, at: JsonNode<'d>, key: &'d str, message: impl AsRef<str>) {
        self.report(at.get(key).unwrap_or(at), message);
    }

    /// The item that the index under `key` refers to; `None` if it is invalid, which the walk reports.
    fn named(&self, list: &'static str, node: JsonNode<'d>, key: &'d str) -> Option<(usize, JsonNode<'d>)> {
        let index = whole(node, key)?;
        Some((index, self.root.item(list, index)?))
    }

    /// The items of a list of the document.
    fn list(&self, list: &'static str) -> Vec<JsonNode<'d>> {
        self.root.get(list).map(|list| list.children().collect()).unwrap_or_default()
    }

    /// The numbers of an accessor; `None` if they cannot be read, which is reported elsewhere.
    fn numbers(&mut self, index: usize) -> Option<Vec<f32>> {
        let node = self.root.item("accessors", index)?;
        let spent = self.budget.spent();
        let numbers = Accessor::open(self.document, index, node, self.budget)
            .and_then(|accessor| accessor.numbers(self.budget));
        self.budget.release(self.budget.spent() - spent);
        self.unless_too_large(node, numbers)
    }

    /// The indices of an accessor; `None` likewise.
    fn indices(&mut self, index: usize) -> Option<Vec<u32>> {
        let node = self.root.item("accessors", index)?;
        let spent = self.budget.spent();
        let indices = Accessor::open(self.document, index, node, self.budget)
            .and_then(|accessor| accessor.indices(self.budget));
        self.budget.release(self.budget.spent() - spent);
        self.unless_too_large(node, indices)
    }

    fn unless_too_large<T>(&mut self, node: JsonNode<'d>, read: Result<T, FormatError>) -> Option<T> {
        if let Err(FormatError::TooLarge { .. }) = &read {
            self.report(node, "these data were not checked because that needs more memory than is allowed");
        }
        read.ok()
    }

    /// Records the use of a buffer view, and reports a second use that conflicts with the first.
    fn assign_role(&mut self, user: JsonNode<'d>, accessor: JsonNode<'d>, role: Role) {
        let Some((index, view)) = self.named("bufferViews", accessor, "bufferView") else { return };
        let before = *self.roles.entry(index).or_insert(role);
        let target = whole(view, "target");
        let targeted = match target {
            Some(34962) => Some(Role::Vertices),
            Some(34963) => Some(Role::Indices),
            _ => None,
        };
        let other = Some(before).filter(|&other| other != role).or(targeted.filter(|&other| other != role));
        if let Some(other) = other {
            let (these, those) = (role.words(), other.words());
            self.report(
                user,
                format!(
                    "its buffer view is for {those} and holds {these}: give each a buffer view of its own"
                ),
            );
        }
        if role != Role::Vertices && view.get("byteStride").is_some() {
            let what = role.words();
            self.report(
                view,
                format!("byteStride is for vertex attributes, but this buffer view holds {what}: remove it"),
            );
        }
    }
}

/// A whole number under a key; `None` if there is none.
fn whole(node: JsonNode, key: &str) -> Option<usize> {
    let value = node.value().get(key)?;
    value.as_u64().or_else(|| whole_float(value)).and_then(|x| usize::try_from(x).ok())
}

/// `3.0` counts as 3, as the specification allows.
fn whole_float(value: &serde_json::Value) -> Option<u64> {
    value.as_f64().filter(|x| x.fract() == 0.0 && (0.0..9e15).contains(x)).map(|x| x as u64)
}

fn number(node: JsonNode, key: &str) -> Option<f64> {
    node.value().get(key)?.as_f64()
}

fn text<'d>(node: JsonNode<'d>, key: &str) -> Option<&'d str> {
    node.value().get(key)?.as_str()
}

fn floats(node: JsonNode, key: &str) -> Option<Vec<f64>> {
    node.value().get(key)?.as_array()?.iter().map(serde_json::Value::as_f64).collect()
}

/// A count with its noun: `1 node`, `2 nodes`.
fn counted(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}
