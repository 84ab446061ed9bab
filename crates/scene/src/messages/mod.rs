//! Errors and warnings, and the places in files that they name.

pub mod error;
pub(crate) mod span;
