//! Elements of the file, and the numbers in them.

use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_import::bytes::float::{parse_f32, parse_f64};
use bilux_import::bytes::text::quoted;
use bilux_import::bytes::xml::Xml;
use bilux_import::input::names::shortened;
use bilux_scene::Span;
use roxmltree::{Node, NodeId};

/// An element with its place in the file.
#[derive(Clone, Copy)]
pub(super) struct Element<'d> {
    node: Node<'d, 'd>,
    xml: &'d Xml<'d>,
}

/// A type of number that words of the file may stand for.
pub(super) trait Number: Copy {
    fn parse(word: &[u8]) -> Option<Self>;
}

impl Number for f32 {
    fn parse(word: &[u8]) -> Option<f32> {
        parse_f32(word)
    }
}

impl Number for f64 {
    fn parse(word: &[u8]) -> Option<f64> {
        parse_f64(word)
    }
}

impl Number for i32 {
    fn parse(word: &[u8]) -> Option<i32> {
        std::str::from_utf8(word).ok()?.parse().ok()
    }
}

impl<'d> Element<'d> {
    pub(super) fn root(xml: &'d Xml<'d>) -> Element<'d> {
        Element { node: xml.root(), xml }
    }

    /// Key that distinguishes the element from all others.
    pub(super) fn key(self) -> NodeId {
        self.node.id()
    }

    pub(super) fn name(self) -> &'d str {
        self.node.tag_name().name()
    }

    pub(super) fn attribute(self, name: &str) -> Option<&'d str> {
        self.node.attribute(name)
    }

    /// Name of the element, or else its id.
    pub(super) fn label(self) -> String {
        let name = self.attribute("name").filter(|name| !name.trim().is_empty());
        shortened(name.or_else(|| self.attribute("id")).unwrap_or_default())
    }

    fn of(self, node: Node<'d, 'd>) -> Element<'d> {
        Element { node, xml: self.xml }
    }

    pub(super) fn children(self) -> impl Iterator<Item = Element<'d>> {
        self.node.children().filter(Node::is_element).map(move |node| self.of(node))
    }

    pub(super) fn children_named<'n>(self, name: &'n str) -> impl Iterator<Item = Element<'d>> + use<'d, 'n> {
        self.children().filter(move |child| child.name() == name)
    }

    pub(super) fn child(self, name: &str) -> Option<Element<'d>> {
        self.children().find(|child| child.name() == name)
    }

    /// The child of a child, and so on.
    pub(super) fn path(self, names: &[&str]) -> Option<Element<'d>> {
        names.iter().try_fold(self, |element, name| element.child(name))
    }

    /// The element and all elements in it, in the order of the file.
    pub(super) fn descendants(self) -> impl Iterator<Item = Element<'d>> {
        self.node.descendants().filter(Node::is_element).map(move |node| self.of(node))
    }

    /// Text of the element, without blanks around it.
    pub(super) fn text(self) -> &'d str {
        self.node.text().unwrap_or_default().trim()
    }

    /// The words of its text, which comments may interrupt.
    pub(super) fn words(self) -> impl Iterator<Item = &'d str> {
        let texts = self.node.children().filter(Node::is_text).filter_map(|text| text.text());
        texts.flat_map(str::split_ascii_whitespace)
    }

    /// The numbers of its text.
    pub(super) fn numbers<T: Number>(self, budget: &mut Budget) -> Result<Vec<T>, FormatError> {
        let count = self.words().count();
        budget.take_bytes((count * size_of::<T>()) as u64, self.file())?;
        let mut numbers = Vec::with_capacity(count);
        for word in self.words() {
            let number = T::parse(word.as_bytes());
            numbers.push(number.ok_or_else(|| {
                let word = quoted(word.as_bytes());
                self.error(format!("<{}> has {word} where a number has to be", self.name()))
            })?);
        }
        Ok(numbers)
    }

    /// The file's name.
    pub(super) fn file(self) -> &'d str {
        self.xml.file()
    }

    pub(super) fn at(self) -> Span {
        self.xml.at(self.node)
    }

    pub(super) fn error(self, message: impl Into<String>) -> FormatError {
        FormatError::malformed(message, self.at())
    }
}
