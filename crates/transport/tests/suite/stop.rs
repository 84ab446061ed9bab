//! Pictures that end when they are good enough.

use crate::common::{built, integrator, mixed, shoot};
use bilux_transport::{RenderError, RenderSettings, Silent, Stop, Window, render};
use std::time::Duration;

fn until(noise: f32) -> RenderSettings {
    let stop = Stop { noise: Some(noise), time_limit: None };
    RenderSettings { stop, threads: 2, ..RenderSettings::new(48, 40, 4096) }
}

#[test]
fn the_stated_noise_is_the_measured_noise() {
    let scene = built(&mixed());
    let truth = shoot(
        &scene,
        &*integrator("path"),
        &RenderSettings { seed: 99, ..RenderSettings::new(48, 40, 1024) },
    );
    let truth: Vec<f64> = truth.film.to_rgb().iter().map(|pixel| f64::from(pixel.luminance())).collect();
    let dark = 0.3 * truth.iter().sum::<f64>() / truth.len() as f64;
    for name in ["path", "bdpt"] {
        let rendered = shoot(&scene, &*integrator(name), &until(0.1));
        let reached = rendered.reached.unwrap();
        assert!(reached.spp < 200 && reached.noise.unwrap() <= 0.1, "{name}: {reached:?}");
        let pixels = rendered.film.to_rgb();
        let of_block = |tile: &Window| {
            let (mut light, mut squares) = (0.0, 0.0);
            for (x, y) in (0..tile.pixels()).map(|i| tile.position(i)) {
                let i = (y * 48 + x) as usize;
                light += truth[i];
                let apart = f64::from(pixels[i].luminance()) - truth[i];
                squares += apart * apart;
            }
            let n = tile.pixels() as f64;
            (squares / n / (light / n * light / n + dark * dark)).sqrt()
        };
        let tiles = Window::whole(48, 40).tiles(8);
        let there = tiles.iter().map(of_block).sum::<f64>() / tiles.len() as f64;
        let ratio = f64::from(reached.noise.unwrap()) / there;
        assert!((0.85..1.2).contains(&ratio), "{name}: {reached:?}, but {there}");
    }
}

#[test]
fn an_early_stop_keeps_the_first_samples() {
    let scene = built(&mixed());
    for name in ["path", "vcm"] {
        let ended = shoot(&scene, &*integrator(name), &until(0.2));
        let spp = ended.reached.unwrap().spp;
        let plain = shoot(
            &scene,
            &*integrator(name),
            &RenderSettings { stop: Stop::default(), spp, samples: 0..spp, ..until(0.2) },
        );
        assert!(ended.film == plain.film, "{name}");
        let alone = shoot(&scene, &*integrator(name), &RenderSettings { threads: 1, ..until(0.2) });
        assert!(ended.film == alone.film && ended.reached == alone.reached, "{name}");
    }
}

#[test]
fn there_is_one_sample_however_short_the_time() {
    let stop = Stop { noise: None, time_limit: Some(Duration::from_nanos(1)) };
    let settings = RenderSettings { stop, ..RenderSettings::new(16, 16, 1000) };
    let ended = shoot(&built(&mixed()), &*integrator("path"), &settings);
    assert_eq!(ended.reached.unwrap().spp, 1);
    assert!(!ended.cancelled);
}

#[test]
fn a_part_cannot_know_when_the_whole_is_done() {
    let scene = built(&mixed());
    let crop = RenderSettings { crop: Some(Window { x: 1, y: 1, width: 2, height: 2 }), ..until(0.1) };
    for settings in [crop, RenderSettings { samples: 3..9, ..until(0.1) }] {
        let refused = render(&scene, &*scene.cameras()[0].1, &*integrator("path"), &settings, &Silent);
        assert!(matches!(refused, Err(RenderError::StopOfPart)));
    }
}
