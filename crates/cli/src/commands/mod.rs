//! One command per file. Each returns the exit status.

pub mod bench;
pub mod compare;
pub mod convert;
pub mod denoise;
pub mod explain;
pub mod farm;
pub mod generate;
pub mod info;
pub mod list;
pub mod manual;
pub mod merge;
pub mod render;
pub mod sensor;
pub mod serve;
pub(crate) mod shared;
pub mod worker;

/// The exit status of a command that succeeded.
pub const DONE: u8 = 0;
