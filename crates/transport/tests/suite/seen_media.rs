//! Guides, alpha and mattes of fog, smoke and murky insides, against closed forms.

use crate::common::labelled::Labelled;
use crate::common::{built, diffuse, integrator, look, put, quad};
use bilux_math::transcendental::exp_f64;
use bilux_math::{Aabb, Rgb, Transform, Vec3};
use bilux_pictures::Picture;
use bilux_scene::cameras::CameraSpec;
use bilux_scene::media::Grid;
use bilux_scene::mesh::shapes::cuboid;
use bilux_scene::{Scene, SceneBuilder, Spec, Value};
use bilux_transport::mattes::{Ranks, mattes};
use bilux_transport::{
    Features, RenderSettings, ShadowCatcher, Silent, Window, coverage, features, shadow_alpha,
};
use std::sync::Arc;

const RED: Rgb = Rgb::new(0.7, 0.2, 0.1);
const SKY: Rgb = Rgb::new(0.1, 0.2, 0.3);
const ABSORPTION: Rgb = Rgb::new(0.05, 0.2, 0.1);
const SCATTERING: Rgb = Rgb::new(0.6, 0.3, 0.0);
const SIDE: u32 = 16;

/// Two metres of a medium, 3 m in front of an orthographic camera, and 2 m behind it a red card that covers the left half.
fn slab(medium: Spec) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    let bounds = Aabb { min: Vec3::new(-4.0, -4.0, 0.0), max: Vec3::new(4.0, 4.0, 2.0) };
    put(&mut builder, "smoke", Arc::new(cuboid(bounds)), medium);
    let card = quad(Vec3::new(-4.0, -4.0, -2.0), Vec3::X * 4.0, Vec3::Y * 8.0);
    put(&mut builder, "card", card, diffuse(RED));
    builder.lights.push(Spec::new("sky", "environment").with("radiance", SKY));
    let camera = Spec::new("", "orthographic").with("position", Vec3::Z * 5.0).with("look_at", Vec3::ZERO);
    builder.cameras = vec![CameraSpec { spec: camera.with("height", 2.0f32), keyframes: Vec::new() }];
    builder
}

fn even() -> Spec {
    let spec = Spec::new("", "interface").with("absorption", ABSORPTION).with("scattering", SCATTERING);
    spec.with("priority", Value::Integer(1))
}

/// The medium of [`even`] from a grid of ones.
fn of_ones() -> Spec {
    const SIZE: [usize; 3] = [24, 24, 20];
    let voxel = Vec3::new(8.0, 8.0, 2.0) / Vec3::from(SIZE.map(|n| n as f32));
    let place = Transform::scale(voxel).unwrap();
    let place = place.then(&Transform::translate(Vec3::new(-4.0, -4.0, 0.0)).unwrap());
    let ones = vec![1.0; SIZE.iter().product()];
    even().with("density", Arc::new(Grid::dense("ones", SIZE, &place, &ones).unwrap()))
}

fn settings() -> RenderSettings {
    RenderSettings::new(SIDE, SIDE, 8)
}

fn seen(scene: &Scene, settings: &RenderSettings) -> Features {
    let camera = &*scene.cameras()[0].1;
    features(scene, camera, &*integrator("path"), settings, None, &Silent).unwrap().unwrap()
}

fn alpha(scene: &Scene, settings: &RenderSettings) -> Vec<f32> {
    coverage(scene, &*scene.cameras()[0].1, &*integrator("path"), settings, 8).unwrap()
}

fn covers(scene: &Scene, settings: &RenderSettings) -> Vec<Ranks> {
    let camera = &*scene.cameras()[0].1;
    let ids = [vec![5, 9]];
    mattes(scene, camera, &*integrator("path"), settings, &ids, 8, &Silent).unwrap().unwrap().remove(0)
}

fn near(a: Rgb, b: [f64; 3], within: f64) -> bool {
    (0..3).all(|c| (f64::from(a[c]) - b[c]).abs() < within)
}

/// Before a card and before the sky, where an even medium has closed forms; a grid of ones is the same medium.
#[test]
fn a_slab_counts_by_what_it_scatters_and_stops() {
    let channels = [0, 1, 2];
    let [a, s] = [ABSORPTION, SCATTERING].map(|sigma| channels.map(|c| f64::from(sigma[c])));
    let passed = channels.map(|c| exp_f64(-2.0 * (a[c] + s[c])));
    let scattered = channels.map(|c| s[c] / (a[c] + s[c]) * (1.0 - passed[c]));
    let mean = |rgb: [f64; 3]| (rgb[0] + rgb[1] + rgb[2]) / 3.0;
    // The distance of each event from the front: the integral of t σs exp(-σt t).
    let far = channels.map(|c| {
        let t = a[c] + s[c];
        s[c] / t * ((1.0 - passed[c]) / t - 2.0 * passed[c])
    });
    let (shown, rest) = (mean(scattered), mean(passed));
    let depth_of_slab = 3.0 + mean(far) / shown;
    let depth = (rest * 7.0 + shown * depth_of_slab) / (rest + shown);
    for (medium, within) in [(even(), 1e-5), (of_ones(), 2e-3)] {
        let scene = built(&slab(medium));
        let (found, alpha, mattes) =
            (seen(&scene, &settings()), alpha(&scene, &settings()), covers(&scene, &settings()));
        let (card, sky) = (SIDE as usize * 8 + 3, SIDE as usize * 8 + 12);
        for (i, behind) in [(card, RED), (sky, SKY)] {
            let albedo = channels.map(|c| passed[c] * f64::from(behind[c]) + scattered[c]);
            assert!(near(found.albedo[i], albedo, within), "{:?} is not {albedo:?}", found.albedo[i]);
            assert!((found.coverage[i] - alpha[i]).abs() < 1e-6);
        }
        assert!((f64::from(found.mean_normal[card].z) - rest / (rest + shown)).abs() < within);
        assert_eq!(found.mean_normal[sky], Vec3::ZERO);
        assert!(
            (f64::from(found.mean_depth[card]) - depth).abs() < 5.0 * within,
            "{} {depth}",
            found.mean_depth[card]
        );
        assert!((f64::from(found.mean_depth[sky]) - depth_of_slab).abs() < 25.0 * within);
        assert_eq!(alpha[card], 1.0);
        assert!((f64::from(alpha[sky]) - (1.0 - rest)).abs() < within, "{} {}", alpha[sky], 1.0 - rest);
        // The labels are those of the card; the mattes know both, and add up to alpha.
        let labels = Labelled::of(&scene, &settings());
        assert_eq!((labels.object[card], labels.object[sky]), (2, 0));
        assert!((labels.depth[card] - 7.0).abs() < 1e-4 && labels.depth[sky].is_infinite());
        let [(first, most), (second, least), ..] = mattes[card];
        assert_eq!((first, second, mattes[sky][0].0), (5, 9, 5));
        assert!((f64::from(most) - (1.0 - rest)).abs() < within && (most + least - 1.0).abs() < 1e-5);
        assert!((mattes[sky][0].1 - alpha[sky]).abs() < 1e-5 && mattes[sky][1] == (0, 0.0));
    }
}

/// Fire that only absorbs and glows covers what it absorbs, and empty smoke nothing at all: its box is not there.
#[test]
fn fire_covers_by_what_it_absorbs() {
    let fire = |absorption: f32| {
        let spec = Spec::new("", "interface").with("absorption", absorption);
        built(&slab(
            spec.with("medium_emission", Rgb::new(5.0, 2.0, 0.5)).with("priority", Value::Integer(1)),
        ))
    };
    let sky = SIDE as usize * 8 + 12;
    for absorption in [0.0, 0.2, 3.0] {
        let scene = fire(absorption);
        let (alpha, found) = (alpha(&scene, &settings()), seen(&scene, &settings()));
        let stopped = 1.0 - exp_f64(-2.0 * f64::from(absorption));
        assert!((f64::from(alpha[sky]) - stopped).abs() < 1e-5, "{} {stopped}", alpha[sky]);
        let lit = [5.0, 2.0, 0.5].map(|glow| (glow * stopped).min(1.0));
        let wanted = [0, 1, 2].map(|c| (f64::from(SKY[c]) * (1.0 - stopped) + lit[c]).min(1.5));
        assert!(near(found.albedo[sky], wanted, 1e-4), "{:?} {wanted:?}", found.albedo[sky]);
        assert_eq!(found.mean_depth[sky].is_finite(), absorption > 0.0);
    }
}

/// Milk behind smooth glass has the normal of the glass and its own colour, not what lies behind it.
#[test]
fn what_scatters_behind_a_surface_has_its_normal() {
    let milk =
        Spec::new("", "dielectric").with("eta", 1.3f32).with("scattering", Rgb::new(400.0, 400.0, 380.0));
    let scene = built(&slab(milk.with("absorption", Rgb::new(0.4, 4.0, 60.0))));
    let found = seen(&scene, &settings());
    for pixel in [SIDE as usize * 8 + 3, SIDE as usize * 8 + 12] {
        assert!(found.mean_normal[pixel].distance(Vec3::Z) < 1e-3, "{}", found.mean_normal[pixel]);
        assert!((found.mean_depth[pixel] - 3.0).abs() < 1e-4, "{}", found.mean_depth[pixel]);
        let Rgb { r, g, b } = found.albedo[pixel];
        assert!(r > 0.75 && r > g && g > 2.0 * b && b > 0.05, "{r} {g} {b}");
        assert_eq!(found.coverage[pixel], 1.0);
    }
}

#[test]
fn smoke_is_seen_alike_by_any_threads_and_in_any_crop() {
    let scene = built(&slab(of_ones()));
    let base = settings();
    let one = RenderSettings { threads: 1, ..base.clone() };
    let crop = Window { x: 5, y: 3, width: 7, height: 6 };
    let part = RenderSettings { crop: Some(crop), ..base.clone() };
    let (all, alphas, shares) = (seen(&scene, &one), alpha(&scene, &one), covers(&scene, &one));
    assert!(seen(&scene, &base) == all && alpha(&scene, &base) == alphas && covers(&scene, &base) == shares);
    let (found, alpha, mattes) = (seen(&scene, &part), alpha(&scene, &part), covers(&scene, &part));
    assert_eq!(alpha.len(), crop.pixels());
    for (i, alpha) in alpha.into_iter().enumerate() {
        let (x, y) = crop.position(i);
        let whole = (y * SIDE + x) as usize;
        assert_eq!(
            (found.albedo[i], found.mean_depth[i], alpha),
            (all.albedo[whole], all.mean_depth[whole], alphas[whole])
        );
        assert_eq!(mattes[i], shares[whole]);
    }
}

/// A slab of smoke over an invisible ground, seen and lit from straight above: it hides what it stops, and of what still shows of the
/// ground, its shadow takes the same fraction.
#[test]
fn smoke_over_a_ground_hides_it_and_shades_it() {
    let mut builder = SceneBuilder::default();
    let bounds = Aabb { min: Vec3::new(-9.0, 1.0, -9.0), max: Vec3::new(9.0, 2.0, 9.0) };
    let smoke = Spec::new("", "interface").with("scattering", 0.7f32).with("priority", Value::Integer(1));
    put(&mut builder, "smoke", Arc::new(cuboid(bounds)), smoke);
    // Its front, the only side that cameras see, is below.
    let ground = quad(Vec3::new(-9.0, 0.0, -9.0), Vec3::X * 18.0, Vec3::Z * 18.0);
    put(&mut builder, "ground", ground, diffuse(0.5f32).with("visible_sides", "front"));
    builder.lights.push(Spec::new("sun", "directional").with("direction", Vec3::NEG_Y));
    look(&mut builder, Vec3::new(0.0, 60.0, 0.0001), Vec3::ZERO, 1.0);
    let scene = built(&builder);
    let camera = &*scene.cameras()[0].1;
    let catcher = ShadowCatcher { ground: 1, objects: 1 };
    let settings = RenderSettings::new(8, 8, 4);
    let [alpha, model] =
        shadow_alpha(&scene, camera, &*integrator("path"), &settings, 4, catcher, None).unwrap();
    let passed = exp_f64(-0.7);
    for (alpha, model) in alpha.iter().zip(&model) {
        assert!((f64::from(*model) - (1.0 - passed)).abs() < 1e-3, "{model}");
        assert!((f64::from(*alpha) - (1.0 - passed * passed)).abs() < 1e-3, "{alpha}");
    }
}

/// The haze that guides denoisers is a fraction of what is there: of a cut-out all of it where there is nothing but fog, and otherwise the part of the
/// light that the fog scatters, 1 - exp(-σ d) of 0.4 per metre over two.
#[test]
fn haze_of_a_cut_out_is_that_of_what_is_there() {
    let mut builder = slab(Spec::new("", "interface").with("scattering", 0.4f32));
    builder.objects.truncate(1);
    let settings = RenderSettings::new(SIDE, SIDE, 8);
    let scene = built(&builder);
    let found = seen(&scene, &settings);
    let stopped = (1.0 - exp_f64(-0.8)) as f32;
    for (is_cut_out, wanted) in [(false, stopped), (true, 1.0)] {
        let mut picture = Picture::from_rgb(SIDE as usize, SIDE as usize, found.albedo.clone()).unwrap();
        if is_cut_out {
            picture.push_channel("A", found.coverage.clone()).unwrap();
        }
        found.push_guides(&mut picture).unwrap();
        let haze = picture.channel("guides.haze").unwrap();
        assert!(haze.iter().all(|haze| (haze - wanted).abs() < 1e-4), "{is_cut_out}: {haze:?}");
    }
}
