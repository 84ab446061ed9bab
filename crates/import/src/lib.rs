//! The ground that the readers and writers of scene files stand on: the state of one read with its limits ([`reading`](input::reading)), files
//! and archives, text and numbers, meshes and looks as files describe them. The formats themselves are crates above this one, and
//! their table is in `bilux-formats`, which programs use; what is here is for the formats alone, and changes with them.

#![allow(missing_docs, reason = "names say what fields and constructors are, and only formats use them")]

pub mod appearance;
pub mod bytes;
pub mod geometry;
pub mod input;
pub mod meshes;
pub mod output;
pub mod tables;
pub mod world;

pub use bytes::error::FormatError;
pub use geometry::subdivision::Scheme;
pub use input::options::{Glass, ReadOptions, WriteOptions};
