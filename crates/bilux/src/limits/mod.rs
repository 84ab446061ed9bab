//! Limits of a render, in time and memory.

pub mod budget;
pub mod memory;
pub mod memory_limit;
