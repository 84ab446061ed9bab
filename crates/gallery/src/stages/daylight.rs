//! Open daylight without caustics: a giant's teapot among columns, under sun and sky.

use super::tiles::Tiles;
use super::{Stage, about, boxes};
use crate::GeneratorEntry;
use crate::modelling::parts::{joined, moved, placed, turned};
use crate::teapot::Teapot;
use bilux_math::transcendental::sin_cos;
use bilux_math::{Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder, Spec};
use std::f32::consts::TAU;

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("daylight", "a giant teapot among columns, in open daylight"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.2);
    let grass = stage.diffuse("grass", [0.15, 0.22, 0.06]);
    stage.put("meadow", shapes::floor(Vec3::new(0.0, -0.3, 0.0), 400.0), grass);
    let marble = stage.diffuse("marble", [0.72, 0.68, 0.60]);
    let clay = stage.diffuse("clay", [0.58, 0.21, 0.10]);
    stage.put("steps", steps(), marble);
    paving(&mut stage);
    stage.put("columns", columns(), marble);
    stage.put(
        "pedestal",
        boxes(&[
            [[-1.0, 0.0, -1.0], [1.0, 0.2, 1.0]],
            [[-0.8, 0.2, -0.8], [0.8, 0.95, 0.8]],
            [[-0.92, 0.95, -0.92], [0.92, 1.08, 0.92]],
        ]),
        marble,
    );
    let pot = Teapot { tessellation: 14, height: 1.75, bottom: true }.mesh();
    stage.put("teapot", placed(&pot, (Vec3::Y, -28.0), [0.0, 1.08, 0.0]), clay);
    let leaf = stage.diffuse("cypress", [0.07, 0.14, 0.05]);
    for (k, [x, z, size]) in [
        [-8.5, -9.0, 1.0],
        [-6.0, -13.0, 1.25],
        [7.5, -10.0, 1.1],
        [10.5, -14.0, 1.4],
        [3.0, -19.0, 1.2],
        [-13.0, -17.0, 1.3],
    ]
    .into_iter()
    .enumerate()
    {
        stage.put("cypress", cypress(k as f32, [x, z], size), leaf);
    }
    stage.light(
        Spec::new("sun", "directional")
            .with("direction", Vec3::new(0.78, -0.62, -0.42))
            .with("irradiance", Rgb::new(4.6, 4.0, 3.1)),
    );
    stage.light(
        Spec::new("sky", "environment")
            .with("zenith", Rgb::new(0.09, 0.20, 0.52))
            .with("horizon", Rgb::new(0.40, 0.54, 0.74))
            .with("ground", Rgb::new(0.2, 0.2, 0.15)),
    );
    stage.seen([2.1, 1.75, 9.6], [0.0, 1.95, 0.0], 36.0)
}

/// Three round steps.
fn steps() -> Mesh {
    let outline =
        [[4.75, 0.0], [4.75, -0.1], [4.76, -0.1], [5.1, -0.1], [5.1, -0.2], [5.45, -0.2], [5.45, -0.31]];
    let rings = outline.windows(2).map(|pair| turned(pair, 96, 1));
    joined(rings)
}

/// The floor within the steps, in two shades of stone.
fn paving(stage: &mut Stage) {
    let ground = stage.diffuse("joints", [0.30, 0.27, 0.23]);
    stage.put("ground", shapes::disc(Vec3::new(0.0, -0.004, 0.0), 4.75, 96), ground);
    let tiles = Tiles {
        corner: [-3.3, 0.0, 3.3],
        edges: [[6.6, 0.0, 0.0], [0.0, 0.0, -6.6]],
        counts: [12, 12],
        joint: 0.03,
        pattern: 401,
    };
    let (shades, _) = tiles.meshes::<3>();
    for (mesh, colour) in shades.into_iter().zip([[0.60, 0.54, 0.45], [0.50, 0.44, 0.36], [0.56, 0.47, 0.37]])
    {
        let stone = stage.diffuse("paving", colour);
        stage.put("paving", mesh, stone);
    }
}

/// Eight columns in a ring that is open towards the front.
fn columns() -> Mesh {
    let shaft = [[0.0, 3.55], [0.30, 3.55], [0.275, 3.2], [0.30, 2.0], [0.33, 0.9], [0.345, 0.16]];
    let base = [[0.345, 0.16], [0.44, 0.15], [0.46, 0.1], [0.44, 0.05], [0.46, 0.0]];
    let capital = [[0.0, 3.68], [0.40, 3.66], [0.42, 3.60], [0.31, 3.50], [0.28, 3.42]];
    let column = joined([
        turned(&shaft, 28, 3),
        turned(&base, 28, 3),
        turned(&capital, 28, 3),
        boxes(&[[[-0.46, 3.66, -0.46], [0.46, 3.82, 0.46]]]),
    ]);
    let place = |k: u32| {
        let (sin, cos) = sin_cos(TAU * (k as f32 + 0.5) / 11.0);
        placed(&column, (Vec3::Y, 90.0 - 360.0 * (k as f32 + 0.5) / 11.0), [-4.05 * sin, 0.0, 4.05 * cos])
    };
    joined((1..10).map(place))
}

/// A slim, slightly irregular cypress.
fn cypress(k: f32, [x, z]: [f32; 2], size: f32) -> Mesh {
    let outline = [
        [0.0, 6.2],
        [0.25, 5.2],
        [0.55, 3.8],
        [0.75, 2.2],
        [0.70, 1.0],
        [0.35, 0.45],
        [0.12, 0.35],
        [0.12, -0.4],
        [0.0, -0.4],
    ];
    let mut tree = turned(&outline, 26, 5);
    for p in &mut tree.positions {
        let (a, b) = (sin_cos(p.y * 9.0 + p.x * 13.0 + k).0, sin_cos(p.z * 17.0 - p.y * 5.0 + 2.0 * k).0);
        let push = 1.0 + 0.10 * a + 0.10 * b;
        *p = Vec3::new(p.x * push, p.y, p.z * push) * size;
    }
    tree.normals = tree.smooth_normals();
    moved(&tree, [x, -0.3, z])
}
