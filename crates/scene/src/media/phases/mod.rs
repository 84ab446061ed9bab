//! Phase functions: the directions that a point of a medium scatters light into. Each has its own file; the table is
//! [`PHASES`].
//!
//! All depend on the angle by which light is turned alone, here as one minus its cosine: 0 is straight on, 2 straight back. Fog
//! scatters so sharply on that the cosine would not tell its directions apart. They are densities over solid angle that
//! integrate to 1, so that sampling one gives every direction the weight 1.

mod draine;
mod droplets;
mod henyey_greenstein;
mod phase;
mod phase_parameters;
mod rayleigh;

pub use draine::Draine;
pub use droplets::Droplets;
pub use henyey_greenstein::HenyeyGreenstein;
pub use phase::{PHASES, Phase, PhaseEntry, PhaseSample, read_phase};
pub(crate) use phase_parameters::{ANISOTROPY, DIAMETER, DRAINE_ALPHA, KIND};
pub use rayleigh::Rayleigh;
