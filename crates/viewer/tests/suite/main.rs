//! The viewer, with clients that speak to it as browsers do.

mod address;
mod choosing;
mod common;
mod comparing;
mod editing;
mod framing;
mod refining;
mod security;
mod visitors;
mod watching;
