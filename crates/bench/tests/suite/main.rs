//! What the benchmarks measure, on scenes that take moments.

mod build;
#[path = "../../../accel/tests/suite/support/effort.rs"]
mod effort;
mod rays;
mod render;
mod speed;
