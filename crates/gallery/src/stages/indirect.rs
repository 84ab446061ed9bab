//! A room lit indirectly by an uplighter: all light comes from the ceiling.

use super::{Stage, about, boxes};
use crate::GeneratorEntry;
use crate::interior::{furniture, soft, tableware};
use crate::modelling::parts::{between, joined, moved, placed, rounded, turned};
use bilux_math::Vec3;
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("indirect", "a reading corner where all light is reflected off the ceiling"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.3);
    room(&mut stage);
    let brass = stage.glossy("brass", [0.30, 0.19, 0.06], 0.4, 60.0);
    let lamp = [-1.25, 0.0, -1.25];
    stage.put("uplighter", moved(&uplighter(), lamp), brass);
    let bulb = stage.glowing("bulb", [210.0, 172.0, 128.0]);
    stage.put("bulb", shapes::disc(Vec3::new(lamp[0], 1.80, lamp[2]), 0.14, 24), bulb);
    let velvet = stage.diffuse("velvet", [0.06, 0.26, 0.27]);
    stage.put("armchair", placed(&furniture::armchair(2), (Vec3::Y, 32.0), [-0.25, 0.0, -0.55]), velvet);
    let wood = stage.glossy("walnut", [0.19, 0.10, 0.055], 0.06, 80.0);
    stage.put("feet", placed(&furniture::feet(2), (Vec3::Y, 32.0), [-0.25, 0.0, -0.55]), wood);
    stage.put("side table", side_table(), wood);
    let ochre = stage.diffuse("cushion", [0.72, 0.40, 0.08]);
    let cushion = rounded(between([-0.2, -0.2, -0.055], [0.2, 0.2, 0.055]), 0.05, 6);
    let cushion = placed(&cushion, (Vec3::X, -20.0), [0.0; 3]);
    stage.put("cushion", placed(&cushion, (Vec3::Y, 36.0), [-0.33, 0.66, -0.64]), ochre);
    table_things(&mut stage);
    pictures(&mut stage);
    stage.seen([0.78, 1.32, 3.75], [0.02, 0.98, -0.6], 38.0)
}

/// Walls, floor, ceiling, rug and skirting; closed behind the camera.
fn room(stage: &mut Stage) {
    let plaster = stage.diffuse("plaster", [0.70, 0.62, 0.53]);
    let white = stage.diffuse("ceiling", [0.84, 0.82, 0.78]);
    let boards = stage.glossy("boards", [0.36, 0.22, 0.12], 0.05, 60.0);
    let walls = [
        [[-2.1, 0.0, -2.0], [2.1, 2.6, -1.9]],
        [[-2.1, 0.0, -2.0], [-2.0, 2.6, 4.2]],
        [[2.0, 0.0, -2.0], [2.1, 2.6, 4.2]],
        [[-2.1, 0.0, 4.1], [2.1, 2.6, 4.2]],
    ];
    stage.put("walls", boxes(&walls), plaster);
    stage.put("ceiling", boxes(&[[[-2.1, 2.6, -2.0], [2.1, 2.7, 4.2]]]), white);
    stage.put("floor", boxes(&[[[-2.1, -0.1, -2.0], [2.1, 0.0, 4.2]]]), boards);
    stage.put(
        "skirting",
        boxes(&[
            [[-2.0, 0.0, -1.9], [2.0, 0.12, -1.88]],
            [[-2.0, 0.0, -1.88], [-1.98, 0.12, 4.1]],
            [[1.98, 0.0, -1.88], [2.0, 0.12, 4.1]],
        ]),
        white,
    );
    let wool = stage.diffuse("wool", [0.52, 0.13, 0.09]);
    stage.put("rug", placed(&soft::rug(1), (Vec3::Y, 8.0), [0.15, 0.0, 0.1]), wool);
}

/// A bowl on a pole, 1.85 m high, that emits light only upwards.
fn uplighter() -> Mesh {
    let bowl = [
        [0.0, 1.745],
        [0.09, 1.755],
        [0.165, 1.80],
        [0.20, 1.875],
        [0.207, 1.87],
        [0.17, 1.785],
        [0.09, 1.735],
        [0.0, 1.72],
    ];
    let pole = [
        [0.0, 1.74],
        [0.014, 1.735],
        [0.013, 1.0],
        [0.013, 0.06],
        [0.03, 0.035],
        [0.13, 0.022],
        [0.14, 0.01],
        [0.14, 0.0],
        [0.0, 0.0],
    ];
    joined([turned(&bowl, 40, 3), turned(&pole, 20, 2)])
}

fn side_table() -> Mesh {
    let leg =
        [[0.0, 0.52], [0.02, 0.52], [0.024, 0.3], [0.035, 0.08], [0.16, 0.02], [0.165, 0.0], [0.0, 0.0]];
    let top = [[0.0, 0.55], [0.26, 0.55], [0.275, 0.54], [0.275, 0.525], [0.26, 0.515], [0.0, 0.515]];
    moved(&joined([turned(&leg, 24, 3), turned(&top, 48, 2)]), [0.72, 0.0, -0.35])
}

/// A vase with leaves, a cup, and books left on the table.
fn table_things(stage: &mut Stage) {
    let glaze = stage.glossy("glaze", [0.08, 0.20, 0.34], 0.10, 200.0);
    let leaf = stage.diffuse("leaf", [0.20, 0.40, 0.10]);
    let pot = stage.diffuse("terracotta", [0.58, 0.26, 0.14]);
    stage.put("cup", placed(&tableware::cup(3), (Vec3::Y, -60.0), [0.84, 0.55, -0.28]), glaze);
    stage.put("pot", moved(&tableware::pot(2), [1.55, 0.0, -1.42]), pot);
    stage.put("leaves", moved(&soft::leaves(1), [1.55, 0.0, -1.42]), leaf);
    for (k, (colour, size)) in
        [([0.45, 0.08, 0.06], 0.13), ([0.80, 0.72, 0.55], 0.12), ([0.07, 0.16, 0.30], 0.10)]
            .into_iter()
            .enumerate()
    {
        let cloth = stage.diffuse("cloth", colour);
        let book = rounded(between([-size, 0.0, -0.75 * size], [size, 0.028, 0.75 * size]), 0.004, 2);
        let place = [0.62, 0.55 + 0.0285 * k as f32, -0.40];
        stage.put("book", placed(&book, (Vec3::Y, 15.0 - 21.0 * k as f32), place), cloth);
    }
}

/// Two framed pictures on the wall.
fn pictures(stage: &mut Stage) {
    let oak = stage.diffuse("oak", [0.40, 0.25, 0.13]);
    let spots =
        [([0.62, 0.34, 0.12], [0.28, 1.55], [0.32, 0.24]), ([0.16, 0.27, 0.33], [1.0, 1.62], [0.2, 0.26])];
    for (colour, [x, y], [w, h]) in spots {
        let canvas = stage.diffuse("canvas", colour);
        stage.put("picture", boxes(&[[[x - w, y - h, -1.9], [x + w, y + h, -1.885]]]), canvas);
        let bar = |low: [f32; 2], high: [f32; 2]| [[low[0], low[1], -1.9], [high[0], high[1], -1.865]];
        let (l, r, b, t) = (x - w, x + w, y - h, y + h);
        let bars = [
            bar([l - 0.03, b - 0.03], [r + 0.03, b]),
            bar([l - 0.03, t], [r + 0.03, t + 0.03]),
            bar([l - 0.03, b], [l, t]),
            bar([r, b], [r + 0.03, t]),
        ];
        stage.put("frame", boxes(&bars), oak);
    }
}
