//! Binary space partitioning: trees whose planes may have any orientation.
//!
//! Two ways to grow one share everything else: [`paper`] takes the planes of the paper that Bilux started
//! from, [`sah`] those that make rays cheapest. Neither splits triangles: a tree only filters what the one
//! triangle test gets to see, so answers are the same whatever the planes are.
//!
//! # The invariant
//! For every point of a triangle there is a way down from the root, at each plane to a side on which the point is,
//! or behind which it is by no more than a small tolerance, that ends in a leaf which holds the triangle. Builders keep
//! it, [`BspTree::validate`] checks it, and walks rely on it. What was tried and measured stands in
//! `docs/adr/0003-bsp-trees.md`.

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
