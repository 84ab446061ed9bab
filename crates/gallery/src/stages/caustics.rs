//! Caustics of glass under a small area light: a goblet, a ball and a teapot on a table.

use super::{Stage, about};
use crate::GeneratorEntry;
use crate::modelling::parts::{moved, placed, sheet, turned};
use crate::teapot::vessel::Vessel;
use bilux_math::{Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder, Spec};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("caustics", "a goblet, a ball and a teapot of glass under a small lamp"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.7);
    stage.deep(16);
    let plaster = stage.diffuse("plaster", [0.72, 0.66, 0.57]);
    stage.put("backdrop", backdrop(), plaster);
    let clear = stage.glass("clear glass", [0.8, 0.3, 0.4]);
    let blue = stage.glass("blue glass", [9.0, 3.2, 0.5]);
    let rose = stage.glass("rose glass", [0.8, 8.0, 4.2]);
    let amber = stage.glass("amber glass", [0.6, 3.0, 14.0]);
    let pot = Vessel { tessellation: 16, height: 0.24, wall: None }.mesh();
    stage.put("teapot", placed(&pot, (Vec3::Y, -24.0), [-0.02, 0.0, -0.10]), blue);
    stage.put("goblet", moved(&goblet(), [-0.29, 0.0, 0.03]), clear);
    stage.put("ball", shapes::icosphere(Vec3::new(0.25, 0.0752, 0.10), 0.075, 5), amber);
    stage.put("marble", shapes::icosphere(Vec3::new(0.07, 0.0382, 0.22), 0.038, 4), rose);
    stage.put("marble", shapes::icosphere(Vec3::new(-0.10, 0.0282, 0.25), 0.028, 4), clear);
    stage.panel(
        "lamp",
        [-0.85, 1.05, -0.75],
        [[0.11, 0.03, -0.03], [0.0, 0.04, 0.11]],
        [175.0, 159.0, 132.0],
    );
    stage.light(Spec::new("room", "environment").with("radiance", Rgb::new(0.05, 0.06, 0.08)));
    stage.seen([0.12, 0.62, 1.28], [-0.01, 0.075, 0.03], 26.0)
}

/// A table that bends up into the wall behind it.
fn backdrop() -> Mesh {
    let (front, bend, radius, top) = (2.0, -0.9, 0.6, 2.2);
    sheet(2, 40, |u, v| {
        let x = (u - 0.5) * 6.0;
        if v < 0.2 {
            return Vec3::new(x, 0.0, front + (bend - front) * v * 5.0);
        }
        if v > 0.8 {
            return Vec3::new(x, radius + (top - radius) * (v - 0.8) * 5.0, bend - radius);
        }
        let (sin, cos) = bilux_math::transcendental::sin_cos((v - 0.2) / 0.6 * std::f32::consts::FRAC_PI_2);
        Vec3::new(x, radius * (1.0 - cos), bend - radius * sin)
    })
}

/// A goblet, 21 cm high, its bowl hollow and empty.
fn goblet() -> Mesh {
    let outline = [
        [0.0, 0.098],
        [0.022, 0.104],
        [0.043, 0.135],
        [0.046, 0.175],
        [0.0385, 0.212],
        [0.0405, 0.213],
        [0.0490, 0.175],
        [0.0455, 0.130],
        [0.024, 0.094],
        [0.008, 0.080],
        [0.0055, 0.05],
        [0.007, 0.018],
        [0.040, 0.005],
        [0.043, 0.0025],
        [0.041, 0.0004],
        [0.0, 0.0004],
    ];
    turned(&outline, 64, 5)
}
