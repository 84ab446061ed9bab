//! Whether two methods of rendering have the same mean, and whether a mean is what it should be.
//!
//! Verdicts of comparisons are remembered (`bilux_testing::verdicts`); planted bugs are compared by [`difference`] and measured by
//! [`channel_means`], which always render everything.

use super::{effort, integrator, shoot};
use bilux_math::Rgb;
use bilux_scene::Scene;
use bilux_testing::statistics::{sidak, welch as welch_if_varied};
use bilux_testing::verdicts::{Picture, Side, Suite};
use bilux_transport::{PixelIntegrator, RenderSettings};
use std::borrow::Borrow;
use std::ops::Range;

/// The comparisons of this suite.
pub const SUITE: Suite = Suite::new(env!("CARGO_PKG_NAME"));

/// Mean and standard error.
pub fn estimate(values: &[f64]) -> (f64, f64) {
    let (mean, variance) = bilux_testing::statistics::estimate(values);
    (mean, variance.sqrt())
}

pub fn channel(values: &[Rgb], channel: usize) -> Vec<f64> {
    values.iter().map(|v| f64::from(v[channel])).collect()
}

/// Probability that two sets of values with the same mean differ by as much as these; 1 where nothing varies. [Welch 1947]
pub fn welch(a: &[f64], b: &[f64]) -> f64 {
    welch_if_varied(a, b).unwrap_or(1.0)
}

/// Block means (2 × 2 blocks, three channels) of pictures with different seeds: `[block][picture]`.
pub fn blocks<'a>(
    scene: impl Borrow<Scene> + 'a,
    integrator: impl Borrow<Box<dyn PixelIntegrator>> + 'a,
    first_seed: u64,
) -> Side<'a> {
    blocks_of_depth(scene, integrator, first_seed, 6)
}

/// Block means of paths with at most this many events on surfaces.
pub fn blocks_of_depth<'a>(
    scene: impl Borrow<Scene> + 'a,
    integrator: impl Borrow<Box<dyn PixelIntegrator>> + 'a,
    first_seed: u64,
    max_depth: u32,
) -> Side<'a> {
    Side::new(first_seed..first_seed + 12, move |seed| {
        let settings = RenderSettings { seed, max_depth, ..RenderSettings::new(16, 16, 32) };
        let pixels = shoot(scene.borrow(), &**integrator.borrow(), &settings).film.to_rgb();
        let mut sums = vec![0.0; 12];
        for (i, pixel) in pixels.iter().enumerate() {
            let block = (i / 16 / 8) * 2 + i % 16 / 8;
            (0..3).for_each(|c| sums[block * 3 + c] += f64::from(pixel[c]));
        }
        Picture::new(&pixels, sums)
    })
}

/// The minimum p-value over all blocks, corrected for their number. [Šidák 1967]
pub fn least_p(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let least = a.iter().zip(b).map(|(a, b)| welch(a, b)).fold(1.0, f64::min);
    sidak(least, a.len())
}

/// The p-value that two sides have the same mean: by the record of this case, where their first pictures are as they were.
pub fn agreement(case: &str, a: &Side, b: &Side) -> f64 {
    SUITE.agreement(case, "least p", [a, b], least_p)
}

/// The p-value that two sides have the same mean, of which one has a planted bug.
pub fn difference(a: &Side, b: &Side) -> f64 {
    least_p(a.cells(), b.cells())
}

/// A p-value below this means a bug, not chance.
pub const UNLIKELY: f64 = 1e-4;

/// For one integrator of a list, what it finds in a scene.
fn blocks_by<'a>(scene: &'a Scene, others: &[&str], i: usize) -> Side<'a> {
    blocks(scene, integrator(others[i]), 100 * (i as u64 + 1))
}

/// Fails where other integrators find a different mean in a scene than `path` does.
pub fn assert_like_path(name: &str, scene: &Scene, others: &[&str]) {
    assert_these_like_path(name, scene, others, 0..others.len());
}

/// Fails where one of many scenes has a different mean; in the short form with only one of the integrators, in turn.
pub fn assert_like_path_in_turn(turn: usize, name: &str, scene: &Scene, others: &[&str]) {
    let one = turn % others.len();
    assert_these_like_path(name, scene, others, effort(one..one + 1, 0..others.len()));
}

fn assert_these_like_path(name: &str, scene: &Scene, others: &[&str], chosen: Range<usize>) {
    let path = blocks(scene, integrator("path"), 0);
    for i in chosen {
        let case = format!("{name}: path and {}", others[i]);
        let p = agreement(&case, &path, &blocks_by(scene, others, i));
        assert!(p > UNLIKELY, "{case}: p = {p}");
    }
}

/// Fails where others find the same mean in a scene with a planted bug as `path` finds in the right one.
pub fn assert_unlike_path(right: &Scene, wrong: &Scene, others: &[&str]) {
    let path = blocks(right, integrator("path"), 0);
    for i in 0..others.len() {
        let p = difference(&path, &blocks_by(wrong, others, i));
        assert!(p < UNLIKELY, "{} passes: p = {p}", others[i]);
    }
}

/// The means of the channels of a picture over its pixels, with their standard errors.
pub fn channel_means(
    scene: &Scene,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
) -> [(f64, f64); 3] {
    means_over(&shoot(scene, integrator, settings).film.to_rgb())
}

fn means_over(pixels: &[Rgb]) -> [(f64, f64); 3] {
    [0, 1, 2].map(|of| estimate(&channel(pixels, of)))
}

/// Means as [`channel_means`] gives them: by the record of this case, where the first of its samples are as they were.
pub fn recorded_means(
    case: &str,
    scene: &Scene,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
) -> [(f64, f64); 3] {
    let numbers = |pixels: &[Rgb]| means_over(pixels).iter().flat_map(|(m, e)| [*m, *e]).collect();
    let found = recorded(case, "means and errors", (scene, integrator, settings), numbers);
    [0, 1, 2].map(|of| (found[2 * of], found[2 * of + 1]))
}

/// Numbers of a picture: by the record of this case, where the first of its samples are as they were.
pub fn recorded(
    case: &str,
    asked: &str,
    (scene, integrator, settings): (&Scene, &dyn PixelIntegrator, &RenderSettings),
    numbers: impl FnOnce(&[Rgb]) -> Vec<f64>,
) -> Vec<f64> {
    let render = |spp| {
        let settings = RenderSettings { spp, samples: 0..spp, ..settings.clone() };
        shoot(scene, integrator, &settings).film.to_rgb()
    };
    SUITE.numbers(case, &format!("{asked} of samples a pixel"), settings.spp, render, |all| numbers(all))
}

/// Fails unless an integrator finds that a scene in light of 1 from everywhere is as bright everywhere.
pub fn assert_vanishes(what: &str, scene: &Scene, name: &str) {
    let settings = RenderSettings { max_depth: 500, ..RenderSettings::new(24, 24, effort(16, 256)) };
    let case = format!("{what}, {name}");
    for (mean, error) in recorded_means(&case, scene, &*integrator(name), &settings) {
        assert!((mean - 1.0).abs() < 3.5 * error + 1e-4, "{case}: {mean} ± {error}");
    }
}
