//! XML, for the formats that are made of it: no document types and no entities of one's own, within the memory that is
//! left.

use crate::FormatError;
use crate::bytes::budget::Budget;
use crate::bytes::text::Places;
use bilux_scene::Span;
use roxmltree::{Document, Node, ParsingOptions};
use std::sync::Arc;

/// The most attributes of an element: each one is compared with those before it.
const MAX_ATTRIBUTES: usize = 1000;

/// Text to write within an attribute.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A file as a tree of elements.
pub struct Xml<'a> {
    document: Document<'a>,
    places: Places<'a>,
}

impl<'a> Xml<'a> {
    /// Parses a text. The tree is charged to the budget before it is made.
    pub fn parse(text: &'a str, name: &Arc<str>, budget: &mut Budget) -> Result<Xml<'a>, FormatError> {
        let places = Places::new(name, text.as_bytes());
        let (elements, attributes) = counted(text.as_bytes(), &places)?;
        // Each element may be followed by text; lists grow by doubling.
        const NODE: usize = 2 * 2 * 96;
        const ATTRIBUTE: usize = 2 * 80;
        budget.take_bytes((NODE * elements + ATTRIBUTE * attributes) as u64, name)?;
        let nodes_limit = u32::try_from(2 * elements + 2).unwrap_or(u32::MAX);
        let options = ParsingOptions { allow_dtd: false, nodes_limit, ..ParsingOptions::default() };
        let document = Document::parse_with_options(text, options).map_err(|error| {
            let pos = error.pos();
            let at = Span { file: name.clone(), line: pos.row, column: pos.col };
            let what = match error {
                roxmltree::Error::DtdDetected => "it has a document type (<!DOCTYPE …>), which is not read: \
                                                  remove it, and replace the entities that it declares"
                    .to_owned(),
                error => format!("this is not well-formed XML: {error}; export the file again"),
            };
            FormatError::malformed(what, at)
        })?;
        Ok(Xml { document, places })
    }

    /// The outermost element.
    pub fn root(&self) -> Node<'_, 'a> {
        self.document.root_element()
    }

    /// The file's name.
    pub fn file(&self) -> &str {
        self.places.file()
    }

    /// Place where an element begins.
    pub fn at(&self, node: Node) -> Span {
        self.places.at(node.range().start)
    }
}

/// The number of tags and attributes of a text; an error if one element has too many.
fn counted(text: &[u8], places: &Places) -> Result<(usize, usize), FormatError> {
    let (mut tags, mut attributes, mut pos) = (0, 0, 0);
    while let Some(next) = text[pos..].iter().position(|b| *b == b'<') {
        tags += 1;
        let start = pos + next;
        pos = start + 1;
        if matches!(text.get(pos), Some(b'!' | b'?' | b'/')) {
            continue;
        }
        let (mut quote, mut quotes) = (None, 0);
        while let Some(&byte) = text.get(pos) {
            pos += 1;
            match (quote, byte) {
                (None, b'>') => break,
                (None, b'"' | b'\'') => (quote, quotes) = (Some(byte), quotes + 1),
                (Some(open), byte) if open == byte => quote = None,
                _ => {}
            }
        }
        attributes += quotes;
        if quotes > MAX_ATTRIBUTES {
            let message = format!("an element has {quotes} attributes: {MAX_ATTRIBUTES} are the most");
            return Err(FormatError::malformed(message, places.at(start)));
        }
    }
    Ok((tags, attributes))
}
