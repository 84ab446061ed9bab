//! Embree 4, loaded at run time from a shared library that the user names. Its C interface is declared here following
//! its public documentation; nothing of it is linked.
#![allow(unsafe_code, reason = "a C library is loaded and called")]

mod layouts;
mod library;
mod packets;
mod tree;

pub(super) use library::Embree;
pub(super) use packets::{EmbreeEngine, Packets};
pub(super) use tree::{KINDS, Tree};
