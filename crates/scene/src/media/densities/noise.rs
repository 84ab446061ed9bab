//! Patches and swathes: several octaves of noise. [Perlin 2002]

use super::density::{FROM, RESOLUTION, TO};
use super::gradient_noise;
use super::{Density, DensityEntry};
use crate::messages::error::SceneError;
use crate::texture::octaves::{ROUGHNESS, SEED, weights};
use bilux_math::Vec3;
use bilux_math::hash::hash_words;
use bilux_math::registry::{Entry, Parameter, ParameterKind};

pub(super) const ENTRY: DensityEntry = DensityEntry {
    entry: Entry {
        name: "noise",
        summary: "fractal Perlin noise: patches of fog",
        source: "Perlin 2002",
        parameters: &[
            Parameter {
                name: "frequency",
                summary: "patches for each metre of the object",
                unit: "1/m",
                kind: ParameterKind::Number { min: 0.0, max: 1e4 },
                default: "4",
            },
            Parameter {
                name: "octaves",
                summary: "number of octaves, each with half the size of the one before",
                unit: "",
                kind: ParameterKind::Integer { min: 1, max: 16 },
                default: "5",
            },
            ROUGHNESS,
            Parameter {
                name: "low",
                summary: "where the noise, whose mean is 0.5, is below this, the density is 0",
                unit: "",
                kind: ParameterKind::Number { min: -10.0, max: 10.0 },
                default: "0",
            },
            Parameter {
                name: "high",
                summary: "where the noise is above this, the density is 1",
                unit: "",
                kind: ParameterKind::Number { min: -10.0, max: 10.0 },
                default: "1",
            },
            SEED,
            FROM,
            TO,
            RESOLUTION,
        ],
    },
    build: |reader| {
        let [frequency, low, high] = ["frequency", "low", "high"].map(|key| reader.number(key));
        if low >= high {
            let message = format!("'low' is {low}, which is not below 'high', {high}");
            return Err(SceneError::invalid(message, reader.span("low")));
        }
        let seed = reader.integer("seed") as u64;
        // Noise of one octave has a standard deviation of .27; that of the sum is then .2.
        let octaves = weights(reader, 0.75).into_iter().zip(0..);
        let octaves = octaves.map(|(weight, octave)| (weight, shift(seed, octave))).collect();
        Ok(Box::new(Noise { frequency, octaves, low, high }))
    },
};

/// Offset of the noise of an octave, in its cells, which repeat every 256.
fn shift(seed: u64, octave: u64) -> Vec3 {
    Vec3::from([0, 1, 2].map(|axis| (hash_words([seed, octave, axis]) >> 48) as f32 / 256.0))
}

struct Noise {
    frequency: f32,
    /// The weight of each octave, and where it begins.
    octaves: Vec<(f32, Vec3)>,
    low: f32,
    high: f32,
}

impl Density for Noise {
    fn at(&self, p: Vec3) -> f32 {
        let (mut sum, mut place) = (0.5, p * self.frequency);
        for (weight, shift) in &self.octaves {
            sum += weight * gradient_noise::noise(place + *shift);
            place *= 2.0;
        }
        ((sum - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    fn detail(&self) -> Vec3 {
        // Four voxels for each cell of the finest octave that has a hundredth of the amplitude.
        let finest = self.octaves.iter().rposition(|(weight, _)| *weight > 0.01).unwrap_or(0);
        Vec3::splat(4.0 * self.frequency * (1u32 << finest) as f32)
    }
}
