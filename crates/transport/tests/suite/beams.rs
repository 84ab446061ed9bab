//! Lamps that shine into narrow cones through fog: their light is found where it is, as often as the light of other lamps.

use crate::common::media::boxed;
use crate::common::{integrator, put, shoot};
use bilux_math::Vec3;
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{Goniometer, IntensityDistribution, Scene, SceneBuilder, Spec};
use bilux_testing::effort;
use bilux_transport::{PixelIntegrator, RenderSettings, integrators};
use std::sync::Arc;

/// Fog around a lamp that stands there, seen from the side: it is so many times as dense as where a tenth of light is scattered in a metre, and as much
/// thinner before the lamp.
fn fog_around(lamp: Spec, x: f32, dense: f32) -> Scene {
    let mut builder = SceneBuilder::default();
    let fog = Spec::new("", "interface").with("scattering", 0.1 * dense).with("absorption", 0.05 * dense);
    put(&mut builder, "fog", boxed(Vec3::new(-6.0, -3.0, -5.0), Vec3::new(6.0, 3.0, 4.0 / dense)), fog);
    builder.add_light(lamp.with("position", Vec3::new(x, 0.2, 0.0)));
    let eye = Spec::new("eye", "orthographic").with("position", Vec3::Z * 5.0).with("look_at", Vec3::ZERO);
    builder.cameras = vec![CameraSpec::new(eye.with("height", 1.0f32))];
    builder.build(&Default::default(), [0.0; 2], 4.0).unwrap()
}

fn spot(angle: f32) -> Spec {
    let spot = Spec::new("", "spot").with("look_at", Vec3::new(2.0, 0.0, 0.1)).with("intensity", 100.0f32);
    spot.with("angle", angle).with("inner_angle", 0.8 * angle)
}

/// A lamp whose measured intensity falls to a hundredth within ten degrees, and to nothing behind.
fn measured() -> Spec {
    let (polar, candela) = (vec![0.0, 2.5, 5.0, 10.0, 30.0, 90.0], vec![900.0, 700.0, 200.0, 9.0, 1.0, 0.0]);
    let table = IntensityDistribution::new(
        "beam",
        Goniometer::C,
        vec![0.0, 360.0],
        polar,
        [&candela[..], &candela].concat(),
    );
    Spec::new("", "luminaire")
        .with("distribution", Arc::new(table.unwrap()))
        .with("direction", Vec3::new(1.0, 0.0, 0.1))
        .with("flux", 9.0f32)
}

/// The mean of a picture, and its noise: the root of the mean square of half the difference of two of its kind, over the mean.
fn seen(scene: &Scene, integrator: &dyn PixelIntegrator, spp: u32) -> [f64; 2] {
    let picture = |seed| {
        let settings = RenderSettings { seed, max_depth: 8, ..RenderSettings::new(64, 16, spp) };
        shoot(scene, integrator, &settings).film.to_rgb()
    };
    let [a, b] = [1, 2].map(picture);
    let mean = a.iter().chain(&b).map(|pixel| f64::from(pixel.g)).sum::<f64>() / (2 * a.len()) as f64;
    let square = |difference: f64| difference * difference;
    let squares = a.iter().zip(&b).map(|(a, b)| square(f64::from(a.g - b.g))).sum::<f64>();
    [mean, (0.5 * squares / a.len() as f64).sqrt() / mean]
}

/// `light` needs no luck to find beams: the others have its mean, and no more than a few times its noise.
#[test]
fn beams_in_fog_are_found_by_all() {
    let names = ["bdpt", "vcm", "auto"];
    let cases = [
        ("6 degrees", spot(6.0), [2.5, 1.5]),
        ("half a degree", spot(0.5), [2.5, 4.0]),
        ("measured", measured(), [2.5, 1.5]),
    ];
    for (turn, (case, lamp, [most, most_of_path])) in cases.into_iter().enumerate() {
        let scene = fog_around(lamp, -3.0, 1.0);
        let [wanted, noise] = seen(&scene, &*integrator("light"), 64);
        // In the short form each lamp by two of the three.
        let is_taken = |i: usize| effort(i != 2 * turn % 3, true);
        for (_, name) in names.into_iter().enumerate().filter(|(i, _)| is_taken(*i)) {
            let [mean, found] = seen(&scene, &*integrator(name), 16);
            assert!((mean / wanted - 1.0).abs() < 0.05, "{case}, {name}: {mean}, not {wanted}");
            assert!(found < most * 2.0 * noise, "{case}, {name}: noise {found}, of light {noise}");
        }
        // By itself a camera path finds what is lit, at once or after an event elsewhere, by points on its rays.
        let spp = effort(128, 256);
        let [mean, found] = seen(&scene, &*integrator("path"), spp);
        let found = found * f64::from(spp / 16).sqrt();
        assert!((mean / wanted - 1.0).abs() < 0.05, "{case}, path: {mean}, not {wanted}");
        assert!(found < most_of_path * 2.0 * noise, "{case}, path: noise {found}, of light {noise}");
    }
}

/// Light subpaths in dense fog are kept as points, and merged in balls as wide as the beam. What is lit straight from the lamp is
/// seen from there, and not merged too.
#[test]
fn beams_in_dense_fog_are_found_once() {
    let scene = fog_around(spot(6.0), -1.0, 20.0);
    let vcm = integrators::build(&Spec::new("", "vcm").with("radius", 0.02f32)).unwrap();
    let [[wanted, _], [mean, _]] = [seen(&scene, &*integrator("light"), 64), seen(&scene, &*vcm, 16)];
    assert!((mean / wanted - 1.0).abs() < 0.04, "{mean}, not {wanted}");
}
