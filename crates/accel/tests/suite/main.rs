//! Every structure gives the same answers, on the nastiest meshes and rays that we know.

mod batches;
mod examples;
mod forest;
mod fuzzed;
mod incoherent_batches;
mod one_answer;
mod places;
mod planted_bugs;
mod primitives;
mod questions;
mod support;
mod two_levels;
mod watertight;
