//! Pictures and files that a render leaves, and what they say.

pub mod description;
pub(crate) mod display;
pub mod merging;
pub mod metadata;
pub(crate) mod writing;
