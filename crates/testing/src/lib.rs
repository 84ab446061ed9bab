//! Development only: how much tests take, statistics, whether meshes are closed, and verdicts that are remembered.

mod effort;
#[cfg(feature = "solids")]
pub mod solids;
#[cfg(feature = "statistics")]
pub mod statistics;
pub mod verdicts;

pub use effort::effort;
