//! `auto`: what its first look foresees is what comes, and it chooses what it should.

mod common;

use bilux_math::Vec3;
use bilux_scene::{Scene, SceneBuilder, Spec};
use bilux_transport::{Choice, PixelIntegrator, RenderSettings, integrators};
use common::statistics::{agreement, blocks};
use common::{
    ball, built, diffuse, floor, integrator, look, mixed, put, shoot, sky, still_life, without_mirrors,
};

fn auto() -> Spec {
    Spec::new("", "auto")
}

fn choice(scene: &Scene, spec: &Spec, settings: &RenderSettings) -> Choice {
    shoot(scene, &*integrators::build(spec).unwrap(), settings).choice.unwrap()
}

/// Under a panel.
fn corner() -> SceneBuilder {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0));
    without_mirrors(panel.with("intensity", 10.0f32))
}

/// The same ways as the sets that `auto` compares, in their order.
fn sets() -> Vec<Box<dyn PixelIntegrator>> {
    let sets = [(false, false, 0.0), (true, false, 0.0), (true, true, 0.0)];
    let merged = [(false, false, RADIUS), (true, false, RADIUS), (true, true, RADIUS)];
    let built = |&(splats, joins, radius): &(bool, bool, f32)| {
        let spec = Spec::new("", "vcm").with("splats", splats).with("joins", joins);
        integrators::build(&spec.with("radius", radius).with("alpha", 1.0f32)).unwrap()
    };
    sets.iter().chain(&merged).map(built).collect()
}

const RADIUS: f32 = 0.012;

/// With as many samples as a turn of a pilot, so that as much is gained by their being spread evenly.
fn film(seed: u64) -> RenderSettings {
    RenderSettings { seed, max_depth: 6, ..RenderSettings::new(16, 16, 8) }
}

/// The relative variance of a pixel, times its samples, as [`Choice`] has it.
fn measured(scene: &Scene, integrator: &dyn PixelIntegrator) -> f64 {
    const PICTURES: u64 = 60;
    let (mut sums, mut squares) = (vec![0.0; 256], vec![0.0; 256]);
    for seed in 0..PICTURES {
        for (i, pixel) in shoot(scene, integrator, &film(seed)).film.to_rgb().into_iter().enumerate() {
            let light = f64::from(pixel.luminance());
            sums[i] += light / PICTURES as f64;
            squares[i] += light * light / PICTURES as f64;
        }
    }
    let dark = 0.3 * sums.iter().sum::<f64>() / 256.0;
    let of_block = |block: usize| {
        let pixels: Vec<usize> = (0..256).filter(|i| i / 16 / 4 * 4 + i % 16 / 4 == block).collect();
        let mean = pixels.iter().map(|&i| sums[i]).sum::<f64>() / 16.0;
        let variance = pixels.iter().map(|&i| squares[i] - sums[i] * sums[i]).sum::<f64>() / 16.0;
        variance * 8.0 * PICTURES as f64 / (PICTURES - 1) as f64 / (mean * mean + dark * dark)
    };
    (0..16).map(of_block).sum::<f64>() / 16.0
}

#[test]
fn the_noise_of_every_set_is_foreseen() {
    let scene = built(&corner());
    let spec = auto().with("radius", RADIUS).with("alpha", 1.0f32);
    let mut foreseen = vec![0.0; 6];
    for seed in 0..60 {
        for (sum, rival) in foreseen.iter_mut().zip(choice(&scene, &spec, &film(seed)).rivals) {
            *sum += rival.error / 60.0;
        }
    }
    for (i, (set, foreseen)) in sets().iter().zip(foreseen).enumerate() {
        let measured = measured(&scene, &**set);
        let ratio = foreseen / measured;
        assert!((0.8..1.25).contains(&ratio), "set {i}: foreseen {foreseen}, measured {measured}");
    }
}

#[test]
fn without_merging_it_has_the_same_mean_as_path() {
    let mut builder = still_life();
    builder.lights.retain(|light| light.kind != "spot");
    let scene = built(&builder);
    let auto = integrators::build(&auto().with("merge", "never")).unwrap();
    let p = agreement(&blocks(&scene, &*integrator("path"), 0), &blocks(&scene, &*auto, 100));
    assert!(p > 1e-4, "p = {p}");
}

#[test]
fn open_daylight_is_left_to_path() {
    let mut builder = corner();
    builder.objects.remove(1);
    builder.lights.clear();
    sky(&mut builder, 1.0);
    let choice = choice(&built(&builder), &auto(), &RenderSettings::new(128, 128, 1));
    assert_eq!(choice.best().name, "path", "{choice}");
    let film = |name: &str| shoot(&built(&builder), &*integrator(name), &film(3)).film;
    assert_eq!(film("auto"), film("path"), "then it is path, to the bit");
}

#[test]
fn a_caustic_is_worth_light_paths() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.7f32));
    let globe = ball(Vec3::new(0.0, 1.7, 0.0), 1.0, 24, true);
    put(&mut builder, "glass", globe, Spec::new("", "dielectric"));
    let lamp = Spec::new("", "rect").with("position", Vec3::new(0.5, 6.0, 0.5)).with("intensity", 40.0f32);
    builder.lights.push(lamp.with("edge_u", Vec3::X * 0.2).with("edge_v", Vec3::Z * 0.2));
    look(&mut builder, Vec3::new(0.0, 3.0, 5.0), Vec3::ZERO, 40.0);
    let scene = built(&builder);
    let choice = choice(&scene, &auto(), &RenderSettings::new(128, 128, 1));
    let path = &choice.rivals[0];
    assert!(path.time_to_error() > 5.0 * choice.best().time_to_error(), "{choice}");
}

#[test]
fn light_that_path_cannot_find_is_not_lost() {
    let mut builder = mixed();
    builder.lights.retain(|light| light.kind == "point");
    let scene = built(&builder);
    let settings = RenderSettings::new(192, 192, 1);
    let chosen = choice(&scene, &auto().with("merge", "never"), &settings);
    assert!(chosen.rivals[0].lost > 0.01 && chosen.best().name != "path", "{chosen}");
    // What the mirror makes of the lamp, seen in the mirror, only photons find.
    assert!(chosen.rivals[2].lost > 1e-3 && chosen.rivals[5].lost < 1e-6, "{chosen}");
    assert!(choice(&scene, &auto(), &settings).best().name.contains("photons"), "{chosen}");
}

#[test]
fn the_choice_is_that_of_the_whole_film() {
    let scene = built(&still_life());
    let whole = RenderSettings { threads: 1, ..RenderSettings::new(40, 30, 8) };
    let of = |settings: &RenderSettings| choice(&scene, &auto(), settings);
    let wanted = of(&whole);
    let crop = Some(bilux_transport::Window { x: 3, y: 4, width: 2, height: 5 });
    for other in [
        RenderSettings { threads: 3, ..whole.clone() },
        RenderSettings { samples: 4..6, ..whole.clone() },
        RenderSettings { spp: 99, ..whole.clone() },
        RenderSettings { crop, ..whole.clone() },
    ] {
        assert_eq!(of(&other), wanted, "{other:?}");
    }
}
