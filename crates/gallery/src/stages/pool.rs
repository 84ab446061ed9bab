//! A pool: objects below the water are lit and seen through it, along specular-diffuse-specular paths.

use super::tiles::Tiles;
use super::{Stage, about, boxes};
use crate::GeneratorEntry;
use crate::modelling::parts::{joined, moved, placed, sheet, turned};
use bilux_math::transcendental::sin_cos;
use bilux_math::{Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder, Spec};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("pool", "a tiled basin under rippled water, lit by a lamp like a low sun"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

/// Half the basin's width and length, and its depth.
const HALF: [f32; 2] = [2.0, 3.0];
const DEPTH: f32 = 1.3;
/// The height of the water, below the edge.
const LEVEL: f32 = -0.12;

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.4);
    basin(&mut stage);
    surroundings(&mut stage);
    let water =
        Spec::new("water", "dielectric").with("eta", 1.33f32).with("absorption", Rgb::new(0.20, 0.045, 0.03));
    let water = stage.material(water);
    stage.put("water", surface(), water);
    things(&mut stage);
    stage.panel("sun", [-5.6, 7.2, 3.4], [[0.8, 0.75, 0.0], [-0.35, 0.35, 1.1]], [190.0, 168.0, 136.0]);
    stage.light(
        Spec::new("sky", "environment")
            .with("zenith", Rgb::new(0.20, 0.34, 0.62))
            .with("horizon", Rgb::new(0.50, 0.58, 0.66))
            .with("ground", Rgb::new(0.1, 0.1, 0.1)),
    );
    stage.seen([2.75, 2.55, 4.9], [-0.15, -0.5, -0.1], 40.0)
}

/// Rippled water; the sheet continues into the walls, which hide its edge.
fn surface() -> Mesh {
    let [x, z] = HALF.map(|half| half + 0.03);
    let waves = [
        [6.1, 2.3, 0.0],
        [-3.7, 6.4, 1.0],
        [7.3, -5.6, 2.2],
        [2.2, -9.6, 4.0],
        [-9.1, -4.2, 5.1],
        [10.9, 5.7, 0.6],
    ];
    sheet(120, 170, |u, v| {
        let (px, pz) = (x * (2.0 * u - 1.0), z * (2.0 * v - 1.0));
        let height =
            |[a, b, shift]: [f32; 3]| sin_cos(a * px + b * pz + shift).0 * 0.055 / (a * a + b * b).sqrt();
        Vec3::new(px, LEVEL + waves.into_iter().map(height).sum::<f32>(), pz)
    })
}

/// Floor and walls of small blue tiles, each wall in front of a solid one.
fn basin(stage: &mut Stage) {
    let [x, z] = HALF;
    let d = DEPTH;
    let sides = [
        ([-x, -d, z], [[2.0 * x, 0.0, 0.0], [0.0, 0.0, -2.0 * z]], [20, 30]),
        ([-x, -d, z], [[0.0, 0.0, -2.0 * z], [0.0, d, 0.0]], [30, 6]),
        ([x, -d, -z], [[0.0, 0.0, 2.0 * z], [0.0, d, 0.0]], [30, 6]),
        ([-x, -d, -z], [[2.0 * x, 0.0, 0.0], [0.0, d, 0.0]], [20, 6]),
        ([x, -d, z], [[-2.0 * x, 0.0, 0.0], [0.0, d, 0.0]], [20, 6]),
    ];
    let colours = [[0.36, 0.68, 0.72], [0.24, 0.58, 0.66], [0.50, 0.76, 0.76], [0.14, 0.44, 0.58]];
    let (mut shades, mut joints) = (colours.map(|_| Vec::new()), Vec::new());
    for (k, (corner, edges, counts)) in sides.into_iter().enumerate() {
        let (tiles, ground) =
            Tiles { corner, edges, counts, joint: 0.06, pattern: 500 + k as u64 }.meshes::<4>();
        shades.iter_mut().zip(tiles).for_each(|(all, tiles)| all.push(tiles));
        joints.push(ground);
    }
    for (tiles, colour) in shades.into_iter().zip(colours) {
        let material = stage.diffuse("tiles", colour);
        stage.put("tiles", joined(tiles), material);
    }
    let white = stage.diffuse("joints", [0.70, 0.70, 0.66]);
    stage.put("joints", joined(joints), white);
}

/// The deck around, a low wall, and the grass beyond.
fn surroundings(stage: &mut Stage) {
    let [x, z] = HALF;
    let stone = stage.diffuse("stone", [0.62, 0.56, 0.46]);
    let edge = [
        [[-x - 0.35, -DEPTH - 0.2, -z], [-x - 0.005, 0.02, z]],
        [[x + 0.005, -DEPTH - 0.2, -z], [x + 0.35, 0.02, z]],
        [[-x - 0.35, -DEPTH - 0.2, -z - 0.35], [x + 0.35, 0.02, -z - 0.005]],
        [[-x - 0.35, -DEPTH - 0.2, z + 0.005], [x + 0.35, 0.02, z + 0.35]],
    ];
    stage.put("coping", boxes(&edge), stone);
    let wood = stage.diffuse("deck", [0.40, 0.26, 0.15]);
    let planks = (0..44).flat_map(|k| {
        let near = -7.0 + 0.25 * k as f32;
        let plank = |from: f32, to: f32| [[from, -0.06, near], [to, -0.01, near + 0.235]];
        let beside = near + 0.235 < -z - 0.35 || near > z + 0.35;
        if beside { vec![plank(-7.0, 7.0)] } else { vec![plank(-7.0, -x - 0.36), plank(x + 0.36, 7.0)] }
    });
    stage.put("deck", boxes(&planks.collect::<Vec<_>>()), wood);
    let plaster = stage.diffuse("wall", [0.74, 0.66, 0.55]);
    stage.put(
        "wall",
        boxes(&[[[-7.0, -0.1, -5.4], [7.0, 1.9, -5.1]], [[-5.4, -0.1, -5.4], [-5.1, 1.9, 5.0]]]),
        plaster,
    );
}

/// A swimming ring, a ball, and steps to climb out by.
fn things(stage: &mut Stage) {
    let red = stage.glossy("red rubber", [0.72, 0.07, 0.05], 0.05, 60.0);
    let white = stage.glossy("white rubber", [0.80, 0.79, 0.76], 0.05, 60.0);
    let ring =
        placed(&shapes::torus(Vec3::ZERO, 0.36, 0.11, 64, 24), (Vec3::X, 3.0), [-0.55, LEVEL + 0.045, -1.05]);
    let (mut odd, mut even) = (ring.clone(), ring);
    let sector = |k: usize| ((k / 2 % 64) / 8).is_multiple_of(2);
    odd.triangles =
        odd.triangles.into_iter().enumerate().filter(|(k, _)| sector(*k)).map(|(_, t)| t).collect();
    even.triangles =
        even.triangles.into_iter().enumerate().filter(|(k, _)| !sector(*k)).map(|(_, t)| t).collect();
    stage.put("ring", odd, red);
    stage.put("ring", even, white);
    let yellow = stage.glossy("ball", [0.85, 0.58, 0.06], 0.05, 60.0);
    stage.put("ball", shapes::uv_sphere(Vec3::new(0.75, -DEPTH + 0.2, 0.3), 0.2, 48, 24), yellow);
    let steel = stage.glossy("steel", [0.34, 0.34, 0.35], 0.4, 80.0);
    let rail = turned(&[[0.0, 0.75], [0.025, 0.74], [0.025, 0.2], [0.025, -1.1], [0.0, -1.1]], 16, 2);
    let rung = placed(
        &turned(&[[0.0, 0.2], [0.016, 0.2], [0.016, -0.2], [0.0, -0.2]], 12, 1),
        (Vec3::X, 90.0),
        [0.0; 3],
    );
    let rungs = [-0.25, -0.5, -0.75].map(|y| moved(&rung, [-1.88, y, -1.2]));
    let rails = [-1.4, -1.0].map(|z| moved(&rail, [-1.88, 0.0, z]));
    stage.put("ladder", joined(rails.into_iter().chain(rungs)), steel);
}
