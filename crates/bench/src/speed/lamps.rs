//! Time of a picture lit by many lamps, relative to one lit by few.

use super::measurement::{Context, Measurement};
use super::row::{Goal, Row};
use super::shots::Plan;
use crate::median;
use crate::render::relmse;
use bilux::Error;
use bilux::math::hash::{hash_words, unit_f32};
use bilux::math::{Rgb, Vec3};
use bilux::scene::cameras::CameraSpec;
use bilux::scene::{Mesh, Object, SceneBuilder, Spec};
use std::sync::Arc;

pub(super) const MEASUREMENT: Measurement = Measurement {
    name: "lamps",
    summary: "path in a yard with 10, 1,000 and 100,000 lamps, one thread",
    run,
};

const COUNTS: [u64; 3] = [10, 1_000, 100_000];
/// About as many as it takes, so that what is built once counts once.
const SAMPLES: u32 = 96;
/// Half of the yard's width, in metres.
const HALF: f32 = 20.0;
/// The power of all lamps together, over 4π, in W/sr.
const INTENSITY: f32 = 4000.0;
/// The error for which times are compared.
const TARGET: f64 = 0.01;

fn run(context: &Context) -> Result<Vec<Row>, Error> {
    let mut seconds = Vec::new();
    for count in COUNTS {
        let scene = yard(count);
        let mut to_target = Vec::new();
        for round in context.rounds() {
            context.say(&format!("lamps: {count}, round {}", round + 1));
            let shot = |seed: u32| {
                let samples = context.options.part_of(SAMPLES);
                Plan { integrator: "path", side: 128, samples, seed, threads: 1, max_depth: 2 }.shoot(&scene)
            };
            let [a, b] = [shot(2 * round + 1)?, shot(2 * round + 2)?];
            // Each differs from their mean by half of what it differs from the truth, in squares.
            let mean: Vec<Rgb> = a.pixels.iter().zip(&b.pixels).map(|(a, b)| (*a + *b) * 0.5).collect();
            let error = relmse(&a.pixels, &mean) * 2.0;
            to_target.push((a.cpu_seconds + b.cpu_seconds) / 2.0 * error / TARGET);
        }
        seconds.push(median(to_target));
    }
    let row = |i: usize| {
        let what = format!("yard with {} lamps, path, one thread: CPU seconds to relMSE 0.01", COUNTS[i]);
        Row::new(what, seconds[i], Goal::RatioAtMost(3.0)).against(seconds[0])
    };
    let note = format!("the other side has {} lamps", COUNTS[0]);
    Ok([1, 2].into_iter().map(|i| row(i).with_note(&*note)).collect())
}

/// A yard with boxes, under lamps of the same light together.
fn yard(lamps: u64) -> SceneBuilder {
    let number = |i: u64, k: u64| unit_f32(hash_words([i, k]) as u32);
    let across = |x: f32| (2.0 * x - 1.0) * HALF;
    let mut builder = SceneBuilder::default();
    let grey = builder.add_material(Spec::new("grey", "diffuse"));
    let floor = block(Vec3::new(-HALF, -1.0, -HALF), Vec3::new(HALF, 0.0, HALF));
    builder.objects.push(Object::new("floor", floor, grey));
    for i in 0..200 {
        let (x, z, height) = (across(number(i, 0)), across(number(i, 1)), 0.3 + 2.0 * number(i, 2));
        let mesh = block(Vec3::new(x, 0.0, z), Vec3::new(x + 0.6, height, z + 0.6));
        builder.objects.push(Object::new("box", mesh, grey));
    }
    let of_all = 1.0 / lamps as f32;
    builder.lights.extend((0..lamps).map(|i| {
        let place = |k: u64| number(i + 1_000, k);
        let position = Vec3::new(across(place(0)), 2.5 + 2.0 * place(1), across(place(2)));
        // Some are far brighter than others.
        let strength = place(3) * place(3) * 3.0;
        Spec::new("lamp", "point").with("position", position).with("intensity", INTENSITY * of_all * strength)
    }));
    let camera = Spec::new("", "perspective").with("position", Vec3::new(0.0, 9.0, 24.0));
    let spec = camera.with("look_at", Vec3::new(0.0, 0.0, 2.0)).with("fov", 60.0f32);
    builder.cameras = vec![CameraSpec { spec, keyframes: Vec::new() }];
    builder
}

/// A box between two corners.
fn block(low: Vec3, high: Vec3) -> Arc<Mesh> {
    let corner = |i: u32| {
        let pick = |bit: u32, axis: usize| if i >> bit & 1 == 0 { low[axis] } else { high[axis] };
        Vec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Arc::new(Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() })
}
