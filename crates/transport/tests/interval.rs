//! How often what is told of a picture's error is true.

mod common;

use bilux_math::{Rgb, Vec3};
use bilux_scene::{Scene, SceneBuilder, Spec};
use bilux_transport::{
    Estimate, Interval, PixelIntegrator, REPLICATES, RenderError, RenderSettings, Silent, Window,
    integrators, render,
};
use common::statistics::estimate;
use common::{ball, built, diffuse, floor, integrator, look, put, shoot};

const SIDE: u32 = 16;

/// Seeds whose pictures are held against the truth.
const SEEDS: u64 = 100;

/// A matt and a satin ball on a table under a panel: all of its light is found from both ends.
fn two_balls() -> Scene {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "table", floor(0.0, 1.6), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    put(&mut builder, "matt", ball(Vec3::new(0.9, 0.6, -0.3), 0.6, 10, true), diffuse(0.6f32));
    let satin = Spec::new("", "phong").with("kd", 0.3f32).with("ks", 0.5f32).with("exponent", 10.0f32);
    let satin = satin.with("reflectivity", 0.0f32);
    put(&mut builder, "satin", ball(Vec3::new(-0.8, 0.7, 0.0), 0.7, 10, true), satin);
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.8, 3.0, 0.5)).with("intensity", 12.0f32);
    builder.lights.push(panel.with("edge_u", Vec3::X).with("edge_v", Vec3::new(0.0, 0.3, 1.0)));
    look(&mut builder, Vec3::new(0.0, 3.0, 4.0), Vec3::new(0.0, 0.3, 0.0), 32.0);
    built(&builder)
}

fn settings(seed: u64, spp: u32) -> RenderSettings {
    RenderSettings { seed, interval: true, max_depth: 4, ..RenderSettings::new(SIDE, SIDE, spp) }
}

fn take(scene: &Scene, integrator: &dyn PixelIntegrator, settings: &RenderSettings) -> Interval {
    shoot(scene, integrator, settings).interval.unwrap()
}

/// Those that claim to be right on average.
fn unbiased() -> [(&'static str, Box<dyn PixelIntegrator>); 4] {
    let auto = integrators::build(&Spec::new("", "auto").with("merge", "never")).unwrap();
    let named = |name: &'static str| (name, integrator(name));
    [named("path"), named("bdpt"), named("light"), ("auto", auto)]
}

/// The share of windows whose interval, made `width` times as wide, holds the truth. What has no noise is no proof of anything, and is left out.
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

fn truth(scene: &Scene) -> Interval {
    take(scene, &*integrator("path"), &settings(1000, 8192))
}

fn is_honest(share: f64) -> bool {
    (0.93..=0.97).contains(&share)
}

#[test]
fn nineteen_of_twenty_intervals_hold_the_truth() {
    let scene = two_balls();
    let truth = truth(&scene);
    for (name, integrator) in unbiased() {
        let one = |seed| take(&scene, &*integrator, &settings(seed, SPP));
        let pictures: Vec<Interval> = (0..SEEDS).map(one).collect();
        let [blocks, pixels] = [4, 1].map(|side| coverage(&pictures, &truth, side, 1.0));
        assert!(is_honest(blocks), "{name}: {blocks} of the blocks, {pixels} of the pixels");
        // A pixel's few samples may all miss what is rare there.
        assert!((0.9..=0.97).contains(&pixels), "{name}: {pixels} of the pixels");
        // The twin: intervals that are too narrow.
        let narrow = coverage(&pictures, &truth, 4, 0.8);
        assert!(!is_honest(narrow), "{name}: {narrow} with four fifths of the width");
    }
}

/// So few samples that even spreading makes most of the difference.
const FEW: u32 = 16;

/// What one would tell from the samples of a plain picture, by taking runs of its one sequence for independent.
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
fn runs_of_one_sequence_are_not_independent_and_tell_too_much() {
    let (scene, path) = (two_balls(), integrator("path"));
    let truth = truth(&scene);
    let (mut held, mut all) = (0, 0);
    for seed in 0..SEEDS {
        let told = as_if_independent(&scene, &*path, seed);
        for (window, told) in Window::whole(SIDE, SIDE).tiles(4).iter().zip(told) {
            if told.half_width > 1e-5 * told.mean {
                held += u32::from((told.mean - truth.luminance(window).mean).abs() <= told.half_width);
                all += 1;
            }
        }
    }
    let share = f64::from(held) / f64::from(all);
    assert!(!is_honest(share), "{share}");
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
        let (told, shown) = (interval.channel(&Window::pixel((x, y)), 1).mean, all.film.pixel(x, y).g);
        assert!((told - f64::from(shown)).abs() <= 1e-5 * told && told > 0.0, "{name}: {told} {shown}");
    }
}

#[test]
fn what_leaves_nothing_to_chance_has_no_interval() {
    let scene = two_balls();
    let camera = &scene.cameras()[0].1;
    for name in ["cast", "whitted"] {
        let refused = render(&scene, &**camera, &*integrator(name), &settings(0, 4), &Silent);
        assert!(matches!(refused, Err(RenderError::IntervalOfPattern)), "{name}");
    }
}
