//! Droplets of water by their size: a mixture of Henyey and Greenstein's phase function and Draine's, fitted to Mie's
//! theory. [Jendersie 2023]

use super::phase_parameters::DIAMETER;
use super::{Draine, HenyeyGreenstein, Phase, PhaseEntry};
use bilux_math::registry::Entry;
use bilux_math::transcendental::exp;

pub(super) const ENTRY: PhaseEntry = PhaseEntry {
    entry: Entry {
        name: "droplets",
        summary: "fog and clouds, by the size of their droplets",
        source: "Jendersie 2023",
        parameters: &[DIAMETER],
    },
    build: |reader| Phase::Droplets(Droplets::new(reader.number(DIAMETER.name))),
    cases: || {
        let of = |diameter| Phase::Droplets(Droplets::new(diameter));
        vec![("cloud", of(5.0)), ("fog", of(20.0)), ("mist", of(50.0))]
    },
};

/// The phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Droplets {
    first: HenyeyGreenstein,
    second: Draine,
    /// The part of the second.
    share: f32,
}

impl Droplets {
    /// Phase function of droplets with a diameter of 5 to 50 µm. [Jendersie 2023]
    pub fn new(diameter: f32) -> Droplets {
        let d = diameter.clamp(5.0, 50.0);
        Droplets {
            first: HenyeyGreenstein { g: exp(-0.099_056_7 / (d - 1.671_54)) },
            second: Draine {
                g: exp(-2.206_79 / (d + 3.910_29) - 0.428_934),
                alpha: exp(3.624_89 - 8.292_88 / (d + 5.528_25)),
            },
            share: exp(-0.599_085 / (d - 0.641_583) - 0.665_888),
        }
    }

    #[inline]
    pub(super) fn at(&self, turn: f32) -> f32 {
        self.first.at(turn) * (1.0 - self.share) + self.second.at(turn) * self.share
    }

    #[inline]
    pub(super) fn sample_turn(&self, u_choice: f32, u: f32) -> f32 {
        if u_choice < self.share { self.second.sample_turn(0.0, u) } else { self.first.sample_turn(0.0, u) }
    }

    pub(super) fn mean_cosine(&self) -> f32 {
        self.first.mean_cosine() * (1.0 - self.share) + self.second.mean_cosine() * self.share
    }
}
