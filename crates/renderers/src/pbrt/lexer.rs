//! Splits a file into words, quoted strings and brackets with their locations. `#` begins a comment.

use bilux_import::FormatError;
use bilux_import::bytes::float::parse_f32;
use bilux_import::bytes::text::{Places, quoted};
use bilux_scene::Span;
use std::borrow::Cow;
use std::sync::Arc;

/// A token of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token<'a> {
    /// A directive, a number, or `true` and `false`.
    Word(&'a [u8]),
    /// The text between quotes.
    Quoted(Cow<'a, [u8]>),
    /// `[`
    Open,
    /// `]`
    Close,
}

/// Iterates over the tokens of a file.
pub(super) struct Lexer<'a> {
    bytes: &'a [u8],
    pos: usize,
    places: Places<'a>,
    /// Rest of the last list of parameters, in the file that includes this one.
    rest: Option<Rest<'a>>,
}

/// Text of another file at the end of one.
#[derive(Clone)]
struct Rest<'a> {
    /// Place where it begins here.
    begins: usize,
    /// Place where it begins in the other file.
    offset: usize,
    places: Places<'a>,
}

const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

impl<'a> Lexer<'a> {
    pub(super) fn new(file: &Arc<str>, bytes: &'a [u8]) -> Lexer<'a> {
        let mark = b"\xef\xbb\xbf";
        let pos = if bytes.starts_with(mark) { mark.len() } else { 0 };
        Lexer { bytes, pos, places: Places::new(file, bytes), rest: None }
    }

    /// The tokens of a file whose bytes, from `begins` on, are those of another file from `offset` on.
    pub(super) fn going_on(self, begins: usize, other: &Lexer<'a>, offset: usize) -> Lexer<'a> {
        let (places, offset) = other.origin(offset);
        Lexer { rest: Some(Rest { begins, offset, places: places.clone() }), ..self }
    }

    /// Skips the parameters that come next, if any do: where they begin, and their text.
    pub(super) fn skip_parameters(&mut self) -> Result<Option<(usize, &'a [u8])>, FormatError> {
        let Some((Token::Quoted(_), begin)) = self.peek()? else { return Ok(None) };
        let is_directive = |token: &Token| matches!(token, Token::Word(word) if word.first().is_some_and(u8::is_ascii_uppercase));
        while self.peek()?.is_some_and(|(token, _)| !is_directive(&token)) {
            self.next()?;
        }
        Ok(Some((begin, &self.bytes[begin..self.pos])))
    }

    /// The location of an offset.
    pub(super) fn place(&self, offset: usize) -> Span {
        let (places, offset) = self.origin(offset);
        places.at(offset)
    }

    /// The file that an offset comes from, and the offset there.
    fn origin(&self, offset: usize) -> (&Places<'a>, usize) {
        match &self.rest {
            Some(rest) if offset >= rest.begins => (&rest.places, offset - rest.begins + rest.offset),
            _ => (&self.places, offset),
        }
    }

    /// An error at an offset.
    pub(super) fn error(&self, message: impl Into<String>, offset: usize) -> FormatError {
        FormatError::malformed(message, self.place(offset))
    }

    /// The next token and its offset; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<(Token<'a>, usize)>, FormatError> {
        self.skip_blanks();
        let at = self.pos;
        let Some(&byte) = self.bytes.get(at) else { return Ok(None) };
        let token = match byte {
            b'[' | b']' => {
                self.pos += 1;
                if byte == b'[' { Token::Open } else { Token::Close }
            }
            b'"' => self.quoted(at)?,
            _ => {
                let rest = &self.bytes[at..];
                let ends = |b: &u8| is_blank(*b) || matches!(b, b'"' | b'[' | b']' | b'#');
                let length = rest.iter().position(ends).unwrap_or(rest.len());
                self.pos += length;
                Token::Word(&rest[..length])
            }
        };
        Ok(Some((token, at)))
    }

    /// The next token without consuming it.
    pub(super) fn peek(&mut self) -> Result<Option<(Token<'a>, usize)>, FormatError> {
        let pos = self.pos;
        let next = self.next();
        self.pos = pos;
        next
    }

    /// A copy of the lexer that continues from here independently.
    pub(super) fn ahead(&self) -> Lexer<'a> {
        Lexer { bytes: self.bytes, pos: self.pos, places: self.places.clone(), rest: self.rest.clone() }
    }

    /// The next token, which must exist; `wanted` describes it in the error.
    pub(super) fn need(&mut self, wanted: &str) -> Result<(Token<'a>, usize), FormatError> {
        let end = self.bytes.len();
        self.next()?.ok_or_else(|| self.error(format!("the file ends here, but {wanted} is expected"), end))
    }

    /// A quoted string.
    pub(super) fn text(&mut self, wanted: &str) -> Result<(String, usize), FormatError> {
        match self.need(wanted)? {
            (Token::Quoted(text), at) => Ok((String::from_utf8_lossy(&text).into_owned(), at)),
            (token, at) => {
                Err(self.error(format!("{wanted}, in quotes, is expected here, not {}", shown(&token)), at))
            }
        }
    }

    /// A finite number.
    pub(super) fn number(&mut self, wanted: &str) -> Result<f64, FormatError> {
        let (token, at) = self.need(wanted)?;
        let number = match &token {
            // Matrices and angles keep all of their digits.
            Token::Word(word) => std::str::from_utf8(word).ok().and_then(|word| word.parse::<f64>().ok()),
            _ => None,
        };
        let number = number
            .ok_or_else(|| self.error(format!("{wanted} is expected here, not {}", shown(&token)), at))?;
        if !number.is_finite() {
            return Err(self.error(format!("{wanted} must be finite, not {number}"), at));
        }
        Ok(number)
    }

    fn skip_blanks(&mut self) {
        while let Some(&byte) = self.bytes.get(self.pos) {
            if byte == b'#' {
                let rest = &self.bytes[self.pos..];
                self.pos += rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
            } else if is_blank(byte) {
                self.pos += 1;
            } else {
                break;
            }
        }
    }

    fn quoted(&mut self, at: usize) -> Result<Token<'a>, FormatError> {
        let inside = &self.bytes[at + 1..];
        let mut escaped = false;
        let mut length = 0;
        loop {
            match inside.get(length) {
                Some(b'"') => break,
                Some(b'\\') => (escaped, length) = (true, length + 2),
                None | Some(b'\n' | b'\r') => {
                    return Err(self.error("this quote is not closed on its line: add a \" at its end", at));
                }
                Some(_) => length += 1,
            }
        }
        self.pos = at + 1 + length + 1;
        let text = &inside[..length];
        Ok(Token::Quoted(if escaped { Cow::Owned(unescaped(text)) } else { Cow::Borrowed(text) }))
    }
}

fn unescaped(text: &[u8]) -> Vec<u8> {
    let mut plain = Vec::with_capacity(text.len());
    let mut bytes = text.iter();
    while let Some(&byte) = bytes.next() {
        plain.push(match byte {
            b'\\' => match bytes.next() {
                Some(b'n') => b'\n',
                Some(b't') => b'\t',
                Some(b'r') => b'\r',
                Some(&other) => other,
                None => b'\\',
            },
            other => other,
        });
    }
    plain
}

/// A number of a list, which may be infinite or NaN.
pub(super) fn number_of(word: &[u8]) -> Option<f32> {
    // Elsewhere a comma may be a decimal comma; here it can only be a mistake.
    if word.contains(&b',') { None } else { parse_f32(word) }
}

/// A token for a message.
pub(super) fn shown(token: &Token) -> String {
    match token {
        Token::Word(word) => quoted(word),
        Token::Quoted(text) => format!("\"{}\"", quoted(text).trim_matches('\'')),
        Token::Open => "'['".to_owned(),
        Token::Close => "']'".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> Result<Vec<String>, String> {
        let file = "f".into();
        let mut lexer = Lexer::new(&file, text.as_bytes());
        let mut found = Vec::new();
        while let Some((token, _)) = lexer.next().map_err(|e| e.to_string())? {
            found.push(shown(&token));
        }
        Ok(found)
    }

    #[test]
    fn words_texts_brackets_and_comments() {
        let found = tokens("Shape\"a b\"[1 2.5]# no\r\n \"q\\\"\" [ ]").unwrap();
        assert_eq!(found, ["'Shape'", "\"a b\"", "'['", "'1'", "'2.5'", "']'", "\"q\"\"", "'['", "']'"]);
    }

    #[test]
    fn unterminated_quotes_are_reported_with_their_location() {
        assert!(tokens("a\n  \"bc\n\"").unwrap_err().starts_with("f:2:3: this quote"));
        assert!(tokens("\"bc").unwrap_err().starts_with("f:1:1"));
        assert!(tokens("\"bc\\").unwrap_err().starts_with("f:1:1"));
    }
}
