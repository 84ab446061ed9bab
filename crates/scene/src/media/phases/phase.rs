//! A phase function, one of [`PHASES`].

use super::phase_parameters::{ANISOTROPY, DIAMETER, DRAINE_ALPHA, KIND};
use super::{Draine, Droplets, HenyeyGreenstein, Rayleigh};
use crate::messages::error::SceneError;
use crate::parameters::Reader;
use bilux_math::registry::Entry;
use bilux_math::transcendental::sin_cos;
use bilux_math::{Frame, Vec2, Vec3};
use std::f32::consts::TAU;

/// A phase function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// One number from straight back to straight on.
    HenyeyGreenstein(HenyeyGreenstein),
    /// Molecules of air.
    Rayleigh(Rayleigh),
    /// Henyey and Greenstein's, with more to the back and less to the sides.
    Draine(Draine),
    /// Droplets of water.
    Droplets(Droplets),
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseSample {
    /// The direction in which light travels on, or came.
    pub wi: Vec3,
    /// Density over solid angle, which is the value of the phase function too.
    pub pdf_solid_angle: f32,
}

macro_rules! each_phase {
    ($phase:expr, $p:ident => $body:expr) => {
        match $phase {
            Phase::HenyeyGreenstein($p) => $body,
            Phase::Rayleigh($p) => $body,
            Phase::Draine($p) => $body,
            Phase::Droplets($p) => $body,
        }
    };
}

impl Phase {
    /// The fraction per solid angle of what came from `wo` that goes on along `wi`; both unit vectors point away from the point.
    /// It is the same when they are exchanged.
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.at((0.5 * (wo + wi).length_squared()).min(2.0))
    }

    /// [`Phase::eval`] by one minus the cosine of the angle by which light is turned.
    #[inline]
    pub fn at(&self, turn: f32) -> f32 {
        each_phase!(self, phase => phase.at(turn))
    }

    /// Samples a direction: `u_choice` picks a part of a mixture, `u` the direction.
    #[inline]
    pub fn sample(&self, wo: Vec3, u_choice: f32, u: Vec2) -> PhaseSample {
        let turn = each_phase!(self, phase => phase.sample_turn(u_choice, u.x)).clamp(0.0, 2.0);
        let sin = (turn * (2.0 - turn)).sqrt();
        let (sin_phi, cos_phi) = sin_cos(TAU * u.y);
        let local = Vec3::new(sin * cos_phi, sin * sin_phi, 1.0 - turn);
        let wi = Frame::from_normal(-wo).to_world(local).normalize();
        PhaseSample { wi, pdf_solid_angle: self.eval(wo, wi) }
    }

    /// The mean cosine: 0 where as much goes back as on.
    pub fn mean_cosine(&self) -> f32 {
        each_phase!(self, phase => phase.mean_cosine())
    }
}

/// A row of [`PHASES`].
#[derive(Clone, Copy, Debug)]
pub struct PhaseEntry {
    /// Name, summary, source, parameters.
    pub entry: Entry,
    /// Makes one from the parameters of its material.
    pub build: fn(&Reader) -> Phase,
    /// Cases for the contract tests: a name and a phase function.
    pub cases: fn() -> Vec<(&'static str, Phase)>,
}

/// All phase functions, the default first.
pub static PHASES: &[PhaseEntry] =
    &[super::henyey_greenstein::ENTRY, super::rayleigh::ENTRY, super::draine::ENTRY, super::droplets::ENTRY];

/// The phase function that a material's parameters describe.
///
/// # Errors
/// A parameter of another phase function than the one that is asked for has no effect, and is refused.
pub fn read_phase(reader: &Reader) -> Result<Phase, SceneError> {
    let name = reader.text(KIND.name);
    let row = PHASES.iter().find(|row| row.entry.name == name).unwrap_or(&PHASES[0]);
    let own = |key: &str| row.entry.parameters.iter().any(|parameter| parameter.name == key);
    for key in [ANISOTROPY, DRAINE_ALPHA, DIAMETER].map(|parameter| parameter.name) {
        if reader.is_given(key) && !own(key) {
            let message =
                format!("'{key}' has no effect on the phase function '{name}': remove it, or choose another");
            return Err(SceneError::invalid(message, reader.span(key)));
        }
    }
    Ok((row.build)(reader))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choice_of_words_is_the_table() {
        assert_eq!(
            PHASES.iter().map(|row| row.entry.name).collect::<Vec<_>>(),
            super::super::phase_parameters::NAMES
        );
    }
}
