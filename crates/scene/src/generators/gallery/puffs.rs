//! Grids of smoke, clouds and flames: shapes with edges of noise.

use crate::grid::Grid;
use bilux_math::hash::hash_words;
use bilux_math::{Aabb, Transform, Vec3};
use std::sync::Arc;

/// A grid that fills a box, from a function of position.
pub(super) fn grid(name: &str, bounds: Aabb, size: [usize; 3], of: impl Fn(Vec3) -> f32) -> Arc<Grid> {
    let voxel = bounds.extent() / Vec3::from(size.map(|n| n as f32));
    let at = |[x, y, z]: [usize; 3]| bounds.min + voxel * (Vec3::new(x as f32, y as f32, z as f32) + 0.5);
    let [nx, ny, nz] = size;
    let values: Vec<f32> = (0..nx * ny * nz).map(|i| of(at([i % nx, i / nx % ny, i / (nx * ny)]))).collect();
    // A box with a volume and as many values as voxels always makes a grid.
    let place =
        Transform::scale(voxel).and_then(|scale| Some(scale.then(&Transform::translate(bounds.min)?)));
    let grid = Grid::dense(name, size, &place.unwrap_or_default(), &values);
    Arc::new(grid.unwrap_or_else(|error| unreachable!("{error}")))
}

/// Smooth noise between -1 and 1, of several octaves.
pub(super) fn clouds(mut at: Vec3, octaves: u32, seed: u64) -> f32 {
    let (mut sum, mut weight, mut all) = (0.0, 1.0, 0.0);
    for octave in 0..octaves {
        sum += weight * noise(at, hash_words([seed, u64::from(octave)]));
        all += weight;
        weight *= 0.5;
        at = at * 2.03 + Vec3::new(0.37, 0.71, 0.13);
    }
    sum / all
}

/// From 0 at `low` to 1 at `high`, level at both ends.
pub(super) fn rise(x: f32, low: f32, high: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Numbers between -1 and 1 at the corners of a lattice, blended smoothly.
fn noise(at: Vec3, seed: u64) -> f32 {
    let corner = at.floor();
    let inside = at - corner;
    let cell = [corner.x as i64, corner.y as i64, corner.z as i64];
    let fade = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let [u, v, w] = inside.to_array().map(fade);
    let value = |x: i64, y: i64, z: i64| {
        let hash = hash_words([seed, (cell[0] + x) as u64, (cell[1] + y) as u64, (cell[2] + z) as u64]);
        (hash >> 40) as f32 / 8_388_608.0 - 1.0
    };
    let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let along_x = |y: i64, z: i64| lerp(value(0, y, z), value(1, y, z), u);
    lerp(lerp(along_x(0, 0), along_x(1, 0), v), lerp(along_x(0, 1), along_x(1, 1), v), w)
}
