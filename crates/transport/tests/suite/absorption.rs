//! Light inside an absorbing medium: a block of index 1, whose surface neither refracts nor reflects, around the light,
//! the surfaces and the camera. Beer's law attenuates every edge of a path, whichever technique found it.

use crate::common::statistics::{UNLIKELY, agreement, blocks, difference, recorded};
use crate::common::{ball, built, diffuse, effort, floor, look, put, quad, shoot, sky};
use bilux_math::transcendental::exp_f64;
use bilux_math::{Aabb, Rgb, Vec2, Vec3};
use bilux_scene::mesh::shapes::cuboid;
use bilux_scene::{CameraSample, Scene, SceneBuilder, Spec, Value};
use bilux_transport::{PixelIntegrator, RenderSettings, integrators};
use std::f64::consts::PI;
use std::sync::Arc;

const SIGMA: Rgb = Rgb::new(0.15, 0.4, 0.8);

/// A block around all of the scenes here, whose medium may have a priority.
fn block(builder: &mut SceneBuilder, sigma: Rgb, has_priority: bool) {
    let bounds = Aabb { min: Vec3::new(-7.0, -1.0, -7.0), max: Vec3::new(7.0, 6.0, 7.0) };
    let air = Spec::new("", "dielectric").with("eta", 1.0f32).with("absorption", sigma);
    if !has_priority {
        put(builder, "block", Arc::new(cuboid(bounds)), air);
        return;
    }
    put(builder, "block", Arc::new(cuboid(bounds)), air.clone().with("priority", Value::Integer(2)));
    // In it, a block of lower priority, which therefore changes nothing: rays pass its surface.
    let inner = Aabb { min: Vec3::new(-5.0, -0.5, -1.0), max: Vec3::new(0.6, 0.9, 0.9) };
    let idle = air.with("absorption", 3.0f32).with("priority", Value::Integer(1));
    put(builder, "idle block", Arc::new(cuboid(inner)), idle);
}

fn integrator(name: &str) -> Box<dyn PixelIntegrator> {
    let spec = match name.split_once(' ') {
        Some((kind, sampling)) => Spec::new("", kind).with("sampling", sampling),
        None if name == "sppm" => Spec::new("", name).with("radius", 0.03f32),
        None => Spec::new("", name),
    };
    integrators::build(&spec).unwrap()
}

fn mean(scene: &Scene, name: &str, settings: &RenderSettings) -> Rgb {
    let mean = |pixels: &[Rgb]| {
        let mean = pixels.iter().copied().sum::<Rgb>() / pixels.len() as f32;
        mean.to_array().map(f64::from).to_vec()
    };
    let found = recorded(name, "mean", (scene, &*integrator(name), settings), mean);
    Rgb::from_array([0, 1, 2].map(|channel| found[channel] as f32))
}

/// Radiance of a small piece of diffuse floor below a point light, averaged over the film: albedo / π · I cosθ / d²,
/// times e to the minus σ times the distance from the light to the floor and on to the camera.
fn follows_beers_law(has_priority: bool) {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.5f32));
    let light = Vec3::new(0.4, 1.1, -0.3);
    builder.lights.push(Spec::new("", "point").with("position", light).with("intensity", 2.0f32));
    look(&mut builder, Vec3::new(-0.5, 1.6, 1.4), Vec3::ZERO, 25.0);
    block(&mut builder, SIGMA, has_priority);
    let scene = built(&builder);
    let wanted = |channel: usize, techniques: f64| {
        let at = |i: usize| {
            let film = Vec2::new((i % 64) as f32 + 0.5, (i / 64) as f32 + 0.5) / 64.0;
            let ray = scene.cameras()[0].1.ray(&CameraSample { film, lens: Vec2::ZERO, time: 0.0 });
            let seen = f64::from(-ray.origin[1] / ray.direction[1]);
            let to_light = (light - Vec3::from(ray.at(seen as f32))).as_dvec3();
            let distance = to_light.length();
            let passed = exp_f64(-f64::from(SIGMA[channel]) * (distance + techniques * seen));
            0.5 / PI * 2.0 * to_light.y / (distance * distance * distance) * passed
        };
        (0..4096).map(at).sum::<f64>() / 4096.0
    };
    for (name, spp, tolerance) in [
        ("path", 16, 2e-3),
        ("path lights", 16, 2e-3),
        ("bdpt", 64, 0.01),
        ("vcm", 64, 0.02),
        ("light", 1 << 9, 0.06),
        ("sppm", 128, 0.08),
        ("auto", 16, 0.02),
    ] {
        let settings = RenderSettings { max_depth: 1, ..RenderSettings::new(16, 16, spp) };
        let found = mean(&scene, name, &settings);
        for channel in 0..3 {
            let (found, wanted) = (f64::from(found[channel]), wanted(channel, 1.0));
            assert!(
                (found / wanted - 1.0).abs() < tolerance,
                "{name}, channel {channel}: {found}, not {wanted}"
            );
        }
    }
    // Forgetting the distance to the camera alone would be noticed.
    assert!(wanted(0, 0.0) > 1.2 * wanted(0, 1.0));
}

#[test]
fn a_light_a_floor_and_a_camera_in_one_block_follow_beers_law() {
    follows_beers_law(true);
}

/// Planted bug: a medium without a priority that is known only once a path has left it.
#[test]
fn a_light_a_floor_and_a_camera_in_a_block_without_a_priority_follow_beers_law() {
    follows_beers_law(false);
}

/// Light that arrives over several edges, in a block, from a panel that paths also hit by chance.
fn indirect(sigma: Rgb, has_priority: bool) -> Scene {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.8, 0.7, 0.6)));
    let wall = quad(Vec3::new(-2.0, 0.0, -1.8), Vec3::X * 4.0, Vec3::Y * 2.5);
    put(&mut builder, "wall", wall, diffuse(0.8f32));
    put(&mut builder, "ball", ball(Vec3::new(0.2, 0.6, 0.0), 0.5, 10, true), diffuse(0.8f32));
    let panel = Spec::new("", "rect").with("position", Vec3::new(-1.0, 2.4, -1.0)).with("radiance", 8.0f32);
    builder.lights.push(panel.with("edge_u", Vec3::X * 2.0).with("edge_v", Vec3::Z * 2.0));
    look(&mut builder, Vec3::new(0.0, 1.5, 4.0), Vec3::new(0.0, 0.7, 0.0), 45.0);
    block(&mut builder, sigma, has_priority);
    built(&builder)
}

/// BSDF sampling alone makes no connections: the light that it finds is attenuated along each ray that it traces.
#[test]
fn connections_are_attenuated_like_traced_rays() {
    let followed = blocks(indirect(SIGMA, true), integrator("path scattering"), 0);
    for has_priority in [true, false] {
        let scene = indirect(SIGMA, has_priority);
        let names = ["path", "path lights", "light", "bdpt", "vcm"].into_iter().enumerate();
        // In the short form, each with one of the two.
        for (i, name) in names.skip(effort(usize::from(has_priority), 0)).step_by(effort(2, 1)) {
            let case = format!("scattering and {name}, priority {has_priority}");
            let p = agreement(&case, &followed, &blocks(&scene, integrator(name), 100 * (i as u64 + 1)));
            assert!(p > UNLIKELY, "{case}: p = {p}");
        }
    }
    // Negative control: a block that absorbs a tenth less.
    let wrong = blocks(indirect(SIGMA * 0.9, true), integrator("bdpt"), 700);
    assert!(difference(&followed, &wrong) < UNLIKELY);
    let unhindered = blocks(indirect(Rgb::BLACK, true), integrator("path scattering"), 800);
    assert!(unhindered.cells()[11].iter().sum::<f64>() > 4.0 * followed.cells()[11].iter().sum::<f64>());
}

/// The boundary of what absorbs and has no surface absorbs what comes from the sky behind it too.
#[test]
fn the_sky_is_seen_through_what_absorbs() {
    let mut builder = SceneBuilder::default();
    let smoke = Spec::new("", "interface").with("absorption", 2.0f32);
    put(
        &mut builder,
        "smoke",
        Arc::new(cuboid(Aabb { min: Vec3::splat(-0.5), max: Vec3::splat(0.5) })),
        smoke,
    );
    sky(&mut builder, 1.0);
    look(&mut builder, Vec3::Z * 100.0, Vec3::ZERO, 0.1);
    let scene = built(&builder);
    let wanted = bilux_math::transcendental::exp(-2.0);
    for name in ["path", "light", "bdpt", "sppm", "vcm", "auto"] {
        let film = shoot(&scene, &*integrator(name), &RenderSettings::new(4, 4, 4)).film;
        for pixel in film.to_rgb() {
            assert!((pixel.g - wanted).abs() < 2e-3, "{name}: {} for {wanted}", pixel.g);
        }
    }
}
