//! Overlapping media: their priorities decide what separates them, from both ends of a path.

use crate::common::statistics::{UNLIKELY, agreement, blocks, difference, recorded};
use crate::common::{
    assert_same_with_every_accelerator, ball, built, diffuse, floor, integrator, look, put, shoot, sky,
};
use bilux_math::transcendental::exp;
use bilux_math::{Motion, Rgb, Transform, Vec3};
use bilux_scene::{Mesh, Scene, SceneBuilder, Spec};
use bilux_transport::RenderSettings;
use std::sync::Arc;

/// A closed box between two heights.
fn slab(low: f32, high: f32) -> Arc<Mesh> {
    let corner = |i: usize| Vec3::new([-2.0, 2.0][i & 1], [low, high][i >> 1 & 1], [-2.0, 2.0][i >> 2]);
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Arc::new(Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() })
}

fn medium(eta: f32, absorption: f32, priority: f32) -> Spec {
    let spec = Spec::new("", "dielectric").with("eta", eta).with("absorption", absorption);
    spec.with("priority", bilux_scene::Value::Integer(priority as i64))
}

const WATER: (f32, f32) = (1.33, 0.3);
const GLASS: (f32, f32) = (1.6, 0.5);

/// A metre of glass under a metre of water that extends a little into it, over a bright floor.
fn slabs(water: f32, glass: f32) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let bright = diffuse(0.0f32).with("emission", 1.0f32);
    put(&mut builder, "floor", floor(-1.0, 3.0), bright);
    put(&mut builder, "water", slab(0.8, 2.0), medium(WATER.0, WATER.1, water));
    put(&mut builder, "glass", slab(0.0, 1.0), medium(GLASS.0, GLASS.1, glass));
    let spec = Spec::new("eye", "perspective").with("position", Vec3::Y * 6.0).with("look_at", Vec3::ZERO);
    let spec = spec.with("up", Vec3::X).with("fov", 1.0f32);
    builder.cameras.push(bilux_scene::cameras::CameraSpec { spec, keyframes: Vec::new() });
    builder
}

/// Transmittance of layers at normal incidence, with all interreflections summed: index, absorption and thickness of
/// each layer, from the top.
fn through(layers: &[(f32, f32, f32)]) -> f32 {
    let index = |i: usize| if i == 0 { 1.0 } else { layers.get(i - 1).map_or(1.0, |layer| layer.0) };
    let reflected = |i: usize| {
        let r = (index(i) - index(i + 1)) / (index(i) + index(i + 1));
        r * r
    };
    let last = reflected(layers.len());
    let (mut reflects, mut passes) = (last, 1.0 - last);
    for (i, (_, sigma, thickness)) in layers.iter().enumerate().rev() {
        let (r, t) = (reflected(i), exp(-sigma * thickness));
        let bounces = 1.0 - r * t * t * reflects;
        passes = (1.0 - r) * t * passes / bounces;
        reflects = r + (1.0 - r) * (1.0 - r) * t * t * reflects / bounces;
    }
    passes
}

#[test]
fn light_through_overlapping_slabs_is_what_fresnel_and_beer_say() {
    let glass_wins = through(&[(WATER.0, WATER.1, 1.0), (GLASS.0, GLASS.1, 1.0)]);
    let water_wins = through(&[(WATER.0, WATER.1, 1.2), (GLASS.0, GLASS.1, 0.8)]);
    let settings = RenderSettings { max_depth: 64, ..RenderSettings::new(32, 32, 64) };
    for (water, glass, wanted) in [(1.0, 2.0, glass_wins), (2.0, 1.0, water_wins), (1.0, 1.0, water_wins)] {
        for name in ["path", "bdpt"] {
            let (case, scene) = (format!("{name}, {water} and {glass}"), built(&slabs(water, glass)));
            let found = recorded_mean(&case, &scene, name, &settings);
            assert!((found / wanted - 1.0).abs() < 5e-3, "{case}: {found}, not {wanted}");
        }
    }
    assert!((glass_wins / water_wins - 1.0).abs() > 0.02);
}

/// Glass, water that fills it exactly, and glass, over a bright floor: the faces between them coincide. The heights are no
/// sums of powers of two, so that rounding puts them in one order here and in another there.
fn stacked(order: [usize; 3], priorities: [f32; 2]) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let bright = diffuse(0.0f32).with("emission", 1.0f32);
    put(&mut builder, "floor", floor(-1.0, 3.0), bright);
    let (glass, water) = ((GLASS.0, GLASS.1, priorities[0]), (WATER.0, WATER.1, priorities[1]));
    let layers = [(0.1, 0.7, glass), (0.7, 1.3, water), (1.3, 1.9, glass)];
    for i in order {
        let (low, high, (eta, absorption, priority)) = layers[i];
        // A little larger or smaller, so that the triangles differ.
        let mut mesh = (*slab(low, high)).clone();
        mesh.positions.iter_mut().for_each(|p| (p.x, p.z) = (p.x * (1.0 + 0.13 * i as f32), p.z * 0.9));
        put(&mut builder, "", Arc::new(mesh), medium(eta, absorption, priority));
    }
    builder
}

/// Adds a camera at this height that looks straight down.
fn look_down(builder: &mut SceneBuilder, height: f32) {
    let eye = Spec::new("eye", "perspective").with("position", Vec3::new(0.01, height, 0.02));
    let eye = eye.with("look_at", Vec3::new(0.01, 0.0, 0.02)).with("up", Vec3::X).with("fov", 1.0f32);
    builder.cameras.push(bilux_scene::cameras::CameraSpec { spec: eye, keyframes: Vec::new() });
}

/// The mean of a picture of 1024 pixels: by the record of this case, where the first of its samples are as they were.
fn recorded_mean(case: &str, scene: &Scene, name: &str, settings: &RenderSettings) -> f32 {
    let mean = |pixels: &[Rgb]| vec![f64::from(pixels.iter().map(|pixel| pixel.g).sum::<f32>() / 1024.0)];
    recorded(case, "mean", (scene, &*integrator(name), settings), mean)[0] as f32
}

/// The mean of a picture by an integrator.
fn mean(case: &str, builder: &SceneBuilder, name: &str) -> f32 {
    let settings = RenderSettings { max_depth: 64, ..RenderSettings::new(32, 32, 32) };
    recorded_mean(case, &built(builder), name, &settings)
}

/// The mean of what is seen from high above.
fn seen_from_above(case: &str, mut builder: SceneBuilder, name: &str) -> f32 {
    look_down(&mut builder, 6.0);
    mean(case, &builder, name)
}

/// Coincident faces give the light of [`light_through_overlapping_slabs_is_what_fresnel_and_beer_say`], whatever the order and the
/// priorities are, and also for a camera in the water.
#[test]
fn coincident_faces_are_one_surface() {
    let (glass, water) = ((GLASS.0, GLASS.1, 0.6), (WATER.0, WATER.1, 0.6));
    let from_air = through(&[glass, water, glass]);
    for (order, priorities) in
        [([0, 1, 2], [2.0, 1.0]), ([1, 2, 0], [2.0, 1.0]), ([2, 0, 1], [1.0, 2.0]), ([1, 0, 2], [1.0, 1.0])]
    {
        for name in ["path", "bdpt"] {
            let found = seen_from_above(&format!("{name}, {order:?}"), stacked(order, priorities), name);
            assert!((found / from_air - 1.0).abs() < 4e-3, "{name}, {order:?}: {found}, not {from_air}");
        }
        // From within the water the floor is there at all: no face of it lets a path out into air by mistake. Light that
        // is reflected up and comes back is little.
        let mut builder = stacked(order, priorities);
        look_down(&mut builder, 1.0);
        let found = mean(&format!("in water, {order:?}"), &builder, "path");
        let fresnel = |a: f32, b: f32| ((a - b) / (a + b)) * ((a - b) / (a + b));
        let (at_glass, at_air) = (fresnel(WATER.0, GLASS.0), fresnel(GLASS.0, 1.0));
        // Radiance in water is n² times that in air.
        let down =
            WATER.0 * WATER.0 * (1.0 - at_glass) * (1.0 - at_air) * exp(-WATER.1 * 0.3 - GLASS.1 * 0.6);
        assert!((found / down - 1.0).abs() < 0.03, "{order:?}: {found}, not {down}");
    }
    // Without the water between them, which is what a lost face makes of it.
    let lost = through(&[glass, (1.0, 0.0, 0.6), glass]);
    assert!((lost / from_air - 1.0).abs() > 0.02);
}

/// The layers of [`stacked`], each a copy of one cube that a transform of its own scales, turns and places: the faces
/// coincide only as far as that is rounded.
#[test]
fn coincident_faces_of_instances_are_one_surface() {
    let cube = slab(-0.5, 0.5);
    let (glass, water) = ((GLASS.0, GLASS.1, 0.6), (WATER.0, WATER.1, 0.6));
    let expected = through(&[glass, water, glass]);
    for priorities in [[2.0, 1.0], [1.0, 2.0]] {
        let mut builder = SceneBuilder::default();
        put(&mut builder, "floor", floor(-1.0, 3.0), diffuse(0.0f32).with("emission", 1.0f32));
        for (i, (eta, absorption, _)) in [glass, water, glass].into_iter().enumerate() {
            let scaled = Transform::scale(Vec3::new(1.0, 0.6, 0.9 + 0.03 * i as f32)).unwrap();
            let turned = Transform::rotate(Vec3::Y, 0.7 * i as f32).unwrap();
            let placed = Transform::translate(Vec3::Y * (0.4 + 0.6 * i as f32)).unwrap();
            put(&mut builder, "", cube.clone(), medium(eta, absorption, priorities[i % 2]));
            let object = builder.objects.last_mut().unwrap();
            object.motion = Motion::still(scaled.then(&turned).then(&placed));
            object.instanced = true;
        }
        let found = seen_from_above(&format!("{priorities:?}"), builder, "path");
        assert!((found / expected - 1.0).abs() < 4e-3, "{priorities:?}: {found}, not {expected}");
    }
}

/// Three faces at one height: glass ends where water begins, and oil that goes on above the water; at the water's top it has
/// no rival any more.
#[test]
fn three_coincident_faces_are_one_surface() {
    let (glass, water, oil) = ((GLASS.0, GLASS.1, 0.6), (WATER.0, WATER.1, 0.6), (1.47, 0.8, 0.6));
    let expected = through(&[oil, water, glass]);
    for order in [[0, 1, 2], [1, 2, 0], [2, 1, 0]] {
        let mut builder = SceneBuilder::default();
        put(&mut builder, "floor", floor(-1.0, 3.0), diffuse(0.0f32).with("emission", 1.0f32));
        let layers = [(0.1, 0.7, glass, 3.0), (0.7, 1.3, water, 2.0), (0.7, 1.9, oil, 1.0)];
        for i in order {
            let (low, high, (eta, absorption, _), priority) = layers[i];
            let mut mesh = (*slab(low, high)).clone();
            mesh.positions.iter_mut().for_each(|p| (p.x, p.z) = (p.x * (1.0 + 0.13 * i as f32), p.z * 0.9));
            put(&mut builder, "", Arc::new(mesh), medium(eta, absorption, priority));
        }
        let found = seen_from_above(&format!("{order:?}"), builder, "path");
        assert!((found / expected - 1.0).abs() < 4e-3, "{order:?}: {found}, not {expected}");
    }
}

/// More faces at one height than count: which do depends on the ray alone.
#[test]
fn many_coincident_faces_are_the_same_with_every_accelerator() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(-1.0, 3.0), diffuse(0.0f32).with("emission", 1.0f32));
    for i in 0..7u32 {
        let mut mesh = (*slab(0.7 - 0.1 * i as f32, 0.7)).clone();
        mesh.positions.iter_mut().for_each(|p| p.x *= 1.0 + 0.13 * i as f32);
        put(&mut builder, "", Arc::new(mesh), medium(1.2 + 0.1 * i as f32, 0.1, i as f32 + 1.0));
    }
    look(&mut builder, Vec3::new(0.5, 3.0, 2.0), Vec3::new(0.0, 0.6, 0.0), 36.0);
    assert_same_with_every_accelerator(&builder);
}

#[test]
fn coincident_media_look_the_same_from_both_ends() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    for (low, high, eta, absorption, priority) in [(0.1, 0.7, 1.5, 0.2, 2.0), (0.7, 1.3, 1.33, 0.5, 1.0)] {
        put(&mut builder, "", slab(low, high), medium(eta, absorption, priority).with("roughness", 0.5f32));
    }
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    builder.lights.push(panel);
    sky(&mut builder, 0.2);
    look(&mut builder, Vec3::new(0.0, 3.0, 5.0), Vec3::new(0.0, 0.6, 0.0), 36.0);
    let scene = built(&builder);
    let path = blocks(&scene, integrator("path"), 0);
    for (i, other) in ["light", "bdpt"].into_iter().enumerate() {
        let case = format!("path and {other}");
        let p = agreement(&case, &path, &blocks(&scene, integrator(other), 100 * (i as u64 + 1)));
        assert!(p > UNLIKELY, "{case}: p = {p}");
    }
}

/// A glass ball and a water ball that overlap, with a light in both.
fn overlapping(roughness: f32, priorities: [f32; 2]) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    for (i, (x, absorption)) in [(-0.4, 3.0), (0.4, 0.1)].into_iter().enumerate() {
        let material = medium([1.5, 1.33][i], absorption, priorities[i]).with("roughness", roughness);
        put(&mut builder, "", ball(Vec3::new(x, 0.9, 0.0), 0.8, 12, true), material);
    }
    let light = diffuse(0.5f32).with("emission", 20.0f32);
    put(&mut builder, "light", ball(Vec3::new(0.1, 0.9, 0.1), 0.12, 6, false), light);
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0)).with("intensity", 10.0f32);
    builder.lights.push(panel);
    sky(&mut builder, 0.2);
    look(&mut builder, Vec3::new(0.0, 2.0, 5.0), Vec3::new(0.0, 0.6, 0.0), 36.0);
    builder
}

#[test]
fn overlapping_media_look_the_same_from_both_ends() {
    for (name, roughness, others) in [("frosted", 0.5, &["light", "bdpt"][..]), ("clear", 0.0, &["bdpt"])] {
        let scene = built(&overlapping(roughness, [2.0, 1.0]));
        let path = blocks(&scene, integrator("path"), 0);
        for (i, other) in others.iter().enumerate() {
            let case = format!("{name}: path and {other}");
            let p = agreement(&case, &path, &blocks(&scene, integrator(other), 100 * (i as u64 + 1)));
            assert!(p > UNLIKELY, "{case}: p = {p}");
        }
        // Otherwise the test could not tell which medium has priority.
        let other = built(&overlapping(roughness, [1.0, 2.0]));
        assert!(difference(&path, &blocks(&other, integrator("path"), 50)) < 1e-4);
    }
}

#[test]
fn priorities_change_nothing_where_nothing_overlaps() {
    let apart = |priority: f32| {
        let mut builder = overlapping(0.3, [priority, 0.0]);
        builder.objects.remove(2);
        built(&builder)
    };
    let settings = RenderSettings::new(24, 16, 4);
    for name in ["path", "bdpt"] {
        let film = |priority| shoot(&apart(priority), &*integrator(name), &settings).film;
        assert_eq!(film(1.0), film(0.0), "{name}");
    }
}
