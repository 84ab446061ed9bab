//! Crate files, the binary form: sections of tokens, fields, paths and specs, and values at offsets.

mod bytes;
mod integers;
mod paths;
mod sections;
mod specs;
mod types;
mod values;

pub(crate) use sections::MAGIC;
pub(crate) use specs::read;
