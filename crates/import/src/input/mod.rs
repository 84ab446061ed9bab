//! The state of one read: its options and limits, the files that belong to it, pictures, and what is odd about them.

pub mod authors;
pub mod choice;
pub mod diagnostics;
pub mod images;
pub mod includes;
pub mod locating;
pub mod mounting;
pub mod names;
pub mod options;
pub(crate) mod plain;
pub mod reading;
pub mod sink;
