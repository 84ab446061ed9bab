//! The algorithms of hidden-surface removal against ray casting.

#[path = "../../../accel/tests/suite/support/effort.rs"]
mod effort;
mod pictures;
