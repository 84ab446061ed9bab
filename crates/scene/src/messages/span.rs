//! Places in files, for messages.

use std::fmt;
use std::sync::Arc;

/// A location in a file; lines and columns count from 1, and 0 means unknown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// The file, as the user named it; empty for values that the program made.
    pub file: Arc<str>,
    /// Line.
    pub line: u32,
    /// Column.
    pub column: u32,
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.file.is_empty(), self.line, self.column) {
            (true, _, _) => f.write_str("(made by the program)"),
            (_, 0, _) => f.write_str(&self.file),
            (_, line, 0) => write!(f, "{}:{line}", self.file),
            (_, line, column) => write!(f, "{}:{line}:{column}", self.file),
        }
    }
}
