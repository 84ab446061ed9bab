//! State that the directives of a file change.

use super::document::{Document, Piece};
use super::loader::Loader;
use super::shapes::ShapeCache;
use super::state::{Matrices, State};
use bilux_import::input::includes::Includes;
use bilux_scene::Span;
use std::collections::HashMap;

/// State of a file that is being read.
pub(super) struct Parser<'o, 'r> {
    /// Contents of the file so far.
    pub(super) document: Document,
    /// Graphics state that holds for the next directives.
    pub(super) graphics: Graphics,
    pub(super) shapes: ShapeCache,
    pub(super) loader: Loader<'o, 'r>,
    pub(super) includes: Includes,
}

/// The graphics state, and what it goes back to.
pub(super) struct Graphics {
    pub(super) state: State,
    pub(super) pushed: Vec<(Scope, Span, State)>,
    /// Named coordinate systems.
    pub(super) systems: HashMap<String, Matrices>,
    /// The object that is being defined.
    pub(super) object: Option<(String, Vec<Piece>)>,
}

/// The directive that pushed a graphics state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    Attribute,
    Transform,
    Object,
}

impl<'o, 'r> Parser<'o, 'r> {
    /// At the beginning of a file.
    pub(super) fn new(includes: Includes, loader: Loader<'o, 'r>) -> Parser<'o, 'r> {
        let (state, pushed, systems) = (State::new(), Vec::new(), HashMap::new());
        let graphics = Graphics { state, pushed, systems, object: None };
        let (document, shapes) = (Document::default(), ShapeCache::default());
        Parser { document, graphics, shapes, loader, includes }
    }
}
