//! Words, strings and numbers of a text.

use bilux_import::FormatError;
use bilux_import::bytes::float::parse_f64;
use bilux_import::bytes::text::quoted;
use bilux_scene::Span;
use std::borrow::Cow;
use std::sync::Arc;

pub(super) struct Lexer<'a> {
    bytes: &'a [u8],
    at: usize,
    pub(super) name: &'a Arc<str>,
    /// The line ends that were counted, up to where, and where the last line begins.
    counted: (u32, usize, usize),
}

const fn is_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b':' | b'.' | b'|' | b'-') || byte >= 0x80
}

impl<'a> Lexer<'a> {
    pub(super) fn new(bytes: &'a [u8], name: &'a Arc<str>) -> Lexer<'a> {
        Lexer { bytes, at: 0, name, counted: (0, 0, 0) }
    }

    /// Line and column of the next word, from 1.
    pub(super) fn place(&mut self) -> (u32, u32) {
        self.skip();
        let (mut lines, from, mut start) = self.counted;
        for (i, byte) in self.bytes[from..self.at].iter().enumerate() {
            if *byte == b'\n' {
                lines = lines.saturating_add(1);
                start = from + i + 1;
            }
        }
        self.counted = (lines, self.at, start);
        (lines + 1, u32::try_from(self.at - start + 1).unwrap_or(u32::MAX))
    }

    pub(super) fn error(&mut self, message: impl Into<String>) -> FormatError {
        let (line, column) = self.place();
        FormatError::malformed(message, Span { file: self.name.clone(), line, column })
    }

    /// An error that says what is there in place of what was expected.
    pub(super) fn expected(&mut self, what: &str) -> FormatError {
        self.skip();
        let rest = &self.bytes[self.at..];
        if rest.is_empty() {
            return self.error(format!("{what} is missing here: the file was cut off"));
        }
        let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len());
        self.error(format!("{what} is missing here, where there is {}", quoted(&rest[..end.clamp(1, 40)])))
    }

    /// Skips blanks, line ends and comments.
    #[inline]
    pub(super) fn skip(&mut self) {
        loop {
            match self.bytes.get(self.at) {
                Some(b' ' | b'\t' | b'\r' | b'\n' | b';' | 0) => self.at += 1,
                Some(b'#') => self.skip_line(),
                Some(b'/') if self.bytes.get(self.at + 1) == Some(&b'/') => self.skip_line(),
                Some(b'/') if self.bytes.get(self.at + 1) == Some(&b'*') => {
                    let rest = &self.bytes[self.at + 2..];
                    let end = rest.windows(2).position(|pair| pair == b"*/");
                    self.at = end.map_or(self.bytes.len(), |end| self.at + end + 4);
                }
                _ => return,
            }
        }
    }

    fn skip_line(&mut self) {
        let rest = &self.bytes[self.at..];
        self.at += rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
    }

    /// The next byte that is not blank.
    #[inline]
    pub(super) fn peek(&mut self) -> Option<u8> {
        self.skip();
        self.bytes.get(self.at).copied()
    }

    /// Takes a byte if it comes next.
    #[inline]
    pub(super) fn takes(&mut self, byte: u8) -> bool {
        let comes = self.peek() == Some(byte);
        self.at += usize::from(comes);
        comes
    }

    pub(super) fn take(&mut self, byte: u8) -> Result<(), FormatError> {
        if self.takes(byte) { Ok(()) } else { Err(self.expected(&format!("'{}'", char::from(byte)))) }
    }

    /// A name, with namespaces; empty if something else comes.
    pub(super) fn word(&mut self) -> &'a str {
        self.skip();
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|b| !is_name(*b)).unwrap_or(rest.len());
        let word = std::str::from_utf8(&rest[..length]).unwrap_or_default();
        self.at += word.len();
        word
    }

    /// The name that comes next, which is not taken.
    pub(super) fn peek_word(&mut self) -> &'a str {
        self.skip();
        let at = self.at;
        let word = self.word();
        self.at = at;
        word
    }

    /// Takes a name if it comes next.
    pub(super) fn takes_word(&mut self, wanted: &str) -> bool {
        let comes = self.peek_word() == wanted;
        self.at += if comes { wanted.len() } else { 0 };
        comes
    }

    #[inline]
    pub(super) fn number(&mut self) -> Result<f64, FormatError> {
        self.skip();
        let rest = &self.bytes[self.at..];
        let is_digit = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'.' | b'-' | b'+');
        let length = rest.iter().position(|b| !is_digit(b)).unwrap_or(rest.len());
        let word = &rest[..length];
        let value = match word {
            b"true" | b"True" => Some(1.0),
            b"false" | b"False" => Some(0.0),
            _ => parse_f64(word),
        };
        let value = value.ok_or_else(|| self.expected("a number"))?;
        self.at += length;
        Ok(value)
    }

    /// A text in single or double quotes, one or three.
    pub(super) fn string(&mut self) -> Result<Cow<'a, str>, FormatError> {
        let Some(quote @ (b'"' | b'\'')) = self.peek() else { return Err(self.expected("a text in quotes")) };
        let rest = &self.bytes[self.at..];
        let marks = if rest.starts_with(&[quote; 3]) { 3 } else { 1 };
        let body = &rest[marks..];
        let mut end = 0;
        while !body.get(end..).unwrap_or_default().starts_with(&[quote; 3][..marks]) {
            match body.get(end) {
                None => return Err(self.error("a text in quotes has no end")),
                Some(b'\n') if marks == 1 => {
                    return Err(self.error("a text in quotes does not end on its line"));
                }
                Some(b'\\') => end += 2,
                Some(_) => end += 1,
            }
        }
        self.at += marks + end + marks;
        let text = String::from_utf8_lossy(&body[..end]);
        Ok(if text.contains('\\') { Cow::Owned(unescaped(&text)) } else { text })
    }

    /// The name of a file, between `@` or `@@@`; within the latter, `\@@@` is `@@@`, and two more at the end belong to the name.
    pub(super) fn asset(&mut self) -> Result<Cow<'a, str>, FormatError> {
        self.skip();
        let Some(body) = self.bytes[self.at..].strip_prefix(b"@@@") else {
            return self.between(b"@", "the name of a file, between @ and @");
        };
        let mut end = 0;
        loop {
            match body.get(end..).unwrap_or_default() {
                [] => return Err(self.error("the name of a file, between @@@ and @@@ has no end")),
                [b'\\', b'@', b'@', b'@', ..] => end += 4,
                [b'@', b'@', b'@', ..] => break,
                _ => end += 1,
            }
        }
        end += body[end + 3..].iter().take(2).take_while(|byte| **byte == b'@').count();
        self.at += end + 6;
        let name = String::from_utf8_lossy(&body[..end]);
        Ok(if name.contains("\\@@@") { Cow::Owned(name.replace("\\@@@", "@@@")) } else { name })
    }

    /// A path between `<` and `>`.
    pub(super) fn path(&mut self) -> Result<Cow<'a, str>, FormatError> {
        if self.peek() != Some(b'<') {
            return Err(self.expected("a path, between < and >"));
        }
        self.between(b">", "a path")
    }

    fn between(&mut self, mark: &[u8], what: &str) -> Result<Cow<'a, str>, FormatError> {
        let body = &self.bytes[self.at..].get(mark.len()..).unwrap_or_default();
        let end = body.windows(mark.len()).position(|part| part == mark);
        let end = end.ok_or_else(|| self.error(format!("{what} has no end")))?;
        self.at += end + 2 * mark.len();
        Ok(String::from_utf8_lossy(&body[..end]))
    }

    /// Skips everything up to the bracket that closes the one that comes next.
    pub(super) fn skip_group(&mut self) -> Result<(), FormatError> {
        let mut depth = 0u64;
        loop {
            match self.peek() {
                None => return Err(self.expected("a closing bracket")),
                Some(b'{' | b'(' | b'[') => depth += 1,
                Some(b'}' | b')' | b']') => depth = depth.saturating_sub(1),
                Some(b'"' | b'\'') => {
                    self.string()?;
                    continue;
                }
                Some(b'@') => {
                    self.asset()?;
                    continue;
                }
                Some(_) => {}
            }
            self.at += 1;
            if depth == 0 {
                return Ok(());
            }
        }
    }
}

fn unescaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut letters = text.chars();
    while let Some(letter) = letters.next() {
        match letter {
            '\\' => match letters.next() {
                Some('n') => out.push('\n'),
                Some('t') => out.push('\t'),
                Some('r') => out.push('\r'),
                Some(other) => out.push(other),
                None => {}
            },
            other => out.push(other),
        }
    }
    out
}
