//! Light that passes panes straight: what paths sample through them, what they meet behind them, and what paths from lights find.

use crate::common::statistics::{UNLIKELY, agreement, blocks};
use crate::common::{ball, built, diffuse, floor, integrator, put, quad, shoot, sky, without_mirrors};
use crate::light_parts::parts;
use crate::receiving::{measured, measured_parts};
use bilux_math::{Rgb, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Scene, SceneBuilder, Spec};
use bilux_transport::{PartOfSky, PixelIntegrator, RenderSettings, integrators};
use std::f32::consts::PI;

const TINT: Rgb = Rgb { r: 0.9, g: 0.6, b: 0.2 };
const SUN: Vec3 = Vec3::new(0.6, -0.8, 0.0);

/// Fraction of light that a pane lets through, with what is reflected within it, by Fresnel's two amplitudes.
fn passed(eta: f32, cos: f32) -> f32 {
    let inside = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
    let across = (cos - eta * inside) / (cos + eta * inside);
    let along = (eta * cos - inside) / (eta * cos + inside);
    let reflected = 0.5 * (across * across + along * along);
    (1.0 - reflected) / (1.0 + reflected)
}

/// A square of this side about a point.
fn square(builder: &mut SceneBuilder, middle: Vec3, normal: Vec3, side: f32, material: Spec) {
    let u = normal.any_orthonormal_vector() * side;
    let v = normal.normalize().cross(u);
    put(builder, "square", quad(middle - (u + v) * 0.5, u, v), material);
}

fn pane(tint: Rgb) -> Spec {
    Spec::new("", "dielectric").with("thin", true).with("tint", tint)
}

/// The normal of a pane that is neither level nor square to the sun.
fn tilted() -> Vec3 {
    Vec3::new(0.25, 1.0, 0.15).normalize()
}

/// A floor of 2 m that reflects half, of which half is seen from below 1 m.
fn room() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 1.0), diffuse(0.5f32));
    let eye = Spec::new("eye", "orthographic").with("position", Vec3::Y * 0.5).with("look_at", Vec3::ZERO);
    let spec = eye.with("up", Vec3::X).with("height", 1.0f32);
    builder.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
    builder
}

fn sunny() -> SceneBuilder {
    let mut builder = room();
    builder.lights.push(Spec::new("", "directional").with("direction", SUN).with("irradiance", 3.0f32));
    builder
}

fn path(sampling: &str) -> Box<dyn PixelIntegrator> {
    integrators::build(&Spec::new("", "path").with("sampling", sampling)).unwrap()
}

fn mean(scene: &Scene, integrator: &dyn PixelIntegrator, max_depth: u32, spp: u32) -> Rgb {
    let settings = RenderSettings { max_depth, ..RenderSettings::new(8, 8, spp) };
    let pixels = shoot(scene, integrator, &settings).film.to_rgb();
    pixels.into_iter().sum::<Rgb>() * (1.0 / 64.0)
}

#[track_caller]
fn assert_near(case: &str, found: Rgb, wanted: Rgb, within: f32) {
    let is_near = |channel: usize| (found[channel] / wanted[channel] - 1.0).abs() < within;
    assert!((0..3).all(is_near), "{case}: {found:?}, not {wanted:?}");
}

#[test]
fn the_sun_shines_through_a_tinted_pane_by_every_technique() {
    let mut builder = sunny();
    square(&mut builder, Vec3::Y * 2.0, tilted(), 8.0, pane(TINT).with("eta", 1.6f32));
    let scene = built(&builder);
    let lit = 0.5 / PI * 3.0 * 0.8;
    let wanted = TINT * (lit * passed(1.6, -tilted().dot(SUN)));
    assert_near("path", mean(&scene, &*integrator("path"), 3, 1), wanted, 1e-4);
    for (name, spp) in [("light", 4096), ("bdpt", 1024), ("vcm", 1024)] {
        assert_near(name, mean(&scene, &*integrator(name), 3, spp), wanted, 0.03);
    }
}

#[test]
fn two_panes_of_which_one_is_principled_let_their_product_through() {
    let mut builder = sunny();
    square(&mut builder, Vec3::Y * 2.0, tilted(), 8.0, pane(TINT));
    let colour = Rgb::new(0.5, 0.7, 0.9);
    let clear = Spec::new("", "principled").with("transmission_weight", 0.8f32).with("thin_walled", true);
    let clear = clear.with("transmission_color", colour).with("specular_ior", 1.4f32);
    square(&mut builder, Vec3::Y * 4.0, Vec3::Y, 12.0, clear.with("specular_roughness", 0.0f32));
    let scene = built(&builder);
    let both = passed(1.5, -tilted().dot(SUN)) * passed(1.4, 0.8);
    let wanted = TINT * colour * (0.5 / PI * 3.0 * 0.8 * 0.8 * both);
    assert_near("two events more", mean(&scene, &*integrator("path"), 3, 1), wanted, 1e-4);
    assert_eq!(mean(&scene, &*integrator("path"), 2, 1), Rgb::BLACK, "each pane is an event");
    square(&mut builder, Vec3::Y * 5.0, Vec3::Y, 14.0, pane(Rgb::grey(0.5)));
    let scene = built(&builder);
    for name in ["path", "bdpt", "vcm"] {
        assert_eq!(mean(&scene, &*integrator(name), 3, 1), Rgb::BLACK, "{name}: and so is the third");
    }
    assert_near("three", mean(&scene, &*integrator("path"), 4, 1), wanted * (0.5 * passed(1.5, 0.8)), 1e-4);
}

/// A panel beyond a pane, which paths also meet by chance: both samplings find the same, and what is weighted adds up, at any depth.
#[test]
fn what_is_sampled_through_panes_and_what_is_met_behind_them_add_up() {
    let mut builder = room();
    square(&mut builder, Vec3::Y * 1.2, tilted(), 12.0, pane(TINT));
    let panel = Spec::new("", "rect").with("position", Vec3::new(-2.0, 3.0, -1.0)).with("radiance", 4.0f32);
    builder.lights.push(panel.with("edge_u", Vec3::X * 3.0).with("edge_v", Vec3::Z * 3.0));
    let scene = built(&builder);
    for depth in [2, 4] {
        let wanted = mean(&scene, &*path("scattering"), depth, 1024);
        for sampling in ["mis", "lights"] {
            let found = mean(&scene, &*path(sampling), depth, 64);
            assert_near(&format!("{sampling}, depth {depth}"), found, wanted, 0.015);
        }
        assert_near("bdpt", mean(&scene, &*integrator("bdpt"), depth, 512), wanted, 0.03);
    }
    let path = |sampling| Spec::new("", "path").with("sampling", sampling);
    let both_ends = ["bdpt", "vcm"].map(|name| Spec::new("", name));
    for spec in ["scattering", "mis", "lights"].map(path).into_iter().chain(both_ends) {
        let integrator = integrators::build(&spec).unwrap();
        assert_eq!(mean(&scene, &*integrator, 1, 64), Rgb::BLACK, "{spec:?}");
        let settings = RenderSettings { max_depth: 4, ..RenderSettings::new(16, 16, 64) };
        let [direct, _] = parts(&scene, &spec, &settings).by_events.unwrap();
        assert!(direct.to_rgb().iter().all(|light| light.is_black()), "{spec:?}: a pane is an event");
    }
}

/// A lamp in a thin bulb, whose interpolated normals are not those of its triangles.
#[test]
fn bulbs_let_the_light_of_their_lamps_through() {
    let mut builder = room();
    put(&mut builder, "bulb", ball(Vec3::Y * 2.0, 0.5, 6, true), pane(TINT));
    let lamp = Spec::new("", "sphere").with("position", Vec3::Y * 2.0).with("radius", 0.3f32);
    builder.lights.push(lamp.with("radiance", 5.0f32));
    let scene = built(&builder);
    let wanted = mean(&scene, &*path("scattering"), 2, 1024);
    for sampling in ["mis", "lights"] {
        assert_near(sampling, mean(&scene, &*path(sampling), 2, 64), wanted, 0.015);
    }
}

/// In fog of which a pane is the window, with a lamp outside and one that a path meets.
#[test]
fn lamps_shine_through_panes_into_fog() {
    let mut builder = room();
    let fog =
        Spec::new("", "interface").with("scattering", Rgb::new(0.3, 0.2, 0.5)).with("absorption", 0.1f32);
    put(&mut builder, "fog", ball(Vec3::ZERO, 8.0, 40, false), fog);
    square(&mut builder, Vec3::Y, tilted(), 6.0, pane(TINT));
    let lamp = Spec::new("", "point").with("position", Vec3::new(0.4, 2.0, 0.2)).with("intensity", 5.0f32);
    builder.lights.push(lamp);
    let panel = Spec::new("", "rect").with("position", Vec3::new(-2.0, 3.0, -1.0)).with("radiance", 1.0f32);
    builder.lights.push(panel.with("edge_u", Vec3::X * 3.0).with("edge_v", Vec3::Z * 3.0));
    let scene = built(&builder);
    let wanted = mean(&scene, &*integrator("bdpt"), 5, 1024);
    assert_near("path", mean(&scene, &*integrator("path"), 5, 1024), wanted, 0.03);
}

/// A still life behind a pane, under a panel and the sky, and a lamp in a bulb; with `many` more lamps that only light some of it.
fn shop_window(many: i32) -> SceneBuilder {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.6, 0.0)).with("intensity", 6.0f32);
    let mut builder = without_mirrors(panel);
    let tilted = quad(Vec3::new(-2.5, 1.9, -2.0), Vec3::X * 5.0, Vec3::new(0.0, 0.2, 4.0));
    put(&mut builder, "pane", tilted, pane(TINT));
    put(&mut builder, "bulb", ball(Vec3::new(0.2, 0.9, 1.2), 0.25, 6, true), pane(Rgb::new(0.4, 0.7, 0.9)));
    let lamp = Spec::new("", "sphere").with("position", Vec3::new(0.2, 0.9, 1.2)).with("radius", 0.1f32);
    builder.lights.push(lamp.with("intensity", Rgb::new(0.4, 0.3, 0.1)));
    sky(&mut builder, 0.3);
    for i in 0..many {
        let p = Vec3::new(0.7 * (i % 4) as f32 - 1.0, 2.4 + 0.1 * i as f32, 0.6 * (i / 4) as f32 - 0.5);
        let lamp = Spec::new("", "sphere").with("position", p).with("radius", 0.03f32);
        builder.lights.push(lamp.with("intensity", 0.1 * (1 + i) as f32));
    }
    builder
}

/// By few lights, which are all sampled, and by many; `vcm` merges what comes through panes, as light that is not direct.
#[test]
fn both_ends_find_the_same_behind_panes() {
    for (many, name) in [(0, "bdpt"), (9, "bdpt"), (0, "vcm")] {
        let scene = built(&shop_window(many));
        let case = format!("{name}, {many} more lamps");
        let [paths, both] =
            [("path", 0), (name, 100)].map(|(name, seed)| blocks(&scene, integrator(name), seed));
        let p = agreement(&case, &paths, &both);
        assert!(p > UNLIKELY, "{case}: p = {p}");
    }
}

/// Points of fog choose lights by power, and here next to never a panel behind a pane: paths meet it by chance, whatever is nearest to the pane.
#[test]
fn fog_meets_lamps_behind_panes_that_it_rarely_samples() {
    let mut builder = room();
    let fog = Spec::new("", "interface").with("scattering", 0.8f32).with("scattering_anisotropy", 0.5f32);
    put(&mut builder, "fog", ball(Vec3::ZERO, 8.0, 40, false), fog);
    square(&mut builder, Vec3::Y, tilted(), 6.0, pane(TINT));
    let panel = Spec::new("", "rect").with("position", Vec3::new(-2.0, 1.8, -2.0)).with("radiance", 1.0f32);
    builder.lights.push(panel.with("edge_u", Vec3::X * 4.0).with("edge_v", Vec3::Z * 4.0));
    for i in 0..9 {
        let below = Vec3::new(20.0 * i as f32, -3000.0, 30.0);
        builder.lights.push(Spec::new("", "point").with("position", below).with("intensity", 1e6f32));
    }
    square(&mut builder, -Vec3::Y * 3.0, Vec3::Y, 20.0, diffuse(0.0f32));
    let scene = built(&builder);
    let wanted = mean(&scene, &*path("scattering"), 5, 1024);
    assert_near("mis", mean(&scene, &*path("mis"), 5, 1024), wanted, 0.03);
}

#[test]
fn points_receive_the_sun_and_the_sky_through_panes() {
    let mut builder = SceneBuilder::default();
    square(&mut builder, Vec3::Y * 2.0, tilted(), 400.0, pane(Rgb::grey(0.7)));
    builder.lights.push(Spec::new("", "directional").with("direction", SUN).with("irradiance", 3.0f32));
    let at = [Vec3::new(0.3, 0.5, 0.1), Vec3::Y];
    let [found, error] = measured(&built(&builder), at, 16);
    let wanted = f64::from(3.0 * 0.8 * 0.7 * passed(1.5, -tilted().dot(SUN)));
    assert!((found / wanted - 1.0).abs() < 1e-4 && error < 1e-4 * wanted, "{found} ± {error}, not {wanted}");
    // What a level pane reflects comes from below.
    builder.lights = vec![Spec::new("", "environment").with("radiance", 1.0f32)];
    builder.objects.clear();
    square(&mut builder, Vec3::Y * 2.0, Vec3::Y, 400.0, pane(Rgb::grey(0.7)));
    let found = measured_parts(&built(&builder), at, 1, 256);
    let lit = |parts: &[PartOfSky]| parts.iter().filter(|part| part.mean > 0.0).count();
    assert!(lit(&found.all) > 100 && lit(&found.reflected) == 1, "{:?}", found.reflected);
}
