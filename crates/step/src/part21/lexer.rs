//! The tokens of Part 21. [ISO 10303-21, 6.3]

use super::value::Piece;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token {
    Open,
    Close,
    Comma,
    Semicolon,
    Equals,
    /// `$`, `*`, or binary data.
    Missing,
    Number(f64),
    Reference(u64),
    Text(Piece),
    Name(Piece),
    Keyword(Piece),
    /// A byte that begins nothing.
    Wrong,
    End,
}

pub(super) struct Lexer<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
}

impl<'a> Lexer<'a> {
    fn piece(&self, start: usize, end: usize) -> Piece {
        Piece { start: start as u32, length: (end - start) as u32 }
    }

    fn skip_blanks(&mut self) {
        while let Some(&byte) = self.bytes.get(self.at) {
            match byte {
                b if b <= b' ' => self.at += 1,
                b'/' if self.bytes[self.at..].starts_with(b"/*") => {
                    let end = self.bytes[self.at..].windows(2).position(|two| two == b"*/");
                    self.at = end.map_or(self.bytes.len(), |end| self.at + end + 2);
                }
                _ => break,
            }
        }
    }

    /// The end of the bytes from here on that satisfy a condition.
    fn run(&self, start: usize, is_part: impl Fn(u8) -> bool) -> usize {
        self.bytes[start..].iter().position(|&byte| !is_part(byte)).map_or(self.bytes.len(), |n| start + n)
    }

    pub(super) fn next(&mut self) -> Token {
        self.skip_blanks();
        let start = self.at;
        let Some(&byte) = self.bytes.get(start) else { return Token::End };
        self.at += 1;
        match byte {
            b'(' => Token::Open,
            b')' => Token::Close,
            b',' => Token::Comma,
            b';' => Token::Semicolon,
            b'=' => Token::Equals,
            b'$' | b'*' => Token::Missing,
            b'\'' => self.text(start + 1),
            b'"' => {
                self.at = self.run(start + 1, |b| b != b'"').saturating_add(1).min(self.bytes.len());
                Token::Missing
            }
            b'.' if self.bytes.get(start + 1).is_some_and(|b| b.is_ascii_alphabetic() || *b == b'_') => {
                let end = self.run(start + 1, |b| b.is_ascii_alphanumeric() || b == b'_');
                self.at = if self.bytes.get(end) == Some(&b'.') { end + 1 } else { end };
                Token::Name(self.piece(start + 1, end))
            }
            b'#' => {
                let end = self.run(start + 1, |b| b.is_ascii_digit());
                self.at = end;
                let digits = std::str::from_utf8(&self.bytes[start + 1..end]).unwrap_or_default();
                digits.parse().map_or(Token::Wrong, Token::Reference)
            }
            b'0'..=b'9' | b'+' | b'-' | b'.' => {
                let end =
                    self.run(start, |b| b.is_ascii_alphanumeric() || matches!(b, b'+' | b'-' | b'.' | b'#'));
                self.at = end;
                Token::Number(number(&self.bytes[start..end]))
            }
            b if b.is_ascii_alphabetic() || matches!(b, b'_' | b'!') => {
                let end = self.run(start + 1, |b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'-'));
                self.at = end;
                Token::Keyword(self.piece(start, end))
            }
            _ => Token::Wrong,
        }
    }

    fn text(&mut self, start: usize) -> Token {
        let mut end = start;
        loop {
            end = self.run(end, |b| b != b'\'');
            if self.bytes.get(end + 1) != Some(&b'\'') || end >= self.bytes.len() {
                break;
            }
            end += 2;
        }
        self.at = (end + 1).min(self.bytes.len());
        Token::Text(self.piece(start, end.min(self.bytes.len())))
    }
}

/// Number that a word states; NaN if it states none (`1.#QNAN`), which users of the number refuse.
fn number(word: &[u8]) -> f64 {
    let text = std::str::from_utf8(word).unwrap_or_default();
    text.parse().or_else(|_| text.replace(['D', 'd'], "e").parse()).unwrap_or(f64::NAN)
}
