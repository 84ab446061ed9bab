//! A document as it is at one time.

use super::document::{Animated, Document, Index, Properties};
use std::collections::HashMap;

/// A document with the values that its animation gives to properties.
pub(super) struct Posed<'d> {
    pub(super) document: &'d Document<'d>,
    animated: HashMap<Index, Animated<'d>>,
}

impl<'d> Posed<'d> {
    /// The document without animation.
    pub(super) fn still(document: &'d Document<'d>) -> Posed<'d> {
        Posed { document, animated: HashMap::new() }
    }

    /// The properties of an object at this time.
    pub(super) fn properties(&self, index: Index) -> Properties<'d, '_> {
        self.document.properties(index).animated(self.animated.get(&index))
    }
}
