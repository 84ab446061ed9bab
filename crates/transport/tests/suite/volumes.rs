//! Media whose density a grid gives: slabs of layers, furnaces, and the same mean by every integrator.

use crate::common::media::{any, boxed, grid_in, smoke};
use crate::common::statistics::{
    UNLIKELY, agreement, assert_like_path, assert_like_path_in_turn, assert_unlike_path, assert_vanishes,
    blocks, recorded_means,
};
use crate::common::{along, built, diffuse, effort, floor, look, put, shoot, sky, without_mirrors};
use bilux_math::transcendental::exp_f64;
use bilux_math::{Quat, Rgb, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::media::Grid;
use bilux_scene::{Scene, SceneBuilder, Spec};
use bilux_transport::{RenderError, RenderSettings, Silent, integrators, render};
use std::sync::Arc;

const WIDE: f32 = 20.0;
const LAYERS: usize = 20;

/// The density of a layer of a slab: very different ones, of which the mean is 1.
fn layer(y: usize) -> f32 {
    let weight = |y: usize| if y.is_multiple_of(3) { 0.0 } else { any([y, 0, 0]) * any([y, 1, 0]) + 0.01 };
    let sum: f32 = (0..LAYERS).map(weight).sum();
    weight(y) * LAYERS as f32 / sum
}

/// A slab of layers, a metre thick, which light from above falls on, or which shines from below. What it reflects and passes depends on
/// its optical thickness alone.
fn layered(albedo: f32, tau: f32, from_above: bool) -> Scene {
    let mut builder = SceneBuilder::default();
    let (min, max) = (Vec3::new(-WIDE, 0.0, -WIDE), Vec3::new(WIDE, 1.0, WIDE));
    let grid = grid_in(min, max, [3, LAYERS, 2], |[_, y, _]| layer(y));
    put(&mut builder, "slab", boxed(min, max), smoke((1.0 - albedo) * tau, albedo * tau, grid));
    let below = if from_above { diffuse(0.0f32) } else { diffuse(0.0f32).with("emission", 1.0f32) };
    put(&mut builder, "below", floor(-0.01, WIDE), below);
    if from_above {
        sky(&mut builder, 1.0);
    }
    let camera = Spec::new("", "orthographic")
        .with("position", Vec3::Y * 3.0)
        .with("look_at", Vec3::ZERO)
        .with("up", Vec3::Z);
    builder.cameras = vec![CameraSpec { spec: camera.with("height", 1.0f32), keyframes: Vec::new() }];
    built(&builder)
}

/// Fails unless the mean over a picture, in green, is this.
fn assert_is(what: &str, (scene, name): (&Scene, &str), spp: u32, wanted: f64, largest: f64) {
    assert_is_with_roulette(1000, what, (scene, name), spp, wanted, largest);
}

/// Fails unless the mean is this with Russian roulette after so many events, as [`assert_is`].
fn assert_is_with_roulette(
    free: i32,
    what: &str,
    (scene, name): (&Scene, &str),
    spp: u32,
    wanted: f64,
    largest: f64,
) {
    let integrator = integrators::build(&Spec::new("", name).with("roulette_depth", free)).unwrap();
    let settings = RenderSettings { max_depth: 200, ..RenderSettings::new(64, 64, spp) };
    let (mean, error) = recorded_means(what, scene, &*integrator, &settings)[1];
    assert!(error <= largest, "{what}: the standard error is {error}, more than {largest}");
    assert!((mean - wanted).abs() < 3.0 * error + 2e-6, "{what}: {mean} ± {error}, not {wanted}");
}

/// Isotropic slabs by discrete ordinates, as in `scattering`. [Hulst 1980]
const SLABS: [(f32, f32, f64, f64); 2] = [(0.9, 2.0, 0.3616489, 0.3565007), (1.0, 0.5, 0.2025060, 0.7974940)];

#[test]
fn layers_reflect_and_pass_what_a_slab_of_their_thickness_does() {
    for (albedo, tau, reflected, passed) in SLABS {
        for (from_above, wanted) in [(true, reflected), (false, passed)] {
            let scene = layered(albedo, tau, from_above);
            let what = format!("albedo {albedo}, thickness {tau}, from above {from_above}");
            let (spp, error) = effort((16, 2e-3), (600, 3e-4));
            assert_is(&what, (&scene, "path"), spp, wanted, error);
            let (spp, error) = effort((3, 6e-3), (100, 1e-3));
            for name in ["bdpt", "vcm"].iter().skip(usize::from(from_above)) {
                assert_is(&format!("{what}, {name}"), (&scene, name), spp, wanted, error);
            }
        }
    }
}

#[test]
fn roulette_keeps_the_light_of_a_slab() {
    let [(albedo, tau, reflected, _), _] = SLABS;
    let scene = layered(albedo, tau, true);
    for (name, (spp, error)) in
        [("path", effort((16, 2e-3), (600, 4e-4))), ("vcm", effort((3, 6e-3), (100, 1e-3)))]
    {
        assert_is_with_roulette(0, name, (&scene, name), spp, reflected, error);
    }
}

/// Smoke that only absorbs lets pass what Beer's law says of its thickness.
#[test]
fn what_only_absorbs_passes_by_its_thickness() {
    let scene = layered(0.0, 1.5, false);
    for name in ["path", "light", "bdpt", "vcm"] {
        assert_is(name, (&scene, name), effort(16, 256), exp_f64(-1.5), 2e-3);
    }
}

#[test]
fn white_smoke_vanishes_in_a_furnace() {
    let (min, max) = (Vec3::splat(-1.0), Vec3::splat(1.0));
    let grid = grid_in(min, max, [12, 9, 17], |at| if any(at) < 0.4 { 0.0 } else { any(at) });
    let mut builder = SceneBuilder::default();
    let spec = smoke(0.0f32, Rgb::new(2.5, 1.2, 6.0), grid).with("scattering_anisotropy", 0.4f32);
    put(&mut builder, "smoke", boxed(min, max), spec);
    sky(&mut builder, 1.0);
    look(&mut builder, Vec3::new(2.0, 1.5, 4.0), Vec3::ZERO, 30.0);
    let scene = built(&builder);
    for name in ["path", "bdpt", "vcm", "auto"] {
        assert_vanishes("smoke", &scene, name);
    }
}

/// Bodies in coloured smoke, with a lamp in it.
fn smoky(light: Spec, density: f32) -> SceneBuilder {
    let mut builder = without_mirrors(light);
    let (min, max) = (Vec3::new(-3.0, -0.5, -3.0), Vec3::new(3.0, 4.0, 3.0));
    let grid = grid_in(min, max, [10, 20, 10], |at| if any(at) < 0.5 { 0.0 } else { 4.0 * any(at) });
    let spec = smoke(Rgb::new(0.01, 0.02, 0.05) * density, Rgb::new(0.1, 0.15, 0.06) * density, grid);
    put(&mut builder, "smoke", boxed(min, max), spec.with("scattering_anisotropy", 0.5f32));
    builder
}

fn panel() -> Spec {
    Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32)
}

#[test]
fn smoke_looks_the_same_from_both_ends() {
    let lights = [
        Spec::new("", "point").with("position", Vec3::new(0.5, 2.0, 2.0)).with("intensity", 4.0f32),
        panel(),
        Spec::new("", "directional").with("direction", Vec3::new(0.3, -1.0, -0.4)),
        Spec::new("", "environment").with("radiance", 0.5f32),
    ];
    for (turn, light) in lights.into_iter().enumerate() {
        let name = light.kind.clone();
        assert_like_path_in_turn(turn, &name, &built(&smoky(light, 1.0)), &["bdpt", "light", "vcm"]);
    }
}

/// Smoke in a moving, turned and stretched object, among other smoke.
#[test]
fn smoke_follows_its_object() {
    let mut builder = smoky(panel(), 0.5);
    let (min, max) = (Vec3::splat(-0.5), Vec3::splat(0.5));
    let grid = grid_in(min, max, [4, 4, 4], |at| 3.0 * any(at));
    let spec = smoke(0.1f32, 2.0f32, grid).with("priority", 2);
    put(&mut builder, "puff", boxed(min, max), spec);
    let turn = Quat::from_rotation_y(0.6);
    let keys = [(0.0, Vec3::new(0.6, 0.8, 1.2)), (1.0, Vec3::new(0.8, 0.9, 1.2))].map(|(time, at)| {
        bilux_math::MotionKey {
            time_seconds: time,
            translation: at,
            rotation: turn,
            scale: Vec3::new(1.0, 0.5, 1.5),
        }
    });
    let moving = builder.objects.last_mut().unwrap();
    moving.motion = bilux_math::Motion::from_keys(keys.to_vec()).unwrap();
    assert_like_path("a puff in smoke", &built(&builder), &["bdpt", "vcm"]);
}

#[test]
fn smoke_that_is_thinner_is_noticed() {
    let right = built(&smoky(panel(), 1.0));
    assert_unlike_path(&right, &built(&smoky(panel(), 0.7)), &["path", "bdpt"]);
}

/// A grid of ones is the medium without one.
#[test]
fn a_grid_of_ones_changes_nothing() {
    let (min, max) = (Vec3::new(-3.0, -0.5, -3.0), Vec3::new(3.0, 4.0, 3.0));
    let of = |grid: Option<Arc<Grid>>| {
        let mut builder = without_mirrors(panel());
        let spec = Spec::new("", "interface").with("scattering", Rgb::new(0.1, 0.2, 0.3));
        let spec = if let Some(grid) = grid { spec.with("density", grid) } else { spec };
        put(&mut builder, "smoke", boxed(min, max), spec);
        built(&builder)
    };
    let ones = grid_in(min, max, [9, 3, 20], |_| 1.0);
    let path = || integrators::build(&Spec::new("", "path")).unwrap();
    let p = agreement("ones", &blocks(of(None), path(), 0), &blocks(of(Some(ones)), path(), 100));
    assert!(p > UNLIKELY, "{p}");
}

/// A slab that glows more where it is denser: what it sends up depends on its thickness alone, whatever its layers.
#[test]
fn fire_that_scatters_nothing_shines_by_its_thickness() {
    let (min, max) = (Vec3::new(-WIDE, 0.0, -WIDE), Vec3::new(WIDE, 1.0, WIDE));
    let grid = grid_in(min, max, [3, LAYERS, 2], |[_, y, _]| layer(y));
    let mut builder = SceneBuilder::default();
    let fire = smoke(1.2f32, 0.0f32, grid).with("medium_emission", Rgb::new(1.0, 3.0, 0.0));
    put(&mut builder, "fire", boxed(min, max), fire);
    put(&mut builder, "below", floor(-0.01, WIDE), diffuse(0.0f32));
    let camera = Spec::new("", "orthographic")
        .with("position", Vec3::Y * 3.0)
        .with("look_at", Vec3::ZERO)
        .with("up", Vec3::Z);
    builder.cameras = vec![CameraSpec { spec: camera.with("height", 1.0f32), keyframes: Vec::new() }];
    let scene = built(&builder);
    for name in ["path", "bdpt", "vcm", "auto"] {
        let wanted = 3.0 * (1.0 - exp_f64(-1.2));
        assert_is(name, (&scene, name), effort(16, 256), wanted, 1e-2);
    }
}

/// A flame in smoke between bodies, which it lights; it glows by its temperature.
#[test]
fn fire_looks_the_same_from_both_ends() {
    let mut builder = smoky(panel().with("intensity", 1.0f32), 1.0);
    let (min, max) = (Vec3::new(-0.4, 0.3, 0.6), Vec3::new(0.4, 1.8, 1.4));
    let density = grid_in(min, max, [8, 16, 8], |at| if any(at) < 0.4 { 0.0 } else { any(at) });
    let heat = grid_in(min, max, [4, 4, 4], |[x, y, z]| 900.0 + 200.0 * any([x, y, z]) + 250.0 * y as f32);
    let fire = smoke(4.0f32, Rgb::new(1.0, 2.0, 3.0), density).with("temperature", heat);
    let fire = fire.with("medium_emission", 20.0f32).with("priority", 3);
    put(&mut builder, "fire", boxed(min, max), fire);
    assert_like_path("fire in smoke", &built(&builder), &["bdpt", "vcm"]);
}

/// In an oven whose walls, smoke and fire are all as hot, everything is as bright: Kirchhoff's law.
#[test]
fn everything_in_an_oven_looks_the_same() {
    let (min, max) = (Vec3::splat(-1.0), Vec3::splat(1.0));
    let grid = grid_in(min, max, [12, 9, 17], |at| if any(at) < 0.4 { 0.0 } else { any(at) });
    for (density, scattering) in [
        (Some(grid.clone()), Rgb::new(0.5, 0.2, 1.0)),
        (Some(grid), Rgb::BLACK),
        (None, Rgb::new(0.5, 0.2, 1.0)),
    ] {
        let mut builder = SceneBuilder::default();
        let fire = Spec::new("", "interface")
            .with("absorption", Rgb::new(1.0, 2.0, 0.5))
            .with("scattering", scattering)
            .with("medium_emission", 1.0f32);
        let fire = if let Some(grid) = density { fire.with("density", grid) } else { fire };
        put(&mut builder, "fire", boxed(min, max), fire);
        sky(&mut builder, 1.0);
        look(&mut builder, Vec3::new(2.0, 1.5, 4.0), Vec3::ZERO, 30.0);
        let scene = built(&builder);
        for name in ["path", "bdpt", "vcm"] {
            assert_vanishes("smoke", &scene, name);
        }
    }
}

#[test]
fn light_tracing_says_that_it_finds_no_fire() {
    let mut builder = without_mirrors(panel());
    let fire = Spec::new("", "interface").with("absorption", 1.0f32).with("medium_emission", 1.0f32);
    put(&mut builder, "fire", boxed(Vec3::splat(-0.5), Vec3::splat(0.5)), fire);
    let scene = built(&builder);
    let integrator = integrators::build(&Spec::new("", "light")).unwrap();
    let settings = RenderSettings::new(8, 8, 1);
    let found = render(&scene, &*scene.cameras()[0].1, &*integrator, &settings, &Silent);
    assert!(matches!(found, Err(RenderError::Glow)));
}

/// Smoke of three thicknesses side by side that moves by 2 m along x while the shutter is open, before a bright floor: the mean over that time
/// of what it lets pass, by its voxels, between whose middles the density is linear.
#[test]
fn a_grid_moves_with_its_object_while_the_shutter_is_open() {
    const VOXELS: [f32; 3] = [0.2, 2.0, 0.7];
    let [min, max] = [Vec3::new(-3.0, 0.2, -4.0), Vec3::new(3.0, 1.0, 4.0)];
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 9.0), diffuse(0.0f32).with("emission", 1.0f32));
    let grid = grid_in(min, max, [3, 1, 1], |[x, _, _]| VOXELS[x]);
    put(&mut builder, "smoke", boxed(min, max), smoke(1.3f32, 0.0f32, grid));
    builder.objects[1].motion = along(Vec3::X * -1.0, Vec3::X * 1.0);
    let camera = Spec::new("", "orthographic").with("position", Vec3::Y * 3.0).with("look_at", Vec3::ZERO);
    let camera = camera.with("up", Vec3::Z).with("height", 0.02f32);
    builder.cameras = vec![CameraSpec { spec: camera, keyframes: Vec::new() }];
    let density = |x: f64| {
        // In voxels of 2 m, from the middle of the first.
        let at = ((x + 3.0) / 2.0 - 0.5).clamp(0.0, 2.0);
        let (low, part) = (at.floor().min(1.0), at - at.floor().min(1.0));
        f64::from(VOXELS[low as usize]) * (1.0 - part) + f64::from(VOXELS[low as usize + 1]) * part
    };
    let [opens, closes] = [0.1, 0.9];
    let passed = |time: f64| exp_f64(-1.3 * 0.8 * density(-(2.0 * time - 1.0)));
    let wanted =
        (0..1000).map(|i| passed(opens + (closes - opens) * (f64::from(i) + 0.5) / 1000.0)).sum::<f64>()
            / 1000.0;
    let scene = builder.build(&Default::default(), [opens as f32, closes as f32], 1.0).unwrap();
    for name in ["path", "bdpt"] {
        let settings = RenderSettings { max_depth: 4, ..RenderSettings::new(16, 16, 64) };
        let film = shoot(&scene, &*integrators::build(&Spec::new("", name)).unwrap(), &settings).film;
        let mean = film.to_rgb().iter().map(|pixel| f64::from(pixel.g)).sum::<f64>() / 256.0;
        assert!((mean / wanted - 1.0).abs() < 0.015, "{name}: {mean}, not {wanted}");
    }
}
