//! The image on the front page: a glass, a mirror and a diffuse teapot in soft light.

use crate::GeneratorEntry;
use crate::teapot::TESSELLATION;
use crate::teapot::vessel::Vessel;
use bilux_math::registry::{Entry, Parameter};
use bilux_math::{DMat4, DVec3, Rgb, Transform, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::typed::cameras::Perspective;
use bilux_scene::{Mesh, Object, SceneBuilder, Spec, Value};
use std::sync::Arc;

pub(super) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: Entry {
        name: "trio",
        summary: "a glass, a mirror and a diffuse teapot in soft light: the scene of the README's first command",
        source: "Newell 1975",
        parameters: &[Parameter { default: "24", ..TESSELLATION }],
    },
    triangles: |reader| 3 * 64 * (reader.integer("tessellation") as u64).pow(2),
    generate: |reader| {
        let tessellation = reader.integer("tessellation") as u32;
        let mut scene = SceneBuilder::default();
        let solid = Vessel { tessellation, height: HEIGHT, wall: None };
        let teapot = Arc::new(solid.mesh());
        let hollow = Vessel { wall: Some(WALL), ..solid };
        let vessel = Arc::new(hollow.mesh());
        let clay = Spec::new("matte", "diffuse").with("reflectance", Rgb::new(0.82, 0.70, 0.50));
        let mirror = Spec::new("mirror", "mirror").with("reflectance", Rgb::new(0.95, 0.93, 0.90));
        let glass = Spec::new("glass", "dielectric").with("absorption", Rgb::new(1.1, 0.35, 0.45));
        place(&mut scene, "matte teapot", &teapot, clay, [-1.20, -0.42], 204.0);
        place(&mut scene, "mirror teapot", &teapot, mirror, [1.10, -0.50], -16.0);
        place(&mut scene, "glass teapot", &vessel, glass, [-0.12, 0.70], -16.0);
        let tea =
            Spec::new("tea", "dielectric").with("eta", 1.33f32).with("absorption", Rgb::new(0.25, 1.5, 6.0));
        place(&mut scene, "tea", &Arc::new(hollow.filling(0.56)), tea, [-0.12, 0.70], -16.0);
        floor(&mut scene);
        light(&mut scene);
        let eye = Perspective::new("front")
            .position(Vec3::new(0.25, 2.3, 6.6))
            .look_at(Vec3::new(0.0, 0.41, 0.0))
            .fov(21.0);
        scene.add_camera(eye);
        scene.settings.set("size", Value::from("960x540"));
        Ok(scene)
    },
};

/// The height of the teapots, metres.
const HEIGHT: f64 = 1.0;
/// The glass teapot's wall thickness, as a fraction of its height.
const WALL: f64 = 0.022;

/// Places a teapot on the floor, turned by an angle in degrees.
fn place(
    scene: &mut SceneBuilder,
    name: &str,
    mesh: &Arc<Mesh>,
    material: Spec,
    [x, z]: [f64; 2],
    degrees: f64,
) {
    let matrix =
        DMat4::from_translation(DVec3::new(x, 0.0, z)) * DMat4::from_rotation_y(degrees.to_radians());
    let material = scene.add_material(material);
    let object = Object::new(name, mesh.clone(), material);
    scene.objects.push(object.placed(Transform::from_matrix(matrix).unwrap_or_default()));
}

fn floor(scene: &mut SceneBuilder) {
    let [light, dark] = [Rgb::new(0.19, 0.30, 0.34), Rgb::new(0.12, 0.21, 0.25)];
    let boards = shapes::chessboard(Vec3::new(0.0, -1e-4, 0.0), 36.0, 48);
    for (board, kd) in boards.into_iter().zip([light, dark]) {
        let name = board.name.clone();
        let stone = Spec::new(&name, "phong").with("kd", kd).with("ks", 0.06f32).with("exponent", 50.0f32);
        let material = scene.add_material(stone);
        scene.objects.push(Object::new(&name, Arc::new(board), material));
    }
}

fn light(scene: &mut SceneBuilder) {
    scene.lights.push(
        Spec::new("key", "rect")
            .with("position", Vec3::new(-4.2, 5.2, 2.8))
            .with("edge_u", Vec3::new(2.2, 0.0, 3.3))
            .with("edge_v", Vec3::new(2.4, 2.9, -1.6))
            .with("radiance", Rgb::new(4.6, 4.3, 3.9))
            .with("classic", Rgb::new(0.80, 0.76, 0.70)),
    );
    scene.lights.push(
        Spec::new("rim", "rect")
            .with("position", Vec3::new(5.2, 2.6, -3.4))
            .with("edge_u", Vec3::new(1.2, 0.0, 2.0))
            .with("edge_v", Vec3::new(-0.8, 2.2, 0.5))
            .with("radiance", Rgb::new(4.2, 3.2, 2.2))
            .with("classic", Rgb::new(0.26, 0.20, 0.14)),
    );
    scene.lights.push(
        Spec::new("sky", "environment")
            .with("zenith", Rgb::new(0.85, 0.92, 1.0))
            .with("horizon", Rgb::new(0.22, 0.26, 0.32))
            .with("ground", Rgb::new(0.10, 0.12, 0.14)),
    );
}
