//! Layers as text.

mod lexer;
mod metadata;
mod parser;
mod types;
mod values;

pub(crate) use parser::{MAGIC, read};
