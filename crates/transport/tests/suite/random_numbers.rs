//! No random number decides two things. Where one does, the joint probability is not the product of the two, and the
//! mean is wrong in scenes that reveal the correlation.

use crate::common::statistics::{SUITE, estimate};
use crate::common::{ball, built, diffuse, floor, look, put, quad, shoot, sky};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Scene, SceneBuilder, Spec, Value};
use bilux_transport::{RenderSettings, integrators};

/// A red mirror and a green diffuse surface, each for half of the light: the choice of lobe decides the colour with
/// which a path continues.
fn two_coloured(builder: &mut SceneBuilder) -> Spec {
    let mirror = Spec::new("", "mirror").with("reflectance", Rgb::new(0.9, 0.2, 0.4));
    let diffuse = Spec::new("", "diffuse").with("reflectance", Rgb::new(0.1, 0.5, 0.2));
    let (mirror, diffuse) = (builder.add_material(mirror), builder.add_material(diffuse));
    let mix = Spec::new("", "mix").with("a", Value::Material(mirror)).with("b", Value::Material(diffuse));
    mix.with("amount", 0.5f32)
}

const ALBEDO: [f64; 3] = [0.5, 0.35, 0.3];

/// Means and standard errors of the channels over pictures of several seeds, with Russian roulette from the first event
/// on.
fn found(scene: &Scene, kind: &str, sampling: &str, settings: &RenderSettings) -> [(f64, f64); 3] {
    let spec = Spec::new("", kind).with("roulette_depth", Value::Integer(0));
    let spec = if sampling.is_empty() { spec } else { spec.with("sampling", sampling) };
    let integrator = integrators::build(&spec).unwrap();
    let shot = |seed| shoot(scene, &*integrator, &RenderSettings { seed, ..settings.clone() }).film.to_rgb();
    let shots = |count: u32| (0..u64::from(count)).map(shot).collect();
    let case = format!("{kind} {sampling}");
    let found = SUITE.numbers(&case, "means and errors by pictures", 12, shots, |all: &Vec<Vec<Rgb>>| {
        let mean = |pixels: &Vec<Rgb>| pixels.iter().copied().sum::<Rgb>() / pixels.len() as f32;
        let means: Vec<Rgb> = all.iter().map(mean).collect();
        let of = |c: usize| estimate(&means.iter().map(|mean| f64::from(mean[c])).collect::<Vec<_>>());
        (0..3).flat_map(|c| <[f64; 2]>::from(of(c))).collect()
    });
    [0, 1, 2].map(|c| (found[2 * c], found[2 * c + 1]))
}

#[track_caller]
fn assert_mean(name: &str, found: [(f64, f64); 3], wanted: [f64; 3]) {
    for (c, ((mean, error), wanted)) in found.into_iter().zip(wanted).enumerate() {
        assert!((mean - wanted).abs() < 5.0 * error, "{name}, channel {c}: {mean} ± {error}, not {wanted}");
        assert!(5.0 * error < 0.05 * wanted, "{name}, channel {c}: ± {error} of {wanted} tells nothing");
    }
}

#[test]
fn roulette_does_not_depend_on_the_sampled_lobe() {
    let mut builder = SceneBuilder::default();
    let material = two_coloured(&mut builder);
    put(&mut builder, "ball", ball(Vec3::ZERO, 1.0, 12, false), material);
    sky(&mut builder, 1.0);
    look(&mut builder, Vec3::Z * 10.0, Vec3::ZERO, 8.0);
    let scene = built(&builder);
    for (kind, sampling) in [("path", "scattering"), ("path", "mis"), ("bdpt", ""), ("vcm", "")] {
        let found = found(&scene, kind, sampling, &RenderSettings::new(12, 12, 64));
        assert_mean(&format!("{kind} {sampling}"), found, ALBEDO);
    }
}

#[test]
fn roulette_does_not_depend_on_the_lobe_with_interreflection() {
    let mut builder = SceneBuilder::default();
    let material = two_coloured(&mut builder);
    put(&mut builder, "floor", floor(0.0, 2.0), diffuse(0.8f32));
    put(&mut builder, "ball", ball(Vec3::new(0.0, 0.7, 0.0), 0.7, 10, true), material.clone());
    let wall = quad(Vec3::new(-2.0, 0.0, -1.5), Vec3::X * 4.0, Vec3::Y * 3.0);
    put(&mut builder, "wall", wall, material);
    let light = Spec::new("", "sphere").with("position", Vec3::new(0.8, 1.9, 0.6)).with("radius", 0.4f32);
    builder.lights.push(light.with("radiance", 10.0f32));
    look(&mut builder, Vec3::new(0.0, 2.0, 4.0), Vec3::new(0.0, 0.5, 0.0), 40.0);
    let scene = built(&builder);
    let path = found(&scene, "path", "", &RenderSettings::new(12, 12, 128));
    for (kind, spp) in [("path scattering", 128), ("bdpt", 64), ("vcm", 64)] {
        let (kind, sampling) = kind.split_once(' ').unwrap_or((kind, ""));
        let other = found(&scene, kind, sampling, &RenderSettings::new(12, 12, spp));
        for (c, (a, b)) in other.into_iter().zip(path).enumerate() {
            let error = (a.1 * a.1 + b.1 * b.1).sqrt();
            assert!((a.0 - b.0).abs() < 5.0 * error, "{kind}, channel {c}: {a:?} and {b:?}");
            assert!(5.0 * error < 0.05 * b.0, "{kind}, channel {c}: {a:?} and {b:?}");
        }
    }
}
