//! Henyey and Greenstein's phase function of one number, the mean cosine. [Henyey 1941]

use super::phase_parameters::ANISOTROPY;
use super::{Phase, PhaseEntry};
use bilux_math::registry::Entry;
use std::f32::consts::FRAC_1_PI;

pub(super) const ENTRY: PhaseEntry = PhaseEntry {
    entry: Entry {
        name: "henyey-greenstein",
        summary: "from straight back to straight on by one number",
        source: "Henyey 1941",
        parameters: &[ANISOTROPY],
    },
    build: |reader| Phase::HenyeyGreenstein(HenyeyGreenstein { g: reader.number(ANISOTROPY.name) }),
    cases: || {
        let of = |g| Phase::HenyeyGreenstein(HenyeyGreenstein { g });
        vec![
            ("even", of(0.0)),
            ("nearly even", of(1e-4)),
            ("on", of(0.8)),
            ("back", of(-0.5)),
            ("sharp", of(0.99)),
        ]
    },
};

/// The phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    /// The mean cosine, -0.99..=0.99.
    pub g: f32,
}

impl HenyeyGreenstein {
    /// Equal scattering in all directions.
    pub const ISOTROPIC: HenyeyGreenstein = HenyeyGreenstein { g: 0.0 };

    #[inline]
    pub(super) fn at(&self, turn: f32) -> f32 {
        let g = self.g;
        let base = (1.0 - g) * (1.0 - g) + 2.0 * g * turn;
        (1.0 - g) * (1.0 + g) * (0.25 * FRAC_1_PI) / (base * base.sqrt())
    }

    /// The inverse of its integral, in a form that divides by nothing small and does not cancel.
    #[inline]
    pub(super) fn sample_turn(&self, _u_choice: f32, u: f32) -> f32 {
        let g = self.g;
        let below = 1.0 - g + 2.0 * g * u;
        (1.0 - g) * (1.0 - u) * ((1.0 - g) * (1.0 + g) / below + 1.0 - g) / below
    }

    pub(super) fn mean_cosine(&self) -> f32 {
        self.g
    }
}
