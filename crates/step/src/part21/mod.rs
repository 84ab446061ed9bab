//! Part 21, the text encoding of STEP: a header, and a table of instances by number. [ISO 10303-21]

mod lexer;
mod parser;
mod strings;
mod table;
mod value;

pub(super) use parser::parse;
pub(super) use table::Table;
pub(super) use value::Values;
