//! Binary space partitioning: trees whose planes may have any orientation.
//!
//! Two builders share everything else: [`paper`] takes the planes of the paper that Bilux started from, [`sah`] takes
//! those that make rays cheapest. Neither splits triangles: a tree only selects which triangles the one triangle test
//! sees, so the answers are the same whatever the planes are.
//!
//! # The invariant
//! For every point of a triangle there is a path down from the root that ends in a leaf which holds the triangle. At
//! each plane, the path takes a side on which the point lies, or behind which it lies by no more than a small
//! tolerance. Builders maintain the invariant, [`BspTree::validate`] checks it, and traversal relies on it.
//! `docs/adr/0003-bsp-trees.md` records what was tried and measured.

mod cell;
mod choice;
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
