//! Draine's phase function: Henyey and Greenstein's times 1 + α cos². [Draine 2003]

use super::phase_parameters::{ANISOTROPY, DRAINE_ALPHA};
use super::{HenyeyGreenstein, Phase, PhaseEntry};
use bilux_math::registry::Entry;

pub(super) const ENTRY: PhaseEntry = PhaseEntry {
    entry: Entry {
        name: "draine",
        summary: "dust: between henyey-greenstein and rayleigh by two numbers",
        source: "Draine 2003",
        parameters: &[ANISOTROPY, DRAINE_ALPHA],
    },
    build: |reader| {
        Phase::Draine(Draine { g: reader.number(ANISOTROPY.name), alpha: reader.number(DRAINE_ALPHA.name) })
    },
    cases: || {
        let of = |g, alpha| Phase::Draine(Draine { g, alpha });
        vec![
            ("rayleigh", of(0.0, 1.0)),
            ("dust", of(0.6, 1.0)),
            ("droplets", of(0.6, 30.0)),
            ("back", of(-0.8, 2.0)),
            ("nearly even", of(2e-5, 500.0)),
        ]
    },
};

/// The phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draine {
    /// The mean cosine without the second factor, -0.99..=0.99.
    pub g: f32,
    /// The weight of the squared cosine, at least 0.
    pub alpha: f32,
}

/// Below this the first factor is even to within what 64 bits tell apart.
const EVEN: f64 = 1e-4;

/// Each step of the bisection halves the range of the cosine; Newton's steps double the digits.
const STEPS: u32 = 40;

impl Draine {
    #[inline]
    pub(super) fn at(&self, turn: f32) -> f32 {
        let cos = 1.0 - turn;
        HenyeyGreenstein { g: self.g }.at(turn) * (1.0 + self.alpha * cos * cos) / self.norm()
    }

    /// The mean of the second factor over the first.
    fn norm(&self) -> f32 {
        1.0 + self.alpha * (1.0 + 2.0 * self.g * self.g) * (1.0 / 3.0)
    }

    /// Solves for the cosine below which lies the fraction `u`: Newton's method, kept between bounds.
    pub(super) fn sample_turn(&self, _u_choice: f32, u: f32) -> f32 {
        let (mut low, mut high) = (-1.0, 1.0);
        let u = f64::from(u);
        let mut cos = 2.0 * u - 1.0;
        for _ in 0..STEPS {
            let error = self.below(cos) - u;
            if error > 0.0 {
                high = cos
            } else {
                low = cos
            }
            let density = f64::from(self.at((1.0 - cos) as f32)) * std::f64::consts::TAU;
            let step = error / density;
            if step.abs() < 1e-9 {
                break;
            }
            let next = cos - step;
            cos = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        (1.0 - cos) as f32
    }

    /// The fraction that is scattered into cosines up to this one.
    fn below(&self, cos: f64) -> f64 {
        let (g, alpha) = (f64::from(self.g), f64::from(self.alpha));
        if g.abs() < EVEN {
            return (cos + 1.0 + alpha * (cos * cos * cos + 1.0) / 3.0) / (2.0 + alpha * (2.0 / 3.0));
        }
        // By s = √(1 + g² - 2g cos): dcos = -s/g ds, and cos = c - s²/2g with c = (1 + g²)/2g.
        let c = (1.0 + g * g) / (2.0 * g);
        let part = |s: f64| {
            let square = -c * c / s - c * s / g + s * s * s / (12.0 * g * g);
            -1.0 / s + alpha * square
        };
        let s = (1.0 + g * g - 2.0 * g * cos).sqrt();
        let scale = (1.0 - g * g) / (2.0 * g);
        scale * (part(1.0 + g) - part(s)) / (1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0)
    }

    /// [Jendersie 2023]
    pub(super) fn mean_cosine(&self) -> f32 {
        let Draine { g, alpha } = *self;
        g * (1.0 + alpha * (3.0 + 2.0 * g * g) / 5.0) / self.norm()
    }
}
