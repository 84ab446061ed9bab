//! Pictures whose time ends within their first pass: samples that are spread evenly, light subpaths that stand for all, and a completion
//! from surfaces.

use crate::common::{built, effort, integrator, mixed, shoot, without_mirrors};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Scene, Spec};
use bilux_transport::{
    Completion, Features, Film, Observer, PixelIntegrator, Progress, RenderSettings, Silent, Standing, Stop,
    Window, features, integrators, render, render_from,
};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// No time at all: only what is taken whatever time it is.
fn hurried(width: u32, height: u32) -> RenderSettings {
    let stop = Stop { noise: None, time_limit: Some(Duration::from_nanos(1)) };
    RenderSettings { stop, threads: 2, ..RenderSettings::new(width, height, 1000) }
}

#[test]
fn the_samples_that_there_are_lie_on_a_lattice() {
    let scene = built(&mixed());
    for name in ["path", "bdpt", "vcm", "sppm", "whitted"] {
        let integrator = integrator(name);
        let (width, height) = (43, 29);
        let cut = shoot(&scene, &*integrator, &hurried(width, height));
        let whole = shoot(&scene, &*integrator, &RenderSettings::new(width, height, 1));
        assert!(cut.cut_short && !cut.cancelled, "{name}");
        assert_eq!((cut.spacing, cut.reached.unwrap().spp), (Some(8), 1), "{name}");
        assert!(cut.film.coverage().pieces().is_empty(), "{name}: no window has all of its samples");
        for (x, y) in (0..width * height).map(|i| (i % width, i / width)) {
            let is_on_lattice = x % 8 == 0 && y % 8 == 0;
            assert_eq!(cut.film.samples(x, y), u32::from(is_on_lattice), "{name}: {x},{y}");
            // Other pixels have no part in these.
            if name == "path" && is_on_lattice {
                assert_eq!(cut.film.pixel(x, y), whole.film.pixel(x, y), "{x},{y}");
            }
        }
        let mut part = cut.film.clone();
        part.keep_covered();
        assert!(part.counts().iter().all(|count| *count == 0), "{name}: a part has what it states");
    }
}

#[test]
fn a_film_of_one_pixel_has_its_sample_at_once() {
    let only = shoot(&built(&mixed()), &*integrator("path"), &hurried(1, 1));
    assert!(!only.cut_short && only.spacing.is_none() && only.film.samples(0, 0) == 1);
}

/// With enough time a picture is that of as many samples without a limit, to the bit.
#[test]
fn spread_samples_are_those_of_any_other_order() {
    let scene = built(&mixed());
    for name in ["path", "bdpt", "vcm"] {
        let stop = Stop { noise: None, time_limit: Some(Duration::from_secs(1000)) };
        let settings = RenderSettings { threads: 2, ..RenderSettings::new(43, 29, 3) };
        let whole = shoot(&scene, &*integrator(name), &settings);
        let limited = shoot(&scene, &*integrator(name), &RenderSettings { stop, ..settings });
        assert!(limited.film == whole.film && !limited.cut_short && limited.spacing.is_none(), "{name}");
    }
}

/// The mean of the pixels of a lattice, and of all splats, over pictures with other seeds, each with its standard error.
fn mean_light(
    scene: &Scene,
    integrator: &dyn PixelIntegrator,
    settings: &RenderSettings,
    pictures: u32,
) -> [[f64; 2]; 2] {
    let of_picture = |seed: u32| {
        let settings = RenderSettings { seed: u64::from(seed), ..settings.clone() };
        let film = shoot(scene, integrator, &settings).film;
        let places = (0..film.width() * film.height()).map(|i| (i % film.width(), i / film.width()));
        let on_lattice = places.clone().filter(|(x, y)| x % 8 == 0 && y % 8 == 0);
        let own = on_lattice.clone().map(|(x, y)| f64::from(film.sampled(x, y).luminance())).sum::<f64>();
        let splats = places.clone().map(|(x, y)| f64::from(film.splatted(x, y).luminance())).sum::<f64>();
        [own / on_lattice.count() as f64, splats / places.count() as f64]
    };
    let all: Vec<[f64; 2]> = (0..pictures).map(of_picture).collect();
    [0, 1].map(|part| {
        let mean = all.iter().map(|light| light[part]).sum::<f64>() / f64::from(pictures);
        let squares = all.iter().map(|light| (light[part] - mean) * (light[part] - mean)).sum::<f64>();
        [mean, (squares / f64::from(pictures * (pictures - 1))).sqrt()]
    })
}

/// Of light subpaths that are traced beside camera subpaths a sixty-fourth has arrived, of those that leave photons the first of twelve tiles.
/// Without scaling their light would be a small part of what it is.
#[test]
fn light_subpaths_so_far_stand_for_all() {
    let lamp = Spec::new("", "rect").with("position", Vec3::new(-1.0, 3.0, 1.0)).with("intensity", 9.0f32);
    let lamp = lamp.with("edge_u", Vec3::X * 2.0).with("edge_v", Vec3::Z * 1.0);
    let scene = built(&without_mirrors(lamp));
    let of_kind = |kind: &str| Spec::new("", kind);
    // What is aimed shares the light among techniques otherwise, and in a hurry nothing is.
    let photons = of_kind("auto").with("techniques", "path-light-photons").with("aim", false);
    let sppm = of_kind("sppm").with("radius", 0.1f32);
    for (spec, has_splats) in [
        (of_kind("light"), true),
        (of_kind("bdpt"), true),
        (of_kind("vcm"), true),
        (sppm, false),
        (photons, true),
    ] {
        let integrator = integrators::build(&spec).unwrap();
        let cut = mean_light(&scene, &*integrator, &hurried(64, 48), effort(400, 4000));
        let whole = mean_light(&scene, &*integrator, &RenderSettings::new(64, 48, 1), 64);
        for ([cut, error], [whole, of_whole]) in cut.into_iter().zip(whole) {
            let bound = 4.0 * (error * error + of_whole * of_whole).sqrt();
            assert!((cut - whole).abs() <= bound, "{}: {cut} ± {error}, not {whole} ± {of_whole}", spec.kind);
            assert!(error <= 0.15 * whole, "{}: {cut} ± {error} tells nothing", spec.kind);
        }
        assert_eq!(whole[1][0] > 0.0, has_splats, "{}", spec.kind);
    }
}

/// Two walls with a fine pattern under different light, and an edge between lattice points.
#[test]
fn a_picture_is_completed_along_its_surfaces() {
    let (width, height) = (48u32, 24u32);
    let window = Window::whole(width, height);
    let is_left = |x: u32| x < 22;
    let albedo = |x: u32, y: u32| {
        let bright = if (x / 2 + y / 3).is_multiple_of(2) { 1.0 } else { 0.4 };
        if is_left(x) { Rgb::new(0.8, 0.5, 0.3) * bright } else { Rgb::new(0.2, 0.3, 0.9) * bright }
    };
    let light = |x: u32, y: u32| albedo(x, y) * if is_left(x) { 2.0 + 0.02 * y as f32 } else { 6.0 };
    let mut film = Film::new(width, height, 24).unwrap();
    let places = || (0..window.pixels()).map(|i| window.position(i));
    for (x, y) in places().filter(|(x, y)| x % 4 == 0 && y % 4 == 0) {
        film.add(x, y, 0, light(x, y));
    }
    let features = Features {
        window,
        albedo: places().map(|(x, y)| albedo(x, y)).collect(),
        mean_normal: places().map(|(x, _)| if is_left(x) { Vec3::X } else { Vec3::Z }).collect(),
        mean_depth: places().map(|(x, _)| if is_left(x) { 3.0 } else { 7.0 }).collect(),
        haze: Vec::new(),
        coverage: vec![1.0; window.pixels()],
    };
    let worst = |features: Option<&Features>| {
        let completion = Completion::new(&film, 4, features);
        assert_eq!(completion.size, [12, 6]);
        let all = completion.completed(&completion.light).unwrap();
        let apart = places().zip(all).map(|((x, y), found)| {
            let apart = (found - light(x, y)) / light(x, y);
            apart.to_array().into_iter().fold(0.0, |worst: f32, c| worst.max(c.abs()))
        });
        apart.fold(0.0, f32::max)
    };
    assert!(worst(Some(&features)) < 0.06, "{}", worst(Some(&features)));
    assert!(worst(None) > 0.5, "{}", worst(None));
}

/// Seven in eight of the pixels between those of the lattice have a sample: they are seen one by one, and the others as their surface is.
#[test]
fn a_picture_that_is_nearly_done_keeps_its_pixels() {
    let (width, height) = (24u32, 16u32);
    let window = Window::whole(width, height);
    let light = |x: u32, y: u32| Rgb::grey(if (x + y).is_multiple_of(2) { 1.0 } else { 0.25 });
    let mut film = Film::new(width, height, 24).unwrap();
    let places = || (0..window.pixels()).map(|i| window.position(i));
    let is_missing = |x: u32, y: u32| (x % 2 == 1 || y % 2 == 1) && (x + 3 * y).is_multiple_of(8);
    for (x, y) in places().filter(|(x, y)| !is_missing(*x, *y)) {
        film.add(x, y, 0, light(x, y));
    }
    let completion = Completion::new(&film, 2, None);
    assert_eq!(completion.size, [width, height]);
    let all = completion.completed(&completion.light).unwrap();
    for ((x, y), found) in places().zip(all) {
        let is_right = if is_missing(x, y) { (0.25..=1.0).contains(&found.g) } else { found == light(x, y) };
        assert!(is_right, "{x},{y}: {found:?}");
    }
}

/// A point whose samples are all bad, and one that has more samples than that of the lattice.
#[test]
fn a_completion_averages_what_is_there() {
    let mut film = Film::new(9, 5, 24).unwrap();
    for (x, y, light) in
        [(0, 0, 1.0), (1, 1, 3.0), (4, 0, f32::NAN), (8, 0, 5.0), (0, 4, 2.0), (4, 4, 2.0), (8, 4, 2.0)]
    {
        film.add(x, y, 0, Rgb::grey(light));
    }
    let completion = Completion::new(&film, 4, None);
    assert_eq!(completion.size, [3, 2]);
    let greens: Vec<f32> = completion.light.iter().map(|light| light.g).collect();
    assert!(greens[1].is_nan());
    assert_eq!([greens[0], greens[2], greens[3], greens[4], greens[5]], [2.0, 5.0, 2.0, 2.0, 2.0]);
    assert!(completion.completed(&completion.light).unwrap().iter().all(|light| light.is_finite()));
    assert_eq!(completion.means(&[1.0; 45]), [1.0; 6]);
}

#[test]
fn features_of_pixels_that_time_left_are_those_beside_them() {
    let scene = built(&mixed());
    let camera = &*scene.cameras()[0].1;
    let of = |time, spp| {
        let settings = RenderSettings::new(37, 26, spp);
        features(&scene, camera, &*integrator("whitted"), &settings, time, &Silent).unwrap().unwrap()
    };
    let (whole, cut) = (of(None, 1), of(Some(Duration::ZERO), 1));
    for (x, y) in (0..37 * 26).map(|i| (i % 37, i / 37)) {
        let beside = y / 8 * 8 * 37 + x / 8 * 8;
        assert_eq!(cut.albedo[y * 37 + x], whole.albedo[beside], "{x},{y}");
        assert_eq!(cut.mean_depth[y * 37 + x].to_bits(), whole.mean_depth[beside].to_bits(), "{x},{y}");
    }
    assert!(of(Some(Duration::from_secs(1000)), 1) == whole);
}

/// Takes long for each tile after the first ones.
struct Slows(AtomicU32);

impl Progress for Slows {
    fn advance(&self, _samples: u64, _rays: u64) {
        if self.0.fetch_add(1, Ordering::Relaxed) > 60 {
            std::thread::sleep(Duration::from_millis(300));
        }
    }

    fn is_cancelled(&self) -> bool {
        false
    }
}

/// A pass that is expected to fit into the time, and then does not.
#[test]
fn time_ends_a_later_pass_too() {
    let scene = built(&mixed());
    let stop = Stop { noise: None, time_limit: Some(Duration::from_secs(2)) };
    for name in ["path", "bdpt"] {
        let settings =
            RenderSettings { stop, threads: 2, batch_means: true, ..RenderSettings::new(64, 64, 9000) };
        let (camera, slows) = (&*scene.cameras()[0].1, Slows(AtomicU32::new(0)));
        let begun = Instant::now();
        let cut = render(&scene, camera, &*integrator(name), &settings, &slows).unwrap();
        assert!(begun.elapsed() < Duration::from_secs(8), "{name}: {:?}", begun.elapsed());
        assert!(cut.cut_short && !cut.cancelled && cut.spacing.is_none(), "{name}");
        let (spp, counts) = (cut.reached.unwrap().spp, cut.film.counts());
        let [least, most] = [counts.iter().min(), counts.iter().max()].map(|count| *count.unwrap());
        assert!(least == spp && most > spp, "{name}: {least} to {most} samples, {spp} of each");
        // The coverage states what the pixels have.
        let stated = |(x, y): (u32, u32)| {
            let pieces = cut.film.coverage().pieces().iter();
            let there = pieces.filter(|(window, _)| window.index(x, y).is_some());
            there.map(|(_, samples)| samples.len() as u32).sum::<u32>()
        };
        let place = |i: usize| cut.film.window().position(i);
        assert!((0..counts.len()).all(|i| stated(place(i)) == counts[i]), "{name}");
        // Those samples are the first ones of a picture that takes as many.
        let whole = RenderSettings { stop: Stop::default(), spp, samples: 0..spp, ..settings };
        let whole = shoot(&scene, &*integrator(name), &whole);
        let (x, y) = place(counts.iter().position(|count| *count == spp).unwrap());
        assert_eq!(cut.film.sampled(x, y), whole.film.sampled(x, y), "{name}");
    }
}

/// Wants a checkpoint until there is one.
#[derive(Default)]
struct Keeper(AtomicBool);

impl Observer for Keeper {
    fn wants_checkpoint(&self) -> bool {
        !self.0.load(Ordering::Relaxed)
    }

    fn keep(&self, _standing: &Standing) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// A render that went on from such a picture would choose with all of a pilot's samples, perhaps otherwise.
#[test]
fn a_choice_in_a_hurry_keeps_no_checkpoint() {
    let scene = built(&mixed());
    let (camera, auto, keeper) = (&*scene.cameras()[0].1, integrator("auto"), Keeper::default());
    let hurried = render_from(None, &scene, camera, &*auto, &hurried(40, 32), &Silent, &keeper).unwrap();
    assert!(hurried.cut_short && hurried.choice.is_some() && !keeper.0.load(Ordering::Relaxed));
    // With enough time the choice is that without a limit.
    let stop = Stop { noise: None, time_limit: Some(Duration::from_secs(1000)) };
    let settings = RenderSettings::new(40, 32, 1);
    let unlimited = shoot(&scene, &*auto, &settings);
    assert_eq!(shoot(&scene, &*auto, &RenderSettings { stop, ..settings }).choice, unlimited.choice);
    // One sample in eight estimates the same, but for noise.
    for (a, b) in hurried.choice.unwrap().candidates.iter().zip(unlimited.choice.unwrap().candidates) {
        let (cost, error) = (a.nanoseconds / b.nanoseconds, a.error / b.error);
        assert!((0.8..1.25).contains(&cost) && (0.2..5.0).contains(&error), "{}: {cost}, {error}", a.name);
        assert!((a.lost - b.lost).abs() < 0.05, "{}: {} and {}", a.name, a.lost, b.lost);
    }
}
