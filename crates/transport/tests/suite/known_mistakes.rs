//! Mistakes that other renderers have made, tested for here. `docs/trust.md` lists them all, including those that other
//! tests cover.

use crate::common::statistics::{UNLIKELY, agreement, blocks, difference};
use crate::common::{ball, built, diffuse, floor, integrator, look, put, quad, shoot, sky, without_mirrors};
use bilux_math::glam::DVec3;
use bilux_math::{DMat4, Motion, Rgb, Transform, Vec3};
use bilux_scene::{Object, Scene, SceneBuilder, Spec, Value};
use bilux_transport::{RenderSettings, Silent, integrators, strategies};

/// Two diffuse leaves that meet at a sharp angle, with a light in front of them: towards the edge, vertices of both
/// subpaths come ever closer together.
fn crevice() -> Scene {
    let mut builder = SceneBuilder::default();
    let hinge = Vec3::new(-1.0, 0.0, 0.0);
    put(&mut builder, "leaf", quad(hinge, Vec3::X * 2.0, Vec3::new(0.0, 0.25, 1.0)), diffuse(0.9f32));
    put(&mut builder, "leaf", quad(hinge, Vec3::X * 2.0, Vec3::new(0.0, -0.25, 1.0)), diffuse(0.9f32));
    let glowing = diffuse(0.0f32).with("emission", 1.0f32);
    put(&mut builder, "light", quad(Vec3::new(-1.0, -1.0, 2.5), Vec3::X * 2.0, Vec3::Y * 2.0), glowing);
    look(&mut builder, Vec3::Z * 1.5, Vec3::ZERO, 14.0);
    built(&builder)
}

/// pbrt-v3 #69: connecting vertices of both subpaths that lie very close together gives a spike.
#[test]
fn vertices_that_lie_close_together_give_no_spike() {
    let scene = crevice();
    let bdpt = integrators::build(&Spec::new("", "bdpt").with("roulette_depth", Value::Integer(1000)));
    let (bdpt, camera) = (bdpt.unwrap(), &*scene.cameras()[0].1);
    let (mut weighted, mut unweighted) = (0.0f32, 0.0f32);
    for seed in 0..40 {
        let settings = RenderSettings { seed, max_depth: 5, ..RenderSettings::new(32, 32, 1) };
        let found = strategies(&scene, camera, &*bdpt, &settings, &Silent).unwrap().unwrap();
        // Each pixel has one connection (s, t > 1): the camera subpath's last vertex with one of the light subpath.
        let joins = found.pictures.iter().filter(|one| one.strategy.s > 1 && one.strategy.t() > 1);
        for picture in joins {
            let greatest = |pixels: &[Rgb]| pixels.iter().map(|pixel| pixel.g).fold(0.0, f32::max);
            weighted = weighted.max(greatest(&picture.weighted));
            unweighted = unweighted.max(greatest(&picture.unweighted));
        }
    }
    // A path's light over the sum of the densities of all techniques is at most that over the density of hitting the
    // light by chance, for which it is the light's radiance, 1, times what surfaces reflect.
    assert!(weighted > 0.0 && weighted <= 1.0, "{weighted}");
    // Negative control: without weights the same connections do spike.
    assert!(unweighted > 100.0, "{unweighted}");
}

/// Photons that fall on one face of a coarse mesh and are merged on the next, which they graze, are weighted by the
/// face that they fell on.
#[test]
fn photons_from_around_a_bend_give_no_spike() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "ball", ball(Vec3::ZERO, 1.0, 6, true), diffuse(0.8f32));
    let light = Spec::new("", "point").with("position", Vec3::new(2.0, 0.0, 0.5)).with("intensity", 10.0f32);
    builder.lights.push(light);
    look(&mut builder, Vec3::Z * 4.0, Vec3::ZERO, 40.0);
    let scene = built(&builder);
    let settings = RenderSettings { max_depth: 1, ..RenderSettings::new(32, 32, 64) };
    let picked = shoot(&scene, &*integrator("path"), &settings).film.to_rgb();
    let sppm = integrators::build(&Spec::new("", "sppm").with("radius", 0.05f32)).unwrap();
    let merged = shoot(&scene, &*sppm, &settings).film.to_rgb();
    let square = |(a, b): (&Rgb, &Rgb)| f64::from(a.g - b.g) * f64::from(a.g - b.g) / 1024.0;
    let error: f64 = merged.iter().zip(&picked).map(square).sum();
    let mean = picked.iter().map(|pixel| f64::from(pixel.g)).sum::<f64>() / 1024.0;
    // Weighted by the face where they are merged, they give 6.4.
    assert!(error < 3.0 * mean * mean, "{error} where there is {mean}");
}

/// Mitsuba 0.6 #132: a bright dot where a point light is in view. It has no extent, so it must be invisible.
#[test]
fn delta_lights_leave_no_firefly_at_their_position() {
    let mut builder = SceneBuilder::default();
    // Something for the lights to illuminate, out of view; the surface behind them is black.
    put(&mut builder, "floor", floor(-3.0, 1.0), diffuse(0.5f32));
    let wall = quad(Vec3::new(-3.0, -2.0, -1.0), Vec3::X * 6.0, Vec3::Y * 4.0);
    put(&mut builder, "wall", wall, diffuse(0.0f32));
    let place = Vec3::new(0.1, 0.2, 0.0);
    builder.lights.push(Spec::new("", "point").with("position", place).with("intensity", 100.0f32));
    let spot = Spec::new("", "spot").with("position", -place).with("look_at", Vec3::new(0.0, 0.0, 4.0));
    builder.lights.push(spot.with("intensity", 100.0f32));
    look(&mut builder, Vec3::Z * 4.0, Vec3::ZERO, 30.0);
    let settings = RenderSettings::new(16, 16, 32);
    let brightest = |builder: &SceneBuilder, name: &str| {
        let film = shoot(&built(builder), &*integrator(name), &settings).film;
        film.to_rgb().iter().map(|pixel| pixel.max_channel()).fold(0.0, f32::max)
    };
    for name in ["path", "light", "bdpt", "vcm", "sppm", "auto"] {
        assert_eq!(brightest(&builder, name), 0.0, "{name}");
    }
    // Negative control: with an extent, however small, they are visible there.
    let bulb = Spec::new("", "sphere").with("position", place).with("radius", 0.02f32);
    builder.lights.push(bulb.with("radiance", 100.0f32));
    for name in ["path", "light", "bdpt", "vcm", "sppm", "auto"] {
        assert!(brightest(&builder, name) > 1.0, "{name}");
    }
}

/// An emissive mesh of triangles of many sizes, rotated and stretched.
fn under_a_mesh(stretch: f64, instanced: bool) -> SceneBuilder {
    let mut builder = without_mirrors(Spec::new("", "point").with("intensity", 0.0f32));
    builder.lights.clear();
    let glowing = builder.add_material(diffuse(0.2f32).with("emission", Rgb::new(9.0, 7.0, 4.0)));
    let matrix = DMat4::from_translation(DVec3::new(-0.4, 2.2, 0.4))
        * DMat4::from_rotation_x(0.7)
        * DMat4::from_scale(DVec3::new(-0.9 * stretch, 0.15, 0.5));
    let placed = Motion::still(Transform::from_matrix(matrix).unwrap());
    let light = Object::new("light", ball(Vec3::ZERO, 1.0, 5, true), glowing);
    builder.objects.push(Object { motion: placed, instanced, ..light });
    builder
}

/// Mitsuba 3 #42: light subpaths from emissive meshes are not as bright as camera subpaths that find them.
#[test]
fn emissive_meshes_look_the_same_from_both_ends() {
    for instanced in [false, true] {
        let scene = built(&under_a_mesh(1.0, instanced));
        let path = blocks(&scene, integrator("path"), 0);
        for (i, name) in ["light", "bdpt"].into_iter().enumerate() {
            let case = format!("{name}, instanced: {instanced}");
            let p = agreement(&case, &path, &blocks(&scene, integrator(name), 100 * (i as u64 + 1)));
            assert!(p > UNLIKELY, "{case}: p = {p}");
            // Negative control: areas as if from before a stretch, with which light subpaths bring more.
            let other = built(&under_a_mesh(1.15, instanced));
            let p = difference(&path, &blocks(&other, integrator(name), 100 * (i as u64 + 3)));
            assert!(p < UNLIKELY, "{name} passes with other areas: p = {p}");
        }
    }
}

/// SORT #5: the sky is missing where subpaths are connected.
#[test]
fn the_sky_is_found_by_connections_and_light_paths_too() {
    let mut builder = without_mirrors(Spec::new("", "environment").with("zenith", 1.0f32));
    let path = blocks(built(&builder), integrator("path"), 0);
    for (i, name) in ["light", "bdpt", "vcm"].into_iter().enumerate() {
        let scene = built(&builder);
        let p = agreement(name, &path, &blocks(&scene, unmerged(name), 100 * (i as u64 + 1)));
        assert!(p > UNLIKELY, "{name}: p = {p}");
    }
    // Negative control: a sky that is a tenth darker is detected.
    builder.lights[0] = Spec::new("", "environment").with("zenith", 0.9f32);
    let p = difference(&path, &blocks(built(&builder), integrator("bdpt"), 500));
    assert!(p < UNLIKELY, "p = {p}");
}

fn unmerged(name: &str) -> Box<dyn bilux_transport::PixelIntegrator> {
    let spec = Spec::new("", name);
    integrators::build(&if name == "vcm" { spec.with("radius", 0.0f32) } else { spec }).unwrap()
}

/// A diffuse ball in a block of rough glass, lit from outside; the camera is in the glass as well, or outside it.
fn in_glass(eta: f32, inside: bool) -> Scene {
    let mut builder = SceneBuilder::default();
    let bounds = bilux_math::Aabb { min: Vec3::new(-1.5, -1.0, -1.5), max: Vec3::new(1.5, 1.2, 2.5) };
    let block = bilux_scene::mesh::shapes::cuboid(bounds);
    let glass = Spec::new("", "dielectric").with("eta", eta).with("roughness", 0.6f32);
    put(&mut builder, "block", std::sync::Arc::new(block), glass);
    put(&mut builder, "ball", ball(Vec3::ZERO, 0.7, 10, true), diffuse(Rgb::new(0.8, 0.5, 0.3)));
    let panel = Spec::new("", "rect").with("position", Vec3::new(-1.5, 2.5, 0.0)).with("intensity", 20.0f32);
    builder.lights.push(panel.with("edge_u", Vec3::X * 3.0).with("edge_v", Vec3::Z * 2.0));
    sky(&mut builder, 0.3);
    look(&mut builder, Vec3::new(0.0, 0.3, if inside { 2.2 } else { 4.5 }), Vec3::ZERO, 40.0);
    built(&builder)
}

/// Radiance grows by η² on its way into glass, importance does not: an integrator that mixes them up is wrong by a
/// factor of 2.25 where an odd number of boundaries lies between the light and the camera.
#[test]
fn cameras_inside_glass_look_the_same_from_both_ends() {
    for inside in [true, false] {
        let scene = in_glass(1.5, inside);
        let path = blocks(&scene, integrator("path"), 0);
        for (i, name) in ["light", "bdpt"].into_iter().enumerate() {
            let case = format!("{name}, inside: {inside}");
            let p = agreement(&case, &path, &blocks(&scene, integrator(name), 100 * (i as u64 + 1)));
            assert!(p > UNLIKELY, "{case}: p = {p}");
        }
        // Negative control: a factor of (1.5 / 1.4)² is detected.
        let p = difference(&path, &blocks(in_glass(1.4, inside), integrator("bdpt"), 500));
        assert!(!inside || p < UNLIKELY, "another index passes: p = {p}");
    }
}
