//! Pictures of single techniques: weighted they add up to the picture, and unweighted they all have the same mean.

use crate::common::statistics::{UNLIKELY, channel, estimate, least_p};
use crate::common::{ball, built, diffuse, effort, floor, integrator, look, mixed, put, quad, shoot};
use bilux_math::{Rgb, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Scene, SceneBuilder, Spec, Value};
use bilux_transport::{RenderSettings, Silent, Strategies, Strategy, Window, integrators, strategies};
use std::collections::BTreeMap;

fn of(scene: &Scene, integrator: &Spec, settings: &RenderSettings) -> Strategies {
    let integrator = integrators::build(integrator).unwrap();
    strategies(scene, &*scene.cameras()[0].1, &*integrator, settings, &Silent).unwrap().unwrap()
}

/// Diffuse bodies that do not touch, so that no two vertices come close and the variance of each technique is finite; a
/// large panel, seen through a large lens.
fn diffuse_scene() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.8, 0.6, 0.5)));
    let wall = quad(Vec3::new(-2.0, 0.6, -2.2), Vec3::X * 4.0, Vec3::Y * 2.0);
    put(&mut builder, "wall", wall, diffuse(Rgb::new(0.5, 0.7, 0.8)));
    put(&mut builder, "ball", ball(Vec3::new(0.2, 1.2, 0.0), 0.6, 8, true), diffuse(0.8f32));
    let panel = Spec::new("", "rect").with("position", Vec3::new(-1.5, 3.2, -1.0)).with("intensity", 20.0f32);
    builder.lights.push(panel.with("edge_u", Vec3::X * 3.0).with("edge_v", Vec3::Z * 2.5));
    let lens =
        Spec::new("", "perspective").with("fov", 50.0f32).with("aperture", 0.3f32).with("focus", 4.0f32);
    let lens = lens.with("position", Vec3::new(0.0, 1.8, 4.2)).with("look_at", Vec3::new(0.0, 1.0, 0.0));
    builder.cameras = vec![CameraSpec { spec: lens, keyframes: Vec::new() }];
    builder
}

/// Block sums (2 × 2 blocks, three channels) of every technique's unweighted picture, `[block][picture]`.
type Blocks = BTreeMap<Strategy, Vec<Vec<f64>>>;

const PICTURES: u64 = 24;

fn unweighted(scene: &Scene, integrator: &Spec, first_seed: u64, settings: &RenderSettings) -> Blocks {
    let mut all = Blocks::new();
    for i in 0..PICTURES {
        let settings = RenderSettings { seed: first_seed + i, ..settings.clone() };
        for picture in of(scene, integrator, &settings).pictures {
            let blocks =
                all.entry(picture.strategy).or_insert_with(|| vec![vec![0.0; PICTURES as usize]; 12]);
            for (k, pixel) in picture.unweighted.iter().enumerate() {
                let block = (k / 16 / 8) * 2 + k % 16 / 8;
                (0..3).for_each(|c| blocks[block * 3 + c][i as usize] += f64::from(pixel[c]));
            }
        }
    }
    all
}

/// The minimum p-value over all techniques against light sampling (s = 1), with other samples, corrected for the number
/// of techniques. [Šidák 1967]
fn least(all: &Blocks, picked: &Blocks) -> (f64, Option<Strategy>) {
    let (mut least, mut count, mut which) = (1.0, 0, None);
    for (strategy, blocks) in all {
        let standard = &picked[&Strategy { edges: strategy.edges, merges: false, s: 1 }];
        let p = least_p(blocks, standard);
        count += 1;
        if p < least {
            (least, which) = (p, Some(*strategy));
        }
    }
    (1.0 - bilux_math::transcendental::powf_f64(1.0 - least, f64::from(count)), which)
}

/// Without light that the camera sees directly, for which there is only one technique.
fn longer(mut blocks: Blocks) -> Blocks {
    blocks.retain(|strategy, _| strategy.edges > 1);
    blocks
}

/// These blocks with one technique brighter by this factor.
fn defective(all: &Blocks, strategy: &Strategy, factor: f64) -> Blocks {
    let mut wrong = all.clone();
    wrong.get_mut(strategy).unwrap().iter_mut().flatten().for_each(|sum| *sum *= factor);
    wrong
}

#[test]
fn all_strategies_find_the_same_light() {
    let (scene, bdpt) =
        (built(&diffuse_scene()), Spec::new("", "bdpt").with("roulette_depth", Value::Integer(1)));
    let settings = RenderSettings { max_depth: 3, ..RenderSettings::new(16, 16, effort(128, 256)) };
    let [all, picked] = [0, 100].map(|seed| longer(unweighted(&scene, &bdpt, seed, &settings)));
    // Paths of 2 to 4 edges, by 3 to 5 techniques each.
    assert_eq!(all.len(), 3 + 4 + 5);
    let (p, which) = least(&all, &picked);
    assert!(p > UNLIKELY, "p = {p}, {which:?}");

    // Each of them on its own is detected when it is a little too bright, or counted twice.
    for strategy in all.keys() {
        let (p, which) = least(&defective(&all, strategy, 2.0), &picked);
        assert!(p < UNLIKELY && which == Some(*strategy), "{strategy} counted twice passes: p = {p}");
    }
    for strategy in all.keys().filter(|strategy| strategy.s > 0 && strategy.edges < 4) {
        let (p, _) = least(&defective(&all, strategy, 1.1), &picked);
        assert!(p < UNLIKELY, "{strategy} passes with a tenth too much: p = {p}");
    }
}

#[test]
fn merging_finds_the_same_light_with_a_small_radius() {
    let scene = built(&diffuse_scene());
    let settings = RenderSettings { max_depth: 3, ..RenderSettings::new(16, 16, effort(64, 128)) };
    let vcm = Spec::new("", "vcm").with("radius", 0.02f32).with("alpha", 1.0f32).with("direct", true);
    let [mut all, picked] = [0, 100].map(|seed| longer(unweighted(&scene, &vcm, seed, &settings)));
    all.retain(|strategy, _| strategy.merges);
    // Paths of 2 to 4 edges, merged at each vertex in between.
    assert_eq!(all.len(), 1 + 2 + 3);
    let (p, which) = least(&all, &picked);
    assert!(p > UNLIKELY, "p = {p}, {which:?}");
    for strategy in all.keys() {
        let (p, _) = least(&defective(&all, strategy, 2.0), &picked);
        assert!(p < UNLIKELY, "{strategy} counted twice passes: p = {p}");
    }
}

#[test]
fn weighted_strategies_add_up_to_the_picture() {
    let scene = built(&mixed());
    for name in ["bdpt", "vcm"] {
        for crop in [None, Some(Window { x: 3, y: 5, width: 9, height: 7 })] {
            let settings = RenderSettings { max_depth: 7, crop, ..RenderSettings::new(20, 16, 4) };
            let film = shoot(&scene, &*integrator(name), &settings).film;
            let strategies = of(&scene, &Spec::new("", name), &settings);
            for i in 0..strategies.window.pixels() {
                let (x, y) = strategies.window.position(i);
                let sum = strategies.pictures.iter().fold(Rgb::BLACK, |sum, one| sum + one.weighted[i]);
                let pixel = film.pixel(x, y);
                // Rounding of the film's steps, and of single precision.
                let error = (0..3).map(|c| (sum[c] - pixel[c]).abs()).fold(0.0, f32::max);
                assert!(
                    error < 1e-5 * (1.0 + pixel.max_channel()),
                    "{name} at {x}, {y}: {sum:?} and {pixel:?}"
                );
            }
        }
    }
}

#[test]
fn light_paths_of_a_part_of_the_pixels_are_weighted_as_in_the_picture() {
    // There the photons are connected with the camera; here every pixel has a light subpath of its own.
    let scene = built(&diffuse_scene());
    let vcm = Spec::new("", "vcm")
        .with("connections", false)
        .with("light_paths", Value::Integer(90))
        .with("radius", 0.02f32);
    let settings = |seed| RenderSettings { max_depth: 5, seed, ..RenderSettings::new(16, 16, 32) };
    let mean = |pixels: Vec<Rgb>| estimate(&channel(&pixels, 1)).0;
    let by_picture =
        |seed| mean(shoot(&scene, &*integrators::build(&vcm).unwrap(), &settings(seed)).film.to_rgb());
    let by_strategies = |seed| {
        of(&scene, &vcm, &settings(seed))
            .pictures
            .into_iter()
            .map(|picture| mean(picture.weighted))
            .sum::<f64>()
    };
    let a: Vec<f64> = (0..12).map(by_picture).collect();
    let b: Vec<f64> = (100..112).map(by_strategies).collect();
    let p = crate::common::statistics::welch(&a, &b);
    assert!(p > UNLIKELY, "p = {p}: {a:?} and {b:?}");
    let twice: Vec<f64> = b.iter().map(|mean| mean * 1.05).collect();
    assert!(crate::common::statistics::welch(&a, &twice) < UNLIKELY);
}

#[test]
fn the_same_for_any_number_of_threads() {
    let scene = built(&mixed());
    let pictures = |threads| {
        let settings = RenderSettings { threads, ..RenderSettings::new(40, 24, 3) };
        of(&scene, &Spec::new("", "vcm"), &settings).pictures
    };
    let (one, three) = (pictures(1), pictures(3));
    assert!(one == three && one.windows(2).all(|pair| pair[0].strategy < pair[1].strategy));
    assert!(one.iter().all(|picture| picture.strategy.edges <= bilux_transport::strategies::MAX_EDGES));
}

#[test]
fn those_without_strategies_say_so() {
    let mut builder = diffuse_scene();
    builder.cameras.clear();
    look(&mut builder, Vec3::new(0.0, 1.8, 4.2), Vec3::Y, 50.0);
    let scene = built(&builder);
    let none = |name: &str| {
        let settings = RenderSettings::new(4, 4, 1);
        strategies(&scene, &*scene.cameras()[0].1, &*integrator(name), &settings, &Silent).unwrap().is_none()
    };
    assert!(none("path") && none("auto") && !none("bdpt"));
    assert_eq!(integrators::with_strategies().collect::<Vec<_>>(), ["bdpt", "vcm"]);
}
