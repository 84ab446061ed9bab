//! Separates code from comments, so that no rule mistakes a word in a string or a comment for code.

/// A Rust file split in two. Both halves keep the file's line breaks, and so its line numbers.
pub(crate) struct RustText {
    /// The code, with spaces in place of comments and literals.
    pub(crate) code: String,
    /// The comments, with spaces in place of everything else.
    pub(crate) comments: String,
}

impl RustText {
    pub(crate) fn new(text: &str) -> RustText {
        let mut splitter = Splitter { rest: text, code: String::new(), comments: String::new() };
        while !splitter.rest.is_empty() {
            splitter.step();
        }
        RustText { code: splitter.code, comments: splitter.comments }
    }
}

struct Splitter<'a> {
    rest: &'a str,
    code: String,
    comments: String,
}

impl Splitter<'_> {
    fn step(&mut self) {
        let rest = self.rest;
        if rest.starts_with("//") {
            self.comment(rest.find('\n').unwrap_or(rest.len()));
        } else if rest.starts_with("/*") {
            self.comment(block_comment(rest));
        } else if let Some(length) = raw_string(rest).filter(|_| self.at_word_start()) {
            self.literal(length);
        } else if rest.starts_with('"') {
            self.literal(quoted(rest, '"'));
        } else if let Some(length) = character(rest) {
            self.literal(length);
        } else {
            let first = rest.chars().next().map_or(0, char::len_utf8);
            // Nothing begins before one of these.
            let length = rest[first..].find(['/', '"', '\'', 'r', 'b']).map_or(rest.len(), |at| first + at);
            let (code, rest) = rest.split_at(length);
            self.code.push_str(code);
            self.comments.push_str(&blank(code));
            self.rest = rest;
        }
    }

    fn comment(&mut self, length: usize) {
        let (comment, rest) = self.rest.split_at(length);
        self.comments.push_str(comment);
        self.code.push_str(&blank(comment));
        self.rest = rest;
    }

    fn literal(&mut self, length: usize) {
        let (literal, rest) = self.rest.split_at(length);
        self.comments.push_str(&blank(literal));
        self.code.push_str(&blank(literal));
        self.rest = rest;
    }

    fn at_word_start(&self) -> bool {
        !self.code.ends_with(|c: char| c.is_alphanumeric() || c == '_')
    }
}

/// Spaces for as many bytes as the text has, except for its line breaks.
fn blank(text: &str) -> String {
    text.bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }).collect()
}

fn block_comment(text: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < text.len() {
        match &text.as_bytes()[at..] {
            [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
            [b'*', b'/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

/// The length of `r"…"`, `r#"…"#`, `br"…"` and so on, if the text begins with one.
fn raw_string(text: &str) -> Option<usize> {
    let opening = text.strip_prefix('b').unwrap_or(text).strip_prefix('r')?;
    let hashes = opening.len() - opening.trim_start_matches('#').len();
    let body = opening[hashes..].strip_prefix('"')?;
    let closing = format!("\"{}", "#".repeat(hashes));
    let end = body.find(&closing).map_or(text.len(), |at| text.len() - body.len() + at + closing.len());
    Some(end)
}

fn quoted(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            _ if c == quote => return at + c.len_utf8(),
            _ => {}
        }
    }
    text.len()
}

/// The length of a character literal, if the text begins with one rather than with a lifetime.
fn character(text: &str) -> Option<usize> {
    let mut chars = text.strip_prefix('\'')?.chars();
    let first = chars.next()?;
    (first == '\\' || chars.next() == Some('\'')).then(|| quoted(text, '\''))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_comments_and_literals_come_apart() {
        let text = "let a = \"// no\"; // yes\nlet c = '\"'; /* b /* c */ d */ fn f<'a>(x: &'a str) {}\n";
        let rust = RustText::new(text);
        assert_eq!(rust.code.lines().next(), Some("let a =        ;       "));
        assert_eq!(rust.comments.lines().next().map(str::trim), Some("// yes"));
        assert_eq!(rust.comments.lines().nth(1).map(str::trim), Some("/* b /* c */ d */"));
        assert!(rust.code.contains("fn f<'a>(x: &'a str) {}"));
    }

    #[test]
    fn raw_strings_and_escapes_end_where_they_should() {
        let rust = RustText::new("a(r#\"un\"safe\"#, b\"\\\"x\", '\\'', br\"y\\\"); bar\"z\" // é\nlast");
        assert_eq!(rust.code.split_whitespace().collect::<Vec<_>>().join(" "), "a( , b , , ); bar last");
        assert_eq!(rust.comments.trim(), "// é");
    }

    #[test]
    fn unterminated_literals_end_with_the_file() {
        for text in ["\"abc", "/* abc", "r#\"abc\"", "'\\", "// abc", "'"] {
            let rust = RustText::new(text);
            assert_eq!(rust.code.len(), text.len());
        }
    }
}
