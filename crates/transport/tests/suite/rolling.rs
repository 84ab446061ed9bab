//! Rolling shutters: rows that are exposed one after the other.

use crate::common::labelled::Labelled;
use crate::common::statistics::{UNLIKELY, agreement, difference};
use crate::common::{along, diffuse, effort, integrator, moving, put, quad, shoot};
use bilux_math::Vec3;
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{AccelChoice, Parameters, Scene, SceneBuilder, Spec};
use bilux_testing::verdicts::{Picture, Side};
use bilux_transport::RenderSettings;

/// A scene whose shutter is open from 0 until this time.
fn open(builder: &SceneBuilder, until: f32) -> Scene {
    builder.build(&AccelChoice::default(), [0.0, until], 1.0).unwrap()
}

/// A bright half plane moves to the right by 2 m in a second, seen by parallel rays on a film of 4 m: its edge leans.
#[test]
fn an_edge_that_moves_leans() {
    let mut builder = SceneBuilder::default();
    let bright = diffuse(0.0f32).with("emission", 1.0f32).with("emission_sides", "both");
    put(&mut builder, "half", quad(Vec3::new(-20.0, -4.0, 0.0), Vec3::X * 19.0, Vec3::Y * 8.0), bright);
    builder.objects[0].motion = along(Vec3::ZERO, Vec3::X * 2.0);
    let camera = Spec::new("", "orthographic").with("height", 4.0f32).with("position", Vec3::Z * 5.0);
    builder.cameras = vec![CameraSpec::new(camera.with("look_at", Vec3::ZERO))];
    let settings = RenderSettings { readout: 0.8, ..RenderSettings::new(64, 16, 64) };
    let scene = builder.build(&AccelChoice::default(), [0.0, 0.9], 4.0).unwrap();
    for name in ["path", "bdpt"] {
        let pixels = shoot(&scene, &*integrator(name), &settings).film.to_rgb();
        for row in 0..16 {
            // The middle of a tenth of a second's exposure; the film is 16 m wide.
            let time = 0.05 + 0.8 * row as f32 / 15.0;
            let edge = (8.0 - 1.0 + 2.0 * time) / 16.0 * 64.0;
            let bright: f32 = (0..64).map(|x| pixels[row * 64 + x].g).sum();
            assert!((bright - edge).abs() < 0.15, "{name}: row {row}: {bright} not {edge}");
        }
    }
}

/// The means of quarters of the film, of pictures with other seeds.
fn quarters<'a>(scene: &'a Scene, name: &str, first_seed: u64, readout: f32) -> Side<'a> {
    let integrator = integrator(name);
    Side::new(first_seed..first_seed + 12, move |seed| {
        let settings = RenderSettings { seed, readout, max_depth: 4, ..RenderSettings::new(16, 16, 64) };
        let pixels = shoot(scene, &*integrator, &settings).film.to_rgb();
        let mut sums = vec![0.0; 8];
        pixels.iter().enumerate().for_each(|(i, pixel)| sums[i / 64 * 2 + i % 16 / 8] += f64::from(pixel.g));
        Picture::new(&pixels, sums)
    })
}

/// With exposures of rows that are longer and shorter than it takes to read them all.
#[test]
fn both_ends_see_rows_when_they_are_exposed() {
    let builder = moving();
    for readout in effort(vec![0.3], vec![0.3, 0.9]) {
        let scene = open(&builder, 1.0);
        let path = quarters(&scene, "path", 0, readout);
        for (i, name) in ["light", "bdpt", "vcm"].into_iter().enumerate() {
            let case = format!("{name}, {readout} s");
            let p = agreement(&case, &path, &quarters(&scene, name, 100 * (i as u64 + 1), readout));
            assert!(p > UNLIKELY, "{case}: p = {p}");
        }
        // And it matters: what is exposed all at once looks different.
        let p = difference(&path, &quarters(&scene, "path", 900, 0.0));
        assert!(p < UNLIKELY, "{readout} s: p = {p}");
    }
}

/// The camera comes nearer by 1 m in a second, and turns: z-depths and normals are those of where it is when a row is exposed.
#[test]
fn labels_in_the_camera_s_space_are_of_the_moment_of_their_row() {
    let mut builder = SceneBuilder::default();
    put(
        &mut builder,
        "wall",
        quad(Vec3::new(-50.0, -50.0, 0.0), Vec3::X * 100.0, Vec3::Y * 100.0),
        diffuse(0.5f32),
    );
    let camera = |z: f32, x: f32| [("position", Vec3::Z * z), ("look_at", Vec3::new(x, 0.0, z - 1.0))];
    let mut later = Parameters::default();
    camera(9.0, 1.0).into_iter().for_each(|(key, place)| later.set(key, place));
    let spec = camera(10.0, 0.0)
        .into_iter()
        .fold(Spec::new("", "perspective"), |spec, (key, place)| spec.with(key, place));
    builder.cameras = vec![CameraSpec { spec, keyframes: vec![(0.0, Parameters::default()), (1.0, later)] }];
    let settings = RenderSettings { readout: 1.0, ..RenderSettings::new(5, 11, 1) };
    let labels = Labelled::of(&open(&builder, 1.0), &settings);
    for row in 0..11 {
        let time = row as f32 / 10.0;
        // It looks to the right by as much as it has moved ahead.
        let forward = Vec3::new(time, 0.0, -1.0).normalize();
        for i in row * 5..row * 5 + 5 {
            let z_depth = (labels.position[i] - Vec3::Z * (10.0 - time)).dot(forward);
            assert!(
                (labels.z_depth[i] - z_depth).abs() < 1e-4,
                "row {row}: {}, not {z_depth}",
                labels.z_depth[i]
            );
            assert!(labels.z_depth[i] <= labels.depth[i] * (1.0 + 1e-6), "row {row}");
            let towards = Vec3::new(forward.x, 0.0, -forward.z);
            assert!(
                labels.camera_normal[i].distance(towards) < 1e-5,
                "row {row}: {}",
                labels.camera_normal[i]
            );
        }
    }
}
