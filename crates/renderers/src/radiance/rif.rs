//! `.rif`: what the program `rad` reads: the files of a scene, and its views.

use super::lexer::Lexer;
use bilux_import::bytes::text::name_of;
use bilux_scene::Span;
use std::sync::Arc;

/// A variable with its words.
pub(super) struct Variable {
    name: String,
    pub(super) words: Vec<String>,
    pub(super) at: Span,
}

/// The variables that name files of statements, in the order in which these are read, and the views.
pub(super) const FILES: [&str; 3] = ["materials", "illum", "scene"];
pub(super) const VIEW: &str = "view";

impl Variable {
    /// True if this is its name, which may be shortened to three letters.
    pub(super) fn is(&self, name: &str) -> bool {
        self.name.len() >= 3 && name.starts_with(&self.name.to_lowercase())
    }
}

/// The variables of a file.
pub(super) fn variables(file: &Arc<str>, bytes: &[u8]) -> Vec<Variable> {
    let mut lexer = Lexer::new(file, bytes);
    let mut found = Vec::new();
    while lexer.peek().is_some() {
        let (line, at) = lexer.line();
        let line = line.split(|byte| *byte == b'#').next().unwrap_or_default();
        let text = name_of(line);
        if let Some((name, words)) = text.split_once('=') {
            let words = words.split_whitespace().map(str::to_owned).collect();
            found.push(Variable { name: name.trim().to_owned(), words, at: lexer.place(at) });
        }
    }
    found
}

/// True if a text begins with one of the variables that a scene has.
pub(super) fn is_rif(bytes: &[u8]) -> bool {
    let name = Arc::from("");
    let mut lexer = Lexer::new(&name, bytes);
    if lexer.peek().is_none() {
        return false;
    }
    let (line, _) = lexer.line();
    let text = name_of(&line[..line.len().min(200)]);
    let Some((word, _)) = text.split_once('=') else { return false };
    let word = word.trim();
    !word.is_empty() && word.chars().all(|c| c.is_ascii_alphabetic() || c == '_')
}
