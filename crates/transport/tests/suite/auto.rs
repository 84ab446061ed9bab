//! `auto`: its pilot's predictions come true, and it chooses what it should.

use crate::common::statistics::{SUITE, UNLIKELY, agreement, blocks};
use crate::common::{
    ball, built, diffuse, effort, floor, integrator, look, mixed, put, quad, shoot, sky, still_life,
    without_mirrors,
};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Scene, SceneBuilder, Spec};
use bilux_transport::{Choice, PixelIntegrator, RenderSettings, integrators};

fn auto() -> Spec {
    Spec::new("", "auto")
}

fn choice(scene: &Scene, spec: &Spec, settings: &RenderSettings) -> Choice {
    shoot(scene, &*integrators::build(spec).unwrap(), settings).choice.unwrap()
}

/// Lit by a panel.
fn corner() -> SceneBuilder {
    let panel = Spec::new("", "rect").with("position", Vec3::new(-0.5, 2.5, 0.0));
    without_mirrors(panel.with("intensity", 10.0f32))
}

/// The sets that `auto` compares, in their order.
const SETS: [&str; 8] =
    ["path", "path-light", "bdpt", "path-few", "path-photons", "path-light-few", "path-light-photons", "vcm"];

/// `auto` with a prescribed set, whatever its pilot predicts.
fn reported(techniques: &'static str, aim: bool) -> Box<dyn PixelIntegrator> {
    let spec = auto().with("techniques", techniques).with("radius", RADIUS).with("alpha", 1.0f32);
    integrators::build(&spec.with("aim", aim)).unwrap()
}

const RADIUS: f32 = 0.012;

/// Number of pixels of a film as small as a pilot.
const PIXELS: usize = 128;

/// As many samples as in a round of the pilot, so that their even distribution gains as much.
fn film(seed: u64) -> RenderSettings {
    RenderSettings { seed, max_depth: 6, ..RenderSettings::new(16, 8, 8) }
}

/// The relative variance of a pixel, times its samples, as in [`Choice`]: by the record of this case, where the first of the pictures are
/// as they were.
fn measured(case: &str, scene: &Scene, integrator: &dyn PixelIntegrator, pictures: u32) -> f64 {
    let shot = |seed| shoot(scene, integrator, &film(seed)).film.to_rgb();
    let shots = |count: u32| (0..u64::from(count)).map(shot).collect::<Vec<_>>();
    SUITE.numbers(case, "variance by pictures", pictures, shots, |all| vec![relative_variance(all)])[0]
}

fn relative_variance(all: &[Vec<Rgb>]) -> f64 {
    let pictures = all.len();
    let (mut sums, mut squares) = (vec![0.0; PIXELS], vec![0.0; PIXELS]);
    for (i, pixel) in all.iter().flat_map(|picture| picture.iter().enumerate()) {
        let light = f64::from(pixel.luminance());
        sums[i] += light / pictures as f64;
        squares[i] += light * light / pictures as f64;
    }
    let dark = 0.3 * sums.iter().sum::<f64>() / PIXELS as f64;
    let of_block = |block: usize| {
        let pixels: Vec<usize> = (0..PIXELS).filter(|i| i / 16 / 4 * 4 + i % 16 / 4 == block).collect();
        let mean = pixels.iter().map(|&i| sums[i]).sum::<f64>() / 16.0;
        let variance = pixels.iter().map(|&i| squares[i] - sums[i] * sums[i]).sum::<f64>() / 16.0;
        variance * 8.0 * pictures as f64 / (pictures - 1) as f64 / (mean * mean + dark * dark)
    };
    (0..PIXELS / 16).map(of_block).sum::<f64>() / (PIXELS / 16) as f64
}

#[test]
fn the_noise_of_every_set_is_predicted() {
    let scene = built(&corner());
    let spec = auto().with("radius", RADIUS).with("alpha", 1.0f32).with("aim", false);
    let pictures = effort(30, 60);
    let errors = |seed| choice(&scene, &spec, &film(seed)).candidates.iter().map(|c| c.error).collect();
    let pilots = |count: u32| (0..u64::from(count)).map(errors).collect();
    let predicted =
        SUITE.numbers("predicted", "errors by pilots", pictures, pilots, |all: &Vec<Vec<f64>>| {
            let mean = |set: usize| all.iter().map(|errors| errors[set] / f64::from(pictures)).sum();
            (0..SETS.len()).map(mean).collect()
        });
    // In the short form, those that have one part each of what the others join: camera paths, light paths, photons.
    for (set, predicted) in SETS.into_iter().zip(predicted).step_by(effort(3, 1)) {
        let measured = measured(set, &scene, &*reported(set, false), pictures);
        let ratio = predicted / measured;
        assert!((0.8..1.25).contains(&ratio), "{set}: predicted {predicted}, measured {measured}");
    }
}

/// Paths sample lights through panes, and what they meet behind them by chance is weighted so; light paths find the same light with more noise.
#[test]
fn the_noise_of_paths_behind_a_pane_is_predicted() {
    let mut panel = corner();
    let tilted = quad(Vec3::new(-2.5, 1.9, -2.0), Vec3::X * 5.0, Vec3::new(0.0, 0.2, 4.0));
    let pane = Spec::new("", "dielectric").with("thin", true).with("tint", Rgb::new(0.9, 0.6, 0.2));
    put(&mut panel, "pane", tilted, pane);
    let mut sun = panel.clone();
    let day = Spec::new("", "directional").with("direction", Vec3::new(0.2, -1.0, 0.1));
    sun.lights = vec![day.with("irradiance", 5.0f32)];
    for (name, builder) in [("panel", panel), ("sun", sun)] {
        let scene = built(&builder);
        let case = format!("{name} behind a pane");
        let spec = auto().with("radius", RADIUS).with("alpha", 1.0f32).with("aim", false);
        let pilots: Vec<Choice> = (0..8).map(|seed| choice(&scene, &spec, &film(seed))).collect();
        let predicted = pilots.iter().map(|choice| choice.candidates[0].error).sum::<f64>() / 8.0;
        let found = measured(&case, &scene, &*reported("path", false), 24);
        assert!(
            (0.75..1.6).contains(&(predicted / found)),
            "{case}: predicted {predicted}, measured {found}"
        );
        assert_eq!(pilots[0].best().name, "path", "{case}: {}", pilots[0]);
    }
}

/// Few pixels of a large film are looked at, and hardly a photon falls within their footprints: predictions by these alone differ
/// by a factor of four from pilot to pilot, and say that photons are as noisy as paths.
#[test]
fn every_pilot_of_a_large_film_sees_that_photons_have_less_noise_than_paths() {
    let scene = built(&bilux_gallery::generate(&Spec::new("", "cornell")).unwrap());
    for seed in 0..4 {
        let film = RenderSettings { seed, ..RenderSettings::new(512, 384, 1) };
        let plan = integrators::build(&auto()).unwrap().chooser().unwrap().plan(
            &scene,
            &*scene.cameras()[0].1,
            &film,
        );
        let error = |techniques| {
            let mut candidates = plan.choice.candidates.iter();
            candidates.find(|candidate| candidate.techniques == techniques).unwrap().error
        };
        // In pictures of eight samples it is 0.10.
        let ratio = error("path-photons") / error("path");
        assert!((0.04..0.25).contains(&ratio), "seed {seed}: {ratio}");
    }
}

/// Of light on the bottom of a pool photons are best by far, so `auto` merges; where it may not, it takes the best of what does not.
#[test]
fn what_may_never_merge_does_not() {
    let scene = built(&bilux_gallery::generate(&Spec::new("", "pool")).unwrap());
    let merges = |techniques: &str| ["few", "photons", "vcm"].iter().any(|word| techniques.contains(word));
    for (merge, may_merge) in [("auto", true), ("never", false)] {
        let auto = integrators::build(&auto().with("merge", merge)).unwrap();
        let film = RenderSettings::new(96, 96, 1);
        let plan = auto.chooser().unwrap().plan(&scene, &*scene.cameras()[0].1, &film);
        let chosen = plan.choice.candidates[plan.choice.chosen].techniques;
        assert_eq!(merges(chosen), may_merge, "{merge}: {chosen}");
    }
}

#[test]
fn without_merging_it_has_the_same_mean_as_path() {
    let mut builder = still_life();
    builder.lights.retain(|light| light.kind != "spot");
    let scene = built(&builder);
    let auto = integrators::build(&auto().with("merge", "never")).unwrap();
    let p = agreement("path and auto", &blocks(&scene, integrator("path"), 0), &blocks(&scene, auto, 100));
    assert!(p > UNLIKELY, "p = {p}");
}

#[test]
fn open_daylight_is_left_to_path() {
    let mut builder = corner();
    builder.objects.remove(1);
    builder.lights.clear();
    sky(&mut builder, 1.0);
    let settings = RenderSettings::new(128, 128, 1);
    let choice = choice(&built(&builder), &auto(), &settings);
    assert_eq!(choice.best().name, "path", "{choice}");
    let film = |name: &str| shoot(&built(&builder), &*integrator(name), &settings).film;
    assert!(film("auto") == film("path"), "then it is path, to the bit");
}

/// A glass ball above a floor, under a small light.
fn burning_glass() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.7f32));
    let globe = ball(Vec3::new(0.0, 1.7, 0.0), 1.0, 24, true);
    put(&mut builder, "glass", globe, Spec::new("", "dielectric"));
    let light_spec =
        Spec::new("", "rect").with("position", Vec3::new(0.5, 6.0, 0.5)).with("intensity", 40.0f32);
    builder.lights.push(light_spec.with("edge_u", Vec3::X * 0.2).with("edge_v", Vec3::Z * 0.2));
    look(&mut builder, Vec3::new(0.0, 3.0, 5.0), Vec3::ZERO, 40.0);
    builder
}

#[test]
fn a_caustic_is_worth_light_paths() {
    let scene = built(&burning_glass());
    let choice = choice(&scene, &auto(), &RenderSettings::new(128, 128, 1));
    let path = &choice.candidates[0];
    assert!(path.time_to_error() > 5.0 * choice.best().time_to_error(), "{choice}");
}

/// The burning glass under each kind of light that can be aimed: at the ball, even from infinity.
fn lit_by(light: &str) -> SceneBuilder {
    let mut builder = burning_glass();
    let kept = std::mem::take(&mut builder.lights);
    match light {
        "rect" => builder.lights = kept,
        "sun" => {
            builder.lights.push(Spec::new("", "directional").with("direction", Vec3::new(-0.2, -1.0, -0.1)))
        }
        "sky" => sky(&mut builder, 1.0),
        "sphere" => builder.lights.push(
            Spec::new("", "sphere")
                .with("position", Vec3::new(0.5, 6.0, 0.5))
                .with("radius", 0.2f32)
                .with("intensity", 40.0f32),
        ),
        kind => builder.lights.push(Spec::new("", kind).with("position", Vec3::new(0.5, 6.0, 0.5))),
    }
    builder
}

#[test]
fn aimed_light_paths_find_the_same_light_with_less_noise() {
    // In the short form, one nearby and one at infinity.
    let lights = effort(vec!["rect", "sun"], vec!["rect", "sphere", "point", "spot", "sun", "sky"]);
    for light in lights {
        let scene = built(&lit_by(light));
        // `path` is no reference for what only light subpaths find.
        let p = agreement(
            light,
            &blocks(&scene, reported("bdpt", false), 0),
            &blocks(&scene, reported("bdpt", true), 100),
        );
        assert!(p > UNLIKELY, "{light}: p = {p}");
        if ["sphere", "spot"].contains(&light) {
            continue;
        }
        let [plain, aimed] = [false, true].map(|aim| {
            let case = format!("{light}, aim: {aim}");
            measured(&case, &scene, &*reported("path-light", aim), effort(12, 24))
        });
        // A sky has no caustics that camera subpaths would not find with less noise.
        let bound = if light == "sky" { 2.0 } else { 1.05 };
        assert!(aimed < bound * plain, "{light}: {aimed} with aim, {plain} without");
    }
}

#[test]
fn light_that_path_cannot_find_is_not_lost() {
    let mut builder = mixed();
    builder.lights.retain(|light| light.kind == "point");
    let scene = built(&builder);
    let settings = RenderSettings::new(192, 192, 1);
    let chosen = choice(&scene, &auto().with("merge", "never"), &settings);
    assert!(chosen.candidates[0].lost > 0.01 && chosen.best().name != "path", "{chosen}");
    // Only photons find the mirror's caustic where it is reflected in the mirror itself.
    assert!(chosen.candidates[2].lost > 1e-3 && chosen.candidates[5].lost < 1e-6, "{chosen}");
    assert!(choice(&scene, &auto(), &settings).best().name.contains("photons"), "{chosen}");
}

#[test]
fn merging_sets_are_refused_when_merging_is_off() {
    let spec = auto().with("merge", "never");
    let error = integrators::build(&spec.clone().with("techniques", "path-few")).err().unwrap().to_string();
    assert!(error.contains("'path-few' needs vertex merging"), "{error}");
    assert!(integrators::build(&spec.with("techniques", "bdpt")).is_ok());
}

#[test]
fn a_camera_that_sees_nothing_gets_a_black_picture() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.5f32));
    builder.lights.push(Spec::new("", "point").with("position", Vec3::Y));
    look(&mut builder, Vec3::new(0.0, 5.0, 0.0), Vec3::new(0.0, 9.0, 0.1), 40.0);
    let scene = built(&builder);
    for techniques in ["auto", "path-photons", "vcm"] {
        let auto = integrators::build(&auto().with("techniques", techniques)).unwrap();
        let film = shoot(&scene, &*auto, &RenderSettings::new(16, 8, 2)).film;
        assert!(film.to_rgb().iter().all(|pixel| pixel.is_black()), "{techniques}");
    }
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
