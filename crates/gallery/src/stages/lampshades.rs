//! Lamps in clear glass shades: no shadow ray gets through, so all light in the room has passed two walls of glass.

use super::{Stage, about, boxes};
use crate::GeneratorEntry;
use crate::interior::{furniture, tableware};
use crate::modelling::parts::{joined, moved, placed, turned};
use crate::teapot::Teapot;
use bilux_math::Vec3;
use bilux_scene::mesh::shapes;
use bilux_scene::{Mesh, SceneBuilder};

pub(crate) const ENTRY: GeneratorEntry = GeneratorEntry {
    entry: about("lampshades", "a laid table under lamps in shades of clear glass"),
    triangles: |_| 0,
    generate: |_| Ok(build()),
};

/// The top of the table.
const TOP: f32 = 0.75;

fn build() -> SceneBuilder {
    let mut stage = Stage::new(0.5);
    stage.deep(12);
    room(&mut stage);
    lamps(&mut stage);
    table(&mut stage);
    stage.seen([0.62, 1.42, 2.45], [0.0, 1.03, -0.1], 36.0)
}

fn room(stage: &mut Stage) {
    let wall = stage.diffuse("wall", [0.20, 0.38, 0.40]);
    let white = stage.diffuse("ceiling", [0.78, 0.76, 0.72]);
    let wood = stage.diffuse("panels", [0.32, 0.18, 0.10]);
    stage.put(
        "walls",
        boxes(&[
            [[-2.1, 0.0, -1.6], [2.1, 2.5, -1.5]],
            [[-2.1, 0.0, -1.6], [-2.0, 2.5, 3.1]],
            [[2.0, 0.0, -1.6], [2.1, 2.5, 3.1]],
            [[-2.1, 0.0, 3.0], [2.1, 2.5, 3.1]],
        ]),
        wall,
    );
    stage.put("ceiling", boxes(&[[[-2.1, 2.5, -1.6], [2.1, 2.6, 3.1]]]), white);
    stage.put("floor", boxes(&[[[-2.1, -0.1, -1.6], [2.1, 0.0, 3.1]]]), wood);
    let battens = (0..16).map(|k| {
        let x = -1.95 + 0.26 * k as f32;
        [[x - 0.015, 0.0, -1.5], [x + 0.015, 0.98, -1.482]]
    });
    let rail = [[-2.0, 0.98, -1.5], [2.0, 1.05, -1.465]];
    let panel = [[-2.0, 0.0, -1.5], [2.0, 0.98, -1.492]];
    stage.put("wainscot", boxes(&battens.chain([rail, panel]).collect::<Vec<_>>()), wood);
}

/// Three pendants: a bulb in a closed globe or bell of glass, 6 mm thick.
fn lamps(stage: &mut Stage) {
    let glass = stage.glass("glass", [0.4, 0.2, 0.2]);
    let amber = stage.glass("amber glass", [2.0, 26.0, 110.0]);
    let smoke = stage.glass("green glass", [60.0, 8.0, 36.0]);
    let brass = stage.glossy("brass", [0.34, 0.22, 0.07], 0.35, 90.0);
    let bulb = stage.glowing("bulb", [90.0, 72.0, 50.0]);
    for (x, y, material, tall) in
        [(-0.62, 1.60, amber, false), (0.0, 1.66, glass, true), (0.62, 1.60, smoke, false)]
    {
        let at = [x, y, -0.12];
        stage.put("shade", moved(&shade(tall), at), material);
        stage.put("bulb", shapes::icosphere(Vec3::new(x, y, -0.12), 0.060, 3), bulb);
        stage.put("cord", moved(&cord(), at), brass);
    }
}

/// A closed shade with two surfaces: an outside, and an inside that faces inwards.
fn shade(tall: bool) -> Mesh {
    let (wide, high) = if tall { (0.125, 0.16) } else { (0.115, 0.115) };
    let shell = |wide: f32, high: f32| {
        let mut outline: Vec<[f32; 2]> = (0..=24)
            .map(|k| {
                let (sin, cos) = bilux_math::transcendental::sin_cos(std::f32::consts::PI * k as f32 / 24.0);
                // Slightly narrower at the top than at the bottom.
                [wide * sin * (1.0 - 0.12 * cos), high * cos]
            })
            .collect();
        outline[0][0] = 0.0;
        outline[24][0] = 0.0;
        turned(&outline, 48, 1)
    };
    let mut inside = shell(wide - 0.006, high - 0.006);
    inside.triangles.iter_mut().for_each(|t| t.reverse());
    inside.normals.iter_mut().for_each(|n| *n = -*n);
    joined([shell(wide, high), inside])
}

/// The cord from just above the shade up to the ceiling.
fn cord() -> Mesh {
    turned(
        &[
            [0.0, 0.95],
            [0.004, 0.95],
            [0.004, 0.6],
            [0.004, 0.24],
            [0.022, 0.22],
            [0.026, 0.175],
            [0.0, 0.172],
        ],
        16,
        2,
    )
}

fn table(stage: &mut Stage) {
    let oak = stage.glossy("oak", [0.40, 0.24, 0.12], 0.05, 60.0);
    let linen = stage.diffuse("linen", [0.76, 0.72, 0.64]);
    let china = stage.glossy("china", [0.72, 0.70, 0.66], 0.08, 200.0);
    let glaze = stage.glossy("glaze", [0.45, 0.10, 0.06], 0.10, 200.0);
    let orange = stage.glossy("orange", [0.85, 0.36, 0.04], 0.04, 30.0);
    stage.put("table", furniture::table(2), oak);
    stage.put("runner", boxes(&[[[-0.97, TOP, -0.19], [0.97, TOP + 0.004, 0.19]]]), linen);
    let chair = furniture::chair(2);
    let seats = [[-0.45, -0.62, 0.0], [0.45, -0.62, 0.0]];
    stage.put("chairs", joined(seats.map(|[x, z, turn]| placed(&chair, (Vec3::Y, turn), [x, 0.0, z]))), oak);
    let on_top = |x: f32, z: f32| [x, TOP + 0.004, z];
    stage.put("bowl", moved(&tableware::bowl(3), on_top(-0.05, 0.0)), china);
    stage.put("oranges", moved(&tableware::oranges(3), on_top(-0.05, 0.0)), orange);
    let plates = [[-0.5, 0.32], [0.42, 0.32], [-0.48, -0.32], [0.42, -0.32]].map(|[x, z]| [x, TOP, z]);
    stage.put("plates", joined(plates.map(|at| moved(&tableware::plate(3), at))), china);
    let cups = plates
        .map(|[x, y, z]| placed(&tableware::cup(3), (Vec3::Y, 50.0 + 300.0 * x), [x + 0.2, y, z * 0.85]));
    stage.put("cups", joined(cups), glaze);
    let pot = Teapot { tessellation: 10, height: 0.2, bottom: true }.mesh();
    stage.put("teapot", placed(&pot, (Vec3::Y, 205.0), on_top(0.36, -0.02)), glaze);
    stage.put("vase", moved(&tableware::vase(3), on_top(-0.62, 0.0)), china);
}
