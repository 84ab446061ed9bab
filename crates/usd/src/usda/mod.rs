//! Layers as text.

mod lexer;
mod metadata;
mod parser;
mod types;
mod values;

pub(super) use parser::{MAGIC, read};
