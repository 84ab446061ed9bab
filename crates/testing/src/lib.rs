//! Development only: how much tests take, statistics, and verdicts that are remembered.

mod effort;
#[cfg(feature = "statistics")]
pub mod statistics;
pub mod verdicts;

pub use effort::effort;
