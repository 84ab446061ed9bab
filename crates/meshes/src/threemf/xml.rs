//! A stream of XML elements: no tree is built, and nothing is kept of what has been read.

use super::attributes::Attributes;
use super::namespaces::{Namespace, Scopes};
use bilux_import::FormatError;
use bilux_import::bytes::text::quoted;
use bilux_scene::Span;
use quick_xml::events::Event;
use quick_xml::{Error, Reader};
use std::io::{self, BufRead, BufReader, Read};
use std::sync::Arc;

/// Elements that are nested deeper than this are refused.
const MAX_DEPTH: usize = 256;
/// Longer elements, comments and texts are refused.
const LONGEST: u64 = 16 << 20;
/// The bytes that are decompressed at a time.
const BLOCK: usize = 1 << 16;

/// The elements of a document, one after the other.
pub(super) struct Xml {
    reader: Reader<Counted>,
    buffer: Vec<u8>,
    file: Arc<str>,
    scopes: Scopes,
    depth: usize,
    current: Current,
}

/// State of an element that its bytes in the buffer do not give.
#[derive(Clone, Copy, Default)]
struct Current {
    is_empty: bool,
    line: u32,
    column: u32,
}

/// An element that has just been opened.
pub(super) struct Element<'x> {
    pub(super) namespace: Namespace,
    /// Name of the element without a prefix.
    pub(super) name: &'x str,
    /// Level of the element's contents.
    pub(super) inside: Level,
    /// The text between its name and its end.
    raw: &'x str,
    scopes: &'x Scopes,
    file: &'x Arc<str>,
    line: u32,
    column: u32,
}

/// The depth of an element's children; of an element without content, a depth that does not occur.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Level(usize);

impl Level {
    /// The document itself, which contains its root.
    pub(super) const DOCUMENT: Level = Level(0);
    const NOTHING: Level = Level(usize::MAX);
}

impl Xml {
    /// The document of a stream; `file` is its name in messages.
    pub(super) fn new(from: Box<dyn Read>, file: Arc<str>) -> Xml {
        let counted = Counted::new(BufReader::with_capacity(BLOCK, from));
        let mut reader = Reader::from_reader(counted);
        reader.config_mut().trim_text(true);
        Xml {
            reader,
            buffer: Vec::new(),
            file,
            scopes: Scopes::default(),
            depth: 0,
            current: Current::default(),
        }
    }

    /// The place that has been read up to.
    pub(super) fn here(&mut self) -> Span {
        let (line, column) = self.reader.get_mut().place();
        Span { file: self.file.clone(), line, column }
    }

    /// The next element at a level, or `None` at its end. What is inside of others is skipped.
    pub(super) fn child(&mut self, level: Level) -> Result<Option<Element<'_>>, FormatError> {
        if level == Level::NOTHING {
            return Ok(None);
        }
        loop {
            self.buffer.clear();
            self.reader.get_mut().begin_token();
            // What an event borrows is looked up again below: the compiler cannot return it out of a loop.
            let (is_open, is_empty) = match self.reader.read_event_into(&mut self.buffer) {
                Ok(Event::Start(_)) => (true, false),
                Ok(Event::Empty(_)) => (true, true),
                Ok(Event::End(_)) => (false, false),
                Ok(Event::Eof) if self.depth == 0 => return Ok(None),
                Ok(Event::Eof) => return Err(self.damaged("it ends within an element: it was cut off")),
                Ok(Event::DocType(_)) => {
                    return Err(self.damaged("it declares its own grammar (DOCTYPE), which 3MF forbids"));
                }
                Ok(Event::Decl(declaration)) => {
                    let is_known = match declaration.encoding() {
                        None => true,
                        Some(Ok(name)) => ["utf-8", "utf-16"].contains(&&*name.to_lowercase()),
                        Some(Err(_)) => false,
                    };
                    if !is_known {
                        return Err(self.damaged("its encoding is neither UTF-8 nor UTF-16"));
                    }
                    continue;
                }
                Ok(_) => continue,
                Err(error) => return Err(self.failed(&error)),
            };
            if !is_open {
                self.depth -= 1;
                self.scopes.close(self.depth);
                if self.depth < level.0 {
                    return Ok(None);
                }
                continue;
            }
            let is_child = self.depth == level.0;
            if self.depth >= MAX_DEPTH {
                return Err(
                    self.damaged(&format!("its elements are nested more than {MAX_DEPTH} levels deep"))
                );
            }
            self.depth += usize::from(!is_empty);
            if is_child {
                return Ok(self.opened(is_empty));
            }
        }
    }

    /// Lets `take` read elements without content at a level, from bytes that need not hold the last one as a whole; it returns the
    /// length of those that it has read. The next [`Xml::child`] is what follows.
    pub(super) fn skim(
        &mut self,
        level: Level,
        take: impl FnOnce(&[u8]) -> usize,
    ) -> Result<(), FormatError> {
        if self.depth != level.0 || self.depth >= MAX_DEPTH {
            return Ok(());
        }
        let counted = self.reader.get_mut();
        counted.begin_token();
        let length = match counted.fill_buf() {
            Ok(bytes) => take(bytes),
            Err(error) => return Err(self.damaged(&error.to_string())),
        };
        self.reader.get_mut().consume(length);
        Ok(())
    }

    /// Takes the element in the buffer as the current one.
    fn opened(&mut self, is_empty: bool) -> Option<Element<'_>> {
        let (line, column) = self.reader.get_mut().place();
        // The element has been read already, and may be several lines long.
        let lines = self.buffer.iter().filter(|&&byte| byte == b'\n').count() as u32;
        let column = if lines > 0 { 1 } else { column.saturating_sub(self.buffer.len() as u32).max(1) };
        self.current = Current { is_empty, line: line.saturating_sub(lines), column };
        // Those without number are many, and declare nothing.
        let is_one_of_many = self.buffer.starts_with(b"<vertex ") || self.buffer.starts_with(b"<triangle ");
        if !is_one_of_many {
            let text = std::str::from_utf8(&self.buffer).unwrap_or_default();
            if text.contains("xmlns") {
                let raw = text.split_once(|c: char| c.is_ascii_whitespace()).map_or("", |(_, raw)| raw);
                self.scopes.open(self.depth - usize::from(!is_empty), Attributes::of(raw));
            }
        }
        self.current()
    }

    /// The element that was opened last, until the next is asked for.
    pub(super) fn current(&self) -> Option<Element<'_>> {
        let Current { is_empty, line, column } = self.current;
        let bytes = self.buffer.strip_prefix(b"<")?.strip_suffix(b">")?;
        let bytes = if is_empty { bytes.strip_suffix(b"/")? } else { bytes };
        // The parser has checked that it is UTF-8.
        let text = std::str::from_utf8(bytes).ok()?;
        let end = bytes.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
        let (whole, raw) = text.split_at(end);
        let (prefix, name) = whole.split_once(':').unwrap_or(("", whole));
        Some(Element {
            namespace: self.scopes.of_element(prefix),
            name,
            inside: if is_empty { Level::NOTHING } else { Level(self.depth) },
            raw,
            scopes: &self.scopes,
            file: &self.file,
            line,
            column,
        })
    }

    /// The text at a level, up to its end. Elements in it are left out.
    pub(super) fn text(&mut self, level: Level) -> Result<String, FormatError> {
        if level == Level::NOTHING {
            return Ok(String::new());
        }
        // Spaces beside references count here.
        self.reader.config_mut().trim_text(false);
        let text = self.text_with_spaces(level);
        self.reader.config_mut().trim_text(true);
        text.map(|text| text.trim().to_owned())
    }

    fn text_with_spaces(&mut self, level: Level) -> Result<String, FormatError> {
        let mut text = String::new();
        loop {
            self.buffer.clear();
            self.reader.get_mut().begin_token();
            match self.reader.read_event_into(&mut self.buffer) {
                Ok(Event::Text(part)) => text.push_str(&part.xml10_content()),
                Ok(Event::CData(part)) => text.push_str(&part.xml10_content()),
                Ok(Event::GeneralRef(part)) => {
                    let named = quick_xml::escape::resolve_predefined_entity(&part).map(str::to_owned);
                    let by_number = part.resolve_char_ref().ok().flatten().map(String::from);
                    text.push_str(&by_number.or(named).unwrap_or_default());
                }
                Ok(Event::Start(_)) => self.depth += 1,
                Ok(Event::End(_)) => {
                    self.depth -= 1;
                    self.scopes.close(self.depth);
                    if self.depth < level.0 {
                        return Ok(text);
                    }
                }
                Ok(Event::Eof) => return Err(self.damaged("it ends within an element: it was cut off")),
                Ok(_) => {}
                Err(error) => return Err(self.failed(&error)),
            }
            if text.len() as u64 > LONGEST || self.depth > MAX_DEPTH {
                return Err(self.damaged("a text in it is too long, or nested too deep"));
            }
        }
    }

    /// The error of the parser in plain words.
    fn failed(&mut self, error: &Error) -> FormatError {
        let why = match error {
            Error::Io(error) => return self.damaged(&error.to_string()),
            Error::Encoding(_) => "it is not UTF-8",
            Error::IllFormed(_) => "its elements do not end in the order in which they began",
            Error::Syntax(_) => "an element, a comment or a text in it does not end",
            _ => "it is no XML",
        };
        self.damaged(why)
    }

    fn damaged(&mut self, why: &str) -> FormatError {
        let at = self.here();
        FormatError::malformed(format!("this XML cannot be read: {why}"), at)
    }
}

impl<'x> Element<'x> {
    pub(super) fn at(&self) -> Span {
        Span { file: self.file.clone(), line: self.line, column: self.column }
    }

    pub(super) fn error(&self, message: impl AsRef<str>) -> FormatError {
        FormatError::malformed(message.as_ref(), self.at())
    }

    /// True for an element of this name in the core specification.
    pub(super) fn is(&self, name: &str) -> bool {
        self.namespace == Namespace::Core && self.name == name
    }

    pub(super) fn attributes(&self) -> Attributes<'x> {
        Attributes::of(self.raw)
    }

    /// The error for attributes that are no XML.
    pub(super) fn no_attributes(&self) -> FormatError {
        self.error(format!("the attributes of '{}' are damaged: {}", self.name, quoted(self.raw.as_bytes())))
    }

    /// The value of an attribute without a prefix, as written.
    pub(super) fn get(&self, name: &str) -> Option<&'x str> {
        self.attributes().flatten().find(|(key, _)| *key == name).map(|(_, value)| value)
    }

    /// The value of an attribute of an extension, as written.
    pub(super) fn of(&self, namespace: Namespace, name: &str) -> Option<&'x str> {
        let is_it = |key: &str| {
            let (prefix, own) = key.split_once(':')?;
            (own == name && self.scopes.of_prefix(prefix) == namespace).then_some(())
        };
        self.attributes().flatten().find(|(key, _)| is_it(key).is_some()).map(|(_, value)| value)
    }

    /// The namespace of an attribute's prefix.
    pub(super) fn namespace_of(&self, prefix: &str) -> Namespace {
        self.scopes.of_prefix(prefix)
    }

    pub(super) fn need(&self, name: &str) -> Result<&'x str, FormatError> {
        self.get(name).ok_or_else(|| self.error(format!("'{}' lacks its attribute '{name}'", self.name)))
    }
}

/// A reader that counts lines, and refuses tokens that are too long.
struct Counted {
    from: BufReader<Box<dyn Read>>,
    /// Bytes consumed so far, and where the current line and token begin.
    offset: u64,
    line_start: u64,
    token_start: u64,
    line: u32,
}

impl Counted {
    fn new(from: BufReader<Box<dyn Read>>) -> Counted {
        Counted { from, offset: 0, line_start: 0, token_start: 0, line: 1 }
    }

    fn begin_token(&mut self) {
        self.token_start = self.offset;
    }

    fn place(&self) -> (u32, u32) {
        (self.line, u32::try_from(self.offset - self.line_start + 1).unwrap_or(u32::MAX))
    }
}

impl Read for Counted {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let mut have = self.fill_buf()?;
        let count = have.read(into)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Counted {
    #[inline]
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.offset - self.token_start > LONGEST {
            return Err(io::Error::other(format!("an element or a text is longer than {LONGEST} bytes")));
        }
        self.from.fill_buf()
    }

    #[inline]
    fn consume(&mut self, count: usize) {
        let consumed = &self.from.buffer()[..count];
        // In pieces whose sums fit a byte, many are counted at once.
        let in_piece = |piece: &[u8]| piece.iter().map(|&byte| u8::from(byte == b'\n')).sum::<u8>();
        let lines: usize = consumed.chunks(255).map(|piece| usize::from(in_piece(piece))).sum();
        if lines > 0 {
            self.line = self.line.saturating_add(lines as u32);
            let last = consumed.iter().rposition(|&byte| byte == b'\n').unwrap_or(0);
            self.line_start = self.offset + last as u64 + 1;
        }
        self.offset += count as u64;
        self.from.consume(count);
    }
}
