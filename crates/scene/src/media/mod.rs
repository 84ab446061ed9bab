//! Media: what fills the inside of an object, and absorbs and scatters light there: the same everywhere, or as dense as a
//! [`Grid`] says, from a file or by a formula of [`DENSITIES`]. How they scatter, the phase function, is one of [`PHASES`].
//!
//! Coefficients are per metre and per channel. All distances of a path are those of one channel, which its sample has chosen: so a
//! density does not depend on the path so far, and is the same for the same line from both ends.

pub mod densities;
mod glow;
mod medium;
mod phases;
mod seen;
pub mod slab;
mod tracking;

pub use crate::grid::{
    BLOCK, BLOCK_VOXELS, Block, Faults, Grid, GridError, GridLine, MAX_SIDE, Origin, Stored, from_binary16,
};
pub use densities::{ComputedDensity, DENSITIES, DensityEntry};
pub(crate) use glow::{EMISSION, EMISSION_GRID, TEMPERATURE, TEMPERATURE_NORM, TEMPERATURE_SCALE};
pub use glow::{Glow, GlowLine};
pub(crate) use medium::{DENSITY, SCATTERING};
pub use medium::{FreePath, Medium, MediumLine, beer, mean};
pub use phases::{
    Draine, Droplets, HenyeyGreenstein, PHASES, Phase, PhaseEntry, PhaseSample, Rayleigh, read_phase,
};
pub use seen::Seen;
pub use tracking::{Draws, Flight, MediumEvent, WalkChannel};

pub(crate) use phases::{ANISOTROPY as PHASE_ANISOTROPY, DIAMETER, DRAINE_ALPHA, KIND as PHASE};
