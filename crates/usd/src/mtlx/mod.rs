//! Documents of MaterialX (`.mtlx`) as layers: each material is the prim that OpenUSD makes of it, `/MaterialX/Materials/NAME`, with
//! everything that it uses below it.

mod document;
mod nodes;
mod values;

pub(crate) use document::{is_document, read};
