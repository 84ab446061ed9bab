//! Lines and words of a text file with their locations. Lines end at CR, LF or both.

use crate::FormatError;
use bilux_scene::Span;
use std::borrow::Cow;
use std::cell::Cell;
use std::sync::Arc;

/// The byte order mark of UTF-8.
const UTF8_MARK: &[u8] = b"\xef\xbb\xbf";

/// The encodings in which text comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TextEncoding {
    /// UTF-8, or any other in which ASCII characters are single bytes.
    Bytes,
    /// UTF-16 in either byte order.
    Utf16 { big: bool },
}

/// A text without the byte order mark of UTF-8.
pub fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(UTF8_MARK).unwrap_or(bytes)
}

/// The encoding of a text and the length of its byte order mark.
///
/// Without a mark, two ASCII characters with zeros between them show UTF-16, as readers of JSON tell it.
fn encoding(bytes: &[u8]) -> (TextEncoding, usize) {
    let ascii = |byte: u8| byte.is_ascii_graphic() || byte.is_ascii_whitespace();
    match bytes {
        [0xff, 0xfe, ..] => (TextEncoding::Utf16 { big: false }, 2),
        [0xfe, 0xff, ..] => (TextEncoding::Utf16 { big: true }, 2),
        [a, 0, b, 0, ..] if ascii(*a) && ascii(*b) => (TextEncoding::Utf16 { big: false }, 0),
        [0, a, 0, b, ..] if ascii(*a) && ascii(*b) => (TextEncoding::Utf16 { big: true }, 0),
        bytes if bytes.starts_with(UTF8_MARK) => (TextEncoding::Bytes, UTF8_MARK.len()),
        _ => (TextEncoding::Bytes, 0),
    }
}

/// True if [`plain`] changes the text.
pub fn is_marked(bytes: &[u8]) -> bool {
    encoding(bytes) != (TextEncoding::Bytes, 0)
}

/// A text without its byte order mark, and as UTF-8 if it is UTF-16. Every reader of text gets its bytes through this.
pub fn plain(bytes: &[u8]) -> Cow<'_, [u8]> {
    let (encoding, mark) = encoding(bytes);
    let text = &bytes[mark..];
    let TextEncoding::Utf16 { big } = encoding else { return Cow::Borrowed(text) };
    let units = text.as_chunks::<2>().0.iter();
    let units = units.map(|unit| if big { u16::from_be_bytes(*unit) } else { u16::from_le_bytes(*unit) });
    let letters = char::decode_utf16(units).map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER));
    Cow::Owned(letters.collect::<String>().into_bytes())
}

/// An upper bound on the bytes that [`plain`] allocates.
pub fn plain_size(bytes: &[u8]) -> u64 {
    // A character of two bytes takes at most three in UTF-8; a growing string may be half empty.
    if matches!(encoding(bytes).0, TextEncoding::Utf16 { .. }) { 3 * bytes.len() as u64 } else { 0 }
}

/// A text without the zeros and the end-of-file character that some programs append.
pub fn without_padding(bytes: &[u8]) -> &[u8] {
    let end = bytes.iter().rposition(|&b| !matches!(b, 0 | END_OF_FILE)).map_or(0, |last| last + 1);
    &bytes[..end]
}

/// Iterates over a text word by word and line by line.
#[derive(Clone, Debug)]
pub struct Cursor<'a> {
    bytes: &'a [u8],
    pos: usize,
    /// The number of lines passed, and the start of the current line.
    line: (u32, usize),
    /// True if a backslash at the end of a line continues it.
    joins_lines: bool,
}

/// A line and a column in a file, from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TextPosition {
    pub line: u32,
    pub column: u32,
}

impl TextPosition {
    pub fn of_key(key: u64) -> TextPosition {
        TextPosition { line: (key >> 32) as u32, column: key as u32 }
    }

    /// Both numbers in one, in reading order.
    pub fn key(self) -> u64 {
        u64::from(self.line) << 32 | u64::from(self.column)
    }

    /// The position after this many more lines.
    pub fn after(self, lines: u32) -> TextPosition {
        TextPosition { line: self.line.saturating_add(lines), ..self }
    }

    pub fn in_file(self, file: &Arc<str>) -> Span {
        Span { file: file.clone(), line: self.line, column: self.column }
    }
}

/// The character with which some programs end a text, as CP/M did.
const END_OF_FILE: u8 = 0x1a;

const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | 0x0b | 0x0c | 0 | END_OF_FILE)
}

const fn is_newline(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

impl<'a> Cursor<'a> {
    pub fn new(bytes: &'a [u8]) -> Cursor<'a> {
        Cursor { bytes, pos: 0, line: (0, 0), joins_lines: false }
    }

    /// A cursor for formats in which a backslash at the end of a line continues it.
    pub fn joining_lines(bytes: &'a [u8]) -> Cursor<'a> {
        Cursor { joins_lines: true, ..Cursor::new(bytes) }
    }

    /// The number of bytes passed.
    #[inline]
    pub fn offset(&self) -> usize {
        self.pos
    }

    /// The position of an offset on the current line; not valid after [`Cursor::seek`].
    pub fn place(&self, offset: usize) -> TextPosition {
        let (lines, start) = self.line;
        let column = u32::try_from(offset - start + 1).unwrap_or(u32::MAX);
        TextPosition { line: lines.saturating_add(1), column }
    }

    /// The number of line ends passed.
    pub fn lines(&self) -> u32 {
        self.line.0
    }

    fn next_line(&mut self) {
        self.line = (self.line.0.saturating_add(1), self.pos);
    }

    /// Moves to an offset.
    pub fn seek(&mut self, offset: usize) {
        self.pos = offset.min(self.bytes.len());
    }

    pub fn is_done(&self) -> bool {
        self.pos >= self.bytes.len()
    }

    /// Skips spaces, and line ends after a backslash, which continues a line.
    #[inline]
    pub fn skip_blanks(&mut self) {
        while let Some(&byte) = self.bytes.get(self.pos) {
            match byte {
                b if is_blank(b) => self.pos += 1,
                // Files that were joined have marks inside.
                0xef if self.bytes[self.pos..].starts_with(UTF8_MARK) => self.pos += UTF8_MARK.len(),
                b'\\' if self.joins_lines => {
                    match &self.bytes[self.pos + 1..] {
                        [b'\r', b'\n', ..] => self.pos += 3,
                        [b'\r' | b'\n', ..] => self.pos += 2,
                        _ => break,
                    }
                    self.next_line();
                }
                _ => break,
            }
        }
    }

    /// The next word of the line; empty at its end.
    #[inline]
    pub fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let rest = &self.bytes[self.pos..];
        let length = rest.iter().position(|&b| is_blank(b) || is_newline(b)).unwrap_or(rest.len());
        let continued = self.joins_lines
            && length < rest.len()
            && is_newline(rest[length])
            && rest[..length].ends_with(b"\\");
        let length = length - usize::from(continued);
        self.pos += length;
        &rest[..length]
    }

    /// The next word without consuming it.
    #[inline]
    pub fn peek_word(&self) -> &'a [u8] {
        self.clone().word()
    }

    /// The rest of the line, trimmed; continued lines are not joined.
    pub fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.pos..];
        let length = rest.iter().position(|&b| is_newline(b)).unwrap_or(rest.len());
        self.pos += length;
        let line = &rest[..length];
        let start = line.iter().position(|&b| !is_blank(b)).unwrap_or(length);
        let end = line.iter().rposition(|&b| !is_blank(b)).map_or(start, |last| last + 1);
        &line[start..end]
    }

    /// Moves past the line end here, which belongs to a text whose first line ends as that of `text` does: in a
    /// text of CRs, a LF after the last one is the first byte of what follows.
    pub fn end_line_as_in(&mut self, text: &[u8]) {
        let first = text.iter().position(|&b| is_newline(b)).unwrap_or(text.len());
        let is_bare = text[first..].starts_with(b"\r") && !text[first..].starts_with(b"\r\n");
        self.rest_of_line();
        if is_bare && self.bytes[self.pos..].starts_with(b"\r") {
            self.pos += 1;
            self.next_line();
        } else {
            self.end_line();
        }
    }

    /// Moves to the start of the next line, treating continued lines as one.
    #[inline]
    pub fn end_line(&mut self) {
        loop {
            let rest = &self.bytes[self.pos..];
            let Some(length) = rest.iter().position(|&b| is_newline(b)) else {
                self.pos = self.bytes.len();
                return;
            };
            let continued = self.joins_lines && rest[..length].ends_with(b"\\");
            self.pos += length + if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
            self.next_line();
            if !continued {
                return;
            }
        }
    }
}

/// Locates offsets in a file. Queries in increasing order scan the file only once in total.
#[derive(Clone, Debug)]
pub struct Places<'a> {
    file: Arc<str>,
    bytes: &'a [u8],
    /// The offset, the line and the line's start of the last query.
    last: Cell<(usize, u32, usize)>,
}

impl<'a> Places<'a> {
    pub fn new(file: &Arc<str>, bytes: &'a [u8]) -> Places<'a> {
        Places { file: file.clone(), bytes, last: Cell::new((0, 1, 0)) }
    }

    /// The line and column of an offset.
    pub fn at(&self, offset: usize) -> Span {
        let offset = offset.min(self.bytes.len());
        let (mut pos, mut line, mut start) =
            if self.last.get().0 <= offset { self.last.get() } else { (0, 1, 0) };
        while pos < offset {
            let byte = self.bytes[pos];
            pos += 1;
            let inside_crlf = byte == b'\r' && self.bytes.get(pos) == Some(&b'\n');
            if is_newline(byte) && !inside_crlf {
                (line, start) = (line.saturating_add(1), pos);
            }
        }
        self.last.set((pos, line, start));
        let column = u32::try_from(offset - start + 1).unwrap_or(u32::MAX);
        Span { file: self.file.clone(), line, column }
    }

    /// The whole file.
    pub fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// The file's name.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// The location of the file as a whole.
    pub fn whole(&self) -> Span {
        whole_file(&self.file)
    }
}

/// True for a line that is a comment to any of the programs that write lists of numbers as text.
pub fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b"#") || line.starts_with(b";") || line.starts_with(b"//")
}

/// The error for a file that should be text; reports binary data as such.
pub fn no_text(error: FormatError, bytes: &[u8]) -> FormatError {
    match error {
        // Trailing zeros, which some programs leave, count as spaces.
        FormatError::Malformed { message, at } if bytes.iter().take(4096).any(|&b| b == 0) => {
            let message = format!("this file is not plain text, but binary ({message})");
            FormatError::Malformed { message, at }
        }
        error => error,
    }
}

/// The location of a file as a whole.
pub fn whole_file(file: &Arc<str>) -> Span {
    Span { file: file.clone(), line: 0, column: 0 }
}

/// Part of a file in quotes for a message: short, and without control characters.
pub fn quoted(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text: String = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * LONGEST)])
        .chars()
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .take(LONGEST)
        .collect();
    let more = if bytes.len() > text.len() { "…" } else { "" };
    format!("'{text}{more}'")
}

/// Bytes of a file as a name, in any encoding.
pub fn name_of(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A name without the quotes around it, which some programs write.
pub fn unquoted(name: &[u8]) -> &[u8] {
    let name = name.trim_ascii();
    match in_quotes(name) {
        Some((inside, length)) if length == name.len() => inside,
        _ => name,
    }
}

/// The part in quotes at the beginning of a line, without them, and its length with them.
pub fn in_quotes(line: &[u8]) -> Option<(&[u8], usize)> {
    let (&quote, rest) = line.split_first().filter(|(first, _)| matches!(first, b'"' | b'\''))?;
    let end = rest.iter().position(|&byte| byte == quote)?;
    Some((rest[..end].trim_ascii(), end + 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_lines_for_every_line_end() {
        for end in ["\n", "\r", "\r\n"] {
            let text = format!("a  b{end}{end}\t c \\{end} d{end}e");
            let mut cursor = Cursor::joining_lines(text.as_bytes());
            let mut lines = Vec::new();
            while !cursor.is_done() {
                let mut words = Vec::new();
                loop {
                    match cursor.word() {
                        b"" => break,
                        word => words.push(name_of(word)),
                    }
                }
                lines.push(words.join(","));
                cursor.end_line();
            }
            assert_eq!(lines, ["a,b", "", "c,d", "e"], "{end:?}");
        }
    }

    #[test]
    fn marks_are_taken_off_and_utf_16_becomes_utf_8() {
        let text = "v 1 2 3\nü €\u{1f600}";
        let utf16 = |bytes: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
        let (little, big) = (utf16(u16::to_le_bytes), utf16(u16::to_be_bytes));
        for bytes in [
            text.as_bytes().to_vec(),
            [UTF8_MARK, text.as_bytes()].concat(),
            [b"\xff\xfe", &little[..]].concat(),
            [b"\xfe\xff", &big[..]].concat(),
            little,
            big,
        ] {
            assert_eq!(plain(&bytes), text.as_bytes());
            assert_eq!(is_marked(&bytes), bytes != text.as_bytes());
            assert!(plain_size(&bytes) == 0 || plain_size(&bytes) >= text.len() as u64);
        }
        assert_eq!(plain(b"\xff\xfea\0b"), &b"a"[..], "half of a character is dropped");
        assert_eq!(without_padding(b"{} \x1a\0\0"), b"{} ");
    }

    #[test]
    fn a_text_of_crs_ends_at_its_last_cr() {
        let end = |text: &[u8]| {
            let mut cursor = Cursor::new(text);
            cursor.end_line();
            cursor.end_line_as_in(text);
            cursor.offset()
        };
        assert_eq!((end(b"a\rb\r\nx"), end(b"a\r\nb\r\nx"), end(b"a\nb\n\rx")), (4, 6, 4));
    }

    #[test]
    fn places_count_every_line_end_once() {
        let file: Arc<str> = "f".into();
        for end in ["\n", "\r", "\r\n"] {
            let text = format!("ab{end}{end}xyz");
            let places = Places::new(&file, text.as_bytes());
            let z = text.find('z').unwrap();
            assert_eq!(places.at(z).to_string(), "f:3:3");
            assert_eq!(places.at(1).to_string(), "f:1:2");
            assert_eq!(places.at(usize::MAX).to_string(), "f:3:4");
        }
    }
}
