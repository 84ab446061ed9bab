//! Invariants of every medium, whatever its shape and however it scatters: the mean length of walks through it, and that camera and
//! lamp can be exchanged.

use crate::common::media::{any, boxed, grid_in, smoke};
use crate::common::statistics::SUITE;
use crate::common::{ball, built, diffuse, effort, look, put, shoot, sky};
use bilux_math::{Rgb, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Scene, SceneBuilder, Spec};
use bilux_transport::{RenderSettings, integrators};
use std::f64::consts::PI;

const MIN: Vec3 = Vec3::new(-0.5, -0.3, -0.4);
const MAX: Vec3 = Vec3::new(0.5, 0.3, 0.4);

const VOXELS: [usize; 3] = [6, 5, 7];

fn lump([x, y, z]: [usize; 3]) -> f32 {
    if any([x, y, z]) < 0.3 { 0.0 } else { any([z, x, y]) + 0.3 * x as f32 }
}

/// Directions that cover the sphere evenly, on a spiral.
fn directions(count: usize) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let (y, turn) = (1.0 - (2.0 * i as f64 + 1.0) / count as f64, 2.399_963_229_728_653 * i as f64);
        let (r, angle) = ((1.0 - y * y).sqrt(), turn.rem_euclid(2.0 * PI));
        let (sin, cos) =
            (bilux_math::transcendental::sin(angle as f32), bilux_math::transcendental::cos(angle as f32));
        Vec3::new(r as f32 * cos, y as f32, r as f32 * sin)
    })
}

/// Light that the box absorbs of what falls on it from everywhere, over all directions, per radiance: the light that is missing in
/// parallel projections of it, integrated over their area. No light is sampled: what a path brings is what has not been absorbed, with next to
/// no noise.
fn absorbed(case: &str, body: &Spec, spp: u32) -> f64 {
    const COUNT: usize = 24;
    const HEIGHT: f32 = 1.5;
    let path = Spec::new("", "path").with("roulette_depth", 1000).with("sampling", "scattering");
    let integrator = integrators::build(&path).unwrap();
    let picture = |spp, (seed, direction): (usize, Vec3)| {
        let mut builder = SceneBuilder::default();
        put(&mut builder, "body", boxed(MIN, MAX), body.clone());
        sky(&mut builder, 1.0);
        let camera = Spec::new("", "orthographic").with("position", direction * 3.0);
        let camera = camera.with("look_at", Vec3::ZERO).with("up", direction.any_orthonormal_vector());
        builder.cameras = vec![CameraSpec { spec: camera.with("height", HEIGHT), keyframes: Vec::new() }];
        let settings =
            RenderSettings { max_depth: 1000, seed: seed as u64, ..RenderSettings::new(24, 24, spp) };
        shoot(&built(&builder), &*integrator, &settings).film.to_rgb()
    };
    let pictures = |spp| directions(COUNT).enumerate().map(|at| picture(spp, at)).collect();
    let found = SUITE.numbers(case, "absorbed, by samples a pixel", spp, pictures, |all: &Vec<Vec<Rgb>>| {
        let missing = all.iter().map(|pixels| {
            pixels.iter().map(|pixel| 1.0 - f64::from(pixel.g)).sum::<f64>() / pixels.len() as f64
        });
        vec![missing.sum::<f64>() / COUNT as f64 * f64::from(HEIGHT * HEIGHT)]
    });
    found[0]
}

/// Walks through a body on which as much light falls from everywhere have a mean length of 4V/S, however they are scattered
/// [Blanco 2003]. So what little is absorbed is the integral of the absorption coefficient over its volume.
#[test]
fn walks_are_as_long_as_volume_and_surface_say() {
    const ABSORPTION: f32 = 4e-3;
    let volume = f64::from((MAX - MIN).element_product());
    let grid = grid_in(MIN, MAX, VOXELS, lump);
    let voxels = VOXELS.iter().product::<usize>();
    let place = |i: usize| [i % VOXELS[0], i / VOXELS[0] % VOXELS[1], i / (VOXELS[0] * VOXELS[1])];
    let density = (0..voxels).map(|i| f64::from(lump(place(i)))).sum::<f64>() / voxels as f64;
    for scattering in [1.0f32, 3.0, 12.0] {
        let even = Spec::new("", "interface").with("absorption", ABSORPTION).with("scattering", scattering);
        let lumps = smoke(ABSORPTION, scattering, grid.clone()).with("scattering_anisotropy", 0.6f32);
        for (body, density) in [(even, 1.0), (lumps, density)] {
            let wanted = f64::from(ABSORPTION) * density * volume;
            let what = format!("scattering {scattering}, mean density {density}");
            let found = absorbed(&what, &body, effort(8, 128));
            assert!((found / wanted - 1.0).abs() < 0.02, "{what}: {found}, not {wanted}");
        }
    }
}

/// Bodies in smoke that is not the same from any two sides.
fn bodies(camera: Vec3, lamp: Vec3) -> Scene {
    let mut builder = SceneBuilder::default();
    let grid = grid_in(MIN, MAX, VOXELS, lump);
    let spec = smoke(Rgb::new(0.1, 0.5, 1.0), Rgb::new(2.0, 4.0, 3.0), grid);
    put(&mut builder, "smoke", boxed(MIN, MAX), spec.with("scattering_anisotropy", 0.5f32));
    put(
        &mut builder,
        "ball",
        ball(Vec3::new(0.3, 0.1, 0.1), 0.25, 12, false),
        diffuse(Rgb::new(0.8, 0.5, 0.2)),
    );
    look(&mut builder, camera, Vec3::ZERO, 50.0);
    builder.lights.push(Spec::new("", "point").with("position", lamp).with("intensity", 1.0f32));
    built(&builder)
}

/// All light that arrives at the camera, over solid angle, and the standard error of its mean over seeds.
fn fluence(case: &str, scene: &Scene, name: &str, spp: u32) -> (Rgb, f32) {
    const SIDE: u32 = 40;
    const SEEDS: u64 = 4;
    let integrator = integrators::build(&Spec::new("", name)).unwrap();
    let half = bilux_math::transcendental::tan(25f32.to_radians());
    let picture = |spp, seed| {
        let settings = RenderSettings { seed, max_depth: 64, ..RenderSettings::new(SIDE, SIDE, spp) };
        shoot(scene, &*integrator, &settings).film.to_rgb()
    };
    let over_angles = |pixels: &Vec<Rgb>| {
        let side = 2.0 * half / SIDE as f32;
        let along = |i: u32| (i as f32 + 0.5) * side - half;
        let angle = |x: f32, y: f32| {
            let square = 1.0 + x * x + y * y;
            side * side / (square * square.sqrt())
        };
        let sum = |sum: Rgb, (i, pixel): (usize, &Rgb)| {
            let (x, y) = (along(i as u32 % SIDE), along(i as u32 / SIDE));
            sum + *pixel * angle(x, y)
        };
        pixels.iter().enumerate().fold(Rgb::BLACK, sum)
    };
    let numbers = |all: &Vec<Vec<Rgb>>| {
        let all: Vec<Rgb> = all.iter().map(over_angles).collect();
        let mean = all.iter().fold(Rgb::BLACK, |sum, one| sum + *one) * (1.0 / SEEDS as f32);
        let spread = all.iter().map(|one| (*one * (1.0 / mean.g)).g - 1.0).map(|off| off * off).sum::<f32>();
        let error = (spread / (SEEDS * (SEEDS - 1)) as f32).sqrt();
        [mean.r, mean.g, mean.b, error].map(f64::from).to_vec()
    };
    let pictures = |spp| (0..SEEDS).map(|seed| picture(spp, seed)).collect();
    let found = SUITE.numbers(case, "fluence and error, by samples a pixel", spp, pictures, numbers);
    let [r, g, b, error] = [0, 1, 2, 3].map(|i| found[i] as f32);
    (Rgb::new(r, g, b), error)
}

/// Camera and lamp are exchanged: light that goes the other way.
#[test]
fn camera_and_lamp_can_be_exchanged() {
    let [near, far] = [Vec3::new(0.4, 1.1, 1.3), Vec3::new(1.6, -0.4, -1.4)];
    for name in ["path", "bdpt"] {
        let [there, back] = [("there", near, far), ("back", far, near)].map(|(way, camera, lamp)| {
            fluence(&format!("{name}, {way}"), &bodies(camera, lamp), name, effort(32, 512))
        });
        let error = (there.1 * there.1 + back.1 * back.1).sqrt();
        assert!(error < 0.02, "{name}: the standard error is {error}");
        for channel in 0..3 {
            let ratio = there.0[channel] / back.0[channel];
            assert!((ratio - 1.0).abs() < 4.0 * error + 2e-3, "{name}: {there:?} and {back:?}");
        }
    }
}
