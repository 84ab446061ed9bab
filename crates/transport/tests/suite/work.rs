//! The work of each pixel is a function of scene, settings and seed, as the picture is; what the accelerator does for it
//! depends on the accelerator alone.

use crate::common::{built, integrator, mixed, shoot, still_life};
use bilux_scene::{AccelChoice, Scene};
use bilux_transport::{INTEGRATORS, RenderSettings, SamplePlace, Silent, Window, Work, replay, work};

fn counted(scene: &Scene, name: &str, settings: &RenderSettings, with_accel: bool) -> Work {
    let camera = &*scene.cameras()[0].1;
    work(scene, camera, &*integrator(name), settings, with_accel, &Silent).unwrap().unwrap()
}

fn settings() -> RenderSettings {
    RenderSettings { threads: 2, seed: 7, ..RenderSettings::new(29, 17, 3) }
}

#[test]
fn threads_and_crops_change_nothing() {
    let scene = built(&still_life());
    for row in INTEGRATORS {
        let name = row.entry.name;
        let one = counted(&scene, name, &RenderSettings { threads: 1, ..settings() }, true);
        let many = counted(&scene, name, &RenderSettings { threads: 5, ..settings() }, true);
        assert_eq!(one, many, "{name}");
        let crop = Window { x: 9, y: 4, width: 12, height: 7 };
        let part = counted(&scene, name, &RenderSettings { crop: Some(crop), ..settings() }, true);
        for i in 0..crop.pixels() {
            let (x, y) = crop.position(i);
            let at = one.window.index(x, y).unwrap();
            assert_eq!(part.rays[i], one.rays[at], "{name}: rays at {x},{y}");
            assert_eq!(part.path_length[i], one.path_length[at], "{name}: vertices at {x},{y}");
            assert_eq!((part.nodes[i], part.tests[i]), (one.nodes[at], one.tests[at]), "{name}: {x},{y}");
        }
    }
}

#[test]
fn only_nodes_and_tests_depend_on_the_accelerator() {
    let of = |name: &str| {
        let accel = AccelChoice { name: name.to_owned(), ..AccelChoice::default() };
        let scene = mixed().build(&accel, [0.0, 0.0], 1.0).unwrap();
        [false, true].map(|with_accel| counted(&scene, "path", &settings(), with_accel))
    };
    let [truth, brute] = of("brute");
    assert_eq!((&brute.rays, &brute.path_length), (&truth.rays, &truth.path_length));
    for row in bilux_accel::ACCELERATORS {
        let [plain, counting] = of(row.entry.name);
        assert_eq!(plain.rays, truth.rays, "{}", row.entry.name);
        assert_eq!(plain.path_length, truth.path_length, "{}", row.entry.name);
        assert_eq!(counting.rays, truth.rays, "{}: counting nodes changes no ray", row.entry.name);
        assert!(plain.nodes.iter().chain(&plain.tests).all(|&count| count == 0.0));
        let sum = |plane: &[f32]| plane.iter().sum::<f32>();
        if !row.entry.name.starts_with("brute") {
            assert!(sum(&counting.nodes) > 0.0, "{}", row.entry.name);
            assert!(sum(&counting.tests) < sum(&brute.tests), "{}", row.entry.name);
        }
    }
}

#[test]
fn it_is_the_work_of_the_render() {
    let scene = built(&mixed());
    for row in INTEGRATORS.iter().filter(|row| !["sppm", "vcm", "auto"].contains(&row.entry.name)) {
        let rendered = shoot(&scene, &*integrator(row.entry.name), &settings());
        let work = counted(&scene, row.entry.name, &settings(), false);
        let rays: f64 = work.rays.iter().map(|&mean| f64::from(mean) * 3.0).sum();
        assert_eq!(rays.round() as u64, rendered.counters.rays, "{}", row.entry.name);
    }
}

#[test]
fn it_is_what_replays_say() {
    let scene = built(&mixed());
    let camera = &*scene.cameras()[0].1;
    let settings = RenderSettings { spp: 1, samples: 0..1, ..settings() };
    for row in INTEGRATORS {
        let work = counted(&scene, row.entry.name, &settings, false);
        for (x, y) in [(3, 5), (14, 8), (20, 12)] {
            let at = work.window.index(x, y).unwrap();
            let place = SamplePlace { x, y, sample: 0 };
            let story = replay(&scene, camera, &*integrator(row.entry.name), &settings, place).unwrap();
            assert_eq!(work.rays[at], story.rays as f32, "{} at {x},{y}", row.entry.name);
        }
    }
}

#[test]
fn longer_paths_are_longer() {
    let scene = built(&still_life());
    let mean = |max_depth| {
        let work = counted(&scene, "path", &RenderSettings { max_depth, ..settings() }, false);
        work.path_length.iter().sum::<f32>() / work.path_length.len() as f32
    };
    // Without scattering, a path reaches one surface where there is one.
    assert!(mean(0) <= 1.0 && mean(0) > 0.0);
    assert!(mean(1) > mean(0) && mean(6) > mean(1));
}
