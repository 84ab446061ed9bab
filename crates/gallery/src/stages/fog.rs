//! Light in fog: a ball of glass gathers the beam of a lamp, and its caustic stands in the air before it falls on the floor.

use super::{Stage, about, boxes};
use crate::GeneratorEntry;
use bilux_math::{Aabb, Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{SceneBuilder, Spec};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("fog", "a ball of glass in the beam of a lamp, in fog"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

fn build() -> SceneBuilder {
    let mut stage = Stage::new(1.7);
    stage.deep(24);
    let plaster = stage.diffuse("plaster", [0.55, 0.52, 0.48]);
    stage.put("floor", shapes::floor(Vec3::ZERO, 12.0), plaster);
    stage.put("wall", boxes(&[[[-6.0, 0.0, -2.6], [6.0, 6.0, -2.4]]]), plaster);
    let slate = stage.diffuse("slate", [0.16, 0.17, 0.19]);
    stage.put(
        "steps",
        boxes(&[[[-0.42, 0.0, -0.42], [0.42, 0.32, 0.42]], [[-0.3, 0.32, -0.3], [0.3, 0.6, 0.3]]]),
        slate,
    );
    let glass = stage.glass("glass", [0.05, 0.03, 0.04]);
    stage.put("ball", shapes::icosphere(Vec3::new(0.0, 0.9005, 0.0), 0.3, 6), glass);
    let amber = stage.glass("amber glass", [1.5, 5.0, 20.0]);
    stage.put("marble", shapes::icosphere(Vec3::new(0.75, 0.1602, 0.55), 0.16, 5), amber);
    let fog =
        Spec::new("fog", "interface").with("scattering", Rgb::grey(0.16)).with("absorption", Rgb::grey(0.01));
    let fog = stage.material(fog.with("scattering_anisotropy", 0.3f32));
    let around = Aabb { min: Vec3::new(-5.9, -0.05, -2.5), max: Vec3::new(5.9, 5.9, 5.9) };
    stage.put("fog", shapes::cuboid(around), fog);
    // The lamp is in a housing, from which only its beam comes out.
    stage.light(
        Spec::new("lamp", "spot")
            .with("position", Vec3::new(-2.4, 3.3, 0.5))
            .with("look_at", Vec3::new(0.05, 0.85, 0.0))
            .with("intensity", Rgb::new(145.0, 118.0, 84.0))
            .with("angle", 9.0f32)
            .with("inner_angle", 7.5f32),
    );
    stage.panel("window", [3.2, 2.6, -1.2], [[0.0, 1.2, 0.0], [-0.35, 0.0, 0.9]], [0.36, 0.62, 1.2]);
    stage.seen([0.9, 1.45, 4.6], [0.0, 0.95, 0.0], 34.0)
}
