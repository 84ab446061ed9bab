//! Frequency with which the error that is stated for a picture is true.

use crate::common::statistics::{SUITE, estimate};
use crate::common::{ball, built, diffuse, effort, floor, integrator, look, put, shoot};
use bilux_math::transcendental::powf_f64;
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Scene, SceneBuilder, Spec};
use bilux_testing::verdicts::{Bits, Hash};
use bilux_transport::{
    Estimate, Interval, PixelIntegrator, REPLICATES, RenderError, RenderSettings, Silent, Stop, Window,
    integrators, render,
};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::BTreeMap;
use std::sync::LazyLock;

const SIDE: u32 = 16;

/// Number of seeds whose pictures are compared with the truth.
const SEEDS: u32 = 100;

/// A diffuse and a glossy ball on a table under a panel: all of the light is found from both ends.
fn two_balls() -> Scene {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "table", floor(0.0, 1.6), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    put(&mut builder, "matte", ball(Vec3::new(0.9, 0.6, -0.3), 0.6, 10, true), diffuse(0.6f32));
    let satin = Spec::new("", "phong").with("kd", 0.3f32).with("ks", 0.5f32).with("exponent", 10.0f32);
    let satin = satin.with("reflectivity", 0.0f32);
    put(&mut builder, "satin", ball(Vec3::new(-0.8, 0.7, 0.0), 0.7, 10, true), satin);
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.8, 3.0, 0.5)).with("intensity", 12.0f32);
    builder.lights.push(panel.with("edge_u", Vec3::X).with("edge_v", Vec3::new(0.0, 0.3, 1.0)));
    look(&mut builder, Vec3::new(0.0, 3.0, 4.0), Vec3::new(0.0, 0.3, 0.0), 32.0);
    built(&builder)
}

fn settings(seed: u64, spp: u32) -> RenderSettings {
    RenderSettings { seed, interval: true, max_depth: 4, threads: 2, ..RenderSettings::new(SIDE, SIDE, spp) }
}

/// Pictures with their intervals.
struct Pictures(Vec<Interval>);

impl Bits for Pictures {
    fn add_to(&self, hash: &mut Hash) {
        for (picture, pixel) in
            self.0.iter().flat_map(|p| p.window().tiles(1).into_iter().map(move |w| (p, w)))
        {
            let Estimate { mean, half_width } = picture.luminance(&pixel);
            [mean, half_width].add_to(hash);
        }
    }
}

fn take(scene: &Scene, integrator: &dyn PixelIntegrator, settings: &RenderSettings) -> Interval {
    shoot(scene, integrator, settings).interval.unwrap()
}

/// The integrators that claim to be unbiased.
fn unbiased() -> [(&'static str, Box<dyn PixelIntegrator>); 4] {
    let auto = integrators::build(&Spec::new("", "auto").with("merge", "never")).unwrap();
    let named = |name: &'static str| (name, integrator(name));
    [named("path"), named("bdpt"), named("light"), ("auto", auto)]
}

/// The fraction of windows whose interval, scaled by `width`, contains the truth. Windows without noise prove nothing,
/// and are left out.
fn coverage(pictures: &[Interval], truth: &Interval, side: u32, width: f64) -> f64 {
    let (mut held, mut all) = (0, 0);
    for window in truth.window().tiles(side) {
        let truth = truth.luminance(&window).mean;
        for estimate in pictures.iter().map(|picture| picture.luminance(&window)) {
            if estimate.half_width > 1e-5 * estimate.mean {
                held += u32::from((estimate.mean - truth).abs() <= width * estimate.half_width);
                all += 1;
            }
        }
    }
    f64::from(held) / f64::from(all)
}

const SPP: u32 = 64;

/// The scene, and its reference picture with a hundred times as many samples as the tested pictures.
static KNOWN: LazyLock<(Scene, Interval)> = LazyLock::new(|| {
    let scene = two_balls();
    let truth = take(&scene, &*integrator("path"), &settings(1000, 100 * SPP));
    (scene, truth)
});

fn is_honest(share: f64) -> bool {
    (0.93..=0.97).contains(&share)
}

#[test]
fn nineteen_of_twenty_intervals_hold_the_truth() {
    let scene = two_balls();
    for (name, integrator) in unbiased().into_iter().take(effort(2, 4)) {
        let one = |seed| take(&scene, &*integrator, &settings(seed, SPP));
        let pictures = |count: u32| Pictures((0..u64::from(count)).map(one).collect());
        let shares = SUITE.numbers(name, "shares of blocks, pixels, by pictures", SEEDS, pictures, |all| {
            let of = |(side, width)| coverage(&all.0, &KNOWN.1, side, width);
            [(4, 1.0), (1, 1.0), (4, 0.8)].map(of).to_vec()
        });
        let [blocks, pixels, narrow] = [0, 1, 2].map(|i| shares[i]);
        assert!(is_honest(blocks), "{name}: {blocks} of the blocks, {pixels} of the pixels");
        // A pixel's few samples may all miss a rare contribution.
        assert!((0.9..=0.97).contains(&pixels), "{name}: {pixels} of the pixels");
        // Negative control: intervals that are too narrow.
        assert!(!is_honest(narrow), "{name}: {narrow} with four fifths of the width");
    }
}

/// So few samples that their even distribution makes most of the difference.
const FEW: u32 = 16;

/// Estimates from the samples of a plain picture, with runs of its one sequence treated as independent.
fn as_if_independent(scene: &Scene, integrator: &dyn PixelIntegrator, seed: u64) -> Vec<Estimate> {
    let run = |k: u32| {
        let samples = k * FEW / REPLICATES..(k + 1) * FEW / REPLICATES;
        let plain = RenderSettings { interval: false, samples, ..settings(seed, FEW) };
        shoot(scene, integrator, &plain).film.to_rgb()
    };
    let runs: Vec<Vec<Rgb>> = (0..REPLICATES).map(run).collect();
    let block = |window: &Window| {
        let at = |i| window.position(i).1 * SIDE + window.position(i).0;
        let light = |run: &Vec<Rgb>| {
            (0..window.pixels()).map(|i| f64::from(run[at(i) as usize].luminance())).sum::<f64>()
                / window.pixels() as f64
        };
        let (mean, error) = estimate(&runs.iter().map(light).collect::<Vec<f64>>());
        Estimate { mean, half_width: error * 2.364_624 }
    };
    Window::whole(SIDE, SIDE).tiles(4).iter().map(block).collect()
}

#[test]
fn runs_of_one_sequence_are_not_independent() {
    let ((scene, truth), path) = (&*KNOWN, integrator("path"));
    let (mut held, mut all) = (0, 0);
    for seed in 0..u64::from(SEEDS) {
        let reported = as_if_independent(scene, &*path, seed);
        for (window, reported) in Window::whole(SIDE, SIDE).tiles(4).iter().zip(reported) {
            if reported.half_width > 1e-5 * reported.mean {
                held +=
                    u32::from((reported.mean - truth.luminance(window).mean).abs() <= reported.half_width);
                all += 1;
            }
        }
    }
    let share = f64::from(held) / f64::from(all);
    assert!(!is_honest(share) && share > 0.97, "{share}");
}

#[test]
fn intervals_are_the_same_whatever_threads_tiles_and_parts() {
    let scene = two_balls();
    for name in ["path", "bdpt", "vcm"] {
        let integrator = integrator(name);
        let whole = settings(3, 21);
        let all = shoot(&scene, &*integrator, &whole);
        let interval = all.interval.unwrap();
        let alone = shoot(&scene, &*integrator, &RenderSettings { threads: 1, ..whole.clone() });
        assert!(alone.film == all.film && alone.interval.as_ref() == Some(&interval), "{name}");
        let window = Window { x: 5, y: 3, width: 9, height: 7 };
        let cropped = shoot(&scene, &*integrator, &RenderSettings { crop: Some(window), ..whole.clone() });
        let cropped = cropped.interval.unwrap();
        for pixel in window.tiles(1) {
            assert_eq!(cropped.luminance(&pixel), interval.luminance(&pixel), "{name}");
        }
        let part = |samples| shoot(&scene, &*integrator, &RenderSettings { samples, ..whole.clone() }).film;
        let mut joined = part(13..21);
        joined.merge(&part(0..13)).unwrap();
        assert!(joined == all.film, "{name}");
        // The mean is that of the picture.
        let (x, y) = window.position(31);
        let (reported, shown) = (interval.channel(&Window::pixel((x, y)), 1).mean, all.film.pixel(x, y).g);
        assert!(
            (reported - f64::from(shown)).abs() <= 1e-5 * reported && reported > 0.0,
            "{name}: {reported} {shown}"
        );
    }
}

#[test]
fn deterministic_integrators_have_no_interval() {
    let scene = two_balls();
    let camera = &scene.cameras()[0].1;
    for name in ["cast", "whitted"] {
        let refused = render(&scene, &**camera, &*integrator(name), &settings(0, 4), &Silent);
        assert!(matches!(refused, Err(RenderError::IntervalOfPattern)), "{name}");
    }
}

/// Distance of means over many seeds from the truth, block by block, in standard errors of these means: the largest
/// deviation, as the probability of one at least as large. [Šidák 1967]
fn agreement_with(truth: &Interval, blocks: &[Vec<f64>]) -> f64 {
    let least = |(window, means): (Window, &Vec<f64>)| {
        let (mean, error) = estimate(means);
        let own = truth.luminance(&window);
        let of_truth = own.half_width / truth.quantile();
        let t = (mean - own.mean).abs() / (error * error + of_truth * of_truth).sqrt();
        2.0 * StudentsT::new(0.0, 1.0, means.len() as f64 - 1.0).unwrap().sf(t)
    };
    let p = truth.window().tiles(4).into_iter().zip(blocks).map(least).fold(1.0, f64::min);
    1.0 - powf_f64(1.0 - p, blocks.len() as f64)
}

/// Pictures that a rule ended, and the numbers of their samples.
struct Ended(Pictures, Vec<u32>);

impl Bits for Ended {
    fn add_to(&self, hash: &mut Hash) {
        self.0.add_to(hash);
        self.1.iter().for_each(|spp| f64::from(*spp).add_to(hash));
    }
}

fn ended(scene: &Scene, count: u32) -> Ended {
    let path = integrator("path");
    let end = |seed| {
        let stop = Stop { noise: Some(0.1), time_limit: None };
        let rendered = shoot(scene, &*path, &RenderSettings { stop, ..settings(seed, 1024) });
        let reached = rendered.reached.unwrap();
        assert_eq!(reached.bias, Some(2.0 / SIDE as f32));
        (rendered.interval.unwrap(), reached.spp)
    };
    let (pictures, ends) = (0..u64::from(count)).map(end).unzip();
    Ended(Pictures(pictures), ends)
}

/// The means of each block over pictures.
fn block_means(pictures: &[Interval]) -> Vec<Vec<f64>> {
    let mean = |tile: &Window| pictures.iter().map(|picture| picture.luminance(tile).mean).collect();
    Window::whole(SIDE, SIDE).tiles(4).iter().map(mean).collect()
}

#[test]
fn a_rule_that_ends_the_whole_film_does_not_shift_its_mean() {
    let scene = two_balls();
    let asked = "p, how many ends, and Σ √(P(1 - P)) over them, by pictures";
    let found = SUITE.numbers(
        "path",
        asked,
        SEEDS,
        |count| ended(&scene, count),
        |Ended(pictures, all)| {
            let mut ends = BTreeMap::<u32, u64>::new();
            all.iter().for_each(|spp| *ends.entry(*spp).or_default() += 1);
            let share = |n: &u64| *n as f64 / f64::from(SEEDS);
            let sum: f64 = ends.values().map(|n| (share(n) * (1.0 - share(n))).sqrt()).sum();
            vec![agreement_with(&KNOWN.1, &block_means(&pictures.0)), ends.len() as f64, sum]
        },
    );
    let [film, ends, sum] = [0, 1, 2].map(|i| found[i]);
    assert!(film > 1e-3, "{film}; pictures have {ends} numbers of samples");
    // The stated bound holds for the observed distribution: the sum is at most 2.
    assert!(ends > 1.0 && sum <= 2.0, "{sum}: {ends}");
}

/// Planted bug: each block is taken twice, and the one that looks better is kept.
#[test]
fn a_rule_that_chooses_blocks_is_detected() {
    let ((scene, truth), path) = (&*KNOWN, integrator("path"));
    let tiles = truth.window().tiles(4);
    let mut chosen = vec![Vec::new(); tiles.len()];
    for seed in 0..u64::from(SEEDS) {
        let twice = [seed, seed + u64::from(SEEDS)].map(|seed| take(scene, &*path, &settings(seed, 4)));
        for (tile, all) in tiles.iter().zip(&mut chosen) {
            let [a, b] = [0, 1].map(|i| twice[i].luminance(tile));
            all.push(if a.half_width < b.half_width { a.mean } else { b.mean });
        }
    }
    let blocks = agreement_with(truth, &chosen);
    assert!(blocks < 1e-3, "{blocks}");
}
