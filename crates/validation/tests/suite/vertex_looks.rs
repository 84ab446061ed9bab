//! Attributes that vertices add to a material: colours that they emit, opacities and their threshold, and widths of points. Each
//! against its closed form.

use bilux::math::{Rgb, Vec3};
use bilux::prelude::*;
use bilux::scene::cameras::CameraSpec;
use std::sync::Arc;

/// A square of side 2 that faces an orthographic camera, which sees nothing else.
fn square(change: impl FnOnce(&mut Mesh), material: Spec) -> SceneBuilder {
    let mut mesh = Mesh::quad(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0);
    change(&mut mesh);
    let mut scene = SceneBuilder { environment_unspecified: false, ..SceneBuilder::default() };
    let material = scene.add_material(material);
    scene.objects.push(Object::new("square", Arc::new(mesh), material));
    let camera = Spec::new("", "orthographic").with("position", Vec3::Z * 3.0).with("look_at", Vec3::ZERO);
    scene.cameras.push(CameraSpec { spec: camera.with("height", 2.0f32), ..CameraSpec::default() });
    scene
}

fn render(scene: &SceneBuilder, integrator: &str, samples: i64) -> Vec<Rgb> {
    let mut all = Parameters::default();
    for (key, value) in [("size", "16x16"), ("integrator", integrator), ("filter", "box")] {
        all.set(key, value);
    }
    all.set("spp", Value::Integer(samples));
    let picture = Job::new(scene, &all).unwrap().render(&Quiet).unwrap().picture().unwrap();
    picture.to_rgb().unwrap()
}

fn mean(pixels: &[Rgb]) -> Rgb {
    pixels.iter().copied().sum::<Rgb>() * (1.0 / pixels.len() as f32)
}

fn glowing(radiance: f32) -> Spec {
    Spec::new("glow", "diffuse").with("reflectance", 0.0f32).with("emission", radiance)
}

/// Red from 0 to 1 from left to right, green from 1 to 0 upwards.
fn tints(mesh: &mut Mesh) {
    mesh.vertex_kd = vec![
        Rgb::new(0.0, 1.0, 0.5),
        Rgb::new(1.0, 1.0, 0.5),
        Rgb::new(1.0, 0.0, 0.5),
        Rgb::new(0.0, 0.0, 0.5),
    ];
    mesh.emission_by_kd = true;
}

#[test]
fn vertices_tint_what_they_emit() {
    let pixels = render(&square(tints, glowing(2.0)), "path", 64);
    for (i, pixel) in pixels.iter().enumerate() {
        // The mean over a pixel is its middle; the samples of a pixel spread over its width.
        let (x, y) = ((i % 16) as f32 + 0.5, (i / 16) as f32 + 0.5);
        let wanted = Rgb::new(2.0 * x / 16.0, 2.0 * y / 16.0, 1.0);
        let off = (*pixel - wanted).map(f32::abs).max_channel();
        assert!(off < 0.03, "{i}: {pixel:?}, not {wanted:?}");
    }
    let untinted = render(
        &square(
            |mesh| {
                tints(mesh);
                mesh.emission_by_kd = false;
            },
            glowing(2.0),
        ),
        "path",
        1,
    );
    assert_eq!(untinted[0], Rgb::grey(2.0));
}

/// The light of a tinted panel on a floor is that of a panel of this colour, by each way to find it.
#[test]
fn what_a_tinted_panel_lights_has_its_colour() {
    let lit = |change: fn(&mut Mesh), glow: Spec| {
        let mut scene = square(change, glow);
        let floor = Mesh::quad(Vec3::new(-4.0, -4.0, -1.5), Vec3::X * 8.0, Vec3::Y * 8.0);
        let paint = scene.add_material(Spec::new("floor", "diffuse").with("reflectance", 0.8f32));
        scene.objects.push(Object::new("floor", Arc::new(floor), paint));
        // From the side, past the panel.
        let camera = Spec::new("", "perspective").with("position", Vec3::new(3.0, 0.0, -0.5));
        scene.cameras[0].spec = camera.with("look_at", Vec3::new(1.0, 0.0, -1.5)).with("fov", 30.0f32);
        scene
    };
    let even = |mesh: &mut Mesh| {
        mesh.vertex_kd = vec![Rgb::new(0.25, 0.5, 1.0); 4];
        mesh.emission_by_kd = true;
    };
    for integrator in ["path", "bdpt"] {
        let tinted = mean(&render(&lit(even, glowing(4.0)), integrator, 64));
        let plain = mean(&render(&lit(|_| {}, glowing(4.0)), integrator, 64));
        for (c, factor) in [0.25, 0.5, 1.0].into_iter().enumerate() {
            let part = tinted.to_array()[c] / (plain.to_array()[c] * factor);
            assert!((part - 1.0).abs() < 0.02, "{integrator}, channel {c}: {part}");
        }
    }
}

#[test]
fn opacities_of_vertices_let_light_through() {
    let backed = |change: fn(&mut Mesh)| {
        let mut scene = square(change, glowing(1.0));
        let behind = Mesh::quad(Vec3::new(-4.0, -4.0, -1.0), Vec3::X * 8.0, Vec3::Y * 8.0);
        let wall = Spec::new("wall", "diffuse").with("reflectance", 0.0f32).with("emission", 3.0f32);
        let wall = scene.add_material(wall);
        scene.objects.push(Object::new("wall", Arc::new(behind), wall));
        scene
    };
    // From 0 at the left to 1 at the right: 1 o + 3 (1 - o).
    let fade = |mesh: &mut Mesh| mesh.vertex_opacity = vec![0.0, 1.0, 1.0, 0.0];
    let pixels = render(&backed(fade), "path", 256);
    for column in 0..16 {
        let all: Vec<Rgb> = pixels.iter().copied().skip(column).step_by(16).collect();
        let o = (column as f32 + 0.5) / 16.0;
        let wanted = o + 3.0 * (1.0 - o);
        // 4096 samples of two values that are 2 apart: five standard deviations.
        let bound = 5.0 * 2.0 * (o * (1.0 - o) / 4096.0).sqrt() + 1e-3;
        assert!((mean(&all).r - wanted).abs() < bound, "column {column}: {}", mean(&all).r);
    }
    let cut = |mesh: &mut Mesh| {
        mesh.vertex_opacity = vec![0.0, 1.0, 1.0, 0.0];
        mesh.opacity_threshold = Some(0.25);
    };
    let pixels = render(&backed(cut), "path", 4);
    for (i, pixel) in pixels.iter().enumerate() {
        assert_eq!(pixel.r, if i % 16 < 4 { 3.0 } else { 1.0 }, "pixel {i}");
    }
}

#[test]
fn points_have_their_own_widths() {
    let mut scene = square(
        |mesh| {
            mesh.triangles.clear();
            mesh.points = vec![0, 2];
            mesh.normals.clear();
            mesh.positions = vec![Vec3::new(-0.5, 0.0, 0.0), Vec3::ZERO, Vec3::new(0.5, 0.0, 0.0), Vec3::ONE];
            mesh.point_widths = vec![0.5, 0.0, 0.25, 0.0];
        },
        glowing(1.0),
    );
    let half_area = |pixels: &[Rgb], side: usize| {
        let lit: f32 = pixels.iter().enumerate().filter(|(i, _)| i % 16 / 8 == side).map(|(_, p)| p.r).sum();
        lit / 128.0 * 2.0
    };
    let disc = |width: f32| std::f32::consts::PI * width * width / 4.0;
    for scale in [1.0, 0.5] {
        let place = bilux::math::Transform::scale(Vec3::splat(scale)).unwrap();
        scene.objects[0].motion = bilux::math::motion::Motion::still(place);
        for instanced in [false, true] {
            scene.objects[0].instanced = instanced;
            let pixels = render(&scene, "path", 1024);
            for (side, width) in [(0, 0.5 * scale), (1, 0.25 * scale)] {
                let area = half_area(&pixels, side);
                assert!((area / disc(width) - 1.0).abs() < 0.1, "{scale} {instanced} {side}: {area}");
            }
        }
    }
}
