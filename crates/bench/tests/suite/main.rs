//! Tests of the benchmarks' results, on scenes that take moments.

mod build;
mod rays;
mod render;
mod speed;
