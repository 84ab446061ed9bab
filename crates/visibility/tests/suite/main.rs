//! The algorithms of hidden-surface removal against ray casting.

mod pictures;
