//! Media, and how light passes one that is the same everywhere.

use super::glow::{Glow, GlowLine};
use super::phases::{HenyeyGreenstein, Phase, read_phase};
use crate::grid::{Grid, GridLine};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use bilux_math::registry::{Parameter, ParameterKind};
use bilux_math::transcendental::{exp, ln};
use bilux_math::{Rgb, Transform, Vec3};

/// A medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium<'a> {
    /// Absorption coefficient, per metre; where a grid varies it, where that is 1.
    pub sigma_a: Rgb,
    /// Scattering coefficient, likewise.
    pub sigma_s: Rgb,
    /// The directions that it scatters into.
    pub phase: Phase,
    /// A factor on both coefficients; without one the medium is the same everywhere.
    pub density: Option<&'a Grid>,
    /// The light that it emits.
    pub glow: Option<&'a Glow>,
}

/// The line of a ray through the grids of a medium.
#[derive(Clone, Copy, Debug)]
pub struct MediumLine {
    pub(super) density: Option<GridLine>,
    pub(super) glow: Option<GlowLine>,
}

/// Transmittance of a line through a medium, and the probabilities of events on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreePath {
    /// The fraction of light that comes this far.
    pub transmittance: Rgb,
    /// The probability that a walk comes this far without an event.
    pub survival: f32,
    /// `survival` for a walk in each channel.
    pub survivals: Rgb,
    /// The density of an event per metre, where a walk came this far: at the beginning of the line, by a walk from its end, and at its
    /// end.
    pub hazards: [f32; 2],
}

impl FreePath {
    /// Through nothing.
    pub const CLEAR: FreePath =
        FreePath { transmittance: Rgb::WHITE, survival: 1.0, survivals: Rgb::WHITE, hazards: [0.0; 2] };
}

impl Medium<'_> {
    /// Nothing.
    pub const VACUUM: Medium<'static> = Medium {
        sigma_a: Rgb::BLACK,
        sigma_s: Rgb::BLACK,
        phase: Phase::HenyeyGreenstein(HenyeyGreenstein::ISOTROPIC),
        density: None,
        glow: None,
    };

    /// One that only absorbs, by this much per metre.
    pub fn absorbing(sigma_a: Rgb) -> Medium<'static> {
        Medium { sigma_a, ..Medium::VACUUM }
    }

    /// Reads [`SCATTERING`] and the parameters of phase functions; `sigma_a` is the absorption.
    ///
    /// # Errors
    /// When the phase function cannot be what its parameters say.
    pub(crate) fn read(reader: &Reader, sigma_a: Rgb) -> Result<Medium<'static>, SceneError> {
        let (sigma_s, phase) = (reader.colour(SCATTERING.name), read_phase(reader)?);
        Ok(Medium { sigma_a, sigma_s, phase, ..Medium::VACUUM })
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

    /// True when it scatters, and walks in different channels have different distances.
    pub fn has_coloured_distances(&self) -> bool {
        let sigma_t = self.sigma_t();
        self.scatters() && (sigma_t.r != sigma_t.g || sigma_t.g != sigma_t.b)
    }

    /// True when a walk through it has events, or only sampling tells what it absorbs or emits.
    #[inline]
    pub fn is_walked(&self) -> bool {
        self.scatters() || self.density.is_some() || self.glow.is_some()
    }

    /// The line of a ray through its grids, if it has any: from a point of the world along a unit vector.
    #[inline]
    pub fn line(
        &self,
        to_world: impl FnOnce() -> Transform,
        origin: Vec3,
        direction: Vec3,
    ) -> Option<MediumLine> {
        let glow = self.glow.filter(|glow| !glow.is_even());
        if self.density.is_none() && glow.is_none() {
            return None;
        }
        let to_object = to_world().inverted();
        let (origin, direction) = (to_object.point(origin), to_object.vector(direction));
        Some(MediumLine {
            density: self.density.map(|grid| grid.line(origin, direction)),
            glow: glow.map(|glow| glow.line(origin, direction)),
        })
    }

    /// The distance to the next event of a walk in a channel, where it is the same everywhere, in metres; infinite where nothing
    /// happens there.
    #[inline]
    pub fn sample_distance(&self, channel: usize, u: f32) -> f32 {
        // Of a channel without extinction this is infinite; 0 over 0 cannot be.
        thickness(u) / self.sigma_t()[channel]
    }

    /// Free path of a walk in a channel over a distance, where the medium is the same everywhere.
    ///
    /// Where nothing is scattered there are no events: a walk passes for certain, and carries less.
    #[inline]
    pub fn free_path(&self, distance: f32, channel: usize) -> FreePath {
        let sigma_t = self.sigma_t();
        let transmittance = beer(sigma_t, distance);
        if !self.scatters() {
            return FreePath { transmittance, ..FreePath::CLEAR };
        }
        FreePath {
            transmittance,
            survival: transmittance[channel],
            survivals: transmittance,
            hazards: [sigma_t[channel]; 2],
        }
    }
}

/// The mean over the channels.
#[inline]
pub fn mean(colour: Rgb) -> f32 {
    (colour.r + colour.g + colour.b) * (1.0 / 3.0)
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

/// The optical thickness that a ray passes before a collision; above 0, and finite since `u` is below 1.
#[inline]
pub(super) fn thickness(u: f32) -> f32 {
    -ln(1.0 - u).min(-f32::MIN_POSITIVE)
}

/// The parameter of media that scatter; those of phase functions belong to it.
pub(crate) const SCATTERING: Parameter = Parameter {
    name: "scattering",
    summary: "scattering coefficient inside: 1 over the mean distance that light travels before it is scattered",
    unit: "1/m",
    kind: ParameterKind::Colour { min: 0.0, max: 1e6 },
    default: "0",
};

/// The grid of media that vary.
pub(crate) const DENSITY: Parameter = Parameter {
    name: "density",
    summary: "factor on absorption and scattering inside, from a grid: smoke, a cloud",
    unit: "",
    kind: ParameterKind::Grid,
    default: "none",
};
