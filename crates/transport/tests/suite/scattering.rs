//! Media that scatter, against closed forms and against numbers of discrete ordinates: slabs, light in fog, furnaces; and the same mean
//! by every integrator.

use crate::common::media::boxed;
use crate::common::statistics::{
    SUITE, UNLIKELY, agreement, assert_like_path, assert_like_path_in_turn, assert_unlike_path,
    assert_vanishes, blocks_of_depth, channel, channel_means, estimate, least_p, recorded_means,
};
use crate::common::{
    ball, built, diffuse, effort, floor, integrator, look, put, quad, shoot, sky, without_mirrors,
};
use bilux_math::transcendental::exp_f64;
use bilux_math::{Rgb, Transform, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::media::Grid;
use bilux_scene::media::slab::Slab;
use bilux_scene::{Scene, SceneBuilder, Spec, Value};
use bilux_transport::{
    LightDivision, PixelIntegrator, RenderError, RenderSettings, Silent, integrators, light_parts, render,
};
use std::f64::consts::PI;
use std::sync::Arc;

fn medium(absorption: impl Into<bilux_scene::Value>, scattering: impl Into<bilux_scene::Value>) -> Spec {
    Spec::new("", "interface").with("absorption", absorption).with("scattering", scattering)
}

/// Looks along a direction by parallel rays through a window of this height.
fn parallel(builder: &mut SceneBuilder, from: Vec3, at: Vec3, up: Vec3, height: f32) {
    let camera = Spec::new("", "orthographic").with("position", from).with("look_at", at).with("up", up);
    builder.cameras = vec![CameraSpec { spec: camera.with("height", height), keyframes: Vec::new() }];
}

/// An integrator by which no path ends early by chance.
fn patient(name: &str) -> Box<dyn PixelIntegrator> {
    integrators::build(&Spec::new("", name).with("roulette_depth", 1000)).unwrap()
}

fn settings(max_depth: u32, side: u32, spp: u32) -> RenderSettings {
    RenderSettings { max_depth, ..RenderSettings::new(side, side, spp) }
}

/// The mean over a picture of one value, in green, and its standard error.
fn mean(scene: &Scene, name: &str, max_depth: u32, side: u32, spp: u32) -> (f64, f64) {
    channel_means(scene, &*patient(name), &settings(max_depth, side, spp))[1]
}

/// Fails unless the mean over a picture of 64 × 64 pixels, in green, is this.
fn assert_mean(
    what: &str,
    (scene, name): (&Scene, &str),
    [max_depth, spp]: [u32; 2],
    wanted: f64,
    largest: f64,
) {
    let found = recorded_means(what, scene, &*patient(name), &settings(max_depth, 64, spp));
    assert_is(what, found[1], wanted, largest);
}

/// Fails unless the mean is this, within three standard errors and these are at most `largest`.
fn assert_is(what: &str, (mean, error): (f64, f64), wanted: f64, largest: f64) {
    assert!(error <= largest, "{what}: the standard error is {error}, more than {largest}");
    assert!((mean - wanted).abs() < 3.0 * error + 2e-6, "{what}: {mean} ± {error}, not {wanted}");
}

/// Half the width of slabs: so much that what leaves at their sides does not count.
const WIDE: f32 = 200.0;

/// A slab of optical thickness `tau`, a metre thick. Light comes from above, or shines from a panel close below.
fn slab(albedo: f32, tau: f32, phase: &[(&str, f32)], from_above: bool) -> Scene {
    let mut builder = SceneBuilder::default();
    let fog = medium((1.0 - albedo) * tau, albedo * tau);
    let fog = phase.iter().fold(fog, |fog, (name, value)| match *name {
        "rayleigh" => fog.with("phase", "rayleigh"),
        name => fog.with(name, *value),
    });
    put(&mut builder, "slab", boxed(Vec3::new(-WIDE, 0.0, -WIDE), Vec3::new(WIDE, 1.0, WIDE)), fog);
    let below = if from_above { diffuse(0.0f32) } else { diffuse(0.0f32).with("emission", 1.0f32) };
    put(&mut builder, "below", floor(-0.01, WIDE), below);
    if from_above {
        sky(&mut builder, 1.0);
    }
    parallel(&mut builder, Vec3::Y * 3.0, Vec3::ZERO, Vec3::Z, 1.0);
    built(&builder)
}

/// Albedo, optical thickness, mean cosine.
const SLABS: &[[f32; 3]] =
    &[[1.0, 0.5, 0.0], [0.9, 2.0, 0.0], [0.9, 2.0, 0.75], [1.0, 2.0, -0.3], [0.5, 2.0, 0.0], [0.9, 8.0, 0.0]];

/// Fractions that a slab reflects and passes at normal incidence, by adding and doubling.
fn reflected_and_passed([albedo, thickness, anisotropy]: [f32; 3]) -> [f64; 2] {
    let [albedo, thickness, anisotropy] = [albedo, thickness, anisotropy].map(f64::from);
    let light = Slab { absorbed: 1.0 - albedo, thickness, anisotropy, eta: 1.0 }.light(24);
    [light.from_inside, light.passed]
}

#[test]
fn slabs_reflect_and_pass_what_discrete_ordinates_say() {
    let (spp, error) = effort((20, 1.6e-3), (600, 3e-4));
    for &[albedo, tau, g] in effort(&SLABS[..4], SLABS) {
        let [reflected, passed] = reflected_and_passed([albedo, tau, g]);
        for (from_above, wanted) in [(true, reflected), (false, passed)] {
            let scene = slab(albedo, tau, &[("scattering_anisotropy", g)], from_above);
            let what = format!("albedo {albedo}, thickness {tau}, mean cosine {g}, from above {from_above}");
            assert_mean(&what, (&scene, "path"), [200, spp], wanted, error);
        }
    }
    for (from_above, wanted) in [(true, 0.3639935), (false, 0.3601731)] {
        let scene = slab(0.9, 2.0, &[("rayleigh", 0.0)], from_above);
        assert_mean("air", (&scene, "path"), [200, spp], wanted, error);
    }
}

#[test]
fn connections_in_slabs_find_the_same() {
    for slab_of @ [albedo, tau, g] in effort(&SLABS[2..3], SLABS) {
        let [reflected, passed] = reflected_and_passed(*slab_of);
        let (spp, error) = effort((4, 5e-3), (100, 1e-3));
        for name in ["bdpt", "vcm"] {
            let of = |from_above| slab(*albedo, *tau, &[("scattering_anisotropy", *g)], from_above);
            assert_mean(&format!("{name} above"), (&of(true), name), [60, spp], reflected, error);
            assert_mean(&format!("{name} below"), (&of(false), name), [60, spp], passed, error);
        }
    }
}

/// A slab whose walks forget what absorbs is brighter by more than the proof allows.
#[test]
fn a_slab_without_absorption_is_noticed() {
    let scene = slab(1.0, 2.0, &[], true);
    let (found, error) = mean(&scene, "path", 200, 64, 16);
    let [reflected, _] = reflected_and_passed(SLABS[1]);
    assert!((found - reflected).abs() > 10.0 * error, "{found} ± {error}");
}

/// Light scattered once out of a point light's, along a ray that passes at a distance of 1 m: the integral by the midpoint
/// rule. [Pegoraro 2009]
fn airlight(sigma_s: f64, sigma_t: f64, half: f64) -> f64 {
    const STEPS: u32 = 200_000;
    let step = 2.0 * half / f64::from(STEPS);
    let at = |i: u32| {
        let s = -half + step * (f64::from(i) + 0.5);
        let square = 1.0 + s * s;
        exp_f64(-sigma_t * (half + s + square.sqrt())) / square
    };
    sigma_s / (4.0 * PI) * (0..STEPS).map(at).sum::<f64>() * step
}

/// The mean over a picture of light that scatters at most once, in green, and its standard error.
fn mean_of_direct_light(what: &str, scene: &Scene, name: &str, spp: u32) -> (f64, f64) {
    let division = LightDivision { by_events: true, ..LightDivision::default() };
    let direct = |spp| {
        let (camera, settings) = (&*scene.cameras()[0].1, RenderSettings::new(64, 64, spp));
        let parts = light_parts(scene, camera, &*integrator(name), &settings, &division, &Silent);
        let [direct, _] = parts.unwrap().unwrap().by_events.unwrap();
        direct.to_rgb()
    };
    let numbers = |pixels: &Vec<Rgb>| <[f64; 2]>::from(estimate(&channel(pixels, 1))).to_vec();
    let found = SUITE.numbers(what, "mean and error of samples a pixel", spp, direct, numbers);
    (found[0], found[1])
}

#[test]
fn light_in_fog_is_what_the_closed_form_says() {
    // Numbers from outside for the integral itself.
    assert!((airlight(0.1, 0.1, 5.0) - 0.011_375_223_08).abs() < 1e-9);
    assert!((airlight(0.5, 0.5, 5.0) - 0.004_991_425_82).abs() < 1e-9);
    for (sigma_s, sigma_t) in effort(vec![(0.1f32, 0.4f32)], vec![(0.1, 0.1), (0.5, 0.5), (0.1, 0.4)]) {
        let mut builder = SceneBuilder::default();
        let fog = medium(sigma_t - sigma_s, sigma_s);
        put(&mut builder, "fog", boxed(Vec3::new(-5.0, -9.0, -9.0), Vec3::new(5.0, 9.0, 9.0)), fog);
        builder.lights.push(Spec::new("", "point").with("position", Vec3::Y).with("intensity", 1.0f32));
        parallel(&mut builder, Vec3::X * -7.0, Vec3::ZERO, Vec3::Y, 1e-3);
        let scene = built(&builder);
        let wanted = airlight(f64::from(sigma_s), f64::from(sigma_t), 5.0);
        for name in ["path", "bdpt"] {
            let what = format!("{name}, {sigma_s} of {sigma_t}");
            let found = mean_of_direct_light(&what, &scene, name, effort(16, 256));
            assert_is(&what, found, wanted, 0.02 * wanted);
        }
        for name in ["vcm", "sppm"] {
            // All pixels of an iteration cross the same beams.
            let found = |seed| {
                let settings = RenderSettings { max_depth: 1, seed, ..RenderSettings::new(32, 32, 16) };
                let pixels = shoot(&scene, &*integrator(name), &settings).film.to_rgb();
                pixels.iter().map(|pixel| f64::from(pixel.g)).sum::<f64>() / pixels.len() as f64
            };
            let means = |pictures| (0..u64::from(pictures)).map(found).collect();
            let what = format!("{name}, {sigma_s} of {sigma_t}");
            let numbers = |means: &Vec<f64>| <[f64; 2]>::from(estimate(means)).to_vec();
            let found = SUITE.numbers(&what, "mean and error of pictures", effort(16, 400), means, numbers);
            assert_is(&what, (found[0], found[1]), wanted, effort(0.05, 0.01) * wanted);
        }
    }
}

/// A path that leaves fog and then the scene has crossed its beams once.
#[test]
fn fog_before_a_mirror_is_crossed_once() {
    let panel = Spec::new("", "rect").with("position", Vec3::new(0.0, 2.0, 0.5)).with("intensity", 8.0f32);
    let mut builder = SceneBuilder { lights: vec![panel], ..SceneBuilder::default() };
    put(&mut builder, "fog", ball(Vec3::ZERO, 1.0, 12, false), medium(0.02f32, 0.3f32));
    let wall = quad(Vec3::new(-3.0, -3.0, -3.0), Vec3::X * 6.0, Vec3::Y * 6.0);
    put(&mut builder, "wall", wall, Spec::new("", "mirror"));
    look(&mut builder, Vec3::new(0.0, 0.5, 4.0), Vec3::ZERO, 35.0);
    assert_like_path("fog before a mirror", &built(&builder), &["vcm", "sppm"]);
}

/// A path that leaves fog, meets a floor beside it and then leaves the scene has had its points near the lamp once.
#[test]
fn fog_beside_a_floor_has_its_points_near_lamps_once() {
    let lamp = Spec::new("", "point").with("position", Vec3::new(0.0, 3.0, 0.0)).with("intensity", 8.0f32);
    let mut builder = SceneBuilder { lights: vec![lamp], ..SceneBuilder::default() };
    put(&mut builder, "fog", ball(Vec3::new(0.0, 1.5, 0.0), 1.0, 12, false), medium(0.0f32, 0.3f32));
    put(&mut builder, "floor", floor(0.0, 9.0), diffuse(0.5f32));
    look(&mut builder, Vec3::new(0.0, 3.0, 5.0), Vec3::new(0.0, 1.0, 0.0), 35.0);
    assert_like_path("fog beside a floor", &built(&builder), &["bdpt", "light", "vcm"]);
}

/// Lamps are so far away in fog that the densities of walks to what is near them run out of numbers.
#[test]
fn weights_are_finite_in_fog_that_nothing_passes() {
    let lamp = |x: f32| Spec::new("", "point").with("position", Vec3::new(x, 1.0, -1.0));
    let lights = [-30.0, 31.0, 33.0, 0.5].map(|x| lamp(x).with("intensity", 50.0f32)).to_vec();
    let mut builder = SceneBuilder { lights, ..SceneBuilder::default() };
    put(&mut builder, "fog", boxed(Vec3::splat(-40.0), Vec3::splat(40.0)), medium(0.0f32, 3.0f32));
    put(&mut builder, "floor", floor(0.0, 39.0), diffuse(0.5f32));
    look(&mut builder, Vec3::new(0.0, 0.4, 0.4), Vec3::ZERO, 60.0);
    let scene = built(&builder);
    for name in ["path", "bdpt", "vcm", "light"] {
        let film = shoot(&scene, &*integrator(name), &RenderSettings::new(24, 24, 2)).film;
        let failures = film.sample_failures();
        assert_eq!(failures.non_finite, 0, "{name}: {:?}", failures.first_non_finite);
        assert!(film.to_rgb().iter().any(|pixel| pixel.g > 0.0), "{name} sees nothing");
    }
}

/// Light that a glass ball casts into fog, seen in the ball: beams find it, and paths that happen to hit the large lamp.
#[test]
fn light_that_glass_casts_into_fog_is_as_bright_seen_through_the_glass() {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.3, 3.0, 0.3)).with("intensity", 20.0f32);
    let panel = panel.with("edge_u", Vec3::X * 2.5).with("edge_v", Vec3::Z * 2.5);
    let mut builder = SceneBuilder { lights: vec![panel], ..SceneBuilder::default() };
    let fog = medium(Rgb::grey(0.02), Rgb::new(0.2, 0.25, 0.3)).with("priority", 1);
    put(&mut builder, "fog", boxed(Vec3::new(-4.0, -1.0, -4.0), Vec3::new(4.0, 4.0, 6.0)), fog);
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.6f32));
    let glass = Spec::new("", "dielectric").with("priority", 2);
    put(&mut builder, "ball", ball(Vec3::new(0.0, 1.0, 0.0), 0.8, 12, true), glass);
    look(&mut builder, Vec3::new(0.0, 1.2, 4.0), Vec3::Y, 40.0);
    assert_like_path("glass in fog", &built(&builder), &["vcm", "sppm"]);
}

/// A medium that absorbs nothing is as bright as what surrounds it.
#[test]
fn white_media_vanish_in_a_furnace() {
    let scattering = Rgb::new(1.5, 0.7, 3.0);
    let spec = medium(0.0f32, scattering);
    let phases = [
        spec.clone().with("scattering_anisotropy", 0.6f32),
        spec.clone().with("phase", "droplets"),
        spec.with("phase", "draine").with("scattering_anisotropy", -0.3f32),
        Spec::new("", "dielectric").with("scattering", scattering).with("eta", 1.3f32),
    ];
    for (i, material) in phases.into_iter().enumerate() {
        let mut builder = SceneBuilder::default();
        put(&mut builder, "ball", ball(Vec3::ZERO, 1.0, 12, false), material);
        sky(&mut builder, 1.0);
        look(&mut builder, Vec3::Z * 4.0, Vec3::ZERO, 20.0);
        let scene = built(&builder);
        for name in ["path", "bdpt", "vcm", "auto"].iter().skip(i % 2) {
            assert_vanishes(&format!("phase function {i}"), &scene, name);
        }
        if i > 0 {
            continue;
        }
        // Beams alone: among almost parallel ones, as in droplets, they have rare bright pairs.
        let sppm = blocks_of_depth(&scene, integrator("sppm"), 0, 100);
        let p = SUITE.agreement("sppm", "least p beside 64", [&sppm, &sppm], |sums, _| {
            least_p(sums, &vec![vec![64.0; 12]; 12])
        });
        assert!(p > UNLIKELY, "phase function {i}, sppm: p = {p}");
    }
}

/// Diffuse and glossy bodies in coloured fog, with a lamp in it.
fn foggy(light: Spec, fog: Spec) -> SceneBuilder {
    let mut builder = without_mirrors(light);
    put(&mut builder, "fog", boxed(Vec3::new(-6.0, -1.0, -6.0), Vec3::new(6.0, 6.0, 6.0)), fog);
    builder
}

fn fog() -> Spec {
    medium(Rgb::new(0.01, 0.02, 0.05), Rgb::new(0.1, 0.15, 0.06)).with("scattering_anisotropy", 0.5f32)
}

#[test]
fn fog_looks_the_same_from_both_ends() {
    let lights = [
        Spec::new("", "point").with("position", Vec3::new(0.5, 2.0, 2.0)).with("intensity", 4.0f32),
        Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32),
        Spec::new("", "directional").with("direction", Vec3::new(0.3, -1.0, -0.4)),
        Spec::new("", "environment").with("radiance", 0.5f32),
        Spec::new("", "sphere")
            .with("position", Vec3::new(-0.5, 2.5, 0.0))
            .with("radius", 0.3f32)
            .with("intensity", 10.0f32),
    ];
    for (turn, light) in lights.into_iter().enumerate() {
        let name = light.kind.clone();
        assert_like_path_in_turn(turn, &name, &built(&foggy(light, fog())), &["bdpt", "light", "vcm"]);
    }
}

/// Events in fog count against the depth, those in milk do not, and all integrators agree on which paths there are.
/// In fog without colour, rays have points near lights; `light` knows nothing of them.
#[test]
fn lamps_in_grey_fog_look_the_same_from_both_ends() {
    let grey = || medium(0.02f32, 0.3f32).with("scattering_anisotropy", 0.5f32);
    let spot = Spec::new("", "spot").with("position", Vec3::new(0.5, 2.0, 2.0)).with("intensity", 8.0f32);
    let lights = [
        Spec::new("", "point").with("position", Vec3::new(0.5, 2.0, 2.0)).with("intensity", 4.0f32),
        spot.with("look_at", Vec3::new(0.0, 0.5, 0.0)).with("angle", 40.0f32),
        Spec::new("", "sphere")
            .with("position", Vec3::new(-0.5, 2.5, 0.0))
            .with("radius", 0.3f32)
            .with("intensity", 10.0f32),
    ];
    for light in lights {
        assert_like_path(&light.kind.clone(), &built(&foggy(light, grey())), &["bdpt", "light", "vcm"]);
    }
}

#[test]
fn paths_of_limited_depth_are_the_same_from_both_ends() {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    let thick = medium(0.1f32, Rgb::new(1.2, 0.8, 0.4)).with("scattering_anisotropy", 0.2f32);
    let mut builder = foggy(panel, thick);
    let milk = Spec::new("", "dielectric").with("eta", 1.2f32).with("scattering", Rgb::new(6.0, 4.0, 2.0));
    put(&mut builder, "milk", ball(Vec3::new(0.0, 0.5, 1.6), 0.4, 10, true), milk.with("roughness", 0.3f32));
    let scene = built(&builder);
    for max_depth in 1..=3 {
        let path = blocks_of_depth(&scene, integrator("path"), 0, max_depth);
        let names = ["bdpt", "light", "vcm"];
        let short = max_depth as usize - 1;
        for name in &names[effort(short..short + 1, 0..3)] {
            let case = format!("path and {name} to a depth of {max_depth}");
            let p = agreement(&case, &path, &blocks_of_depth(&scene, integrator(name), 100, max_depth));
            assert!(p > UNLIKELY, "{case}: p = {p}");
        }
    }
}

/// Without any event there is only emission, in fog too.
#[test]
fn nothing_scatters_at_depth_zero() {
    let light = Spec::new("", "point").with("position", Vec3::new(0.5, 2.0, 2.0)).with("intensity", 4.0f32);
    let scene = built(&foggy(light, fog()));
    for name in ["path", "light", "bdpt", "vcm", "sppm"] {
        assert_eq!(mean(&scene, name, 0, 16, 4), (0.0, 0.0), "{name}");
    }
}

/// Light that comes to the camera straight out of fog has scattered once; behind a surface it may have scattered any number of times.
#[test]
fn depth_counts_fog() {
    let (fog, glass) = (medium(0.0f32, 2.0f32), Spec::new("", "dielectric").with("eta", 1.0f32));
    let mean_to = |material: &Spec, max_depth: u32| {
        let mut builder = SceneBuilder::default();
        put(&mut builder, "ball", ball(Vec3::ZERO, 1.0, 12, false), material.clone());
        sky(&mut builder, 1.0);
        look(&mut builder, Vec3::Z * 4.0, Vec3::ZERO, 20.0);
        mean(&built(&builder), "path", max_depth, 24, 16).0
    };
    // A ray through the ball's middle meets two events on average.
    assert!(mean_to(&fog, 1) < 0.75 && mean_to(&fog, 100) > 0.97);
    // Light goes in and out of glass by two events.
    let milk = glass.with("scattering", 2.0f32);
    assert!(mean_to(&milk, 2) > 0.97, "{}", mean_to(&milk, 2));
}

/// A ball in which light scatters hundreds of times, and which absorbs nothing, is white at the usual depth.
#[test]
fn long_walks_through_milk_do_not_end_early() {
    let milk = Spec::new("", "dielectric").with("eta", 1.3f32).with("scattering", 15.0f32);
    let matched = Spec::new("", "dielectric").with("eta", 1.0f32).with("scattering", 30.0f32);
    for (material, names) in [(matched, &["path", "vcm"]), (milk, &["path", "bdpt"])] {
        let mut builder = SceneBuilder::default();
        put(&mut builder, "ball", ball(Vec3::ZERO, 1.0, 12, false), material);
        sky(&mut builder, 1.0);
        look(&mut builder, Vec3::Z * 4.0, Vec3::ZERO, 20.0);
        let scene = built(&builder);
        for name in names {
            let settings = RenderSettings::new(24, 24, effort(8, 64));
            let (mean, error) = recorded_means(name, &scene, &*integrator(name), &settings)[1];
            assert!(error < 0.04, "{name}: {mean} ± {error}");
            assert!((mean - 1.0).abs() < 3.5 * error + 2e-3, "{name}: {mean} ± {error}");
        }
    }
}

/// A ball of milk in a glass with a wall, a clear ball in the fog, a leaf that light passes, a mirror: what borders on what.
#[test]
fn fog_around_glass_and_milk_looks_the_same_from_both_ends() {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    let mut builder = foggy(panel, fog());
    let milk = Spec::new("", "dielectric").with("eta", 1.33f32).with("scattering", Rgb::new(3.0, 2.0, 1.0));
    let glass = Spec::new("", "dielectric").with("priority", 3).with("roughness", 0.3f32);
    put(&mut builder, "glass", ball(Vec3::new(0.0, 0.5, 1.6), 0.5, 10, true), glass);
    let milk = milk.with("absorption", 0.1f32).with("roughness", 0.3f32);
    put(&mut builder, "milk", ball(Vec3::new(0.0, 0.5, 1.6), 0.4, 10, true), milk.with("priority", 4));
    let clear = Spec::new("", "dielectric").with("roughness", 0.4f32);
    put(&mut builder, "clear", ball(Vec3::new(-1.6, 0.4, 1.2), 0.4, 10, true), clear);
    let leaf = Spec::new("", "translucent");
    put(&mut builder, "leaf", quad(Vec3::new(1.0, 0.2, 1.2), Vec3::X * 0.8, Vec3::Y * 0.8), leaf);
    assert_like_path("milk in glass in fog", &built(&builder), &["bdpt", "vcm"]);
}

/// Fog that is twice as thick, or scatters back what it ought to scatter on, is noticed.
#[test]
fn fog_that_is_thicker_or_turned_is_noticed() {
    let panel =
        || Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    let fog = |density: f32, anisotropy: f32| {
        let fog = medium(Rgb::new(0.01, 0.02, 0.05), Rgb::new(0.2, 0.3, 0.12) * density);
        fog.with("scattering_anisotropy", anisotropy)
    };
    let right = built(&foggy(panel(), fog(1.0, 0.7)));
    for wrong in [fog(3.0, 0.7), fog(1.0, -0.7)] {
        assert_unlike_path(&right, &built(&foggy(panel(), wrong)), &["path", "bdpt"]);
    }
}

#[test]
fn photon_mapping_says_that_it_does_not_follow_smoke() {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("radiance", 1.0f32);
    let grid = Grid::dense("smoke", [2; 3], &Transform::IDENTITY, &[0.5; 8]).unwrap();
    let scene = built(&foggy(panel, fog().with("density", Value::Grid(Arc::new(grid)))));
    let integrator = integrators::build(&Spec::new("", "sppm")).unwrap();
    let settings = RenderSettings::new(8, 8, 1);
    let found = render(&scene, &*scene.cameras()[0].1, &*integrator, &settings, &Silent);
    assert!(matches!(found, Err(RenderError::Media)));
}

/// The box around fog is not what hides the sky.
#[test]
fn fog_occludes_nothing() {
    let panel =
        || Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    let of = |scene: &SceneBuilder| {
        shoot(
            &built(scene),
            &*integrators::build(&Spec::new("", "occlusion")).unwrap(),
            &RenderSettings::new(24, 24, 4),
        )
        .film
        .to_rgb()
    };
    assert!(of(&foggy(panel(), fog())) == of(&without_mirrors(panel())));
}
