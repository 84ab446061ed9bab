//! Scenes and shapes that several tests share.
#![allow(dead_code, unreachable_pub)]

pub mod labelled;
pub mod media;
pub mod statistics;

pub use bilux_testing::effort;

use bilux_math::motion::{Motion, MotionKey};
use bilux_math::transcendental::sin_cos;
use bilux_math::{Quat, Rgb, Vec3};
use bilux_scene::cameras::CameraSpec;
use bilux_scene::{AccelChoice, Mesh, Object, Parameters, Scene, SceneBuilder, Spec};
use bilux_transport::{PixelIntegrator, RenderSettings, Rendered, Silent, integrators, render};
use std::sync::Arc;

/// A ball of about `2 * rings * rings` quads, smooth or with its triangles' own normals.
pub fn ball(centre: Vec3, radius: f32, rings: u32, smooth: bool) -> Arc<Mesh> {
    let (columns, mut mesh) = (2 * rings, Mesh::default());
    for row in 0..=rings {
        let (sin_theta, cos_theta) = sin_cos(std::f32::consts::PI * row as f32 / rings as f32);
        for column in 0..columns {
            let (s, c) = sin_cos(std::f32::consts::TAU * column as f32 / columns as f32);
            let ends = row == 0 || row == rings;
            let n = if ends {
                Vec3::Y * cos_theta.signum()
            } else {
                Vec3::new(sin_theta * c, cos_theta, sin_theta * s)
            };
            mesh.positions.push(centre + n * radius);
            mesh.normals.push(n);
        }
    }
    for row in 0..rings {
        for column in 0..columns {
            let at = |r: u32, c: u32| r * columns + c % columns;
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
            if row > 0 {
                mesh.triangles.push([a, b, c]);
            }
            if row + 1 < rings {
                mesh.triangles.push([b, d, c]);
            }
        }
    }
    if !smooth {
        mesh.normals.clear();
    }
    Arc::new(mesh)
}

/// A flat quadrilateral from its corner along two edges.
pub fn quad(corner: Vec3, u: Vec3, v: Vec3) -> Arc<Mesh> {
    Arc::new(Mesh {
        positions: vec![corner, corner + u, corner + u + v, corner + v],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    })
}

/// A floor at this height that faces up.
pub fn floor(y: f32, half: f32) -> Arc<Mesh> {
    quad(Vec3::new(-half, y, -half), Vec3::Z * 2.0 * half, Vec3::X * 2.0 * half)
}

/// Fails where a picture is not the same, to the bit, with every accelerator.
pub fn assert_same_with_every_accelerator(builder: &SceneBuilder) {
    let picture = |accel: &str| {
        let choice = AccelChoice { name: accel.to_owned(), ..AccelChoice::default() };
        let scene = builder.build(&choice, [0.0, 0.0], 1.0).unwrap();
        shoot(&scene, &*integrator("path"), &RenderSettings::new(24, 24, 8)).film.to_rgb()
    };
    let brute = picture("brute");
    for row in bilux_accel::ACCELERATORS {
        assert!(picture(row.entry.name) == brute, "{} sees something else than brute", row.entry.name);
    }
}

/// Adds an object with a material of its own.
pub fn put(builder: &mut SceneBuilder, name: &str, mesh: Arc<Mesh>, material: Spec) {
    let material = builder.add_material(material);
    builder.objects.push(Object::new(name, mesh, material));
}

/// Adds a camera.
pub fn look(builder: &mut SceneBuilder, from: Vec3, at: Vec3, fov: f32) {
    let spec = Spec::new("eye", "perspective").with("position", from).with("look_at", at).with("fov", fov);
    builder.cameras.push(CameraSpec { spec, keyframes: Vec::new() });
}

pub fn diffuse(reflectance: impl Into<bilux_scene::Value>) -> Spec {
    Spec::new("", "diffuse").with("reflectance", reflectance)
}

/// A scene for a square film, with a closed shutter.
pub fn built(builder: &SceneBuilder) -> Scene {
    builder.build(&AccelChoice::default(), [0.0, 0.0], 1.0).unwrap()
}

pub fn integrator(name: &str) -> Box<dyn PixelIntegrator> {
    integrators::build(&Spec::new("", name)).unwrap()
}

/// Renders through the first camera, without progress reports.
pub fn shoot(scene: &Scene, integrator: &dyn PixelIntegrator, settings: &RenderSettings) -> Rendered {
    render(scene, &*scene.cameras()[0].1, integrator, settings, &Silent).unwrap()
}

/// A table with a plastic, a mirror and a glass ball under a panel, a spot and a sky: something of everything.
pub fn still_life() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 6.0), diffuse(Rgb::new(0.25, 0.55, 0.25)));
    let plastic = Spec::new("", "phong").with("kd", Rgb::new(0.7, 0.12, 0.08)).with("ks", 0.25f32);
    put(
        &mut builder,
        "plastic",
        ball(Vec3::new(-2.1, 1.0, 0.0), 1.0, 24, true),
        plastic.with("reflectivity", 0.3f32),
    );
    let mirror = Spec::new("", "mirror").with("reflectance", Rgb::new(0.9, 0.88, 0.8)).with("gloss", 4.0f32);
    put(&mut builder, "mirror", ball(Vec3::new(0.0, 1.0, -1.2), 1.0, 24, true), mirror);
    let glass = Spec::new("", "dielectric").with("absorption", Rgb::new(0.25, 0.05, 0.03));
    put(&mut builder, "glass", ball(Vec3::new(2.0, 1.0, 0.3), 1.0, 24, true), glass);
    let panel = Spec::new("panel", "rect")
        .with("position", Vec3::new(-1.0, 5.0, 2.0))
        .with("edge_u", Vec3::new(2.0, 0.0, 0.0))
        .with("edge_v", Vec3::new(0.0, 0.0, 2.0))
        .with("intensity", 60.0f32);
    builder.lights.push(panel);
    builder.lights.push(
        Spec::new("spot", "spot").with("position", Vec3::new(4.0, 5.0, 3.0)).with("intensity", 30.0f32),
    );
    let sky = Spec::new("sky", "environment").with("radiance", Rgb::new(0.25, 0.32, 0.45));
    builder.lights.push(sky.with("ground", 0.1f32));
    look(&mut builder, Vec3::new(0.0, 3.0, 8.0), Vec3::new(0.0, 0.8, 0.0), 36.0);
    builder
}

/// Along a line, from one place at 0 s to another at 1 s.
pub fn along(from: Vec3, to: Vec3) -> Motion {
    let key = |time_seconds, translation| MotionKey {
        time_seconds,
        translation,
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    };
    Motion::from_keys(vec![key(0.0, from), key(1.0, to)]).unwrap()
}

/// A lamp that moves from left to right over a floor within a second, a ball that rises, and a camera that does, too.
pub fn moving() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 6.0), diffuse(0.6f32));
    put(&mut builder, "ball", ball(Vec3::ZERO, 0.3, 8, true), diffuse(0.4f32));
    builder.objects[1].motion = along(Vec3::new(0.0, 0.4, -0.5), Vec3::new(0.0, 1.0, -0.5));
    let shine = diffuse(0.0f32).with("emission", 30.0f32).with("emission_sides", "front");
    let panel = quad(Vec3::new(-0.1, 0.0, -0.1), Vec3::X * 0.2, Vec3::Z * 0.2);
    put(&mut builder, "lamp", panel, shine);
    builder.objects[2].motion = along(Vec3::new(-1.5, 0.5, 0.0), Vec3::new(1.5, 0.5, 0.0));
    look(&mut builder, Vec3::new(0.0, 4.0, 4.0), Vec3::ZERO, 50.0);
    builder.cameras[0].keyframes = [(0.0, 3.9f32), (1.0, 4.1)]
        .map(|(time, height)| {
            let mut changes = Parameters::default();
            changes.set("position", Vec3::new(0.0, height, 4.0));
            (time, changes)
        })
        .to_vec();
    builder
}

/// A uniform sky.
pub fn sky(builder: &mut SceneBuilder, radiance: f32) {
    builder.lights.push(Spec::new("", "environment").with("radiance", radiance));
}

/// Diffuse, glossy and mirror surfaces under two panels, a point light and a sky: each sampling technique is best
/// somewhere.
pub fn mixed() -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    let satin = Spec::new("", "phong").with("kd", 0.2f32).with("ks", 0.6f32).with("exponent", 30.0f32);
    put(
        &mut builder,
        "satin",
        ball(Vec3::new(-0.8, 0.7, 0.0), 0.7, 10, true),
        satin.with("reflectivity", 0.2f32),
    );
    put(&mut builder, "mirror", ball(Vec3::new(0.9, 0.6, -0.3), 0.6, 10, false), Spec::new("", "mirror"));
    for (x, size) in [(-1.5, 1.5), (1.8, 0.3)] {
        let panel = Spec::new("", "rect").with("position", Vec3::new(x, 3.0, 0.5)).with("intensity", 12.0f32);
        builder.lights.push(panel.with("edge_u", Vec3::X * size).with("edge_v", Vec3::new(0.0, 0.3, size)));
    }
    builder
        .lights
        .push(Spec::new("", "point").with("position", Vec3::new(0.0, 2.0, 3.0)).with("intensity", 2.0f32));
    sky(&mut builder, 0.3);
    look(&mut builder, Vec3::new(0.0, 2.0, 5.0), Vec3::new(0.0, 0.5, 0.0), 40.0);
    builder
}

/// Diffuse and glossy bodies, smooth and faceted, so that light subpaths find all of the light.
pub fn without_mirrors(light: Spec) -> SceneBuilder {
    let mut builder = SceneBuilder::default();
    put(&mut builder, "floor", floor(0.0, 3.0), diffuse(Rgb::new(0.7, 0.5, 0.3)));
    put(
        &mut builder,
        "wall",
        quad(Vec3::new(-3.0, 0.0, -2.0), Vec3::X * 6.0, Vec3::Y * 3.0),
        diffuse(0.6f32),
    );
    put(&mut builder, "ball", ball(Vec3::new(-0.8, 0.7, 0.0), 0.7, 10, true), diffuse(0.8f32));
    let satin = Spec::new("", "phong")
        .with("kd", 0.3f32)
        .with("ks", 0.5f32)
        .with("exponent", 20.0f32)
        .with("reflectivity", 0.0f32);
    put(&mut builder, "satin", ball(Vec3::new(0.9, 0.6, 0.3), 0.6, 6, true), satin);
    builder.lights.push(light);
    look(&mut builder, Vec3::new(0.0, 2.0, 5.0), Vec3::new(0.0, 0.5, 0.0), 40.0);
    builder
}
