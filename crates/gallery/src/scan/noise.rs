//! Procedural roughness: deterministic noise in space.

use bilux_math::Vec3;
use bilux_math::hash::{hash_words, unit_f32};

/// A pseudo-random number in 0..1 for a cell of space.
fn cell(at: [i32; 3], salt: u64) -> f32 {
    unit_f32(hash_words([at[0] as u64, at[1] as u64, at[2] as u64, salt]) as u32)
}

/// Values at the corners of cells of side 1, blended smoothly between them; in -1..1.
fn value(p: Vec3, salt: u64) -> f32 {
    let floor = p.floor();
    let f = p - floor;
    let s = f * f * (3.0 - 2.0 * f);
    let [x, y, z] = floor.to_array().map(|c| c as i32);
    let along_x = |j: i32, k: i32| {
        let (a, b) = (cell([x, y + j, z + k], salt), cell([x + 1, y + j, z + k], salt));
        a + (b - a) * s.x
    };
    let along_y = |k: i32| along_x(0, k) + (along_x(1, k) - along_x(0, k)) * s.y;
    2.0 * (along_y(0) + (along_y(1) - along_y(0)) * s.z) - 1.0
}

/// Several octaves of noise, each with half the size and half the amplitude of the previous one; in -2..2.
pub(super) fn rough(p: Vec3, octaves: u32) -> f32 {
    let octave = |n: u32| value(p * (1u32 << n) as f32, u64::from(n)) / (1u32 << n) as f32;
    (0..octaves).map(octave).sum()
}

/// Distance to the nearest of points scattered one per cell of side 1: scales and pebbles. At most about 1.2.
pub(super) fn pebbles(p: Vec3) -> f32 {
    let floor = p.floor();
    let [x, y, z] = floor.to_array().map(|c| c as i32);
    let mut nearest = f32::INFINITY;
    for n in 0..27 {
        let at = [x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1];
        let jitter = Vec3::new(cell(at, 101), cell(at, 102), cell(at, 103));
        let point = Vec3::from(at.map(|c| c as f32)) + Vec3::splat(0.15) + 0.7 * jitter;
        nearest = nearest.min(point.distance_squared(p));
    }
    nearest.sqrt()
}
