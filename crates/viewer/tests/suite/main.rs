//! The viewer, with clients that speak to it as browsers do.

mod common;
mod comparing;
mod editing;
mod security;
mod watching;
