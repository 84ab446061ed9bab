//! What the benchmarks measure, on scenes that take moments.

mod build;
mod rays;
mod render;
mod speed;
