//! Many lights: a garden supper at night under six hundred small bulbs.

use super::tiles::Tiles;
use super::{Stage, about, boxes};
use crate::GeneratorEntry;
use crate::interior::{furniture, tableware};
use crate::modelling::parts::{chance, joined, moved, placed, turned};
use bilux_math::{Rgb, Vec3};
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder, Spec};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("many-lights", "a supper in a garden at night, under 600 small bulbs"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

/// The number of cords, and of bulbs on each.
const CORDS: u32 = 15;
const BULBS: u32 = 40;

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.7);
    ground(&mut stage);
    bulbs(&mut stage);
    supper(&mut stage);
    trees(&mut stage);
    stage.light(
        Spec::new("night", "environment")
            .with("zenith", Rgb::new(0.006, 0.010, 0.030))
            .with("horizon", Rgb::new(0.030, 0.036, 0.080))
            .with("ground", Rgb::new(0.0, 0.0, 0.0)),
    );
    stage.seen([1.1, 1.75, 7.2], [0.0, 1.42, 0.0], 38.0)
}

fn ground(stage: &mut Stage) {
    let grass = stage.diffuse("grass", [0.14, 0.20, 0.07]);
    stage.put("grass", shapes::floor(Vec3::new(0.0, -0.05, 0.0), 400.0), grass);
    let tiles = Tiles {
        corner: [-3.6, 0.0, 4.8],
        edges: [[7.2, 0.0, 0.0], [0.0, 0.0, -9.0]],
        counts: [12, 15],
        joint: 0.04,
        pattern: 700,
    };
    let (shades, joints) = tiles.meshes::<3>();
    for (mesh, colour) in shades.into_iter().zip([[0.48, 0.45, 0.42], [0.40, 0.38, 0.36], [0.54, 0.49, 0.44]])
    {
        let stone = stage.diffuse("flags", colour);
        stage.put("flags", mesh, stone);
    }
    let moss = stage.diffuse("moss", [0.10, 0.12, 0.06]);
    stage.put("joints", joints, moss);
}

/// Cords between two beams on posts, with a bulb every few inches; most are warm, a few are coloured.
fn bulbs(stage: &mut Stage) {
    let wood = stage.diffuse("posts", [0.24, 0.15, 0.09]);
    stage.put(
        "posts",
        boxes(&[
            [[-3.3, 0.0, -3.3], [-3.15, 3.0, -3.15]],
            [[3.15, 0.0, -3.3], [3.3, 3.0, -3.15]],
            [[-3.3, 0.0, 3.15], [-3.15, 3.0, 3.3]],
            [[3.15, 0.0, 3.15], [3.3, 3.0, 3.3]],
            [[-3.32, 3.0, -3.6], [-3.13, 3.15, 3.6]],
            [[3.13, 3.0, -3.6], [3.32, 3.15, 3.6]],
        ]),
        wood,
    );
    let black = stage.diffuse("cord", [0.03, 0.03, 0.03]);
    let colours = [
        [22.0, 15.5, 8.5],
        [20.0, 13.0, 6.5],
        [23.0, 17.5, 11.0],
        [24.0, 6.0, 3.0],
        [6.0, 15.0, 21.0],
        [20.0, 18.0, 4.0],
    ];
    let glows = colours.map(|colour| stage.glowing("bulb", colour));
    let bulb = shapes::icosphere(Vec3::ZERO, 0.030, 1);
    let mut cords = Vec::new();
    for k in 0..CORDS {
        let z = 3.3 - 6.6 * k as f32 / (CORDS - 1) as f32;
        let sag = 0.42 + 0.16 * chance(710, k);
        let at =
            |t: f32| Vec3::new(6.3 * (t - 0.5), 3.02 - 4.0 * sag * t * (1.0 - t), z + 0.05 * chance(711, k));
        cords.extend((0..24).map(|i| piece(at(i as f32 / 24.0), at((i + 1) as f32 / 24.0))));
        for i in 0..BULBS {
            let n = k * BULBS + i;
            let kind = if chance(712, n) < 0.82 {
                (chance(713, n) * 3.0) as usize
            } else {
                3 + (chance(713, n) * 3.0) as usize
            };
            let p = at((i as f32 + 0.5) / BULBS as f32);
            stage.put("bulb", moved(&bulb, [p.x, p.y - 0.042, p.z]), glows[kind.min(5)]);
        }
    }
    stage.put("cords", joined(cords), black);
}

/// A thin three-sided bar from one point to another.
fn piece(a: Vec3, b: Vec3) -> Mesh {
    let around = [Vec3::new(0.0, 0.006, 0.0), Vec3::new(0.0, -0.003, 0.005), Vec3::new(0.0, -0.003, -0.005)];
    let positions: Vec<Vec3> = around.iter().map(|&o| a + o).chain(around.iter().map(|&o| b + o)).collect();
    let sides = [[0, 1], [1, 2], [2, 0]].into_iter().flat_map(|[i, j]| [[i, j, j + 3], [i, j + 3, i + 3]]);
    let mut mesh = Mesh { name: "cord".to_owned(), positions, triangles: sides.collect(), ..Mesh::default() };
    mesh.normals = mesh.smooth_normals();
    mesh
}

/// A long table, laid, with chairs around it.
fn supper(stage: &mut Stage) {
    let oak = stage.glossy("oak", [0.38, 0.23, 0.12], 0.05, 60.0);
    let linen = stage.diffuse("linen", [0.74, 0.72, 0.68]);
    let china = stage.glossy("china", [0.66, 0.68, 0.72], 0.08, 200.0);
    let orange = stage.glossy("orange", [0.85, 0.36, 0.04], 0.04, 30.0);
    let tables = [-0.98, 0.98].map(|x| moved(&furniture::table(1), [x, 0.0, 0.3]));
    stage.put("table", joined(tables), oak);
    stage.put("cloth", boxes(&[[[-1.96, 0.751, -0.14], [1.96, 0.757, 0.74]]]), linen);
    let chair = furniture::chair(1);
    let seats = (0..5).flat_map(|k| {
        let x = -1.6 + 0.8 * k as f32;
        [
            placed(&chair, (Vec3::Y, 6.0 * (chance(720, k) - 0.5)), [x, 0.0, -0.46]),
            placed(&chair, (Vec3::Y, 180.0 + 14.0 * (chance(721, k) - 0.5)), [x, 0.0, 1.08]),
        ]
    });
    stage.put("chairs", joined(seats), oak);
    let places = (0..5).flat_map(|k| [0.04, 0.56].map(|z| [-1.6 + 0.8 * k as f32, 0.757, z]));
    stage.put("plates", joined(places.clone().map(|at| moved(&tableware::plate(1), at))), china);
    let cups = places.map(|[x, y, z]| placed(&tableware::cup(1), (Vec3::Y, 90.0 * x), [x + 0.2, y, z]));
    stage.put("cups", joined(cups), china);
    let glaze = stage.glossy("glaze", [0.07, 0.20, 0.34], 0.10, 120.0);
    for x in [-0.8, 0.8] {
        stage.put("bowl", moved(&tableware::bowl(2), [x, 0.757, 0.3]), glaze);
        stage.put("oranges", moved(&tableware::oranges(2), [x, 0.757, 0.3]), orange);
    }
    stage.put("vase", moved(&tableware::vase(2), [0.0, 0.757, 0.3]), glaze);
}

/// Dark round trees in the background.
fn trees(stage: &mut Stage) {
    let leaf = stage.diffuse("leaves", [0.09, 0.17, 0.05]);
    let bark = stage.diffuse("bark", [0.16, 0.10, 0.07]);
    for (k, [x, z, size]) in [
        [-4.6, -5.0, 1.3],
        [-1.9, -6.4, 1.5],
        [1.2, -5.6, 1.2],
        [4.4, -5.4, 1.45],
        [-6.2, -1.8, 1.2],
        [6.0, -1.2, 1.3],
    ]
    .into_iter()
    .enumerate()
    {
        let lumpy = |d: Vec3| {
            size * (0.9
                + 0.12 * bilux_math::transcendental::sin_cos(7.0 * d.x + 5.0 * d.y + k as f32).0
                + 0.1 * bilux_math::transcendental::sin_cos(9.0 * d.z - 8.0 * d.y).0)
        };
        stage.put("crown", shapes::blob(Vec3::new(x, 1.9 * size, z), 4, lumpy), leaf);
        stage.put(
            "trunk",
            moved(
                &turned(
                    &[[0.0, 1.6 * size], [0.1, 1.6 * size], [0.12, 0.5], [0.18, -0.06], [0.0, -0.06]],
                    14,
                    2,
                ),
                [x, 0.0, z],
            ),
            bark,
        );
    }
}
