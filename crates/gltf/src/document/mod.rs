//! The document: its JSON, the bytes of its buffers, and the numbers in them.

pub(crate) mod accessor;
pub(crate) mod container;
pub(crate) mod data;
pub(crate) mod extras;
pub(crate) mod json;
pub(crate) mod json_document;
pub(crate) mod meshopt;
pub(crate) mod uri;
