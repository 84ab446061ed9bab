//! Crate files, the binary form: sections of tokens, fields, paths and specs, and values at offsets.

mod bytes;
mod integers;
mod paths;
mod sections;
mod specs;
mod types;
mod values;

pub(super) use sections::MAGIC;
pub(super) use specs::read;
