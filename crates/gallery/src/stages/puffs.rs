//! Grids of smoke, clouds and flames: shapes with edges of noise.

use bilux_math::hash::{hash_more, hash_words};
use bilux_math::parallel;
use bilux_math::{Aabb, Transform, Vec3};
use bilux_scene::media::Grid;
use std::sync::Arc;

/// A grid that fills a box, from a function of position.
pub(super) fn grid(name: &str, bounds: Aabb, size: [usize; 3], of: impl Fn(Vec3) -> f32 + Sync) -> Arc<Grid> {
    let voxel = bounds.extent() / Vec3::from(size.map(|n| n as f32));
    let at = |[x, y, z]: [usize; 3]| bounds.min + voxel * (Vec3::new(x as f32, y as f32, z as f32) + 0.5);
    let [nx, ny, nz] = size;
    let value = |i| of(at([i % nx, i / nx % ny, i / (nx * ny)]));
    let mut values = vec![0.0; nx * ny * nz];
    parallel::fill(&mut values, 1 << 12, value);
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
    // The hash of the seed and the corner. Its beginning is common to several corners.
    let more = |hash: u64, axis: usize, step: i64| hash_more(hash, (cell[axis] + step) as u64);
    let seed = hash_words([seed]);
    let of_x = [0, 1].map(|x| more(seed, 0, x));
    let of_y = [0, 1].map(|y| of_x.map(|hash| more(hash, 1, y)));
    let value = |hash: u64, z: i64| (more(hash, 2, z) >> 40) as f32 / 8_388_608.0 - 1.0;
    let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let along_x = |y: usize, z: i64| lerp(value(of_y[y][0], z), value(of_y[y][1], z), u);
    lerp(lerp(along_x(0, 0), along_x(1, 0), v), lerp(along_x(0, 1), along_x(1, 1), v), w)
}
