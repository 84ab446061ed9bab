//! Clouds: several octaves of gradient noise. [Perlin 2002]

use super::place::{U_OFFSET, UvPlacement, V_OFFSET, u_scale, v_scale};
use super::{Pattern, TextureEntry, tone};
use crate::texture::ColourMap;
use crate::texture::octaves::{ROUGHNESS, SEED, weights};
use bilux_math::hash::hash_words;
use bilux_math::registry::{Entry, Parameter, ParameterKind};
use bilux_math::transcendental::{cos, sin};
use bilux_math::{Rgb, Vec2};
use std::f32::consts::{SQRT_2, TAU};
use std::sync::{Arc, LazyLock};

/// The row of `noise`.
pub(super) const ENTRY: TextureEntry = TextureEntry {
    entry: Entry {
        name: "noise",
        summary: "fractal Perlin noise between two colours",
        source: "Perlin 2002",
        parameters: &[
            tone("a", "colour where the noise is 0", "0 0 0"),
            tone("b", "colour where the noise is 1", "1 1 1"),
            Parameter {
                name: "octaves",
                summary: "number of octaves",
                unit: "",
                kind: ParameterKind::Integer { min: 1, max: 16 },
                default: "6",
            },
            ROUGHNESS,
            SEED,
            u_scale("factor on u: the number of cells of the noise across", "4"),
            v_scale("factor on v: the number of cells of the noise upwards", "4"),
            U_OFFSET,
            V_OFFSET,
        ],
    },
    build: |reader, parts| {
        let [a, b] = ["a", "b"].map(|key| parts.colour(reader, key));
        let octaves = weights(reader, SQRT_2);
        let seed = reader.integer("seed") as u64;
        Ok(Arc::new(Noise { a, b, octaves, seed, place: UvPlacement::read(reader) }))
    },
};

#[derive(Debug)]
struct Noise {
    a: ColourMap,
    b: ColourMap,
    /// The weight of each octave.
    octaves: Vec<f32>,
    seed: u64,
    place: UvPlacement,
}

impl Pattern for Noise {
    fn at(&self, uv: Vec2) -> Rgb {
        let mut at = self.place.of(uv);
        let mut sum = 0.0;
        for (octave, weight) in self.octaves.iter().enumerate() {
            // Far away, f32 has no numbers for positions between grid corners.
            if !at.is_finite() {
                break;
            }
            sum += weight * noise(at, hash_words([self.seed, octave as u64]));
            // The shift keeps the zeros of the octaves from coinciding.
            at = at * 2.0 + Vec2::new(0.37, 0.71);
        }
        self.a.at(uv).lerp(self.b.at(uv), (0.5 + 0.5 * sum).clamp(0.0, 1.0))
    }
}

/// Unit vectors in all directions.
static DIRECTIONS: LazyLock<[Vec2; 64]> = LazyLock::new(|| {
    let angle = |i: usize| (i as f32 + 0.5) / 64.0 * TAU;
    std::array::from_fn(|i| Vec2::new(cos(angle(i)), sin(angle(i))))
});

/// Gradients at the corners of a grid, blended with a continuous second derivative: 0 at corners, and between -1/√2 and
/// 1/√2. [Perlin 2002]
fn noise(at: Vec2, seed: u64) -> f32 {
    let corner = at.floor();
    let inside = at - corner;
    let (x, y) = (corner.x as i64, corner.y as i64);
    let slope = |dx: i64, dy: i64| {
        let hash = hash_words([seed, x.wrapping_add(dx) as u64, y.wrapping_add(dy) as u64]);
        DIRECTIONS[(hash >> 58) as usize].dot(inside - Vec2::new(dx as f32, dy as f32))
    };
    let fade = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v) = (fade(inside.x), fade(inside.y));
    let between = |a: f32, b: f32, t: f32| a + (b - a) * t;
    between(between(slope(0, 0), slope(1, 0), u), between(slope(0, 1), slope(1, 1), u), v)
}
