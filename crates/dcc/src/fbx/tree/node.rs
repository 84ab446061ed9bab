//! A file as a tree of nodes.

use super::arrays::Number;
use super::records::{Encoding, Record};
use super::values::{Value, Values};
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::bytes::text::{Places, quoted};
use bilux_scene::Span;

/// All nodes of a file.
pub(in crate::fbx) struct Tree<'a> {
    /// The version of the format, such as 7400 for 7.4.
    pub(in crate::fbx) version: u32,
    pub(super) encoding: Encoding,
    /// Parents first, in the order of the file; the first one stands for the file.
    pub(super) records: Vec<Record<'a>>,
    pub(super) places: Places<'a>,
    pub(super) file: &'a str,
}

impl<'a> Tree<'a> {
    /// The node that stands for the file.
    pub(in crate::fbx) fn root(&self) -> Node<'_> {
        Node { tree: self, index: 0 }
    }

    /// The file as a place.
    pub(in crate::fbx) fn whole(&self) -> Span {
        self.places.whole()
    }
}

/// A node with its values and the nodes below it.
#[derive(Clone, Copy)]
pub(in crate::fbx) struct Node<'d> {
    tree: &'d Tree<'d>,
    index: u32,
}

impl<'d> Node<'d> {
    fn record(&self) -> &'d Record<'d> {
        &self.tree.records[self.index as usize]
    }

    pub(in crate::fbx) fn name(&self) -> &'d [u8] {
        self.record().name
    }

    /// The nodes directly below it.
    pub(in crate::fbx) fn children(&self) -> impl Iterator<Item = Node<'d>> + use<'d> {
        let (tree, end, mut next) = (self.tree, self.record().end, self.index + 1);
        std::iter::from_fn(move || {
            let child = (next < end).then_some(Node { tree, index: next })?;
            next = child.record().end;
            Some(child)
        })
    }

    /// The children with a name.
    pub(in crate::fbx) fn children_named<'n>(
        self,
        name: &'n str,
    ) -> impl Iterator<Item = Node<'d>> + use<'d, 'n> {
        self.children().filter(move |child| child.name() == name.as_bytes())
    }

    /// The first child with a name.
    pub(in crate::fbx) fn child(&self, name: &str) -> Option<Node<'d>> {
        self.children_named(name).next()
    }

    pub(in crate::fbx) fn values(&self) -> Values<'d> {
        Values::new(self.record().values, self.tree.encoding)
    }

    /// The value at an index.
    pub(in crate::fbx) fn value(&self, index: usize) -> Option<Value<'d>> {
        self.values().nth(index)
    }

    /// The first value of a node below it.
    pub(in crate::fbx) fn child_value(&self, name: &str) -> Option<Value<'d>> {
        self.child(name)?.value(0)
    }

    /// All of its values as numbers: an array, or a list.
    pub(in crate::fbx) fn numbers<T: Number>(&self, budget: &mut Budget) -> Result<Vec<T>, FormatError> {
        let count = self.most_numbers()?;
        budget.take_bytes((count * size_of::<T>()) as u64, self.file())?;
        let mut numbers = Vec::with_capacity(count);
        self.each_number(|some| numbers.extend_from_slice(some))?;
        Ok(numbers)
    }

    /// At least as many as it has numbers.
    pub(in crate::fbx) fn most_numbers(&self) -> Result<usize, FormatError> {
        match self.value(0) {
            Some(Value::Array(array)) => array.count().map_err(|message| self.error(message)),
            _ => Ok(self.listed().most()),
        }
    }

    /// Passes on its numbers, some of them at a time: whole tuples of up to four, but for the last.
    pub(in crate::fbx) fn each_number<T: Number>(
        &self,
        mut take: impl FnMut(&[T]),
    ) -> Result<(), FormatError> {
        /// A multiple of all widths of tuples.
        const SOME: usize = 12 * 64;
        if let Some(Value::Array(array)) = self.value(0) {
            return array.each(take).map_err(|message| self.error(message));
        }
        let mut numbers = Vec::with_capacity(SOME);
        for value in self.listed() {
            let number = value
                .number()
                .ok_or_else(|| self.error("there are numbers here, and among them something else"))?;
            numbers.push(T::of(number));
            if numbers.len() == SOME {
                take(&numbers);
                numbers.clear();
            }
        }
        take(&numbers);
        Ok(())
    }

    /// Values of the node; in text the numbers of an array are a node of their own.
    fn listed(&self) -> Values<'d> {
        match self.value(0) {
            Some(Value::Length) => self.child("a").map_or(self.values(), |list| list.values()),
            _ => self.values(),
        }
    }

    /// True in a binary file.
    pub(in crate::fbx) fn is_binary(&self) -> bool {
        self.tree.encoding != Encoding::Text
    }

    /// Place of the node: a line of a text, or the whole of a binary file.
    pub(in crate::fbx) fn at(&self) -> Span {
        match self.tree.encoding {
            Encoding::Text => self.tree.places.at(self.record().offset),
            Encoding::Binary { .. } => self.tree.whole(),
        }
    }

    pub(in crate::fbx) fn file(&self) -> &'d str {
        self.tree.file
    }

    /// An error here; in a binary file the message has the byte.
    pub(in crate::fbx) fn error(&self, message: impl AsRef<str>) -> FormatError {
        let record = self.record();
        let name = quoted(record.name);
        let message = match self.tree.encoding {
            Encoding::Text => format!("{name}: {}", message.as_ref()),
            Encoding::Binary { .. } => format!("byte {}, {name}: {}", record.offset, message.as_ref()),
        };
        FormatError::malformed(message, self.at())
    }
}
