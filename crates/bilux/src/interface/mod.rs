//! Tables and messages for programs on top of this crate.

pub mod tables;
pub mod wording;
