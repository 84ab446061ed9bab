//! Media: what fills the inside of an object, and absorbs and scatters light there. How they scatter, the phase function,
//! is one of [`PHASES`].
//!
//! Coefficients are per metre and per channel. Where a channel is chosen, all channels are as likely, wherever a path comes from: so a
//! density does not depend on the path so far, and is the same for the same line from both ends.

mod grid;
mod phases;

pub use grid::{BLOCK, BLOCK_VOXELS, Block, Grid, GridError, GridLine, MAX_SIDE};
pub use phases::{
    Draine, Droplets, HenyeyGreenstein, PHASES, Phase, PhaseEntry, PhaseSample, Rayleigh, read_phase,
};

use crate::error::SceneError;
use crate::parameters::Reader;
use bilux_math::Rgb;
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::transcendental::{exp, ln};

/// A medium that is the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Absorption coefficient, per metre.
    pub sigma_a: Rgb,
    /// Scattering coefficient, per metre.
    pub sigma_s: Rgb,
    /// The directions that it scatters into.
    pub phase: Phase,
}

/// What a path meets on a line through a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreePath {
    /// The fraction of light that comes this far.
    pub transmittance: Rgb,
    /// The probability that a walk comes this far without an event.
    pub survival: f32,
    /// The density of an event here, per metre, where a walk came this far.
    pub hazard: f32,
}

impl Medium {
    /// Nothing.
    pub const VACUUM: Medium = Medium {
        sigma_a: Rgb::BLACK,
        sigma_s: Rgb::BLACK,
        phase: Phase::HenyeyGreenstein(HenyeyGreenstein::ISOTROPIC),
    };

    /// One that only absorbs, by this much per metre.
    pub fn absorbing(sigma_a: Rgb) -> Medium {
        Medium { sigma_a, ..Medium::VACUUM }
    }

    /// Reads [`SCATTERING`] and the parameters of phase functions; `sigma_a` is the absorption.
    ///
    /// # Errors
    /// When the phase function cannot be what its parameters say.
    pub(crate) fn read(reader: &Reader, sigma_a: Rgb) -> Result<Medium, SceneError> {
        Ok(Medium { sigma_a, sigma_s: reader.colour(SCATTERING.name), phase: read_phase(reader)? })
    }

    /// Extinction coefficient, per metre: what absorbs and what scatters.
    #[inline]
    pub fn sigma_t(&self) -> Rgb {
        self.sigma_a + self.sigma_s
    }

    /// True when it changes nothing.
    #[inline]
    pub fn is_clear(&self) -> bool {
        self.sigma_a.is_black() && self.sigma_s.is_black()
    }

    /// True when it scatters light.
    #[inline]
    pub fn scatters(&self) -> bool {
        !self.sigma_s.is_black()
    }

    /// Transmittance over a distance in metres, by Beer's law.
    #[inline]
    pub fn transmittance(&self, distance: f32) -> Rgb {
        beer(self.sigma_t(), distance)
    }

    /// The distance to the next event, in metres, where a channel is chosen by `u_channel`; infinite where nothing happens in
    /// that channel.
    #[inline]
    pub fn sample_distance(&self, u_channel: f32, u: f32) -> f32 {
        let channel = ((u_channel * 3.0) as usize).min(2);
        // Of a channel without extinction this is infinite; 0 over 0 cannot be, since u is below 1 and so the logarithm
        // finite.
        -ln(1.0 - u).min(-f32::MIN_POSITIVE) / self.sigma_t()[channel]
    }

    /// What a walk meets over a distance: densities are means over the channels that [`Medium::sample_distance`] chooses from.
    ///
    /// Where nothing is scattered there are no events: a walk passes for certain, and carries less.
    #[inline]
    pub fn free_path(&self, distance: f32) -> FreePath {
        let sigma_t = self.sigma_t();
        let transmittance = beer(sigma_t, distance);
        if !self.scatters() {
            return FreePath { transmittance, survival: 1.0, hazard: 0.0 };
        }
        let mean = |colour: Rgb| (colour.r + colour.g + colour.b) * (1.0 / 3.0);
        let survival = mean(transmittance);
        let density = mean(sigma_t * transmittance);
        // Beyond the range of numbers the clearest channel is all that is left.
        let clearest = sigma_t.r.min(sigma_t.g).min(sigma_t.b);
        FreePath {
            transmittance,
            survival,
            hazard: if survival > 0.0 { density / survival } else { clearest },
        }
    }
}

/// Transmittance over a distance in metres.
#[inline]
pub fn beer(sigma_t: Rgb, distance: f32) -> Rgb {
    if sigma_t.is_black() {
        return Rgb::WHITE;
    }
    // A distance that rounding made negative must not create light, and an infinite one leaves a channel without extinction
    // as it is.
    sigma_t.map(|sigma| if sigma == 0.0 { 1.0 } else { exp(-sigma * distance.max(0.0)) })
}

/// The parameter of media that scatter; those of phase functions belong to it.
pub(crate) const SCATTERING: Parameter = Parameter {
    name: "scattering",
    summary: "scattering coefficient inside: 1 over the mean distance that light travels before it is scattered",
    unit: "1/m",
    kind: ParameterKind::Colour { min: 0.0, max: 1e6 },
    default: "0",
};

pub(crate) use phases::{ANISOTROPY as PHASE_ANISOTROPY, DIAMETER, DRAINE_ALPHA, KIND as PHASE};
