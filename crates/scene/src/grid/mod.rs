//! Numbers in space, on a regular lattice: the density of smoke, the temperature of fire.
//!
//! Voxels come in blocks of 8³, as in the leaves of OpenVDB, and blocks of zeros are not stored. Each block has a bound, its
//! majorant, so that paths cross thin parts in long steps. [Woodcock 1965; Museth 2013]

mod blocks;
mod dense;
mod faults;
#[expect(clippy::module_inception, reason = "the folder is the concept, and this the type")]
mod grid;
mod half;
mod line;
mod origin;

pub use blocks::{BLOCK, BLOCK_VOXELS, Block, GridError, MAX_SIDE};
pub use faults::Faults;
pub use grid::{Grid, Stored};
pub use half::from_binary16;
pub use line::GridLine;
pub use origin::Origin;
