//! Densities that are formulas: clouds, noise, fog that thins out with height. Each has its own file; the table is [`DENSITIES`].
//!
//! A formula is evaluated once, at the voxels of a [`Grid`](crate::grid::Grid): so it has majorants that bound it, and costs no more
//! than a grid of a file wherever light meets it.

mod cloud;
mod density;
mod gradient_noise;
mod height;
mod noise;

pub use density::{ComputedDensity, DENSITIES, Density, DensityEntry, USUAL_MAX_VOXELS};
