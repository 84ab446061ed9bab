//! Rayleigh's phase function: molecules of air and all that is small beside the wavelength. [Rayleigh 1871; Frisvad 2011]

use super::{Phase, PhaseEntry};
use bilux_math::registry::Entry;
use bilux_math::transcendental::powf;
use std::f32::consts::FRAC_1_PI;

pub(super) const ENTRY: PhaseEntry = PhaseEntry {
    entry: Entry {
        name: "rayleigh",
        summary: "molecules of air: as much back as on, and half of that to the sides",
        source: "Rayleigh 1871",
        parameters: &[],
    },
    build: |_| Phase::Rayleigh(Rayleigh),
    cases: || vec![("air", Phase::Rayleigh(Rayleigh))],
};

/// The phase function of unpolarised light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rayleigh;

impl Rayleigh {
    #[inline]
    pub(super) fn at(&self, turn: f32) -> f32 {
        let cos = 1.0 - turn;
        3.0 / 16.0 * FRAC_1_PI * (1.0 + cos * cos)
    }

    /// The root of a cubic. [Frisvad 2011]
    #[inline]
    pub(super) fn sample_turn(&self, _u_choice: f32, u: f32) -> f32 {
        let z = 2.0 * (2.0 * u - 1.0);
        // The larger of the two roots, which does not cancel.
        let root = powf(z.abs() + (z * z + 1.0).sqrt(), 1.0 / 3.0);
        1.0 - (root - 1.0 / root).copysign(z)
    }

    pub(super) fn mean_cosine(&self) -> f32 {
        0.0
    }
}
