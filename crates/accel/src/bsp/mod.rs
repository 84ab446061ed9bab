//! Binary space partitioning: trees whose planes may have any orientation.
//!
//! Two ways to grow one share everything else : [`paper`] takes the planes of the paper that Bilux
//! started from, [`sah`] those that make rays cheapest. Neither splits triangles: a tree only filters
//! what the one triangle test gets to see, so answers are the same whatever the planes are.

mod cell;
mod facing;
mod partition;
mod path;
mod pieces;
mod plane;
mod sweep;
mod tree;
mod validate;

#[cfg(test)]
mod tests;

pub mod paper;
pub mod sah;

pub use tree::BspTree;
