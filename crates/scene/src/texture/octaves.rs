//! Octaves of noise, as textures and densities have them.

use crate::parameters::Reader;
use bilux_math::registry::{Parameter, ParameterKind};

/// Rate at which octaves fade.
pub(crate) const ROUGHNESS: Parameter = Parameter {
    name: "roughness",
    summary: "amplitude of each octave relative to the one before",
    unit: "",
    kind: ParameterKind::Number { min: 0.0, max: 1.0 },
    default: "0.5",
};

/// Which noise it is.
pub(crate) const SEED: Parameter = Parameter {
    name: "seed",
    summary: "seed of the noise",
    unit: "",
    kind: ParameterKind::Integer { min: 0, max: i64::MAX },
    default: "0",
};

/// The weight of each octave, given the parameters `octaves` and `roughness`: the root of the sum of their squares is `spread`, so that
/// the noise has the same standard deviation for any number of octaves.
pub(crate) fn weights(reader: &Reader, spread: f32) -> Vec<f32> {
    let roughness = reader.number("roughness");
    let mut weights: Vec<f32> = std::iter::successors(Some(1.0), |weight| Some(weight * roughness))
        .take(reader.integer("octaves") as usize)
        .collect();
    let sum = weights.iter().map(|weight| weight * weight).sum::<f32>().sqrt();
    weights.iter_mut().for_each(|weight| *weight *= spread / sum);
    weights
}
