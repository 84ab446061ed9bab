//! A picture is a function of scene, settings and seed: threads, crops, parts and cancellation make no difference.

use crate::common::{built, diffuse, floor, integrator, put, shoot, still_life};
use bilux_math::{Rgb, Vec2, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{AccelChoice, Ray, Scene, SceneBuilder, Spec};
use bilux_transport::{
    Film, INTEGRATORS, PixelAnchor, PixelIntegrator, Progress, RenderError, RenderSettings, SamplePlace,
    Silent, Task, Window, integrators, render, replay,
};
use std::f32::consts::PI;
use std::sync::atomic::{AtomicU64, Ordering};

fn settings() -> RenderSettings {
    RenderSettings { threads: 2, seed: 7, ..RenderSettings::new(37, 21, 5) }
}

/// Everything except how the coverage is composed.
fn same(a: &Film, b: &Film) -> bool {
    a.to_rgb() == b.to_rgb()
        && a.to_partial().unwrap().integer_planes() == b.to_partial().unwrap().integer_planes()
}

#[test]
fn threads_change_nothing() {
    let scene = built(&still_life());
    for row in INTEGRATORS {
        let integrator = integrator(row.entry.name);
        let one = shoot(&scene, &*integrator, &RenderSettings { threads: 1, ..settings() });
        for threads in [2, 7] {
            let many = shoot(&scene, &*integrator, &RenderSettings { threads, ..settings() });
            assert_eq!(one.film, many.film, "{} on {threads} threads", row.entry.name);
            assert_eq!(one.counters, many.counters);
        }
    }
}

#[test]
fn crops_and_ranges_merge_to_the_whole_in_any_order() {
    let scene = built(&still_life());
    for name in ["cook", "path"] {
        let integrator = integrator(name);
        let whole = shoot(&scene, &*integrator, &settings()).film;
        let mut parts = Vec::new();
        for crop in Window::whole(37, 21).tiles(19) {
            for samples in [3..5, 0..1, 1..3] {
                let part = RenderSettings { crop: Some(crop), samples, ..settings() };
                parts.push(shoot(&scene, &*integrator, &part).film);
            }
        }
        for rotation in [0, 3, 7] {
            parts.rotate_left(rotation);
            let mut merged = parts[0].clone();
            parts[1..].iter().for_each(|part| merged.merge(part).unwrap());
            assert!(same(&merged, &whole), "{name}, rotated by {rotation}");
        }
    }
}

#[test]
fn every_accelerator_gives_the_same_picture() {
    let of = |name: &str| {
        let accel = AccelChoice { name: name.to_owned(), ..AccelChoice::default() };
        let scene = still_life().build(&accel, [0.0, 0.0], 1.0).unwrap();
        shoot(&scene, &*integrator("path"), &RenderSettings::new(24, 24, 2)).film
    };
    let truth = of("brute");
    for row in bilux_accel::ACCELERATORS {
        assert_eq!(of(row.entry.name), truth, "{}", row.entry.name);
    }
}

#[test]
fn another_seed_gives_other_noise() {
    let scene = built(&still_life());
    let path = integrator("path");
    let one = shoot(&scene, &*path, &settings()).film;
    assert_ne!(one, shoot(&scene, &*path, &RenderSettings { seed: 8, ..settings() }).film);
}

/// A scene in which every extent of `cook` has something to spread over.
fn every_extent_matters_scene() -> Scene {
    let mut builder = still_life();
    builder.materials[3].parameters.set("translucency", 6.0f32);
    let keys = [(0.0, Vec3::ZERO), (1.0, Vec3::new(0.5, 0.3, 0.0))].map(|(time_seconds, translation)| {
        bilux_math::MotionKey {
            time_seconds,
            translation,
            rotation: bilux_math::Quat::IDENTITY,
            scale: Vec3::ONE,
        }
    });
    builder.objects[1].motion = bilux_math::Motion::from_keys(keys.to_vec()).unwrap();
    let spec = builder.cameras[0].spec.clone().with("aperture", 0.1f32);
    let mut later = bilux_scene::Parameters::default();
    later.set("position", Vec3::new(0.5, 3.0, 8.0));
    let keyframes = vec![(0.0, bilux_scene::Parameters::default()), (1.0, later)];
    builder.cameras = vec![CameraSpec { spec, keyframes }];
    builder.build(&AccelChoice::default(), [0.0, 1.0], 1.0).unwrap()
}

#[test]
fn cook_without_extents_is_whitted_to_the_bit() {
    let scene = every_extent_matters_scene();
    let settings = RenderSettings::new(64, 64, 3);
    let whitted = shoot(&scene, &*integrator("whitted"), &settings).film;
    let cook = |key: &str, value: f32| {
        let integrator = integrators::build(&Spec::new("", "cook").with(key, value)).unwrap();
        shoot(&scene, &*integrator, &settings).film
    };
    assert_eq!(cook("extent", 0.0), whitted);
    // Negative control: each extent alone changes the picture, so the scene really has something to spread over.
    let extents = ["pixel", "gloss", "translucency", "lights", "lens", "shutter"];
    for on in extents {
        let spec = extents.iter().filter(|e| **e != on).fold(Spec::new("", "cook"), |s, e| s.with(e, 0.0f32));
        let film = shoot(&scene, &*integrators::build(&spec).unwrap(), &settings).film;
        assert_ne!(film, whitted, "{on}");
    }
}

/// Greatest distances of the rays of a pixel's samples from its middle, from that of the lens and from that of the shutter's time: each as a part of what
/// filter, aperture and shutter allow.
fn spread_of(spec: &Spec) -> [f32; 3] {
    let mut builder = SceneBuilder::default();
    let eye =
        Spec::new("", "perspective").with("position", Vec3::new(0.0, 1.0, 5.0)).with("look_at", Vec3::Y);
    let eye = eye.with("aperture", 0.2f32).with("focus", 4.0f32);
    builder.cameras = vec![CameraSpec { spec: eye, keyframes: Vec::new() }];
    let scene = builder.build(&AccelChoice::default(), [2.0, 5.0], 1.0).unwrap();
    let (camera, integrator) = (&*scene.cameras()[0].1, integrators::build(spec).unwrap());
    let settings = RenderSettings::new(16, 16, 256);
    let mut most = [0.0f32; 3];
    for sample in 0..256 {
        let place = SamplePlace { x: 3, y: 9, sample };
        let ray = replay(&scene, camera, &*integrator, &settings, place).unwrap().ray;
        let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
        // Where it is in focus, the place on the lens does not count.
        let film = camera.project(origin + direction * (-4.0 / direction.z), ray.time).unwrap() * 16.0;
        let beside = (film - Vec2::new(3.5, 9.5)).abs().max_element() / 0.5;
        let aside = origin.distance(Vec3::new(0.0, 1.0, 5.0)) / 0.2;
        let late = (ray.time - 3.5).abs() / 1.5;
        most = [most[0].max(beside), most[1].max(aside), most[2].max(late)];
    }
    most
}

/// Each fraction of `cook` is that of its own extent, and the factor on all of them is one on each.
#[test]
fn rays_of_cook_spread_over_the_fraction_that_is_asked_for() {
    let names = ["pixel", "lens", "shutter"];
    let mut cases = vec![(Spec::new("", "cook").with("extent", 0.25f32), [0.25; 3])];
    for (i, name) in names.into_iter().enumerate() {
        let mut wanted = [1.0; 3];
        wanted[i] = 0.4;
        cases.push((Spec::new("", "cook").with(name, 0.4f32), wanted));
    }
    for (spec, wanted) in cases {
        let found = spread_of(&spec);
        for ((found, wanted), name) in found.into_iter().zip(wanted).zip(names) {
            let part = found / wanted;
            assert!((0.95..1.001).contains(&part), "{:?}: {name}: {found}, not {wanted}", spec.parameters);
        }
    }
}

/// Cancels after this many samples.
struct StopAfter(AtomicU64, u64);

impl Progress for StopAfter {
    fn advance(&self, samples: u64, _rays: u64) {
        self.0.fetch_add(samples, Ordering::Relaxed);
    }
    fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed) >= self.1
    }
}

#[test]
fn cancelled_renders_are_complete_up_to_their_coverage() {
    let scene = built(&still_life());
    let (path, camera) = (integrator("path"), scene.cameras()[0].1.clone());
    let settings = RenderSettings { threads: 3, ..RenderSettings::new(40, 40, 9) };
    for stop in [0, 1, 1000, 5000, 9000] {
        let stopping = StopAfter(AtomicU64::new(0), stop);
        let stopped = render(&scene, &*camera, &*path, &settings, &stopping).unwrap();
        assert!(stopped.cancelled);
        let mut again = Film::new(40, 40, stopped.film.scale_exponent()).unwrap();
        for (window, samples) in stopped.film.coverage().pieces() {
            let part = RenderSettings { crop: Some(*window), samples: samples.clone(), ..settings.clone() };
            again.merge(&shoot(&scene, &*path, &part).film).unwrap();
        }
        assert!(same(&again, &stopped.film), "stopped after {stop}");
    }
}

/// The light of an iteration's photons is added to the film before its camera rays are traced.
#[test]
fn cancelled_renders_have_no_light_of_an_incomplete_iteration() {
    let scene = built(&still_life());
    let vcm = integrators::build(&Spec::new("", "vcm").with("connections", false)).unwrap();
    let camera = scene.cameras()[0].1.clone();
    let settings = RenderSettings { threads: 3, ..RenderSettings::new(40, 40, 4) };
    let splats = |film: &Film| (0..1600).map(|i| film.splatted(i % 40, i / 40)).collect::<Vec<_>>();
    for (stop, complete) in [(1, 0), (1000, 0), (1601, 1), (4000, 2)] {
        let stopping = StopAfter(AtomicU64::new(0), stop);
        let stopped = render(&scene, &*camera, &*vcm, &settings, &stopping).unwrap();
        assert!(stopped.cancelled);
        let whole =
            shoot(&scene, &*vcm, &RenderSettings { samples: 0..complete.max(1), ..settings.clone() }).film;
        let expected = if complete == 0 { vec![Rgb::BLACK; 1600] } else { splats(&whole) };
        assert!(splats(&stopped.film) == expected, "stopped after {stop}");
        assert!(splats(&whole).iter().any(|light| !light.is_black()));
    }
}

/// Returns NaN for rays towards the upper right.
struct Broken;

impl PixelIntegrator for Broken {
    fn radiance(&self, ray: &Ray, task: &mut Task) -> Rgb {
        let whole = integrator("cast").radiance(ray, task);
        if ray.direction[1] > 0.0 && ray.direction[0] > 0.0 { Rgb::grey(f32::NAN) } else { whole }
    }
}

#[test]
fn bad_samples_are_located_whatever_the_threads() {
    let scene = built(&still_life());
    let of = |threads| shoot(&scene, &Broken, &RenderSettings { threads, ..settings() }).film;
    let failures = of(1).sample_failures();
    assert!(failures.non_finite > 0);
    let SamplePlace { x, y, sample } = failures.first_non_finite.unwrap();
    assert_eq!((x, y), (18, 0));
    assert_eq!(of(5).sample_failures(), failures);
    let place = SamplePlace { x, y, sample };
    let again = replay(&scene, &*scene.cameras()[0].1, &Broken, &settings(), place).unwrap();
    assert!(again.radiance.r.is_nan());
}

#[test]
fn a_replay_reproduces_the_sample_and_records_its_events() {
    let scene = built(&still_life());
    let camera = &*scene.cameras()[0].1;
    for row in INTEGRATORS {
        let integrator = integrator(row.entry.name);
        let (x, y, sample) = (26, 12, 3);
        let crop = Some(Window { x, y, width: 1, height: 1 });
        let one = RenderSettings { samples: sample..sample + 1, crop, ..settings() };
        let film = shoot(&scene, &*integrator, &one).film;
        let story = replay(&scene, camera, &*integrator, &settings(), SamplePlace { x, y, sample }).unwrap();
        let difference = (film.sampled(x, y) - story.radiance).max_channel().abs();
        assert!(difference < 1e-6, "{}: {difference}", row.entry.name);
        assert!(!story.events.is_empty(), "{}", row.entry.name);
        assert!(story.to_string().contains("pixel 26,12 sample 3"));
    }
}

#[test]
fn the_vertices_of_a_replayed_path_bring_the_light_of_its_sample() {
    let scene = built(&still_life());
    let (camera, integrator) = (&*scene.cameras()[0].1, integrator("path"));
    let mut bright = 0;
    for place in (0..40).map(|i| SamplePlace { x: i % 37, y: 3 + i % 16, sample: i }) {
        let story = replay(&scene, camera, &*integrator, &settings(), place).unwrap();
        let vertices = story.events.iter().filter_map(|event| event.vertex);
        let brought: Rgb = vertices.map(|vertex| vertex.light).sum();
        let difference = (brought - story.radiance).to_array().map(f32::abs).into_iter().fold(0.0, f32::max);
        assert!(difference <= 1e-5 * story.radiance.max_channel(), "{story}");
        bright += u32::from(!story.radiance.is_black());
    }
    assert!(bright > 10, "{bright}");
}

/// Each contribution is named by its technique: the light in the sample's own pixel is their sum, as [Veach 1997, eq. 10.3]
/// adds it up.
#[test]
fn replays_of_bidirectional_integrators_name_each_contribution() {
    let scene = built(&still_life());
    let camera = &*scene.cameras()[0].1;
    for name in ["bdpt", "vcm"] {
        // Within the default radius there is no photon in so few samples.
        let spec = Spec::new("", name);
        let spec = if name == "vcm" { spec.with("radius", 0.2f32) } else { spec };
        let integrator = integrators::build(&spec).unwrap();
        let mut kinds = std::collections::BTreeSet::new();
        for place in (0..30).map(|i| SamplePlace { x: i % 37, y: 3 + i % 16, sample: i }) {
            let story = replay(&scene, camera, &*integrator, &settings(), place).unwrap();
            let own = story.contributions.iter().filter(|found| found.film.is_none());
            let sum: Rgb = own.map(|found| found.light).sum();
            assert!((sum - story.radiance).max_channel().abs() <= 1e-5 * story.radiance.max_channel());
            for found in &story.contributions {
                assert!((0.0..=1.0).contains(&found.weight), "{name}: {found}");
                assert_eq!(found.film.is_some(), found.t == 1 && !found.is_merged, "{name}: {found}");
                assert!(story.to_string().contains(&format!("s = {}, t = {}", found.s, found.t)));
                kinds.insert((found.s.min(2), found.t.min(2), found.is_merged));
            }
        }
        // A point on a light (s = 1), a light that is hit (s = 0), two vertices, and for `vcm` merged ones.
        let wanted = [(0, 2, false), (1, 2, false), (2, 2, false), (2, 2, name == "vcm")];
        assert!(wanted.iter().all(|kind| kinds.contains(kind)), "{name}: {kinds:?}");
    }
}

/// A floor under a sun, seen straight from above: a camera subpath reaches a point with the density of one over the film's area
/// there, a light subpath with that of one over the disc of the scene's bounding sphere. The weights are these densities over
/// their sum. [Veach 1997, eq. 9.8]
#[test]
fn replayed_weights_are_those_of_the_balance_heuristic() {
    const HALF: f32 = 1.5;
    const HEIGHT: f32 = 2.0;
    const IRRADIANCE: f32 = 2.0;
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, HALF), diffuse(0.5f32));
    let sun = Spec::new("", "directional").with("direction", -Vec3::Y);
    builder.lights.push(sun.with("irradiance", IRRADIANCE));
    let camera = Spec::new("", "orthographic").with("position", Vec3::Y * 3.0).with("look_at", Vec3::ZERO);
    builder.cameras.push(CameraSpec::new(camera.with("up", -Vec3::Z).with("height", HEIGHT)));
    let scene = built(&builder);
    let densities = [1.0 / (HEIGHT * HEIGHT), 1.0 / (PI * 2.0 * HALF * HALF)];
    let [by_camera, by_sun] = densities.map(|density| density / (densities[0] + densities[1]));
    let settings = RenderSettings { max_depth: 1, ..settings() };
    let mut counts = [0; 2];
    for place in (0..400).map(|i| SamplePlace { x: i % 37, y: i % 21, sample: i % 5 }) {
        let story = replay(&scene, &*scene.cameras()[0].1, &*integrator("bdpt"), &settings, place).unwrap();
        for found in &story.contributions {
            let (which, weight) = match (found.s, found.t) {
                (1, 2) => (0, by_camera),
                (2, 1) => (1, by_sun),
                other => panic!("{other:?} finds nothing here"),
            };
            counts[which] += 1;
            assert!((found.weight / weight - 1.0).abs() < 1e-5, "{found}, not {weight}");
            if which == 0 {
                let light = weight * 0.5 * IRRADIANCE / PI;
                assert!((found.light.g / light - 1.0).abs() < 1e-5, "{found}, not {light}");
            }
        }
    }
    // The disc around the scene sends so many onto the film, within three standard deviations.
    let expected = 400.0 * HEIGHT * HEIGHT / (PI * 2.0 * HALF * HALF);
    let spread = 3.0 * expected.sqrt();
    assert!(counts[0] == 400 && (counts[1] as f32 - expected).abs() < spread, "{counts:?}, not {expected}");
}

#[test]
fn senseless_settings_are_refused() {
    let scene = built(&still_life());
    let refused = |settings: RenderSettings| {
        let camera = &*scene.cameras()[0].1;
        let error = render(&scene, camera, &*integrator("cast"), &settings, &Silent).unwrap_err();
        assert!(!error.to_string().is_empty());
        error
    };
    assert!(matches!(refused(RenderSettings::new(0, 4, 1)), RenderError::Film(_)));
    assert!(matches!(refused(RenderSettings::new(4, u32::MAX, 1)), RenderError::Film(_)));
    assert!(matches!(refused(RenderSettings::new(4, 4, 0)), RenderError::Samples { .. }));
    assert!(matches!(refused(RenderSettings::new(4, 4, u32::MAX)), RenderError::Samples { .. }));
    let backwards = RenderSettings { samples: std::ops::Range { start: 3, end: 2 }, ..settings() };
    assert!(matches!(refused(backwards), RenderError::Samples { .. }));
    let outside = RenderSettings { crop: Some(Window { x: 30, y: 0, width: 8, height: 1 }), ..settings() };
    assert!(matches!(refused(outside), RenderError::Film(_)));
    assert!(matches!(refused(RenderSettings { max_depth: 5000, ..settings() }), RenderError::Depth { .. }));
}

#[test]
fn pixels_may_be_anchored_at_their_corner() {
    let scene = built(&still_life());
    let at = |anchor, place: SamplePlace| {
        let settings = RenderSettings { pixel_anchor: anchor, ..settings() };
        replay(&scene, &*scene.cameras()[0].1, &*integrator("cast"), &settings, place).unwrap().ray
    };
    let middle = at(PixelAnchor::Centre, SamplePlace { x: 18, y: 10, sample: 0 });
    let forward = scene.cameras()[0].1.forward(0.0);
    assert!(Vec3::from(middle.direction).distance(forward) < 1e-6);
    let corner = at(PixelAnchor::Corner, SamplePlace { x: 0, y: 0, sample: 0 });
    let edge =
        bilux_scene::CameraSample { film: bilux_math::Vec2::ZERO, lens: bilux_math::Vec2::ZERO, time: 0.0 };
    assert_eq!(corner, scene.cameras()[0].1.ray(&edge));
}
