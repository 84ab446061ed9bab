//! Pictures in intervals of the length of paths: the speed of light, glass, agreement of both ends, and their sum.

use crate::common::{ball, built, diffuse, floor, integrator, look, mixed, put, quad, shoot};
use bilux_math::{Rgb, Vec3};
use bilux_scene::{Mesh, Scene, SceneBuilder, Spec};
use bilux_transport::{Film, LengthBins, LightDivision, RenderSettings, Silent, light_parts};
use std::sync::Arc;

/// The films of the intervals, and of the rest.
fn films(scene: &Scene, name: &str, settings: &RenderSettings, bins: LengthBins) -> Vec<Film> {
    let division = LightDivision { by_length: Some(bins), ..LightDivision::default() };
    let camera = &*scene.cameras()[0].1;
    let parts = light_parts(scene, camera, &*integrator(name), settings, &division, &Silent);
    parts.unwrap().unwrap().by_length
}

/// The light of each interval in all pixels, and of the rest.
fn histogram(scene: &Scene, name: &str, settings: &RenderSettings, bins: LengthBins) -> Vec<f64> {
    let sum = |film: &Film| film.to_rgb().iter().map(|light| f64::from(light.luminance())).sum();
    films(scene, name, settings, bins).iter().map(sum).collect()
}

/// The share of all light that comes within a millimetre of a length, in metres.
fn share_at(scene: &Scene, name: &str, length: f64) -> f64 {
    let settings = RenderSettings::new(8, 8, 4);
    let bins = LengthBins { begin: length - 1e-3, width: 2e-3, count: 1 };
    let found = histogram(scene, name, &settings, bins);
    found[0] / (found[0] + found[1])
}

/// A narrow view along -z from the origin.
fn ahead(builder: &mut SceneBuilder) {
    look(builder, Vec3::ZERO, -Vec3::Z, 0.1);
}

/// A plate across z.
fn plate(z: f32, half: f32) -> Arc<Mesh> {
    quad(Vec3::new(-half, -half, z), Vec3::X * 2.0 * half, Vec3::Y * 2.0 * half)
}

/// A box without sides between two depths.
fn slab(near: f32, far: f32, half: f32) -> Arc<Mesh> {
    let corner = Vec3::new(-half, -half, far);
    let (x, y, z) = (Vec3::X * 2.0 * half, Vec3::Y * 2.0 * half, Vec3::Z * (near - far));
    let mut mesh = Mesh::default();
    for face in [
        quad(corner + z, x, y),
        quad(corner, y, x),
        quad(corner, x, z),
        quad(corner + y, z, x),
        quad(corner, z, y),
        quad(corner + x, y, z),
    ] {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(&face.positions);
        mesh.triangles.extend(face.triangles.iter().map(|corners| corners.map(|i| i + first)));
    }
    Arc::new(mesh)
}

#[test]
fn light_of_a_lamp_at_the_camera_returns_from_a_plate_after_twice_its_distance() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "plate", plate(-5.0, 3.0), diffuse(0.5f32));
    builder
        .lights
        .push(Spec::new("", "point").with("position", Vec3::new(0.0, 1e-4, 0.0)).with("intensity", 9.0f32));
    ahead(&mut builder);
    let scene = built(&builder);
    for name in ["path", "bdpt"] {
        assert!(share_at(&scene, name, 10.0) > 0.9999, "{name}");
        // One way, or a length that is off by the width of an interval, would be noticed.
        assert!(share_at(&scene, name, 5.0) < 1e-6 && share_at(&scene, name, 10.003) < 1e-6, "{name}");
    }
}

#[test]
fn two_mirrors_show_a_lamp_at_the_length_of_all_legs() {
    let mut builder = SceneBuilder::default();
    let mirror = || Spec::new("", "mirror").with("reflectance", 0.9f32);
    // Ahead for 4 m, 2 m to the right, and back for 7 m.
    put(&mut builder, "one", quad(Vec3::new(-0.5, -0.5, -3.5), Vec3::new(1.0, 0.0, -1.0), Vec3::Y), mirror());
    put(&mut builder, "two", quad(Vec3::new(1.5, -0.5, -4.5), Vec3::new(1.0, 0.0, 1.0), Vec3::Y), mirror());
    let lamp = diffuse(0.0f32).with("emission", 3.0f32);
    put(&mut builder, "lamp", quad(Vec3::new(1.5, -0.5, 3.0), Vec3::Y, Vec3::X), lamp);
    ahead(&mut builder);
    let scene = built(&builder);
    for name in ["path", "bdpt"] {
        assert!(share_at(&scene, name, 13.0) > 0.9999, "{name}");
    }
}

#[test]
fn two_bounces_in_a_corner_arrive_after_their_shortest_way() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 20.0), diffuse(0.8f32));
    let wall = quad(Vec3::new(-20.0, 0.0, -2.0), Vec3::X * 40.0, Vec3::Y * 20.0);
    put(&mut builder, "wall", wall, diffuse(0.8f32));
    // The lamp shines at a spot of the wall alone, which shines on the floor that the camera sees.
    let lamp = Spec::new("", "spot")
        .with("position", Vec3::new(0.0, 1.0, 1.0))
        .with("look_at", Vec3::new(0.0, 1.0, -2.0));
    builder.lights.push(lamp.with("intensity", 50.0f32).with("angle", 1.0f32).with("inner_angle", 1.0f32));
    look(&mut builder, Vec3::new(0.0, 4.0, 0.0), Vec3::new(0.0, 0.0, -1.0), 0.1);
    let scene = built(&builder);
    let shortest = 17f64.sqrt() + 2f64.sqrt() + 3.0;
    let settings = RenderSettings::new(4, 4, 64);
    let bins = LengthBins { begin: shortest - 1.1, width: 1.0, count: 2 };
    for name in ["path", "bdpt"] {
        let found = histogram(&scene, name, &RenderSettings { max_depth: 2, ..settings.clone() }, bins);
        assert!(found[0] == 0.0 && found[1] > 0.0 && found[2] < 1e-3 * found[1], "{name}: {found:?}");
    }
}

#[test]
fn glass_takes_light_as_much_longer_as_its_index_says() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "glass", slab(-2.0, -2.6, 3.0), Spec::new("", "dielectric").with("eta", 1.5f32));
    put(&mut builder, "lamp", plate(-4.0, 3.0), diffuse(0.0f32).with("emission", 3.0f32));
    ahead(&mut builder);
    let scene = built(&builder);
    for name in ["path", "bdpt"] {
        let share = share_at(&scene, name, 4.0 + 0.5 * 0.6);
        // A few in a thousand go to and fro in the slab once more.
        assert!(share > 0.98, "{name}: {share}");
        assert!(share_at(&scene, name, 4.0) < 1e-6, "{name}");
    }
}

#[test]
fn both_ends_find_the_same_histogram_also_through_glass() {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(0.7f32));
    put(
        &mut builder,
        "wall",
        quad(Vec3::new(-3.0, 0.0, -2.0), Vec3::X * 6.0, Vec3::Y * 4.0),
        diffuse(0.7f32),
    );
    let glass = Spec::new("", "dielectric").with("eta", 1.6f32);
    put(&mut builder, "ball", ball(Vec3::new(0.0, 0.7, 0.0), 0.6, 16, true), glass);
    let lamp =
        Spec::new("", "rect").with("position", Vec3::new(-1.0, 2.5, -1.0)).with("edge_u", Vec3::X * 2.0);
    builder.lights.push(lamp.with("edge_v", Vec3::Z * 2.0).with("radiance", Rgb::WHITE));
    look(&mut builder, Vec3::new(0.0, 1.5, 5.0), Vec3::new(0.0, 0.7, 0.0), 40.0);
    let scene = built(&builder);
    let bins = LengthBins { begin: 5.0, width: 0.75, count: 12 };
    let runs = |name: &str| -> Vec<Vec<f64>> {
        let run = |seed| {
            let settings = RenderSettings { seed, max_depth: 5, ..RenderSettings::new(16, 12, 32) };
            histogram(&scene, name, &settings, bins)
        };
        (1..=8).map(run).collect()
    };
    let moments = |runs: &[Vec<f64>], bin: usize| {
        let mean = runs.iter().map(|run| run[bin]).sum::<f64>() / 8.0;
        let variance = runs.iter().map(|run| (run[bin] - mean) * (run[bin] - mean)).sum::<f64>() / 7.0;
        (mean, variance / 8.0)
    };
    let farthest = |a: &[Vec<f64>], b: &[Vec<f64>], shift: usize| {
        let off = |bin: usize| {
            let ((a, error_a), (b, error_b)) = (moments(a, bin), moments(b, bin + shift));
            (a - b).abs() / (error_a + error_b).sqrt().max(1e-12)
        };
        (0..bins.count as usize - shift).map(off).fold(0.0, f64::max)
    };
    let (path, bdpt) = (runs("path"), runs("bdpt"));
    // Student's t of 14 degrees of freedom exceeds this once in 60,000.
    assert!(farthest(&path, &bdpt, 0) < 6.0, "{}", farthest(&path, &bdpt, 0));
    assert!(farthest(&path, &bdpt, 1) > 12.0);
}

#[test]
fn the_intervals_add_up_to_the_picture() {
    let scene = built(&mixed());
    let settings = RenderSettings::new(24, 16, 4);
    for name in ["path", "bdpt"] {
        let film = shoot(&scene, &*integrator(name), &settings).film;
        let bins = LengthBins { begin: 3.0, width: 0.5, count: 10 };
        let parts = films(&scene, name, &settings, bins);
        assert_eq!(parts.len(), 11);
        for (x, y) in (0..24 * 16).map(|i| film.window().position(i)) {
            let sum = parts.iter().fold(Rgb::BLACK, |sum, part| sum + part.pixel(x, y));
            let off =
                (sum + film.pixel(x, y) * -1.0).to_array().map(f32::abs).into_iter().fold(0.0, f32::max);
            assert!(off < 1e-5 * (1.0 + film.pixel(x, y).max_channel()), "{name} ({x}, {y}): {off}");
        }
        let bright = |film: &Film| film.to_rgb().iter().any(|light| light.max_channel() > 1e-3);
        assert!(parts.iter().filter(|part| bright(part)).count() > 5, "{name}");
    }
}
