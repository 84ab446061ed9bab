//! `path` against closed forms, and its sampling techniques against each other.

use crate::common::statistics::{UNLIKELY, agreement, blocks, channel, difference, estimate};
use crate::common::{ball, built, diffuse, floor, integrator, look, mixed, put, quad, shoot, sky};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Ray, Scene, SceneBuilder, Spec};
use bilux_transport::{PixelIntegrator, RenderSettings, Task, integrators};

fn path(sampling: &str) -> Box<dyn PixelIntegrator> {
    integrators::build(&Spec::new("", "path").with("sampling", sampling)).unwrap()
}

fn named(name: &str) -> Box<dyn PixelIntegrator> {
    integrators::build(&Spec::new("", name)).unwrap()
}

/// The means of eight pictures with different seeds, each over all of its pixels.
fn means(scene: &Scene, integrator: &dyn PixelIntegrator, settings: &RenderSettings) -> Vec<Rgb> {
    let mean = |seed| {
        let film = shoot(scene, integrator, &RenderSettings { seed, ..settings.clone() }).film;
        let pixels = film.to_rgb();
        pixels.iter().copied().sum::<Rgb>() / pixels.len() as f32
    };
    (0..8).map(mean).collect()
}

/// Every mean lies within five standard errors of the truth, with a small relative allowance.
fn assert_mean(found: &[Rgb], wanted: f64) {
    for c in 0..3 {
        let (mean, error) = estimate(&channel(found, c));
        assert!(
            (mean - wanted).abs() < 5.0 * error + 1e-5 * wanted,
            "channel {c}: {mean} ± {error}, not {wanted}"
        );
    }
}

#[test]
fn a_convex_diffuse_body_under_a_uniform_sky_shows_its_albedo() {
    for sampling in ["mis", "lights", "scattering"] {
        let mut builder = SceneBuilder::default();
        put(&mut builder, "ball", ball(Vec3::ZERO, 1.0, 16, false), diffuse(0.6f32));
        sky(&mut builder, 1.0);
        look(&mut builder, Vec3::Z * 10.0, Vec3::ZERO, 8.0);
        let scene = built(&builder);
        assert_mean(&means(&scene, &*path(sampling), &RenderSettings::new(8, 8, 64)), 0.6);
    }
}

#[test]
fn light_in_a_glowing_shell_sums_to_the_geometric_series() {
    for albedo in [0.0f32, 0.5, 0.8] {
        let mut builder = SceneBuilder::default();
        let glowing = diffuse(albedo).with("emission", 1.0f32);
        put(&mut builder, "shell", ball(Vec3::ZERO, 1.0, 8, false), glowing);
        look(&mut builder, Vec3::ZERO, Vec3::new(0.3, 0.4, -1.0), 60.0);
        let settings = RenderSettings { max_depth: 1000, ..RenderSettings::new(8, 8, 32) };
        let found = means(&built(&builder), &*path("mis"), &settings);
        assert_mean(&found, 1.0 / (1.0 - f64::from(albedo)));
        // With a limit on the length of paths, the series ends too.
        let settings = RenderSettings { max_depth: 2, ..settings };
        let found = means(&built(&builder), &*path("mis"), &settings);
        assert_mean(&found, f64::from(1.0 + albedo + albedo * albedo));
    }
}

#[test]
fn smooth_dielectric_is_invisible_in_a_white_furnace() {
    for (camera, thin) in [(10.0, false), (0.2, false), (10.0, true)] {
        let mut builder = SceneBuilder::default();
        let glass = Spec::new("", "dielectric").with("thin", thin);
        put(&mut builder, "ball", ball(Vec3::ZERO, 1.0, 12, false), glass);
        sky(&mut builder, 1.0);
        look(&mut builder, Vec3::Z * camera, Vec3::ZERO, 8.0);
        let path = integrators::build(
            &Spec::new("", "path").with("roulette_depth", bilux_scene::Value::Integer(1000)),
        );
        let settings = RenderSettings { max_depth: 1000, ..RenderSettings::new(16, 16, 16) };
        let film = shoot(&built(&builder), &*path.unwrap(), &settings).film;
        // Radiance within glass is η² times that outside, and returns to its former value on the way out.
        let wanted = if camera < 1.0 { 1.5 * 1.5 } else { 1.0 };
        for pixel in film.to_rgb() {
            assert!((pixel.g - wanted).abs() < 2e-4 * wanted, "{pixel:?} from {camera}, thin: {thin}");
        }
    }
}

#[test]
fn a_mirror_ball_loses_no_light_at_its_silhouette() {
    // At the silhouette, reflection about the interpolated normal would send light into the triangle.
    let mut builder = SceneBuilder::default();
    let mirror = Spec::new("", "mirror").with("reflectance", 1.0f32);
    put(&mut builder, "ball", ball(Vec3::ZERO, 1.0, 8, true), mirror);
    sky(&mut builder, 1.0);
    look(&mut builder, Vec3::Z * 10.0, Vec3::ZERO, 12.0);
    let film = shoot(&built(&builder), &*path("mis"), &RenderSettings::new(64, 64, 4)).film;
    for pixel in film.to_rgb() {
        assert!((pixel.g - 1.0).abs() < 1e-5, "{pixel:?}");
    }
}

/// A path tracer with a bug.
struct Wrong(Box<dyn PixelIntegrator>, f32);

impl PixelIntegrator for Wrong {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        self.0.radiance(ray, task) * self.1
    }
}

/// Near its silhouette, interpolated normals of a coarse mesh face away from the camera.
#[test]
fn a_coarse_smooth_ball_has_no_black_edge() {
    let clay = Spec::new("", "phong").with("kd", 0.6f32).with("ks", 0.05f32).with("reflectivity", 0.0f32);
    let plastic = Spec::new("", "principled").with("base_color", 0.6f32);
    for material in [clay, diffuse(0.6f32), plastic] {
        let name = material.kind.clone();
        let mut builder = SceneBuilder::default();
        put(&mut builder, "ball", ball(Vec3::ZERO, 1.0, 4, true), material);
        sky(&mut builder, 1.0);
        look(&mut builder, Vec3::new(0.0, 0.3, 4.0), Vec3::ZERO, 32.0);
        let settings = RenderSettings::new(48, 48, 64);
        let pixels = shoot(&built(&builder), &*path("mis"), &settings).film.to_rgb();
        let darkest = pixels.iter().map(|pixel| pixel.g).fold(f32::INFINITY, f32::min);
        assert!(darkest > 0.25, "{name}: {darkest}");
    }
}

#[test]
fn all_sampling_techniques_agree() {
    let scene = built(&mixed());
    let mis = blocks(&scene, path("mis"), 0);
    for (sampling, seed) in [("lights", 100), ("scattering", 200)] {
        let case = format!("mis and {sampling}");
        let p = agreement(&case, &mis, &blocks(&scene, path(sampling), seed));
        assert!(p > UNLIKELY, "{case}: p = {p}");
    }
    // Negative control: light that is five hundredths too bright is detected.
    let wrong: Box<dyn PixelIntegrator> = Box::new(Wrong(path("lights"), 1.05));
    let p = difference(&mis, &blocks(&scene, wrong, 300));
    assert!(p < 1e-4, "a wrong density passes: p = {p}");
}

#[test]
fn a_backdrop_is_seen_and_lights_nothing() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.5f32));
    put(
        &mut builder,
        "mirror",
        quad(Vec3::new(0.0, 0.0, -1.0), Vec3::X, Vec3::Y),
        Spec::new("", "mirror").with("reflectance", 1.0f32),
    );
    let backdrop =
        Spec::new("", "environment").with("radiance", Rgb::new(0.1, 0.2, 0.3)).with("backdrop", true);
    builder.lights.push(backdrop);
    let seen = |from: Vec3, at: Vec3| {
        let mut builder = builder.clone();
        look(&mut builder, from, at, 0.02);
        shoot(&built(&builder), &*path("mis"), &RenderSettings::new(1, 1, 64)).film.pixel(0, 0)
    };
    let colour = Rgb::new(0.1, 0.2, 0.3);
    let near = |a: Rgb, b: Rgb| (a - b).map(f32::abs).max_channel() < 1e-5;
    let mirror = Vec3::new(0.5, 0.9, -1.0);
    let [above, below] = [4.0, 0.1].map(|y| Vec3::new(0.5, y, 4.0));
    assert!(near(seen(above, Vec3::new(-3.0, 5.0, -1.0)), colour), "it is seen");
    assert!(near(seen(above, Vec3::ZERO), Rgb::BLACK), "it lights no floor");
    assert!(near(seen(above, mirror), Rgb::BLACK), "nor the floor in the mirror");
    assert!(near(seen(below, mirror), colour), "it is seen in the mirror");
    // With an environment as well, the camera sees the backdrop; the mirror shows the environment, which also lights
    // the floor.
    let lit = Rgb::grey(0.7);
    builder.lights.push(Spec::new("", "environment").with("radiance", lit));
    for integrator in
        [path("mis"), named("bdpt"), named("vcm"), named("light"), named("whitted"), named("cast")]
    {
        let seen = |from: Vec3, at: Vec3| {
            let mut builder = builder.clone();
            look(&mut builder, from, at, 0.02);
            shoot(&built(&builder), &*integrator, &RenderSettings::new(1, 1, 64)).film.pixel(0, 0)
        };
        assert!(near(seen(above, Vec3::new(-3.0, 5.0, -1.0)), colour), "seen in place of what lights");
    }
    let seen = |from: Vec3, at: Vec3| {
        let mut builder = builder.clone();
        look(&mut builder, from, at, 0.02);
        [path("mis"), named("bdpt")].map(|integrator| {
            shoot(&built(&builder), &*integrator, &RenderSettings::new(1, 1, 64)).film.pixel(0, 0)
        })
    };
    assert!(seen(below, mirror).into_iter().all(|light| near(light, lit)), "the mirror shows what lights");
    assert!(seen(above, Vec3::ZERO).into_iter().all(|light| light.g > 0.2), "the floor is lit");
}

#[test]
fn glass_and_its_contents_absorb_along_the_ray() {
    // A black, glowing square in a ball of glass is dimmed by the glass in front of it.
    let sigma = Rgb::new(0.2, 0.6, 1.2);
    let mut builder = SceneBuilder::default();
    let glass = Spec::new("", "dielectric").with("eta", 1.0f32).with("absorption", sigma);
    put(&mut builder, "glass", ball(Vec3::ZERO, 2.0, 16, false), glass);
    put(
        &mut builder,
        "core",
        quad(Vec3::new(-0.5, -0.5, 0.5), Vec3::X, Vec3::Y),
        diffuse(0.0f32).with("emission", 1.0f32),
    );
    look(&mut builder, Vec3::Z * 5.0, Vec3::ZERO, 0.02);
    let scene = built(&builder);
    let camera = bilux_scene::CameraSample {
        film: bilux_math::Vec2::splat(0.5),
        lens: bilux_math::Vec2::ZERO,
        time: 0.0,
    };
    let enters =
        bilux_scene::Tracer::new(&scene, false).closest(&scene.cameras()[0].1.ray(&camera)).unwrap().p.z;
    let wanted = sigma.map(|s| bilux_math::transcendental::exp(-s * (enters - 0.5)));
    for name in ["path", "whitted"] {
        let found = shoot(&scene, &*integrator(name), &RenderSettings::new(1, 1, 4)).film.pixel(0, 0);
        assert!((found - wanted).map(f32::abs).max_channel() < 1e-4, "{name}: {found:?}, not {wanted:?}");
    }
}

/// Red over green of a patch of floor, at this distance in front of a red body. (The paper, section 4.4.)
fn red_over_green(integrator_name: &str, distance: f32) -> f32 {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 20.0), diffuse(Rgb::new(0.2, 0.6, 0.2)));
    put(&mut builder, "pot", ball(Vec3::Y, 1.0, 16, true), diffuse(Rgb::new(0.8, 0.05, 0.05)));
    let panel = Spec::new("", "rect").with("position", Vec3::new(0.0, 2.0, 7.0)).with("intensity", 100.0f32);
    builder.lights.push(panel.with("edge_u", Vec3::X * 2.0).with("edge_v", Vec3::Y * 2.0));
    let patch = Vec3::new(0.0, 0.0, 1.0 + distance);
    look(&mut builder, patch + Vec3::new(0.0, 3.0, 2.0), patch, 2.0);
    let film = shoot(&built(&builder), &*integrator(integrator_name), &RenderSettings::new(8, 8, 64)).film;
    let sum: Rgb = film.to_rgb().into_iter().sum();
    sum.r / sum.g
}

#[test]
fn the_pot_colours_the_floor_near_it_in_path_and_not_in_whitted() {
    let floor = 0.2 / 0.6;
    for distance in [0.2, 6.0] {
        let whitted = red_over_green("whitted", distance);
        assert!((whitted - floor).abs() < 1e-3, "whitted at {distance}: {whitted}");
    }
    let (near, far) = (red_over_green("path", 0.2), red_over_green("path", 6.0));
    assert!(near > 1.15 * floor, "path near the pot: {near}");
    assert!((far - floor).abs() < 0.02 * floor, "path far from it: {far}");
}
