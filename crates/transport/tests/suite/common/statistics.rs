//! Whether two methods of rendering have the same mean.

use super::{effort, integrator, shoot};
use bilux_math::Rgb;
use bilux_scene::Scene;
use bilux_transport::{PixelIntegrator, RenderSettings};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::ops::Range;

/// Mean and standard error.
pub fn estimate(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

pub fn channel(values: &[Rgb], channel: usize) -> Vec<f64> {
    values.iter().map(|v| f64::from(v[channel])).collect()
}

/// Probability that two sets of values with the same mean differ by as much as these. [Welch 1947]
pub fn welch(a: &[f64], b: &[f64]) -> f64 {
    let ((mean_a, error_a), (mean_b, error_b)) = (estimate(a), estimate(b));
    let (va, vb) = (error_a * error_a, error_b * error_b);
    if va + vb == 0.0 {
        return f64::from(u8::from(mean_a == mean_b));
    }
    let freedom =
        (va + vb) * (va + vb) / (va * va / (a.len() as f64 - 1.0) + vb * vb / (b.len() as f64 - 1.0));
    let t = (mean_a - mean_b).abs() / (va + vb).sqrt();
    2.0 * StudentsT::new(0.0, 1.0, freedom).unwrap().sf(t)
}

/// Block means (2 × 2 blocks, three channels) of pictures with different seeds: `[block][picture]`.
pub fn blocks(scene: &Scene, integrator: &dyn PixelIntegrator, first_seed: u64) -> Vec<Vec<f64>> {
    blocks_of_depth(scene, integrator, first_seed, 6)
}

/// The same of paths with at most this many events on surfaces.
pub fn blocks_of_depth(
    scene: &Scene,
    integrator: &dyn PixelIntegrator,
    first_seed: u64,
    max_depth: u32,
) -> Vec<Vec<f64>> {
    let mut blocks = vec![Vec::new(); 12];
    for seed in first_seed..first_seed + 12 {
        let settings = RenderSettings { seed, max_depth, ..RenderSettings::new(16, 16, 32) };
        let film = shoot(scene, integrator, &settings).film;
        let mut sums = vec![0.0; 12];
        for (i, pixel) in film.to_rgb().into_iter().enumerate() {
            let block = (i / 16 / 8) * 2 + i % 16 / 8;
            (0..3).for_each(|c| sums[block * 3 + c] += f64::from(pixel[c]));
        }
        blocks.iter_mut().zip(sums).for_each(|(block, sum)| block.push(sum));
    }
    blocks
}

/// The minimum p-value over all blocks, corrected for their number. [Šidák 1967]
pub fn agreement(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let least = a.iter().zip(b).map(|(a, b)| welch(a, b)).fold(1.0, f64::min);
    1.0 - bilux_math::transcendental::powf_f64(1.0 - least, a.len() as f64)
}

/// A p-value below this means a bug, not chance.
pub const UNLIKELY: f64 = 1e-4;

/// For some of these integrators, the p-value that what it finds in a scene has the mean of what `path` finds in another.
fn against_path<'a>(
    path: &Scene,
    scene: &Scene,
    others: &[&'a str],
    chosen: Range<usize>,
) -> Vec<(&'a str, f64)> {
    let path = blocks(path, &*integrator("path"), 0);
    let p = |i: usize| {
        (others[i], agreement(&path, &blocks(scene, &*integrator(others[i]), 100 * (i as u64 + 1))))
    };
    chosen.map(p).collect()
}

/// Fails where other integrators find a different mean in a scene than `path` does.
pub fn assert_like_path(name: &str, scene: &Scene, others: &[&str]) {
    assert_these_like_path(name, scene, others, 0..others.len());
}

/// The same for one of many scenes: in the short form with only one of the integrators, in turn.
pub fn assert_like_path_in_turn(turn: usize, name: &str, scene: &Scene, others: &[&str]) {
    let one = turn % others.len();
    assert_these_like_path(name, scene, others, effort(one..one + 1, 0..others.len()));
}

fn assert_these_like_path(name: &str, scene: &Scene, others: &[&str], chosen: Range<usize>) {
    for (other, p) in against_path(scene, scene, others, chosen) {
        assert!(p > UNLIKELY, "{name}: path and {other}: p = {p}");
    }
}

/// Fails where others find the same mean in a scene with a planted bug as `path` finds in the right one.
pub fn assert_unlike_path(right: &Scene, wrong: &Scene, others: &[&str]) {
    for (other, p) in against_path(right, wrong, others, 0..others.len()) {
        assert!(p < UNLIKELY, "{other} passes: p = {p}");
    }
}

/// Fails unless an integrator finds that a scene in light of 1 from everywhere is as bright everywhere.
pub fn assert_vanishes(what: &str, scene: &Scene, name: &str) {
    let settings = RenderSettings { max_depth: 500, ..RenderSettings::new(24, 24, effort(16, 256)) };
    let pixels = shoot(scene, &*integrator(name), &settings).film.to_rgb();
    for of in 0..3 {
        let (mean, error) = estimate(&channel(&pixels, of));
        assert!((mean - 1.0).abs() < 3.5 * error + 1e-4, "{what}, {name}: {mean} ± {error}");
    }
}
