//! The process: signals and how it ends, memory, and its standard streams.

pub(crate) mod allocator;
pub(crate) mod ending;
pub(crate) mod interrupt;
pub(crate) mod memory;
pub(crate) mod output;
pub(crate) mod signals;
pub(crate) mod usage;
