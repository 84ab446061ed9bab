//! The nodes of a file, whichever its encoding. Their values stay encoded until somebody asks for them.

mod arrays;
mod binary;
mod node;
mod read;
mod records;
mod text;
mod values;

pub(super) use arrays::Number;
pub(super) use binary::MAGIC as BINARY_MAGIC;
pub(super) use node::{Node, Tree};
pub(super) use text::is_text;
pub(super) use values::{Value, Values};
